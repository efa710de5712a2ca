//! How much fused photographs look like their contents, beside what the paper prints.
//!
//! cargo run --release -p aquafuse-data --example published_table -- DATA
//!
//! DATA is the folder of real pictures; `scenes/` in it is read. Each is a content and is fused with eight
//! references, in even steps through the others as sorted by name. Means and variances are over all fused
//! pictures of a row.

mod published;
mod scores;

use std::error::Error;
use std::path::PathBuf;

use aquafuse::fusion::Options;
use aquafuse::smooth::Smoothing;
use published::Published;
use rayon::prelude::*;
use scores::{Scene, Scores, Settings, read_all, references};

fn main() -> Result<(), Box<dyn Error>> {
    let data = std::env::args_os().nth(1).ok_or("give the folder of real pictures")?;
    let scenes = read_all(&PathBuf::from(data).join("scenes"))?;
    if scenes.len() < 2 {
        return Err("there must be two scenes at least, content and reference".into());
    }
    println!(
        "| settings | contents | PSNR, dB | SSIM | depth RMSE, % | depth RMSE, 0-255 | consistency, % |"
    );
    println!("|---|---|---|---|---|---|---|");
    for settings in ways() {
        print_rows(&scenes, &settings)?;
    }
    print_published(&published::read()?);
    Ok(())
}

fn ways() -> [Settings; 2] {
    [
        Settings {
            name: "`--as-published`",
            options: Options::as_published(),
            smoothing: Smoothing::Bilateral,
        },
        Settings { name: "default", options: Options::default(), smoothing: Smoothing::default() },
    ]
}

/// One row for all contents and one for each kind of water, which the names of the files begin with.
fn print_rows(scenes: &[Scene], settings: &Settings) -> Result<(), Box<dyn Error>> {
    let of = |content: usize| {
        let others: Vec<&Scene> = references(content, scenes.len()).map(|i| &scenes[i]).collect();
        scenes[content].scores(&others, settings).map_err(|error| error.to_string())
    };
    let scores: Vec<Vec<Scores>> = (0..scenes.len()).into_par_iter().map(of).collect::<Result<_, _>>()?;
    let mut waters: Vec<&str> = scenes.iter().map(water).collect();
    waters.dedup();
    for kind in std::iter::once(None).chain(waters.into_iter().map(Some)) {
        let chosen =
            scenes.iter().zip(&scores).filter(|(scene, _)| kind.is_none_or(|kind| water(scene) == kind));
        let (count, scores) = chosen.fold((0, Vec::new()), |(count, mut all), (_, scores)| {
            all.extend(scores);
            (count + 1, all)
        });
        let column = |of: fn(&Scores) -> f64| mean_and_variance(scores.iter().map(|scores| of(scores)));
        // A fused picture that equals its content has no decibels to take the mean of.
        let decibels: Vec<f64> =
            scores.iter().map(|scores| scores.psnr).filter(|psnr| psnr.is_finite()).collect();
        let unchanged = match scores.len() - decibels.len() {
            0 => String::new(),
            count => format!(" ({count} unchanged left out)"),
        };
        println!(
            "| {} | {count} {} | {}{unchanged} | {} | {} | {} | {:.1} |",
            settings.name,
            kind.unwrap_or("scenes"),
            printed(mean_and_variance(decibels.into_iter()), 2),
            printed(column(|scores| scores.ssim), 3),
            printed(column(|scores| scores.depth.percent()), 2),
            printed(column(|scores| scores.depth.levels()), 2),
            column(|scores| scores.depth.consistency())[0],
        );
    }
    Ok(())
}

/// The kind of water of a scene named `KIND_NUMBER`.
fn water(scene: &Scene) -> &str {
    scene.name.split('_').next().unwrap_or_default()
}

/// The paper does not say on which scale its depth RMSE is: it stands in both columns.
fn print_published(published: &Published) {
    let found = &published.image_similarity;
    for (i, feet) in found.depth_feet.iter().enumerate() {
        let rmse = printed(found.rmse[i], 2);
        println!(
            "| {}, {} | site at {feet}' | {} | {} | {rmse} ? | {rmse} ? | |",
            published.label,
            found.table,
            printed(found.psnr[i], 2),
            printed(found.ssim[i], 3)
        );
    }
}

fn mean_and_variance(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let values: Vec<f64> = values.collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let middle = mean(&values);
    [middle, mean(&values.iter().map(|value| (value - middle).powi(2)).collect::<Vec<_>>())]
}

fn printed([mean, variance]: [f64; 2], digits: usize) -> String {
    format!("{mean:.digits$} ± {variance:.digits$}")
}
