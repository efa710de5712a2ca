//! What commands on scenes, and on the files of long runs, hold under a small budget.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use aquafuse::image::Image;
use aquafuse_data::image_file::{ImageFile, WriteOptions};

use super::photos;
use crate::runner::{End, Limits, Runner};
use xtask::shell::say;

const BUDGET: &str = "256MiB";
const LIMITS: Limits = Limits { seconds: 3600, address_space: 16 << 20 };
/// A scene: the sides of its images, how many they are, and its points.
struct Scene {
    size: [usize; 2],
    images: usize,
    points: usize,
}

const SCENE: Scene = Scene { size: [1920, 1280], images: 60, points: 20_000 };
/// One that the budget is too small for.
const LARGE: Scene = Scene { size: photos::LARGE, images: 4, points: 2_000_000 };
/// Letters of a message that are shown.
const LONGEST: usize = 160;
/// Lines of the files of runs.
const LINES: usize = 1_000_000;
/// Splats of the large file.
const SPLATS: usize = 5_000_000;

/// The table.
pub(super) fn table(program: &Path, folder: &Path) -> Result<String> {
    let folder = folder.join("runs");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let mut trials = Trials { program, folder, runner: Runner::new(LIMITS)?, table: String::new() };
    writeln!(trials.table, "| what | budget | peak memory, MiB | end |\n|---|---|---|---|")?;
    say("Making a large scene, and files of a million lines");
    scenes(&mut trials)?;
    files_of_runs(&mut trials)?;
    Ok(trials.table)
}

struct Trials<'a> {
    program: &'a Path,
    folder: PathBuf,
    runner: Runner,
    table: String,
}

impl Trials<'_> {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Runs a command whose words that begin with `@` are files here, and adds its row.
    fn row(&mut self, what: &str, words: &[&str]) -> Result<()> {
        let words: Vec<PathBuf> = words
            .iter()
            .chain(&["--max-memory", BUDGET, "--threads", "2"])
            .map(|word| word.strip_prefix('@').map_or_else(|| PathBuf::from(word), |name| self.path(name)))
            .collect();
        let words: Vec<&Path> = words.iter().map(PathBuf::as_path).collect();
        let outcome = self.runner.run(self.program, &words)?;
        let said = outcome.said.replace(&format!("{}/", self.folder.display()), "");
        let cause = said.lines().rfind(|line| line.starts_with("aquafuse: ")).unwrap_or_default();
        let end = match outcome.end {
            End::Exit(0) => "done".to_owned(),
            End::Exit(code) if !cause.is_empty() => {
                // All that was said is one line here, which may be as long as the run.
                let cause: String = cause.trim_start_matches("aquafuse: ").chars().take(LONGEST).collect();
                format!("exit code {code}: {cause}")
            }
            other => bail!("{what} ended with {other:?}: {said}"),
        };
        eprintln!("   {what}: {:.0} MiB, {end}", outcome.peak);
        writeln!(self.table, "| {what} | {BUDGET} | {:.0} | {} |", outcome.peak, end.replace('|', "\\|"))?;
        Ok(())
    }

    /// Runs a command of the set-up.
    fn set_up(&mut self, words: &[&str]) -> Result<()> {
        let words: Vec<PathBuf> = words
            .iter()
            .map(|word| word.strip_prefix('@').map_or_else(|| PathBuf::from(word), |name| self.path(name)))
            .collect();
        let words: Vec<&Path> = words.iter().map(PathBuf::as_path).collect();
        let outcome = self.runner.run(self.program, &words)?;
        if outcome.end != End::Exit(0) {
            bail!("{words:?} ended with {:?}: {}", outcome.end, outcome.said);
        }
        Ok(())
    }
}

fn writer(path: &Path) -> Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path).with_context(|| format!("cannot make {}", path.display()))?))
}

/// Writes a scene as COLMAP does.
fn write_scene(folder: &Path, scene: &Scene) -> Result<()> {
    let (model, photos) = (folder.join("sparse/0"), folder.join("images"));
    fs::create_dir_all(&model)?;
    fs::create_dir_all(&photos)?;
    let [width, height] = scene.size;
    let camera = format!("1 PINHOLE {width} {height} {width} {width} {} {}\n", width / 2, height / 2);
    fs::write(model.join("cameras.txt"), camera)?;
    photos::write(&photos.join("000.jpg"), 0, scene.size)?;
    let mut images = writer(&model.join("images.txt"))?;
    for number in 0..scene.images {
        let name = format!("{number:03}.jpg");
        if number > 0 {
            fs::hard_link(photos.join("000.jpg"), photos.join(&name)).context("cannot link an image")?;
        }
        writeln!(images, "{} 1 0 0 0 {} 0 0 1 {name}\n", number + 1, -(number as f64) / 50.0)?;
    }
    let mut points = writer(&model.join("points3D.txt"))?;
    for number in 0..scene.points {
        let (x, y) = ((number % 1000) as f64 / 250.0 - 2.0, (number / 1000 % 500) as f64 / 250.0 - 1.0);
        let z = 4.0 + (number % 97) as f64 / 20.0;
        writeln!(points, "{} {x} {y} {z} 90 120 110 0.5 1 {number} 2 {number}", number + 1)?;
    }
    points.flush()?;
    Ok(images.flush()?)
}

