//! Trains on a truth scene and prints, as tables, how near views come that were not shown, what was found of the water, and
//! what a step costs.
//!
//!     cargo run --release -p aquafuse-scene --example scene_table -- [FOLDER]
//!
//! FOLDER is for images to look at. Uses one thread, so that seconds are those of one core.

use std::path::{Path, PathBuf};

use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim};
use aquafuse::truth::{Size, waters};
use aquafuse_data::image_file::{FileError, ImageFile, WriteOptions};
use aquafuse_scene::compare::image;
use aquafuse_scene::medium::{Medium, Water};
use aquafuse_scene::render::render;
use aquafuse_scene::splats::Splats;
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{Options, Rates, Shot, Trainer};
use aquafuse_scene::truth::TruthView;
use aquafuse_scene::{points, truth};

/// Views, and which of them are held back: every eighth, as is usual.
const VIEWS: usize = 28;
const HELD: usize = 8;
/// The size of the images, and how much finer they are made.
const SIZE: Size = Size { width: 200, height: 152 };
const FINER: usize = 2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let folder = std::env::args().nth(1).map(PathBuf::from);
    let place = Place { views: truth::views(1, SIZE, VIEWS, FINER) };
    let air = place.seen(TruthView::clear);

    println!("<!-- scene -->");
    println!("| seen through | rates | points | splats | steps | CPU seconds | PSNR, dB | SSIM |");
    println!("|---|---|---|---|---|---|---|---|");
    let quick = Rates::quick();
    for (name, rates, every, steps) in [
        ("air", Rates::published(), 48, 600),
        ("air", quick.clone(), 48, 600),
        ("air", quick.clone(), 48, 300),
        ("air", quick.clone(), 24, 700),
    ] {
        let named = if rates == quick { "quick" } else { "published" };
        let run = place.run(&air, &options(rates, steps, 24_000), every, None);
        println!("{}", place.row(name, named, &run, &air)?);
        save(folder.as_deref(), "air", &place.drawn(&run.splats, &run.medium))?;
    }
    save(folder.as_deref(), "true", &place.held(&air).cloned().collect::<Vec<_>>())?;
    let [blue, green, ..] = waters();
    let wet = place.seen(|view| view.seen_through(&blue.water));
    // As far off as first guesses are: B∞ by a tenth, the betas by a third.
    let guess = Water::new([0.08, 0.30, 0.58], [0.14, 0.12, 0.10], [0.24, 0.09, 0.07]);
    let options = options(quick, 700, 24_000);
    let run = place.run(&wet, &options, 24, Some(guess.clone()));
    println!("{}", place.row("blue water, learned", "quick", &run, &wet)?);
    println!("<!-- /scene -->");

    println!("<!-- scene-water -->");
    let Medium::Learned(found) = &run.medium else { return Err("a water was to be learned".into()) };
    println!("| | B∞ | β_B a metre | β_D a metre |\n|---|---|---|---|");
    let fading = blue.water.attenuation.each_ref().map(|curve| curve.coefficient(0.0));
    let true_one = [blue.water.veiling_light.rgb(), blue.water.backscatter_coefficient, fading];
    let numbers = |water: &Water<f32>| [water.veil(), water.backscatter(), water.attenuation()];
    for (name, three) in [("true", true_one), ("first guess", numbers(&guess)), ("found", numbers(found))] {
        let cells = three.map(|rgb| rgb.map(|value| format!("{value:.3}")).join(" "));
        println!("| {name} | {} |", cells.join(" | "));
    }
    let known = Medium::Known { water: green.water, per_unit: 1.0 };
    let in_green = place.seen(|view| view.seen_through(&green.water));
    println!("\n| views held back | PSNR, dB | SSIM |\n|---|---|---|");
    for (name, medium, truth) in
        [("dewatered, against air", &Medium::Air, &air), ("in green water", &known, &in_green)]
    {
        let drawn = place.drawn(&run.splats, medium);
        let (near, alike) = place.scores(&drawn, truth)?;
        println!("| {name} | {near:.2} | {alike:.3} |");
        save(folder.as_deref(), if medium == &known { "green" } else { "dewatered" }, &drawn)?;
    }
    for (name, images) in [
        ("the blue images themselves, against air", &air),
        ("the blue images themselves, against green", &in_green),
    ] {
        let blue: Vec<_> = place.held(&wet).cloned().collect();
        let (near, alike) = place.scores(&blue, images)?;
        println!("| {name} | {near:.2} | {alike:.3} |");
    }
    println!("<!-- /scene-water -->");

    println!("<!-- scene-cost -->");
    println!(
        "| pixels | splats | in view | draw | loss | back | whole step, ms CPU |\n|---|---|---|---|---|---|---|"
    );
    let [middle, large] = [(256, 192), (512, 384)].map(|(width, height)| Size { width, height });
    for (size, splats) in [(SIZE, 5000), (middle, 5000), (middle, 10_000), (middle, 20_000), (large, 20_000)]
    {
        println!("{}", cost(size, splats));
    }
    println!("<!-- /scene-cost -->");
    Ok(())
}

fn options(rates: Rates, iterations: u32, most_splats: usize) -> Options {
    Options { iterations, most_splats, rates, ..Options::default() }
}

struct Place {
    views: Vec<TruthView>,
}

/// What a run ended with.
struct Run {
    splats: Splats<f32>,
    medium: Medium<f32>,
    begun_with: usize,
    steps: u32,
    seconds: f64,
}

