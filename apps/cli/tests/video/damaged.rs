//! Videos that are cut or none, and encoders and disks that fail.

use super::clips::{H264, PICTURE, SOUND, has_parts, make, run, times};
use super::run::program;

#[test]
fn a_cut_video_keeps_the_frames_that_can_be_decoded_and_fails() {
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &SOUND, &["-t", "3"], &H264, &["-movflags", "faststart", "whole.mp4"]]);
    make(&run, &[&["-i", "whole.mp4", "-c", "copy", "whole.mkv"]]);
    for (whole, cut) in [("whole.mp4", "cut.mp4"), ("whole.mkv", "cut.mkv")] {
        let bytes = run.bytes(whole);
        std::fs::write(run.path(cut), &bytes[..bytes.len() / 2]).unwrap();
        let output = format!("out_{cut}");
        let said = run.fails(1, &["video", cut, "green.png", "-o", &output]).stderr;
        let frames = times(&run, &output).len();
        assert!((30..70).contains(&frames), "{frames} frames of 90");
        let words = format!(
            "{cut} is damaged or cut: {output} has its {frames} frames that can be decoded, the last one at 0:00:0"
        );
        assert!(said.contains(&words), "{said}");
        let lenient = run.ok(&["video", cut, "green.png", "-o", &output, "--overwrite", "--lenient"]);
        assert!(lenient.stdout.contains("WARNING: "), "{}", lenient.stdout);
    }
    // Without its index nothing of it can be read.
    make(&run, &[&["-i", "whole.mp4", "-c", "copy", "tail.mp4"]]);
    let bytes = run.bytes("tail.mp4");
    std::fs::write(run.path("none.mp4"), &bytes[..bytes.len() / 2]).unwrap();
    let said = run.fails(1, &["video", "none.mp4", "--enhance", "-o", "out.mp4"]).stderr;
    assert!(said.contains("cannot read none.mp4 as video: ") && said.contains("moov"), "{said}");
    assert!(!run.path("out.mp4").exists() && !has_parts(&run.path("")));
}

#[test]
fn what_is_no_video_is_named_with_its_cause() {
    let Some(run) = run() else { return };
    make(&run, &[&SOUND, &["-t", "1", "sound.m4a"]]);
    std::fs::write(run.path("list.mp4"), "ffconcat version 1.0\nfile secret.mp4\n").unwrap();
    std::fs::write(
        run.path("list.m3u8"),
        "#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\nsecret.ts\n#EXT-X-ENDLIST\n",
    )
    .unwrap();
    std::fs::write(run.path("empty.mp4"), "").unwrap();
    for (name, cause) in [
        ("sound.m4a", "it has no video stream"),
        ("list.mp4", "no format that holds one video"),
        ("list.m3u8", "no format that holds one video"),
        ("empty.mp4", "cannot read empty.mp4"),
        ("green.png", "cannot read green.png"),
    ] {
        let said = run.fails(1, &["video", name, "--enhance", "-o", "out.mp4"]).stderr;
        assert!(said.contains(cause) && said.contains(name), "{name}: {said}");
    }
    for (arguments, cause) in [
        (&["video", "gone.mp4", "--enhance", "-o", "out.mp4"][..], "cannot read gone.mp4"),
        (&["video", ".", "--enhance", "-o", "out.mp4"], "it is a folder"),
        (&["video", "sound.m4a", "--enhance", "-o", "out.avi"], "must end in .mp4"),
        (&["video", "sound.m4a", "--enhance", "-o", "out.mp4", "--codec", "ffv1"], "Write to .mkv"),
        (&["video", "sound.m4a", "--enhance", "-o", "out.mp4", "--raw", "2x2"], "give - for IN"),
        (&["video", "sound.m4a", "-o", "out.mp4"], "<WATER>"),
        (&["video", "sound.m4a", "--enhance", "--theta", "3", "-o", "out.mp4"], "cannot be used with"),
        (&["video", "sound.m4a", "green.png", "--strength", "1", "-o", "out.mp4"], "--restore"),
    ] {
        let said = run.fails(2, arguments).stderr;
        assert!(said.contains(cause), "{arguments:?}: {said}");
    }
    assert!(!run.path("out.mp4").exists());
}

#[test]
fn without_ffmpeg_one_sentence_says_how_to_install_it() {
    let Some(run) = run() else { return };
    std::fs::write(run.path("a.mp4"), "").unwrap();
    let mut command = run.command(&["video", "a.mp4", "--enhance", "-o", "out.mp4"]);
    let ended = command.env("PATH", "/nowhere").env_remove("AQUAFUSE_FFMPEG").output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!((ended.status.code(), said.lines().count()), (Some(1), 1), "{said}");
    assert!(said.contains("cannot find ffmpeg") && said.contains("Install it ("), "{said}");
}

/// An ffmpeg that decodes, and does something else when it is to encode.
fn encoder_that(run: &super::run::Run, lines: &str) -> String {
    program(run, "fake", &format!("case \"$*\" in *'-f ivf'*) {lines} ;; esac\nexec ffmpeg \"$@\""))
}

#[test]
fn an_encoder_that_fails_is_named_and_leaves_nothing() {
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &["-t", "3"], &H264, &["a.mp4"]]);
    for (lines, cause, remedy) in [
        ("head -c 500000 >/dev/null; kill -9 $$", "signal: 9", "Something ended it"),
        ("echo '[error] x: No space left on device' >&2; exit 1", "No space left", "Free space on its disk"),
        ("echo '[fatal] Unknown encoder' >&2; exit 1", "Unknown encoder", "another --codec"),
        ("cat >/dev/null; echo '[info] frame=    7 fps=0.0' >&2; exit 0", "exit status: 0", "Check that"),
        ("cat >/dev/null; echo '[error] Error writing trailer' >&2; exit 0", "writing trailer", "Check that"),
    ] {
        let fake = encoder_that(&run, lines);
        let mut command = run.command(&["video", "a.mp4", "--enhance", "-o", "out.mp4"]);
        let ended = command.env("AQUAFUSE_FFMPEG", &fake).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{said}");
        assert!(said.contains("cannot write out.mp4: ffmpeg ended after "), "{said}");
        assert!(said.contains(cause) && said.contains(remedy), "{lines}: {said}");
        assert!(!run.path("out.mp4").exists() && !has_parts(&run.path("")), "{lines}");
    }
}

/// A limit on the size of files is a disk that is full.
#[test]
fn a_full_disk_leaves_no_file() {
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &["-t", "3"], &H264, &["a.mp4"]]);
    let mut command = std::process::Command::new("sh");
    let line = "trap '' XFSZ; ulimit -f 100; exec \"$0\" video a.mp4 --enhance -o out.mkv --codec ffv1";
    let ended = command.args(["-c", line, env!("CARGO_BIN_EXE_aquafuse")]).current_dir(run.path("")).output();
    let ended = ended.unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(1), "{said}");
    assert!(said.contains("cannot write out.mkv: ffmpeg ended after "), "{said}");
    assert!(!run.path("out.mkv").exists() && !has_parts(&run.path("")));
}
