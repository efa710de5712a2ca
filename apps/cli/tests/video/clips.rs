//! Clips of ffmpeg's own sources, and what ffprobe says about a file.

use std::path::Path;
use std::process::{Command, Stdio};

use super::run::{Run, scene};

/// A picture that moves, 30 frames of it a second.
pub(crate) const PICTURE: [&str; 4] = ["-f", "lavfi", "-i", "testsrc2=size=128x96:rate=30"];
pub(crate) const SOUND: [&str; 4] = ["-f", "lavfi", "-i", "sine"];
pub(crate) const H264: [&str; 4] = ["-c:v", "libx264", "-preset", "ultrafast"];

/// A run with a reference image, if there is ffmpeg.
pub(crate) fn run() -> Option<Run> {
    let there = |program| Command::new(program).arg("-version").stdout(Stdio::null()).status().is_ok();
    if !there("ffmpeg") || !there("ffprobe") {
        println!("skipped: no ffmpeg and ffprobe here");
        return None;
    }
    let run = Run::new();
    scene(&run.path("green.png"), 2, "green");
    Some(run)
}

/// Makes a clip by ffmpeg.
pub(crate) fn make(run: &Run, parts: &[&[&str]]) {
    let mut command = Command::new("ffmpeg");
    command.current_dir(run.path("")).args(["-v", "error", "-y"]).args(parts.concat()).stdin(Stdio::null());
    assert!(command.status().unwrap().success(), "ffmpeg {parts:?}");
}

/// What ffprobe says about some entries, a line each.
pub(crate) fn probe(run: &Run, name: &str, arguments: &[&str]) -> Vec<String> {
    let mut command = Command::new("ffprobe");
    command.current_dir(run.path("")).args(["-v", "error", "-of", "csv=p=0"]).args(arguments).arg(name);
    let said = String::from_utf8(command.output().unwrap().stdout).unwrap();
    said.lines().map(|line| line.trim_end_matches(',').to_owned()).filter(|line| !line.is_empty()).collect()
}

/// The times of all frames of a video, in order.
pub(crate) fn times(run: &Run, name: &str) -> Vec<f64> {
    let entries = ["-select_streams", "V:0", "-show_entries", "packet=pts_time"];
    let mut times: Vec<f64> =
        probe(run, name, &entries).iter().filter_map(|time| time.parse().ok()).collect();
    times.sort_by(f64::total_cmp);
    times
}

/// A digest of the packets of the first sound.
pub(crate) fn sound(run: &Run, name: &str) -> String {
    let mut command = Command::new("ffmpeg");
    command.current_dir(run.path("")).args(["-v", "error", "-i", name, "-map", "0:a:0", "-c", "copy"]);
    let ended = command.args(["-f", "md5", "-"]).output().unwrap();
    assert!(ended.status.success());
    String::from_utf8(ended.stdout).unwrap()
}

/// All frames of a video, in red, green and blue.
pub(crate) fn pixels(run: &Run, name: &str) -> Vec<u8> {
    let mut command = Command::new("ffmpeg");
    command.current_dir(run.path("")).args(["-v", "error", "-i", name, "-map", "0:v:0", "-f", "rawvideo"]);
    command.args(["-pix_fmt", "rgb24", "-"]).output().unwrap().stdout
}

/// Whether the folder of a run holds a file that is not whole.
pub(crate) fn has_parts(folder: &Path) -> bool {
    folder.read_dir().unwrap().any(|entry| entry.unwrap().file_name().to_string_lossy().ends_with(".part"))
}
