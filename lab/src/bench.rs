//! `lab bench`: whole frames, ours and others', in one run, into `BENCHMARKS.md`.

pub(crate) mod apart;
mod footprint;
mod ours;
mod published;
pub(crate) mod python;
mod rivals;
mod turns;
mod video;

use std::fmt::Write;
use std::path::Path;

use anyhow::Result;
use published::Published;
use rivals::{OTHERS, Others};
use turns::{TURNS, Turns};
use xtask::setup;
use xtask::shell::{command, output, say};

use crate::pages::{show_section, write_section};
use crate::synthetic::images;

const PAGE: &str = "BENCHMARKS.md";

/// Width and height.
type Size = (usize, usize);

/// The sizes of the paper.
const SIZES: [Size; 4] = [(256, 256), (512, 512), (1024, 1024), FULL_HD];
const FULL_HD: Size = (1920, 1080);
/// Beyond the paper's, by ourselves: UHD and 8K.
const LARGE: [Size; 2] = [(3840, 2160), (7680, 4320)];
const CASES: [(&str, &str, &str); 3] = [
    ("cached", "reference cached", "none"),
    ("estimated", "both estimated", "none"),
    ("smoothed", "reference cached", "bilateral"),
];
const STAGES: [&str; 4] = ["depth", "waterbody", "fusion", "bilateral"];

/// What can be measured by itself.
pub(crate) const PARTS: [&str; 7] = ["frames", "others", "scaling", "python", "footprint", "arm64", "video"];

/// Measures these of [`PARTS`].
pub(crate) fn run(parts: &[&str]) -> Result<()> {
    crate::programs::aquafuse()?;
    for part in parts {
        match *part {
            "frames" => frames(&setup::python()?)?,
            "others" => others()?,
            "scaling" => scaling()?,
            "python" => python::write()?,
            "footprint" => footprint::write(PAGE)?,
            "video" => video::write()?,
            _ => crate::arm64::write_instructions(PAGE, &images((256, 256))?, &published()?)?,
        }
    }
    Ok(())
}

/// The pipeline against the same in OpenCV, its stages, streams, and `restore`.
fn frames(python: &Path) -> Result<()> {
    let published = Published::read()?;
    let [mut rows, mut stages, mut streamed, mut restored] = [const { String::new() }; 4];
    let mut machine = None;
    for size @ (width, height) in SIZES {
        say(&format!("{width} x {height}"));
        let (images, frames) = (images(size)?, frames_of(size));
        let (mut ours, mut theirs) = (Turns::default(), Turns::default());
        for _ in 0..TURNS {
            machine = Some(ours::turn(&mut ours, size, &frames, ours::ALL)?);
            rivals::pipeline(python, &mut theirs, &images, &frames)?;
        }
        for (case, reference, smoothing) in CASES {
            let (our, their) = (ours.median(case), theirs.median(case));
            let times = theirs.times(case, (&ours, case));
            let said = published.fps(size).filter(|_| case == "estimated");
            let said = said.map_or(String::new(), |fps| format!("{fps:.1}"));
            let fps = 1e3 / our;
            let row = format!(
                "| {width} x {height} | {reference} | {smoothing} | {our:.2} | {their:.1} | {times:.1} | {fps:.0} | {said} |"
            );
            println!("{row}");
            writeln!(rows, "{row}")?;
        }
        let [depth, water, fusion, bilateral] = STAGES.map(|stage| ours.median(stage));
        writeln!(stages, "| {width} x {height} | {depth:.2} | {water:.2} | {fusion:.2} | {bilateral:.2} |")?;
        for (case, table) in [("streamed", &mut streamed), ("restored", &mut restored)] {
            let milliseconds = ours.median(case);
            writeln!(table, "| {width} x {height} | {milliseconds:.2} | {:.1} |", 1e3 / milliseconds)?;
        }
    }
    if let Some(machine) = machine {
        write_section(PAGE, "machine", &about(python, &machine)?)?;
    }
    let head = "| size | reference | smoothing | ours, ms | OpenCV, ms | times as fast | ours, frames/s | \
                published, other machine, frames/s |\n|---|---|---|---|---|---|---|---|\n";
    write_section(PAGE, "speed", &format!("{head}{rows}"))?;
    let head = "| size | depth, ms | waterbody, ms | fusion, ms | bilateral, ms |\n|---|---|---|---|---|\n";
    write_section(PAGE, "stages", &format!("{head}{stages}"))?;
    let head = "| size | ms a frame | frames/s |\n|---|---|---|\n";
    write_section(PAGE, "streamed", &format!("{head}{streamed}"))?;
    let head = "| size | `restore`, ms a frame | frames/s |\n|---|---|---|\n";
    write_section(PAGE, "restored", &format!("{head}{restored}"))
}