fn scenes(trials: &mut Trials<'_>) -> Result<()> {
    write_scene(&trials.path("reef"), &SCENE)?;
    write_scene(&trials.path("large"), &LARGE)?;
    large_ply(&trials.path("many.ply"))?;
    let said = |scene: &Scene| {
        format!("{} images of {}x{}, {} points", scene.images, scene.size[0], scene.size[1], scene.points)
    };
    let fuse = |scene, output| ["scene", "fuse", scene, "preset:jerlov-IB", "-o", output];
    let how = ["--longest", "200", "--hold", "8", "--iterations", "20", "--splats", "20000"];
    let train = |scene, output| [&["scene", "train", scene, "-o", output][..], &how].concat();
    trials.row(&format!("scene fuse, {}", said(&SCENE)), &fuse("@reef", "@fused"))?;
    trials.row("scene train on it, 200 pixels, 20,000 splats", &train("@reef", "@reef.ply"))?;
    // What follows reads it.
    if !trials.path("reef.ply").exists() {
        bail!("the scene was not trained on within {BUDGET}");
    }
    trials.set_up(&train("@fused", "@fused.ply"))?;
    trials.row("scene render, its cameras", &["scene", "render", "@reef.ply", "@reef", "-o", "@views"])?;
    let of = ["--original", "@reef.ply", "--fused", "@fused.ply", "--hold", "8"];
    trials.row("scene compare", &[&["scene", "compare", "@reef", "@fused"][..], &of].concat())?;
    trials.row(&format!("scene fuse, {}", said(&LARGE)), &fuse("@large", "@large_fused"))?;
    trials.row("scene train on it, 200 pixels, 20,000 splats", &train("@large", "@large.ply"))?;
    let render = ["scene", "render", "@reef.ply", "@reef", "-o", "@full", "--longest", "6000"];
    trials.row("scene render, 6000 pixels", &render)?;
    let what = format!("a PLY of {SPLATS} splats");
    trials
        .row(&format!("scene render, {what}"), &["scene", "render", "@many.ply", "@reef", "-o", "@many"])?;
    trials.row(&format!("scene view, {what}"), &["scene", "view", "@many.ply", "-o", "@many.html"])
}

/// Splats of degree 0 as PLY, whose values are all small.
fn large_ply(path: &Path) -> Result<()> {
    let names = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";
    let mut file = writer(path)?;
    write!(file, "ply\nformat binary_little_endian 1.0\nelement vertex {SPLATS}\n")?;
    for name in names.split(' ') {
        writeln!(file, "property float {name}")?;
    }
    file.write_all(b"end_header\n")?;
    let row: Vec<u8> = (1..=17_u8).flat_map(|at| (f32::from(at) / 10.0).to_le_bytes()).collect();
    for _ in 0..SPLATS {
        file.write_all(&row)?;
    }
    Ok(file.flush()?)
}

/// A record, and a manifest, of a run over one small image, with a million lines more.
fn files_of_runs(trials: &mut Trials<'_>) -> Result<()> {
    let pixel = |at: usize| {
        let (x, y) = (at % 96, at / 96);
        [20 + y as u8, 150 - y as u8, 100 + (x * 7 + y * 13) as u8 % 23]
    };
    let image = Image::from_raw(96, 64, (0..96 * 64).flat_map(pixel).collect())?;
    for folder in ["photos", "set/images", "set/labels"] {
        fs::create_dir_all(trials.path(folder))?;
    }
    for name in ["photos/a.png", "set/images/a.png"] {
        ImageFile::new(image.clone()).write(&trials.path(name), &WriteOptions::default())?;
    }
    fs::write(trials.path("set/labels/a.txt"), "0 0.5 0.5 0.2 0.2\n")?;
    trials.set_up(&["fuse", "@photos", "preset:jerlov-IB", "-o", "@out"])?;
    trials.set_up(&["augment", "@set", "preset:jerlov-IB", "-o", "@multiplied"])?;
    longer(&trials.path("out/aquafuse-job.jsonl"))?;
    let lines = format!("{LINES} lines more");
    let what = format!("fuse goes on, its record has {lines}");
    trials.row(&what, &["fuse", "@photos", "preset:jerlov-IB", "-o", "@out"])?;
    let manifest = trials.path("multiplied/manifest.jsonl");
    longer(&manifest)?;
    trials.row(&format!("verify, a manifest of {lines}"), &["verify", "@multiplied"])?;
    trials.row(&format!("replay, a manifest of {lines}"), &["replay", "@multiplied", "-o", "@again"])?;
    let augment = ["augment", "@set", "preset:jerlov-IB", "-o", "@multiplied"];
    trials.row(&format!("augment goes on, its manifest has {lines}"), &augment)
}

/// Repeats the last line but one of a file that names `a.png`, each time with another name, so many times.
fn longer(path: &Path) -> Result<()> {
    let lines: Vec<String> = BufReader::new(File::open(path)?).lines().collect::<Result<_, _>>()?;
    let at = lines
        .iter()
        .rposition(|line| line.contains("a.png") || line.contains("a__"))
        .context("no line of an image")?;
    let mut file = writer(path)?;
    for (number, line) in lines.iter().enumerate() {
        writeln!(file, "{line}")?;
        if number == at {
            for other in 0..LINES {
                let name = format!("n{other}");
                writeln!(
                    file,
                    "{}",
                    line.replace("a.png", &format!("{name}.png")).replace("a__", &format!("{name}__"))
                )?;
            }
        }
    }
    Ok(file.flush()?)
}
