//! `cargo xtask bench`: a whole frame, ours and OpenCV's, in one run on one thread.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::results;
use crate::setup::Tools;
use crate::shell::{cargo, command, output, root, run as call, say};

/// The sizes of the paper.
const SIZES: [(usize, usize); 4] = [(256, 256), (512, 512), (1024, 1024), (1920, 1080)];
/// Ours and theirs take turns this often; each turn's median counts once.
const TURNS: usize = 5;
const CASES: [(&str, &str); 2] = [("cached", "reference cached"), ("estimated", "both estimated")];

/// Milliseconds a frame, one entry a turn, by case.
type Turns = BTreeMap<String, Vec<f64>>;

pub(crate) fn run(tools: &Tools) -> Result<()> {
    say("Building");
    call(cargo(&["build", "--release", "--package", "aquafuse", "--examples", "--locked"]))?;
    let (mut rows, mut restorations) = (String::new(), String::new());
    for (width, height) in SIZES {
        say(&format!("{width} x {height}"));
        let folder = pictures(width, height)?;
        let (mut ours, mut theirs) = (Turns::new(), Turns::new());
        let frames = (24_000_000 / (width * height)).clamp(7, 60).to_string();
        for _ in 0..TURNS {
            let pictures = [folder.join("blue.ppm"), folder.join("green.ppm")];
            let [content, reference] = pictures.each_ref().map(|path| path.to_string_lossy());
            let own = root().join("target/release/examples/time_frames");
            read(&mut ours, &output(command(own, &[&content, &reference, &frames]))?);
            let script = ["benches/opencv_pipeline.py", "time", &content, &reference, "--frames", &frames];
            read(&mut theirs, &output(command(&tools.python, &script))?);
        }
        let restored = median(&ours, "restored");
        writeln!(restorations, "| {width} x {height} | {restored:.2} | {:.1} |", 1e3 / restored)?;
        for (case, name) in CASES {
            let (our, their) = (median(&ours, case), median(&theirs, case));
            let ratios = ours[case].iter().zip(&theirs[case]).map(|(our, their)| our / their).collect();
            let ratio = middle(ratios);
            let row = format!("| {width} x {height} | {name} | {our:.2} | {their:.2} | {ratio:.2} |");
            println!("{row}");
            writeln!(rows, "{row}")?;
        }
    }
    results::write_section(results::RESULTS, "speed", &section(tools, &rows)?)?;
    let restored =
        format!("| size | `restore`, ms a frame | frames a second |\n|---|---|---|\n{restorations}");
    results::write_section(results::RESULTS, "restored", &restored)
}

/// The truth scene of seed 1 through its waters; made anew, for the scene's code may have changed.
fn pictures(width: usize, height: usize) -> Result<PathBuf> {
    let folder = root().join(format!("target/bench/{width}x{height}"));
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let program = root().join("target/release/examples/scene");
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
        "Milliseconds a frame on one thread: median of {TURNS} turns in which the two alternate; the ratio is the\n\
         median of the turns' ratios. Model `aquafuse`, no smoothing. {}, {} on {}.\n\n\
         | size | reference | ours, ms | OpenCV, ms | ratio |\n|---|---|---|---|---|\n{rows}",
        theirs.trim(),
        rust.split(" (").next().unwrap_or("rustc"),
        processor.trim_start_matches([' ', '\t', ':'])
    ))
}
