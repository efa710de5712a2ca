//! What a video keeps: times, sound, subtitles, tags, rotation, colours, bits, pixels.

use aquafuse::fuser::{Fuser, Options};
use aquafuse::image::Image;
use aquafuse::stream::Stream;
use aquafuse::waterbody::{EstimateOptions, WaterMap};
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::pipeline::{DepthSource, analyse};

use super::clips::{H264, PICTURE, SOUND, has_parts, make, pixels, probe, run, sound, times};

#[test]
fn sound_times_and_tags_are_those_of_the_source() {
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &SOUND, &["-t", "1", "-metadata", "title=reef"], &H264, &["a b.mp4"]]);
    let said = run.ok(&["video", "a b.mp4", "green.png", "-o", "out.mp4", "--flicker"]).stdout;
    assert!(said.contains("out.mp4: 30 frames written; estimates: "), "{said}");
    assert!(said.contains("flicker: mean colours change "), "{said}");
    assert_eq!(times(&run, "out.mp4"), times(&run, "a b.mp4"));
    assert_eq!(sound(&run, "out.mp4"), sound(&run, "a b.mp4"));
    let about = ["-show_entries", "format_tags=title:stream=codec_name,pix_fmt"];
    assert_eq!(probe(&run, "out.mp4", &about), ["h264,yuv420p", "aac", "reef"]);
    let length = ["-select_streams", "v", "-show_entries", "stream=duration_ts,time_base"];
    assert_eq!(probe(&run, "out.mp4", &length), probe(&run, "a b.mp4", &length));
    assert_ne!(pixels(&run, "out.mp4"), pixels(&run, "a b.mp4"));
    assert!(!has_parts(&run.path("")));
    // It is not replaced unasked, and the source never.
    assert!(run.fails(2, &["video", "a b.mp4", "green.png", "-o", "out.mp4"]).stderr.contains("exists"));
    let onto_itself = ["video", "a b.mp4", "--enhance", "-o", "./a b.mp4", "--overwrite"];
    assert!(run.fails(2, &onto_itself).stderr.contains("would be replaced"));
}

#[test]
fn a_rate_that_varies_stays_as_it_is() {
    let Some(run) = run() else { return };
    let vary = ["-t", "2", "-vf", "select='not(mod(n,3))+gt(n,30)'", "-vsync", "vfr"];
    make(&run, &[&PICTURE, &vary, &H264, &["vfr.mp4"]]);
    let wanted = times(&run, "vfr.mp4");
    assert!(wanted.windows(2).any(|pair| pair[1] - pair[0] > 0.05), "its rate varies: {wanted:?}");
    for (name, more) in [("out.mp4", "--restore"), ("out.mkv", "--enhance")] {
        run.ok(&["video", "vfr.mp4", more, "-o", name]);
        let found = times(&run, name);
        assert_eq!(found.len(), wanted.len());
        // Matroska has times in milliseconds.
        assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 6e-4), "{found:?} {wanted:?}");
    }
}

#[test]
fn a_stream_that_begins_at_any_time_begins_at_0() {
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &SOUND, &["-t", "1"], &H264, &["-output_ts_offset", "5000", "a.ts"]]);
    run.ok(&["video", "a.ts", "--enhance", "-o", "out.mp4"]);
    let (found, wanted) = (times(&run, "out.mp4"), times(&run, "a.ts"));
    assert!(found[0] < 0.1 && wanted[0] > 4999.0, "{} {}", found[0], wanted[0]);
    let same = |(a, b): (&f64, &f64)| ((a - found[0]) - (b - wanted[0])).abs() < 1e-4;
    assert!(found.len() == wanted.len() && found.iter().zip(&wanted).all(same), "{found:?} {wanted:?}");
}

#[test]
fn rotation_is_applied_and_its_tag_dropped() {
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &["-t", "0.5"], &H264, &["flat.mp4"]]);
    make(&run, &[&["-i", "flat.mp4", "-c", "copy", "-metadata:s:v", "rotate=90", "turned.mp4"]]);
    run.ok(&["video", "turned.mp4", "--enhance", "-o", "out.mp4"]);
    let about = [
        "-select_streams",
        "v",
        "-show_entries",
        "stream=width,height:stream_tags=rotate:stream_side_data=rotation",
    ];
    assert_eq!(probe(&run, "out.mp4", &about), ["96,128"]);
}

#[test]
fn ten_bits_and_colour_tags_stay() {
    let Some(run) = run() else { return };
    let deep =
        ["-t", "0.5", "-pix_fmt", "yuv422p10le", "-colorspace", "bt2020nc", "-color_primaries", "bt2020"];
    make(
        &run,
        &[&PICTURE, &deep, &["-color_trc", "arib-std-b67", "-color_range", "tv"], &H264, &["deep.mkv"]],
    );
    run.ok(&["video", "deep.mkv", "green.png", "-o", "out.mkv", "--flicker"]);
    let about = [
        "-select_streams",
        "v",
        "-show_entries",
        "stream=pix_fmt,color_range,color_space,color_transfer,color_primaries",
    ];
    let found = probe(&run, "out.mkv", &about);
    assert_eq!(found, probe(&run, "deep.mkv", &about));
    assert_eq!(found, ["yuv422p10le,tv,bt2020nc,arib-std-b67,bt2020"]);
    // The whole range, and a frame of odd size.
    let full = ["-t", "0.2", "-vf", "scale=127:95:out_range=pc,format=yuv444p", "-color_range", "pc"];
    make(&run, &[&PICTURE, &full, &H264, &["full.mkv"]]);
    run.ok(&["video", "full.mkv", "--enhance", "-o", "full.mp4"]);
    let about = ["-select_streams", "v", "-show_entries", "stream=width,height,pix_fmt,color_range"];
    assert_eq!(probe(&run, "full.mp4", &about), probe(&run, "full.mkv", &about));
}

