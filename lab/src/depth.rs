//! `lab depth`: how well each depth model orders measured depth.

mod bootstrap;
mod pairs;
#[cfg(test)]
mod tests;

use std::path::Path;

use anyhow::Result;
use aquafuse::depth::DepthModel;
use aquafuse::depth::fit::{Fitter, Options, Target};
use aquafuse::metrics::spearman;
use xtask::shell::say;

use crate::evaluate;
use crate::pages::{RESULTS, real_images, show_section};
use bootstrap::{RESAMPLES, interval, resampled};
use pairs::{Pair, by_place, read_all};

pub(crate) fn run() -> Result<()> {
    let data = real_images()?;
    let aquafuse = crate::programs::aquafuse()?;
    say("Comparing depth from colour with measured depth");
    show_section(RESULTS, "depth", &table(&read_all(Path::new(&data))?)?)?;
    let pairs = format!("{data}/depth_pairs");
    evaluate::write(&aquafuse, "depth-scores", &["depth", &pairs, "--depth-kind", "metres"])
}

fn table(pairs: &[Pair]) -> Result<String> {
    let names: Vec<&str> = pairs.iter().map(|pair| pair.name.trim_start_matches("flsea_")).collect();
    let mut table = format!("| depth | {} | mean by place |\n", names.join(" | "));
    table += &format!("|---|{}---|\n", "---|".repeat(names.len()));
    for &model in DepthModel::ALL {
        table += &row(&format!("`{}`", model.name()), pairs, |pair| Ok(pair.estimated(model)))?;
        if model == DepthModel::default() {
            for (target, name) in [(Target::Distances, "distances"), (Target::Order, "order")] {
                let options = Options::default().with_target(target);
                let name = format!("`eq3` fitted to the {name} of the other places");
                table +=
                    &row(&name, pairs, |pair| Ok(pair.estimated(fitted_elsewhere(pair, pairs, options)?)))?;
            }
        }
    }
    table += &row("row", pairs, |pair| {
        let (width, height) = pair.image.size();
        Ok(pair.measured.iter().map(|place| (height - place / width) as f32).collect())
    })?;
    Ok(table)
}

/// Eq. 3 fitted to the pairs of every other place.
fn fitted_elsewhere(pair: &Pair, pairs: &[Pair], options: Options) -> Result<DepthModel> {
    let mut fitter = Fitter::new(options);
    for other in pairs.iter().filter(|other| other.place() != pair.place()) {
        fitter.add_weighted(&other.image, &other.distances, other.share_of_place(pairs))?;
    }
    Ok(DepthModel::Eq3(fitter.solve()?.eq3))
}

/// One depth model: its score on each image and their mean, each with its interval.
fn row(name: &str, pairs: &[Pair], estimate: impl Fn(&Pair) -> Result<Vec<f32>>) -> Result<String> {
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
    Ok(format!("| {name} | {} | {mean} |\n", columns.join(" | ")))
}
