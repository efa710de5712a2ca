//! Videos of 1920 x 1080, end to end, beside ffmpeg that only decodes and encodes; and memory for more and more frames.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use xtask::shell::{command, run, say};

use super::turns::Turns;
use super::{FULL_HD, PAGE};
use crate::pages::show_section;
use crate::synthetic::images;

/// Turns; each is minutes long on a small machine.
const TURNS: usize = 3;
const SECONDS: &str = "2";
const ALONE: [&str; 4] = ["-c:v", "libx264", "-crf", "18"];
/// With the first three both encode the same frames.
const WAYS: [&[&str]; 5] = [
    &["green.png", "--theta", "90"],
    &["green.png", "--theta", "90", "--model", "aquafuse"],
    &["--enhance", "--strength", "0"],
    &["green.png"],
    &["--restore"],
];
/// Frames of 3840 x 2160 whose memory is compared.
const FRAMES: [u32; 2] = [60, 600];

pub(super) fn write() -> Result<()> {
    let program = crate::programs::aquafuse()?;
    let folder = images(FULL_HD)?;
    let clip = clip(&folder)?;
    let (mut ours, mut theirs) = (Turns::default(), Turns::default());
    for turn in 0..TURNS {
        say(&format!("Turn {} of {TURNS}", turn + 1));
        theirs.add("alone", alone(&clip)?);
        for way in WAYS {
            ours.add(&way.join(" "), changed(&program, &clip, way)?);
        }
    }
    let mut table = String::from(
        "| 1920 x 1080, h264 | frames/s | ffmpeg alone, frames/s | share of its speed |\n|---|---|---|---|\n",
    );
    for way in WAYS.map(|way| way.join(" ")) {
        let share = theirs.times("alone", (&ours, &way));
        let [fps, alone] = [ours.median(&way), theirs.median("alone")].map(|each| 1e3 / each);
        writeln!(table, "| `{way}` | {fps:.1} | {alone:.1} | {share:.2} |")?;
    }
    table += &memory(&program, &folder)?;
    show_section(PAGE, "video", &table)
}

/// A camera that moves over a synthetic place, with the noise of a camera.
fn clip(folder: &Path) -> Result<PathBuf> {
    say("Making a clip");
    let clip = folder.join("clip.mp4");
    let moves =
        "scale=2112:1188,crop=1920:1080:96+90*sin(t):54+50*cos(0.7*t),noise=alls=8:allf=t,format=yuv420p";
    let mut make = command("ffmpeg", &["-v", "error", "-y", "-loop", "1", "-framerate", "30", "-i"]);
    make.arg(folder.join("blue.ppm")).args(["-f", "lavfi", "-i", "sine", "-t", SECONDS, "-vf", moves]);
    make.args(["-c:v", "libx264", "-crf", "20", "-preset", "fast"]).arg(&clip);
    run(make)?;
    let mut convert = command("ffmpeg", &["-v", "error", "-y", "-i"]);
    convert.arg(folder.join("green.ppm")).arg(folder.join("green.png"));
    run(convert)?;
    Ok(clip)
}

/// Milliseconds a frame.
fn timed(mut command: std::process::Command) -> Result<f64> {
    let began = Instant::now();
    let status = command.stdin(Stdio::null()).stdout(Stdio::null()).status().context("cannot start it")?;
    if !status.success() {
        bail!("{command:?} ended with {status}");
    }
    let frames = SECONDS.parse::<f64>()? * 30.0;
    Ok(1e3 * began.elapsed().as_secs_f64() / frames)
}

fn alone(clip: &Path) -> Result<f64> {
    let mut ffmpeg = command("ffmpeg", &["-v", "error", "-nostdin", "-y", "-i"]);
    ffmpeg.arg(clip).args(["-c:a", "copy"]).args(ALONE).arg(clip.with_file_name("alone.mp4"));
    timed(ffmpeg)
}

fn changed(program: &Path, clip: &Path, way: &[&str]) -> Result<f64> {
    let mut ours = command(program, &["video", "clip.mp4", "--quiet", "--overwrite", "-o", "changed.mp4"]);
    ours.args(way).current_dir(clip.parent().context("the clip has a folder")?);
    timed(ours)
}

/// Memory of the command, without ffmpeg, for more and more frames.
fn memory(program: &Path, folder: &Path) -> Result<String> {
    let mut table = String::from("\n| frames of 3840 x 2160 | peak memory, MiB |\n|---|---|\n");
    for frames in FRAMES {
        say(&format!("{frames} frames of 3840 x 2160"));
        let source =
            ["-v", "error", "-y", "-f", "lavfi", "-i", "testsrc2=size=3840x2160:rate=30", "-frames:v"];
        let mut make = command("ffmpeg", &source);
        make.arg(frames.to_string())
            .args(["-c:v", "libx264", "-preset", "ultrafast"])
            .arg(folder.join("uhd.mp4"));
        run(make)?;
        let mut ours = command(
            program,
            &["video", "uhd.mp4", "green.png", "--quiet", "--overwrite", "-o", "changed.mp4"],
        );
        let mut child = ours.current_dir(folder).stdin(Stdio::null()).spawn().context("cannot start it")?;
        let mut peak = 0.0_f64;
        let status = loop {
            peak = peak.max(held(child.id()).unwrap_or(0.0));
            match child.try_wait()? {
                Some(status) => break status,
                None => std::thread::sleep(Duration::from_millis(50)),
            }
        };
        if !status.success() {
            bail!("it ended with {status}");
        }
        writeln!(table, "| {frames} | {peak:.0} |")?;
    }
    Ok(table)
}

/// The most memory that a process has held so far, in MiB.
fn held(process: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches("kB").trim().parse::<f64>().ok().map(|kib| kib / 1024.0)
}