/// What others do to an image, at the largest size of the paper.
fn others() -> Result<()> {
    say("Other programs");
    let rivals = Others::set_up()?;
    let (images, frames) = (images(FULL_HD)?, frames_of(FULL_HD));
    let (mut ours, mut theirs) = (Turns::default(), Turns::default());
    for _ in 0..TURNS {
        ours::turn(&mut ours, FULL_HD, &frames, ours::CACHED)?;
        rivals.turn(&mut theirs, &images)?;
    }
    let mut table =
        String::from("| program | ms | beside ours | ms | times as fast |\n|---|---|---|---|---|\n");
    for (case, name, beside) in OTHERS {
        let beside_name =
            if beside == "depth" { "depth from colour with its 7x7 median" } else { "a whole frame, cached" };
        let (their, our, times) =
            (theirs.median(case), ours.median(beside), theirs.times(case, (&ours, beside)));
        writeln!(table, "| {name} | {their:.1} | {beside_name} | {our:.2} | {times:.1} |")?;
    }
    show_section(PAGE, "others", &table)
}

/// One thread and two, in turn.
fn scaling() -> Result<()> {
    let mut table = String::from(
        "| size | one thread, ms | ns a pixel | two threads, times as fast |\n|---|---|---|---|\n",
    );
    for size @ (width, height) in SIZES.into_iter().chain(LARGE) {
        say(&format!("{width} x {height} on two threads"));
        let (mut alone, mut together) = (Turns::default(), Turns::default());
        for _ in 0..TURNS {
            ours::turns(&mut alone, &mut together, size, &frames_of(size))?;
        }
        let milliseconds = alone.median("cached");
        let a_pixel = 1e6 * milliseconds / (width * height) as f64;
        let times = alone.times("cached", (&together, "cached"));
        writeln!(table, "| {width} x {height} | {milliseconds:.2} | {a_pixel:.2} | {times:.2} |")?;
    }
    show_section(PAGE, "scaling", &table)
}

fn published() -> Result<String> {
    let published = Published::read()?.raspberry_pi_4;
    Ok(format!("{} frames/s at {}", published.fps, published.size))
}

/// Enough frames for a median, few enough to wait for.
fn frames_of((width, height): Size) -> String {
    (24_000_000 / (width * height)).clamp(5, 60).to_string()
}

fn about(python: &Path, machine: &ours::Machine) -> Result<String> {
    let versions = "import cv2, numpy; print('OpenCV', cv2.__version__, 'and NumPy', numpy.__version__)";
    let theirs = output(command(python, &["-c", versions]))?;
    let rust = output(command("rustc", &["--version"]))?;
    let ours::Machine { processor, cores, vectors, aquafuse } = machine;
    Ok(format!(
        "aquafuse {aquafuse} ({vectors}), {}, {}; {processor}, {cores} cores. Others: `benches/requirements.txt` and \
         `benches/medians/Cargo.lock`.\n",
        rust.split(" (").next().unwrap_or("rustc"),
        theirs.trim(),
    ))
}