impl Place {
    fn seen(&self, through: impl Fn(&TruthView) -> Image<f32>) -> Vec<Image<f32>> {
        self.views.iter().map(through).collect()
    }

    fn held<'a, T>(&self, of: &'a [T]) -> impl Iterator<Item = &'a T> {
        of.iter().enumerate().filter(|(i, _)| i % HELD == 0).map(|(_, one)| one)
    }

    fn run(&self, images: &[Image<f32>], options: &Options, every: usize, water: Option<Water<f32>>) -> Run {
        let begin = points::splats(&truth::points(&self.views, images, every), 0);
        let kept = self.views.iter().zip(images).enumerate().filter(|(i, _)| i % HELD != 0);
        let shots = kept.map(|(_, (view, image))| Shot {
            camera: view.camera.clone(),
            target: Target::new(view.camera.width, view.camera.height, image.pixels()),
        });
        let (begun_with, began) = (begin.len(), processor_seconds());
        let mut trainer = Trainer::new(options.clone(), shots.collect(), begin, water);
        while !trainer.is_done() {
            trainer.step();
        }
        Run {
            splats: trainer.splats().clone(),
            medium: trainer.medium(),
            begun_with,
            steps: trainer.steps(),
            seconds: processor_seconds() - began,
        }
    }

    fn drawn(&self, splats: &Splats<f32>, medium: &Medium<f32>) -> Vec<Image<f32>> {
        self.held(&self.views).map(|view| image(&render(splats, 0, &view.camera, medium).drawing)).collect()
    }

    /// PSNR and SSIM of what was drawn for the views held back, against all images.
    fn scores(
        &self,
        drawn: &[Image<f32>],
        truth: &[Image<f32>],
    ) -> Result<(f64, f64), Box<dyn std::error::Error>> {
        let (mut near, mut alike) = (0.0, 0.0);
        for (drawn, truth) in drawn.iter().zip(self.held(truth)) {
            near += psnr(drawn, truth)?;
            alike += ssim(drawn, truth)?.unwrap_or(f64::NAN);
        }
        Ok((near / drawn.len() as f64, alike / drawn.len() as f64))
    }

    fn row(
        &self,
        name: &str,
        rates: &str,
        run: &Run,
        truth: &[Image<f32>],
    ) -> Result<String, Box<dyn std::error::Error>> {
        let (near, alike) = self.scores(&self.drawn(&run.splats, &run.medium), truth)?;
        Ok(format!(
            "| {name} | {rates} | {} | {} | {} | {:.1} | {near:.2} | {alike:.3} |",
            run.begun_with,
            run.splats.len(),
            run.steps,
            run.seconds
        ))
    }
}

/// Steps that are timed.
const TIMED: u32 = 40;

/// What a step costs, and its parts, a few steps into training.
fn cost(size: Size, splats: usize) -> String {
    let place = Place { views: truth::views(1, size, 2, 1) };
    let images = place.seen(TruthView::clear);
    let mut points = truth::points(&place.views, &images, 2);
    // As many as asked for, evenly from all.
    let share = points.len() as f64 / splats as f64;
    points = (0..splats).map(|i| points[(i as f64 * share) as usize]).collect();
    let begin = points::splats(&points, 0);
    let camera = &place.views[1].camera;
    let target = Target::new(size.width, size.height, images[1].pixels());
    let shot = Shot { camera: camera.clone(), target: target.clone() };
    let mut trainer =
        Trainer::new(Options { iterations: 100_000, ..Options::default() }, vec![shot], begin, None);
    for _ in 0..TIMED {
        trainer.step();
    }
    let timed = |work: &mut dyn FnMut()| {
        let began = processor_seconds();
        (0..TIMED).for_each(|_| work());
        1e3 * (processor_seconds() - began) / f64::from(TIMED)
    };
    let whole = timed(&mut || {
        trainer.step();
    });
    let splats = trainer.splats();
    let drawn = render(splats, 0, camera, &Medium::Air);
    let (_, gradient) = aquafuse_scene::train::loss::loss(&drawn.drawing, &target, 0.2);
    let draw = timed(&mut || drop(render(splats, 0, camera, &Medium::Air)));
    let loss = timed(&mut || drop(aquafuse_scene::train::loss::loss(&drawn.drawing, &target, 0.2)));
    let back = timed(&mut || drop(drawn.back(splats, &Medium::Air, &gradient)));
    format!(
        "| {}x{} | {} | {} | {draw:.1} | {loss:.1} | {back:.1} | {whole:.1} |",
        size.width,
        size.height,
        splats.len(),
        drawn.seen()
    )
}

fn save(folder: Option<&Path>, name: &str, images: &[Image<f32>]) -> Result<(), FileError> {
    let writing = WriteOptions { overwrite: true, ..WriteOptions::default() };
    for (i, image) in folder.into_iter().flat_map(|_| images.iter().enumerate()) {
        let path = folder.unwrap_or(Path::new(".")).join(format!("{i}_{name}.png"));
        ImageFile::new(image.convert::<u8>()).write(&path, &writing)?;
    }
    Ok(())
}

/// What this process has used of processors so far, where the system tells: in hundredths of a second.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit_once(") ").map_or("", |(_, rest)| rest);
    let ticks = after_name.split(' ').skip(11).take(2).filter_map(|field| field.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}
