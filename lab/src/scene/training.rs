//! How near views come that were not trained on, on a truth scene, and what was found of the water.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Result, bail};
use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim};
use aquafuse::truth::{Size, waters};
use aquafuse_data::files::FileError;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_scene::compare::image;
use aquafuse_scene::medium::{Medium, Water};
use aquafuse_scene::render::render;
use aquafuse_scene::splats::Splats;
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{Options, Rates, TrainView, Trainer};
use aquafuse_scene::truth::TruthView;
use aquafuse_scene::{points, truth};
use xtask::clock;

/// Views, and which of them are held out: every eighth, as is usual.
const VIEWS: usize = 28;
const HELD: usize = 8;
/// The size of the images, and how much finer they are made.
pub(super) const SIZE: Size = Size { width: 200, height: 152 };
const FINER: usize = 2;

/// The tables by the names of their sections; images to look at go into a folder, if one is given.
pub(super) fn tables(folder: Option<&Path>) -> Result<[(&'static str, String); 2]> {
    let mut learned = String::from(
        "| seen through | rates | points | splats | steps | CPU seconds | PSNR, dB | SSIM |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let place = Place { views: truth::views(1, SIZE, VIEWS, FINER) };
    let air = place.seen(TruthView::clear);

    let quick = Rates::quick();
    for (name, rates, every, steps) in [
        ("air", Rates::published(), 48, 600),
        ("air", quick.clone(), 48, 600),
        ("air", quick.clone(), 48, 300),
        ("air", quick.clone(), 24, 700),
    ] {
        let named = if rates == quick { "quick" } else { "published" };
        let run = place.run(&air, &options(rates, steps, 24_000), every, None);
        learned += &place.row(name, named, &run, &air)?;
        save(folder, "air", &place.drawn(&run.splats, &run.medium))?;
    }
    save(folder, "true", &place.held(&air).cloned().collect::<Vec<_>>())?;
    let [blue, green, ..] = waters();
    let wet = place.seen(|view| view.seen_through(&blue.water));
    // As far off as first guesses are: B∞ by a tenth, the betas by a third.
    let guess = Water::new([0.08, 0.30, 0.58], [0.14, 0.12, 0.10], [0.24, 0.09, 0.07]);
    let options = options(quick, 700, 24_000);
    let run = place.run(&wet, &options, 24, Some(guess.clone()));
    learned += &place.row("blue water, learned", "quick", &run, &wet)?;

    let Medium::Learned(found) = &run.medium else { bail!("a water was to be learned") };
    let mut water = String::from("| | B∞ | β_B a metre | β_D a metre |\n|---|---|---|---|\n");
    let fading = blue.water.attenuation.each_ref().map(|curve| curve.coefficient(0.0));
    let true_one = [blue.water.veiling_light.rgb(), blue.water.backscatter_coefficient, fading];
    let numbers = |water: &Water<f32>| [water.veil(), water.backscatter(), water.attenuation()];
    for (name, three) in [("true", true_one), ("first guess", numbers(&guess)), ("found", numbers(found))] {
        let cells = three.map(|rgb| rgb.map(|value| format!("{value:.3}")).join(" "));
        writeln!(water, "| {name} | {} |", cells.join(" | "))?;
    }
    let known = Medium::Known { water: green.water, per_unit: 1.0 };
    let in_green = place.seen(|view| view.seen_through(&green.water));
    writeln!(water, "\n| views held out | PSNR, dB | SSIM |\n|---|---|---|")?;
    for (name, medium, truth) in
        [("dewatered, against air", &Medium::Air, &air), ("in green water", &known, &in_green)]
    {
        let drawn = place.drawn(&run.splats, medium);
        let (near, alike) = place.scores(&drawn, truth)?;
        writeln!(water, "| {name} | {near:.2} | {alike:.3} |")?;
        save(folder, if medium == &known { "green" } else { "dewatered" }, &drawn)?;
    }
    for (name, images) in [
        ("the blue images themselves, against air", &air),
        ("the blue images themselves, against green", &in_green),
    ] {
        let blue: Vec<_> = place.held(&wet).cloned().collect();
        let (near, alike) = place.scores(&blue, images)?;
        writeln!(water, "| {name} | {near:.2} | {alike:.3} |")?;
    }
    Ok([("scene", learned), ("scene-water", water)])
}

fn options(rates: Rates, iterations: u32, max_splats: usize) -> Options {
    Options { iterations, max_splats, rates, ..Options::default() }
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
        let shots = kept.map(|(_, (view, image))| TrainView {
            camera: view.camera.clone(),
            target: Target::new(view.camera.width, view.camera.height, image.pixels()),
        });
        let (begun_with, began) = (begin.len(), clock::processor_seconds().own);
        let mut trainer = Trainer::new(options.clone(), shots.collect(), begin, water);
        while !trainer.is_done() {
            trainer.step();
        }
        Run {
            splats: trainer.splats().clone(),
            medium: trainer.medium(),
            begun_with,
            steps: trainer.steps(),
            seconds: clock::processor_seconds().own - began,
        }
    }

    fn drawn(&self, splats: &Splats<f32>, medium: &Medium<f32>) -> Vec<Image<f32>> {
        self.held(&self.views).map(|view| image(&render(splats, 0, &view.camera, medium).rendering)).collect()
    }

    /// PSNR and SSIM of what was drawn for the views held out, against all images.
    fn scores(&self, drawn: &[Image<f32>], truth: &[Image<f32>]) -> Result<(f64, f64)> {
        let (mut near, mut alike) = (0.0, 0.0);
        for (drawn, truth) in drawn.iter().zip(self.held(truth)) {
            near += psnr(drawn, truth)?;
            alike += ssim(drawn, truth)?.unwrap_or(f64::NAN);
        }
        Ok((near / drawn.len() as f64, alike / drawn.len() as f64))
    }

    fn row(&self, name: &str, rates: &str, run: &Run, truth: &[Image<f32>]) -> Result<String> {
        let (near, alike) = self.scores(&self.drawn(&run.splats, &run.medium), truth)?;
        Ok(format!(
            "| {name} | {rates} | {} | {} | {} | {:.1} | {near:.2} | {alike:.3} |\n",
            run.begun_with,
            run.splats.len(),
            run.steps,
            run.seconds
        ))
    }
}

fn save(folder: Option<&Path>, name: &str, images: &[Image<f32>]) -> Result<(), FileError> {
    let writing = WriteOptions { overwrite: true, ..WriteOptions::default() };
    for (i, image) in folder.into_iter().flat_map(|_| images.iter().enumerate()) {
        let path = folder.unwrap_or(Path::new(".")).join(format!("{i}_{name}.png"));
        ImageFile::new(image.convert::<u8>()).write(&path, &writing)?;
    }
    Ok(())
}
