//! Videos of 1920 x 1080, end to end, beside ffmpeg that only decodes and encodes; and memory for more and more frames.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use xtask::shell::{command, run, say};

use super::turns::Turns;
use super::{FULL_HD, PAGE};
use crate::pages::show_section;
use crate::runner::{End, Limits, Runner};
use crate::synthetic::images;

/// Turns; each is minutes long on a small machine.
const TURNS: usize = 3;
const SECONDS: &str = "4";
const CODECS: [(&str, &[&str]); 2] =
    [("h264", &["-c:v", "libx264", "-crf", "18"]), ("h265", &["-c:v", "libx265", "-crf", "20"])];
const WAYS: [&str; 3] = ["fuse", "--restore", "--enhance"];
/// Frames of 3840 x 2160 whose memory is compared.
const FRAMES: [u32; 2] = [60, 600];
const LIMITS: Limits = Limits { seconds: 7200, address_space: 16 << 20 };

pub(super) fn write() -> Result<()> {
    let program = crate::programs::aquafuse()?;
    let folder = images(FULL_HD)?;
    let clip = clip(&folder)?;
    let mut table = String::from(
        "| 1920 x 1080 | codec | frames/s | ffmpeg alone, frames/s | share of its speed |\n|---|---|---|---|---|\n",
    );
    for (codec, arguments) in CODECS {
        let (mut ours, mut theirs) = (Turns::default(), Turns::default());
        for turn in 0..TURNS {
            say(&format!("{codec}, turn {} of {TURNS}", turn + 1));
            theirs.add("alone", alone(&clip, arguments)?);
            for way in WAYS {
                ours.add(way, changed(&program, &clip, &folder, way, codec)?);
            }
        }
        for way in WAYS {
            let share = theirs.times("alone", (&ours, way));
            let [fps, alone] = [ours.median(way), theirs.median("alone")].map(|each| 1e3 / each);
            writeln!(table, "| `{way}` | {codec} | {fps:.1} | {alone:.1} | {share:.2} |")?;
        }
    }
    table += &memory(&program, &folder)?;
    show_section(PAGE, "video", &table)
}

/// A camera that moves over a synthetic place, with the noise of a camera.
fn clip(folder: &Path) -> Result<PathBuf> {
    say("Making a clip");
    let clip = folder.join("clip.mp4");
    let moves = "scale=2112:1188,crop=1920:1080:96+90*sin(t):54+50*cos(0.7*t),noise=alls=8:allf=t,format=yuv420p";
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

fn alone(clip: &Path, codec: &[&str]) -> Result<f64> {
    let mut ffmpeg = command("ffmpeg", &["-v", "error", "-nostdin", "-y", "-i"]);
    ffmpeg.arg(clip).args(["-c:a", "copy"]).args(codec).arg(clip.with_file_name("alone.mp4"));
    timed(ffmpeg)
}

fn changed(program: &Path, clip: &Path, folder: &Path, way: &str, codec: &str) -> Result<f64> {
    let mut ours = command(program, &["video"]);
    match way {
        "fuse" => ours.arg(clip).arg(folder.join("green.png")),
        way => ours.arg(clip).arg(way),
    };
    ours.args(["--quiet", "--overwrite", "--codec", codec, "-o"]).arg(clip.with_file_name("changed.mp4"));
    timed(ours)
}

/// Memory of the command, without ffmpeg, for more and more frames.
fn memory(program: &Path, folder: &Path) -> Result<String> {
    let mut runner = Runner::new(LIMITS)?;
    let mut table = String::from("\n| frames of 3840 x 2160 | peak memory, MiB |\n|---|---|\n");
    for frames in FRAMES {
        say(&format!("{frames} frames of 3840 x 2160"));
        let clip = folder.join("uhd.mp4");
        let source = ["-v", "error", "-y", "-f", "lavfi", "-i", "testsrc2=size=3840x2160:rate=30", "-frames:v"];
        let mut make = command("ffmpeg", &source);
        make.arg(frames.to_string()).args(["-c:v", "libx264", "-preset", "ultrafast"]).arg(&clip);
        run(make)?;
        let (water, changed) = (folder.join("green.png"), folder.join("changed.mp4"));
        let arguments = [Path::new("video"), &clip, &water, Path::new("--overwrite"), Path::new("-o"), &changed];
        let ended = runner.run(program, &arguments)?;
        if ended.end != End::Exit(0) {
            bail!("it ended with {:?}: {}", ended.end, ended.said);
        }
        writeln!(table, "| {frames} | {:.0} |", ended.peak)?;
    }
    Ok(table)
}
