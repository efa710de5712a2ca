//! Standard input and output: YUV4MPEG2 and raw frames.

use std::io::Write;
use std::process::{Command, Output, Stdio};

use super::clips::{H264, PICTURE, make, pixels, probe, run};
use super::run::Run;

/// Runs a command with these bytes on standard input.
fn fed(run: &Run, arguments: &[&str], bytes: Vec<u8>, ffmpeg: Option<&str>) -> Output {
    let mut command = run.command(arguments);
    if let Some(ffmpeg) = ffmpeg {
        command.env("AQUAFUSE_FFMPEG", ffmpeg);
    }
    let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = piped.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let feed = std::thread::spawn(move || {
        let _ = stdin.write_all(&bytes);
    });
    let ended = child.wait_with_output().unwrap();
    feed.join().unwrap();
    ended
}

#[test]
fn y4m_comes_and_goes() {
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &["-t", "1"], &H264, &["a.mp4"]]);
    make(&run, &[&["-i", "a.mp4", "a.y4m"]]);
    let ended = fed(&run, &["video", "-", "green.png", "-o", "-"], run.bytes("a.y4m"), None);
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(ended.status.success() && said.contains("30 frames written"), "{said}");
    std::fs::write(run.path("out.y4m"), &ended.stdout).unwrap();
    let about = ["-count_frames", "-show_entries", "stream=width,height,pix_fmt,r_frame_rate,nb_read_frames"];
    assert_eq!(probe(&run, "out.y4m", &about), ["128,96,yuv420p,30/1,30"]);
    // To a file it is the same as from a file.
    let ended =
        fed(&run, &["video", "-", "--enhance", "-o", "b.mkv", "--codec", "ffv1"], run.bytes("a.y4m"), None);
    assert!(ended.status.success());
    run.ok(&["video", "a.y4m", "--enhance", "-o", "c.mkv", "--codec", "ffv1"]);
    assert!(pixels(&run, "b.mkv") == pixels(&run, "c.mkv"));
    for junk in [&b""[..], b"hello\n", b"YUV4MPEG2 W0 H0\n", &[b'Y'; 9000]] {
        let ended = fed(&run, &["video", "-", "--enhance", "-o", "-"], junk.to_vec(), None);
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert!(ended.status.code() == Some(1) && said.contains("cannot read standard input"), "{said}");
    }
    let twice = fed(&run, &["video", "-", "green.png", "--one-water", "-o", "-"], run.bytes("a.y4m"), None);
    assert_eq!(twice.status.code(), Some(2));
}

#[test]
fn raw_frames_need_no_ffmpeg() {
    let run = Run::new();
    super::run::scene(&run.path("green.png"), 2, "green");
    let frames: Vec<u8> = (0..5 * 64 * 48 * 3).map(|i: u32| (i * 7 % 251) as u8).collect();
    let raw = ["video", "-", "green.png", "-o", "-", "--raw", "64x48"];
    let ended = fed(&run, &raw, frames.clone(), Some("/nowhere"));
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    assert!(ended.stdout.len() == frames.len() && ended.stdout != frames);
    // A part of a frame is not a frame.
    let ended = fed(&run, &raw, frames[..frames.len() - 7].to_vec(), Some("/nowhere"));
    assert_eq!((ended.status.code(), ended.stdout.len()), (Some(1), frames.len() / 5 * 4));
    let ended = fed(&run, &["video", "-", "--enhance", "-o", "out.mp4", "--raw", "64x48"], frames, None);
    assert_eq!(ended.status.code(), Some(2));
}

/// A reader that goes away is an error that is named, and nothing hangs.
#[test]
fn a_reader_that_goes_away_ends_the_run() {
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &["-t", "20"], &H264, &["a.mp4"]]);
    let line = "\"$0\" video a.mp4 --enhance -o - 2>said.txt | head -c 100 >/dev/null";
    let mut command = Command::new("timeout");
    command.args(["60", "sh", "-c", line, env!("CARGO_BIN_EXE_aquafuse")]).current_dir(run.path(""));
    assert!(command.status().unwrap().success());
    let said = String::from_utf8(run.bytes("said.txt")).unwrap();
    assert!(said.contains("Broken pipe"), "{said}");
}
