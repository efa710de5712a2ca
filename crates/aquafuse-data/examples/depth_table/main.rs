//! How well each way to depth orders measured depth.
//!
//! cargo run --release -p aquafuse-data --example depth_table -- DATA
//!
//! DATA is the folder of real images; `depth_pairs/` in it is read.

mod bootstrap;
mod pairs;

use std::path::PathBuf;

use aquafuse::depth::DepthModel;
use aquafuse::depth::fit::{Fitter, Options, Target};
use aquafuse::metrics::spearman;
use bootstrap::{RESAMPLES, interval, resampled};
use pairs::{Pair, by_place, read_all};

type Error = Box<dyn std::error::Error>;

fn main() -> Result<(), Error> {
    let data = std::env::args_os().nth(1).ok_or("give the folder of real images")?;
    let pairs = read_all(&PathBuf::from(data))?;
    let names: Vec<&str> = pairs.iter().map(|pair| pair.name.trim_start_matches("flsea_")).collect();
    println!("| depth | {} | mean by place |", names.join(" | "));
    println!("|---|{}---|", "---|".repeat(names.len()));
    for &model in DepthModel::ALL {
        print_row(&format!("`{}`", model.name()), &pairs, |pair| Ok(pair.estimated(model)))?;
        if model == DepthModel::default() {
            for (target, name) in [(Target::Distances, "distances"), (Target::Order, "order")] {
                let options = Options::default().with_target(target);
                print_row(&format!("`eq3` fitted to the {name} of the other places"), &pairs, |pair| {
                    Ok(pair.estimated(fitted_elsewhere(pair, &pairs, options)?))
                })?;
            }
        }
    }
    print_row("row", &pairs, |pair| {
        let (width, height) = pair.image.size();
        Ok(pair.measured.iter().map(|place| (height - place / width) as f32).collect())
    })?;
    Ok(())
}

/// Eq. 3 fitted to the pairs of every other place.
fn fitted_elsewhere(pair: &Pair, pairs: &[Pair], options: Options) -> Result<DepthModel, Error> {
    let mut fitter = Fitter::new(options);
    for other in pairs.iter().filter(|other| other.place() != pair.place()) {
        fitter.add_weighted(&other.image, &other.distances, other.share_of_place(pairs))?;
    }
    Ok(DepthModel::Eq3(fitter.solve()?.eq3))
}

/// One way to depth: its score on each image and their mean, each with its interval.
fn print_row(
    name: &str,
    pairs: &[Pair],
    estimate: impl Fn(&Pair) -> Result<Vec<f32>, Error>,
) -> Result<(), Error> {
    let (mut scores, mut resamples) = (Vec::new(), Vec::new());
    for pair in pairs {
        let (estimated, metres) = (estimate(pair)?, pair.metres());
        scores.push(spearman(&estimated, &metres).unwrap_or_default());
        resamples.push(resampled(pair, &estimated, &metres));
    }
    let means = (0..RESAMPLES).map(|i| {
        let drawn: Vec<f64> = resamples.iter().map(|scores| scores[i]).collect();
        by_place(pairs, &drawn)
    });
    let cell = |score: f64, resamples: Vec<f64>| {
        let [low, high] = interval(resamples);
        format!("{score:.2} ({low:.2} to {high:.2})")
    };
    let mean = cell(by_place(pairs, &scores), means.collect());
    let columns: Vec<String> =
        scores.iter().zip(resamples).map(|(score, resamples)| cell(*score, resamples)).collect();
    println!("| {name} | {} | {mean} |", columns.join(" | "));
    Ok(())
}