#[test]
fn subtitles_go_along_and_into_the_codec_of_the_file() {
    let Some(run) = run() else { return };
    std::fs::write(run.path("s.srt"), "1\n00:00:00,100 --> 00:00:00,900\nfish\n").unwrap();
    let more = ["-i", "s.srt", "-t", "1", "-metadata:s:a:0", "language=deu", "-c:s", "srt"];
    make(&run, &[&PICTURE, &SOUND, &more, &H264, &["-c:a", "flac", "flac.mkv"]]);
    make(&run, &[&["-i", "flac.mkv", "-map", "0", "-c", "copy", "-c:a", "libopus", "opus.mkv"]]);
    run.ok(&["video", "flac.mkv", "--enhance", "-o", "out.mkv"]);
    let about = ["-show_entries", "stream=codec_name:stream_tags=language"];
    assert_eq!(probe(&run, "out.mkv", &about), ["h264", "flac,deu", "subrip"]);
    assert_eq!(sound(&run, "out.mkv"), sound(&run, "flac.mkv"));
    assert_eq!(times(&run, "out.mkv"), times(&run, "flac.mkv"));
    for (name, codecs) in [("out.mp4", ["h264", "opus", "mov_text"]), ("out.webm", ["vp9", "opus", "webvtt"])]
    {
        run.ok(&["video", "opus.mkv", "--enhance", "-o", name]);
        assert_eq!(probe(&run, name, &["-show_entries", "stream=codec_name"]), codecs);
    }
    // Sound that does not go into a file is an error with a remedy, and leaves nothing.
    let said = run.fails(1, &["video", "flac.mkv", "--enhance", "-o", "none.webm"]).stderr;
    assert!(said.contains("cannot write none.webm") && said.contains("Write to a .mkv file"), "{said}");
    assert!(!run.path("none.webm").exists() && !has_parts(&run.path("")));
}

/// FFV1 keeps what was computed: the same as the core's stream makes of the same frames.
#[test]
fn pixels_are_those_of_the_stream() {
    let Some(run) = run() else { return };
    let lossless = ["-t", "0.5", "-c:v", "ffv1", "-pix_fmt", "bgr0"];
    make(&run, &[&PICTURE, &lossless, &["a.mkv"]]);
    run.ok(&["video", "a.mkv", "green.png", "-o", "out.mkv", "--codec", "ffv1"]);
    let reference = ImageFile::read(&run.path("green.png")).unwrap().with_water_map(WaterMap::BEST);
    let reference = analyse(&reference, &DepthSource::default()).unwrap().estimate;
    let as_the_command = EstimateOptions::default().with_water_map(WaterMap::BEST);
    let options = Options::default().with_estimate(as_the_command);
    let mut stream = Stream::new(Fuser::from_estimate(reference, options));
    let mut wanted = pixels(&run, "a.mkv");
    assert_eq!(wanted.len(), 15 * 128 * 96 * 3);
    for frame in wanted.chunks_exact_mut(128 * 96 * 3) {
        let mut image = Image::<u8>::from_raw(128, 96, frame.to_vec()).unwrap();
        stream.fuse_mut(&mut image).unwrap();
        frame.copy_from_slice(&image.into_raw());
    }
    assert!(pixels(&run, "out.mkv") == wanted, "the pixels differ");
}

#[cfg(target_os = "linux")]
#[test]
fn no_name_of_a_file_means_anything_else() {
    use std::os::unix::ffi::OsStrExt;
    let Some(run) = run() else { return };
    make(&run, &[&PICTURE, &["-t", "0.1"], &H264, &["a.mp4"]]);
    for name in [&b"a%d.mp4"[..], b"concat:a.mp4|b.mp4", b"file:a.mp4", b"-a.mp4", b"n\xff\n.mp4"] {
        let name = std::ffi::OsStr::from_bytes(name);
        std::fs::copy(run.path("a.mp4"), run.path("").join(name)).unwrap();
        let output = std::path::Path::new(".").join([name, "_out.mp4".as_ref()].concat_os());
        let mut command = run.command(&["video", "--enhance", "--quiet", "-o"]);
        let ended = command.arg(&output).arg("--").arg(name).output().unwrap();
        assert!(ended.status.success(), "{name:?}: {}", String::from_utf8_lossy(&ended.stderr));
        assert!(run.path("").join(&output).is_file());
    }
}

#[cfg(target_os = "linux")]
trait Joined {
    fn concat_os(&self) -> std::ffi::OsString;
}

#[cfg(target_os = "linux")]
impl Joined for [&std::ffi::OsStr] {
    fn concat_os(&self) -> std::ffi::OsString {
        self.iter().collect::<Vec<_>>().iter().fold(std::ffi::OsString::new(), |mut all, part| {
            all.push(part);
            all
        })
    }
}
