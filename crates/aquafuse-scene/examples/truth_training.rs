//! Trains on a truth scene and prints how near the views come that it was not shown, and what a step costs.
//!
//!     cargo run --release -p aquafuse-scene --example truth_training -- [ITERATIONS] [WIDTH] [HEIGHT] [EVERY] [SPLATS] [FOLDER]

use std::path::PathBuf;

use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim};
use aquafuse::truth::Size;
use aquafuse_data::picture::{Picture, WriteOptions};
use aquafuse_scene::render::render;
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{Options, Shot, Trainer};
use aquafuse_scene::{points, truth};

/// Views, and which of them are held back: every eighth, as is usual.
const VIEWS: usize = 28;
const HELD: usize = 8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: usize| arguments.get(i).map_or(Ok(default), |text| text.parse());
    let (iterations, width, height) = (number(0, 2000)?, number(1, 200)?, number(2, 152)?);
    let (every, most_splats) = (number(3, 128)?, number(4, 10_000)?);
    let degree = u8::try_from(number(6, 0)?)?;
    let folder = arguments.get(5).map(PathBuf::from);

    let views = truth::views(1, Size { width, height }, VIEWS, 2);
    let pictures: Vec<Image<f32>> = views.iter().map(|view| view.clear()).collect();
    let begin = points::splats(&truth::points(&views, &pictures, every), degree);
    let shots = views.iter().zip(&pictures).enumerate().filter(|(i, _)| i % HELD != 0);
    let shots = shots.map(|(_, (view, picture))| Shot {
        camera: view.camera.clone(),
        target: Target::new(width, height, picture.pixels()),
    });
    let options = Options { iterations: u32::try_from(iterations)?, most_splats, ..Options::default() };
    let mut trainer = Trainer::new(options, shots.collect(), begin, None);
    println!("{} splats to begin with", trainer.splats().len());
    let began = processor_seconds();
    while !trainer.is_done() {
        let loss = trainer.step();
        if trainer.steps() % 200 == 0 {
            let per_step = 1e3 * (processor_seconds() - began) / f64::from(trainer.steps());
            println!(
                "{:5} {:.4} {:6} splats, {per_step:.1} ms CPU a step",
                trainer.steps(),
                loss.total,
                trainer.splats().len()
            );
        }
    }
    let (mut total, mut similar, mut count) = (0.0, 0.0, 0.0);
    for (i, (view, picture)) in views.iter().zip(&pictures).enumerate().filter(|(i, _)| i % HELD == 0) {
        let drawn = render(trainer.splats(), degree, &view.camera, &trainer.medium());
        let samples = drawn.drawing.pixels().flatten().collect();
        let drawn = Image::<f32>::from_raw(width, height, samples)?;
        total += psnr(&drawn, picture)?;
        similar += ssim(&drawn, picture)?.unwrap_or(f64::NAN);
        count += 1.0;
        if let Some(folder) = &folder {
            let writing = WriteOptions { overwrite: true, ..WriteOptions::default() };
            Picture::new(drawn.to_samples::<u8>())
                .write(&folder.join(format!("{i:02}_drawn.png")), &writing)?;
            Picture::new(picture.to_samples::<u8>())
                .write(&folder.join(format!("{i:02}_true.png")), &writing)?;
        }
    }
    println!("held back: PSNR {:.2} dB, SSIM {:.3}", total / count, similar / count);
    Ok(())
}

/// What all threads of this process have used so far, where the system tells: in hundredths of a second.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit_once(") ").map_or("", |(_, rest)| rest);
    let ticks = after_name.split(' ').skip(11).take(2).filter_map(|field| field.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}
