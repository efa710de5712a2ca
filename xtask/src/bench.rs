//! `cargo xtask bench`: a whole frame, ours and OpenCV's, in one run on one thread.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::results;
use crate::setup::Tools;
use crate::shell::{cargo, command, output, root, run as call, say, target};

/// The sizes of the paper.
const SIZES: [(usize, usize); 4] = [(256, 256), (512, 512), (1024, 1024), (1920, 1080)];
/// Ours and theirs take turns this often; each turn's median counts once.
const TURNS: usize = 5;
/// Beyond the paper's, by ourselves: UHD and 8K.
const LARGE: [(usize, usize); 2] = [(3840, 2160), (7680, 4320)];
const CASES: [(&str, &str); 2] = [("cached", "reference cached"), ("estimated", "both estimated")];

/// Milliseconds a frame, one entry a turn, by case.
type Turns = BTreeMap<String, Vec<f64>>;

pub(crate) fn run(tools: &Tools) -> Result<()> {
    say("Building");
    call(cargo(&["build", "--release", "--package", "aquafuse", "--examples", "--locked"]))?;
    let (mut rows, mut restorations, mut scaling) = (String::new(), String::new(), String::new());
    for (width, height) in SIZES {
        say(&format!("{width} x {height}"));
        let folder = pictures(width, height)?;
        let (mut ours, mut theirs) = (Turns::new(), Turns::new());
        let [content, reference] = ["blue.ppm", "green.ppm"].map(|name| folder.join(name));
        let [content, reference] = [&content, &reference].map(|path| path.to_string_lossy());
        let frames = frames(width, height);
        for _ in 0..TURNS {
            read(&mut ours, &time_frames(&folder, &frames, 1)?);
            let script = ["benches/opencv_pipeline.py", "time", &content, &reference, "--frames", &frames];
            read(&mut theirs, &output(command(&tools.python, &script))?);
        }
        let restored = median(&ours, "restored");
        writeln!(restorations, "| {width} x {height} | {restored:.2} | {:.1} |", 1e3 / restored)?;
        for (case, name) in CASES {
            let (our, their) = (median(&ours, case), median(&theirs, case));
            let ratios = ours[case].iter().zip(&theirs[case]).map(|(our, their)| their / our).collect();
            let ratio = middle(ratios);
            let row = format!("| {width} x {height} | {name} | {our:.2} | {their:.2} | {ratio:.1} |");
            println!("{row}");
            writeln!(rows, "{row}")?;
        }
    }
    for (width, height) in SIZES.into_iter().chain(LARGE) {
        say(&format!("{width} x {height} on two threads"));
        let row = scaled(width, height)?;
        println!("{row}");
        writeln!(scaling, "{row}")?;
    }
    results::write_section(results::RESULTS, "speed", &section(tools, &rows)?)?;
    let scaling = format!(
        "Reference cached; as above, one and two threads in turn.\n\n\
         | size | one thread, ms | ns a pixel | two threads, times as fast |\n|---|---|---|---|\n{scaling}"
    );
    results::write_section(results::RESULTS, "scaling", &scaling)?;
    let restored =
        format!("| size | `restore`, ms a frame | frames a second |\n|---|---|---|\n{restorations}");
    results::write_section(results::RESULTS, "restored", &restored)
}

/// One thread and two, in turn.
fn scaled(width: usize, height: usize) -> Result<String> {
    let folder = pictures(width, height)?;
    let (mut alone, mut together) = (Turns::new(), Turns::new());
    for _ in 0..TURNS {
        read(&mut alone, &time_frames(&folder, &frames(width, height), 1)?);
        read(&mut together, &time_frames(&folder, &frames(width, height), 2)?);
    }
    let case = CASES[0].0;
    let gains = alone[case].iter().zip(&together[case]).map(|(one, two)| one / two).collect();
    let milliseconds = median(&alone, case);
    let a_pixel = 1e6 * milliseconds / (width * height) as f64;
    Ok(format!("| {width} x {height} | {milliseconds:.2} | {a_pixel:.2} | {:.2} |", middle(gains)))
}

/// Enough frames for a median, few enough to wait for.
fn frames(width: usize, height: usize) -> String {
    (24_000_000 / (width * height)).clamp(7, 60).to_string()
}

/// What our frames take on so many threads, as printed.
fn time_frames(folder: &Path, frames: &str, threads: usize) -> Result<String> {
    let [content, reference] = ["blue.ppm", "green.ppm"].map(|name| folder.join(name));
    let [content, reference] = [&content, &reference].map(|path| path.to_string_lossy());
    let own = target().join("release/examples/time_frames");
    let mut own = command(own, &[&content, &reference, frames]);
    own.env("RAYON_NUM_THREADS", threads.to_string());
    output(own)
}

/// The truth scene of seed 1 through its waters; made anew, for the scene's code may have changed.
fn pictures(width: usize, height: usize) -> Result<PathBuf> {
    let folder = root().join(format!("target/bench/{width}x{height}"));
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let program = target().join("release/examples/scene");
    let size = [width.to_string(), height.to_string()];
    call(command(program, &["1", &size[0], &size[1], &folder.to_string_lossy()]))?;
    Ok(folder)
}

fn read(turns: &mut Turns, printed: &str) {
    for line in printed.lines() {
        if let Some((name, Ok(milliseconds))) = line.split_once(' ').map(|(n, m)| (n, m.parse())) {
            turns.entry(name.to_owned()).or_default().push(milliseconds);
        }
    }
}

fn median(turns: &Turns, case: &str) -> f64 {
    turns.get(case).cloned().map_or(f64::NAN, middle)
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn section(tools: &Tools, rows: &str) -> Result<String> {
    let processor = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let processor = processor.lines().find_map(|line| line.strip_prefix("model name")).unwrap_or("unknown");
    let versions = "import cv2, numpy; print('OpenCV', cv2.__version__, 'and NumPy', numpy.__version__)";
    let theirs = output(command(&tools.python, &["-c", versions]))?;
    let rust = output(command("rustc", &["--version"]))?;
    Ok(format!(
        "Milliseconds a frame on one thread: median of {TURNS} turns in which the two alternate; how many times\n\
         as fast we are is the median of the turns' ratios. Model `aquafuse`, no smoothing. {}, {} on {}.\n\n\
         | size | reference | ours, ms | OpenCV, ms | times as fast |\n|---|---|---|---|---|\n{rows}",
        theirs.trim(),
        rust.split(" (").next().unwrap_or("rustc"),
        processor.trim_start_matches([' ', '\t', ':'])
    ))
}
