//! `lab bounds`: what each safety bound of a fusion saves, and what it costs.

use std::path::Path;

use anyhow::Result;
use aquafuse::depth::{DepthMap, DepthModel};
use aquafuse::fusion::{Bounded, Bounds, Model, Options, TransferLaw, Waters};
use aquafuse::image::{Encoded, Image};
use aquafuse::truth::{Exchange, Site, Trials};
use aquafuse::waterbody::{Estimate, EstimateOptions, WaterMap, WaterShare, estimate_with_share};
use aquafuse_data::image_file::{ImageFile, ReadOptions, list};
use xtask::shell::say;

use crate::pages::{RESULTS, real_images, show_section};

/// Exchanges at each kind of place.
const EXCHANGES: usize = 60;
/// Scenes that give their water to all real scenes.
const REFERENCES: [&str; 4] = ["blueish_01.jpg", "greenish_01.jpg", "turbid_01.jpg", "clear_01.jpg"];
const MODELS: [Model; 2] = [Model::Physical, Model::Exchange];
/// A share that differs by less is the same.
const SAME: f64 = 0.02;
/// By so many levels of 255 red leads where it is seen to.
const LEADS: f32 = 20.0 / 255.0;

/// Where depth is from.
#[derive(Clone, Copy)]
enum Depth {
    Given,
    Colour,
}

pub(crate) fn run() -> Result<()> {
    say("Fusing synthetic scenes with and without bounds (minutes)");
    let mut rows: Vec<Fused> = Vec::new();
    for site in Site::ALL.iter().copied() {
        let trials = Trials::at(site);
        for number in 0..EXCHANGES {
            let exchange = trials.exchange::<Encoded>(number);
            for depth in [Depth::Given, Depth::Colour] {
                rows.extend(MODELS.map(|model| of_truth(&exchange, depth, model)));
            }
        }
    }
    let synthetic = table(
        "| depth | model | bound that acted | of exchanges | share of the true change with it | without it | better with it | better without it |\n\
         |---|---|---|---|---|---|---|---|\n",
        &rows,
        |with, without| with > without + SAME,
    );
    show_section(RESULTS, "bounds", &synthetic)?;
    let photographs = table(
        "| depth | model | bound that acted | of fusions | pixels that turn red with it, % | without it | fewer with it | fewer without it |\n\
         |---|---|---|---|---|---|---|---|\n",
        &of_photographs()?,
        |with, without| with + SAME < without,
    );
    show_section(RESULTS, "bounds-photographs", &photographs)
}

/// A fusion with its bounds and without them.
struct Fused {
    depth: Depth,
    model: Model,
    bounds: Bounds,
    with: f64,
    without: f64,
}

/// Depth and water of an image, as the command estimates them.
struct Found {
    z: DepthMap,
    estimate: Estimate,
    share: WaterShare,
}

impl Found {
    fn of(image: &Image<u8>, z: DepthMap) -> Self {
        let options = EstimateOptions::default().with_water_map(WaterMap::BEST);
        let (estimate, share) = estimate_with_share(image, &z, &options).expect("a map of this image");
        Self { z, estimate, share }
    }

    /// The image by a law, not clipped.
    fn by(&self, image: &Image<u8>, law: &TransferLaw) -> Image<f32> {
        let mut fused = image.to_unit();
        let width = fused.width();
        for (i, (pixel, z)) in fused.pixels_mut().iter_mut().zip(self.z.distances()).enumerate() {
            let w = self.share.at(i % width, i / width, *pixel);
            *pixel = law.in_share(law.at(z), w).of(*pixel);
        }
        fused
    }
}

/// An image in another's water, with the bounds and without, and which of them acted.
fn fused(image: &Image<u8>, own: &Found, other: &Estimate, model: Model) -> (Bounds, [Image<f32>; 2]) {
    let options = Options::for_model(model);
    let bounded = Bounded::new(&own.estimate, other, options);
    let factors = own.estimate.depth_factors.filter(|_| model == Model::Physical);
    let free = Waters::new(&own.estimate.water, &other.water).with_depth_factors(factors.as_ref());
    let laws = [TransferLaw::new(bounded.waters(), &bounded.options), TransferLaw::new(free, &options)];
    (bounded.bounds, laws.map(|law| own.by(image, &law)))
}

fn of_truth(exchange: &Exchange<Encoded>, depth: Depth, model: Model) -> Fused {
    let [own, other] = [&exchange.content, &exchange.reference].map(|case| {
        let z = match depth {
            Depth::Given => case.depth.clone(),
            Depth::Colour => DepthModel::default().estimate(&case.image),
        };
        Found::of(&case.image, z)
    });
    let image = &exchange.content.image;
    let (bounds, made) = fused(image, &own, &other.estimate, model);
    // `physical` exchanges the veil, `exchange` the whole water.
    let truth = exchange.truths[usize::from(model == Model::Exchange)].as_raw();
    let before = off(image.to_unit().as_raw(), truth);
    let [with, without] = made.map(|made| 1.0 - off(made.as_raw(), truth) / before);
    Fused { depth, model, bounds, with, without }
}

fn of_photographs() -> Result<Vec<Fused>> {
    let folder = Path::new(&real_images()?).join("scenes");
    let read = |path: &Path| -> Result<Image<u8>> {
        Ok(ImageFile::open(path, &ReadOptions::default())?.decode()?.bytes().into_owned())
    };
    let references = REFERENCES.iter().map(|name| {
        let image = read(&folder.join(name))?;
        Ok(Found::of(&image, DepthModel::default().estimate(&image)).estimate)
    });
    let references = references.collect::<Result<Vec<_>>>()?;
    let mut rows = Vec::new();
    for path in list(&folder)?.images {
        let image = read(&path)?;
        let own = Found::of(&image, DepthModel::default().estimate(&image));
        for (other, model) in references.iter().flat_map(|other| MODELS.map(|model| (other, model))) {
            let (bounds, made) = fused(&image, &own, other, model);
            let [with, without] = made.map(|made| turned_red(&image.to_unit(), &made));
            rows.push(Fused { depth: Depth::Colour, model, bounds, with, without });
        }
    }
    Ok(rows)
}

/// The share of the pixels in which red leads now and did not, in percent.
fn turned_red(before: &Image<f32>, after: &Image<f32>) -> f64 {
    let leads = |[r, g, b]: [f32; 3]| r > g.max(b) + LEADS;
    let turned =
        before.pixels().iter().zip(after.pixels()).filter(|(old, new)| !leads(**old) && leads(**new));
    100.0 * turned.count() as f64 / before.pixels().len() as f64
}

fn off(a: &[f32], b: &[f32]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

/// One row for each set of bounds that acted together, the most frequent first.
fn table(header: &str, all: &[Fused], is_better: fn(f64, f64) -> bool) -> String {
    let mut text = header.to_owned();
    for (depth, depth_name) in [(Depth::Given, "given"), (Depth::Colour, "`eq3`")] {
        for model in MODELS {
            let of = all.iter().filter(|one| one.depth as u8 == depth as u8 && one.model == model);
            let of: Vec<&Fused> = of.collect();
            let mut groups: Vec<(String, Vec<&Fused>)> = Vec::new();
            for one in &of {
                let name = names(one.bounds);
                match groups.iter_mut().find(|(other, _)| *other == name) {
                    Some((_, group)) => group.push(one),
                    None => groups.push((name, vec![one])),
                }
            }
            groups.retain(|(name, _)| !name.is_empty());
            groups.sort_by_key(|(_, group)| std::cmp::Reverse(group.len()));
            for (name, group) in groups {
                let mean = |value: fn(&Fused) -> f64| {
                    group.iter().map(|one| value(one)).sum::<f64>() / group.len() as f64
                };
                let count = |holds: &dyn Fn(&Fused) -> bool| group.iter().filter(|one| holds(one)).count();
                text += &format!(
                    "| {depth_name} | `{}` | {name} | {} of {} | {:.2} | {:.2} | {} | {} |\n",
                    model.name(),
                    group.len(),
                    of.len(),
                    mean(|one| one.with),
                    mean(|one| one.without),
                    count(&|one| is_better(one.with, one.without)),
                    count(&|one| is_better(one.without, one.with)),
                );
            }
        }
    }
    text
}

fn names(bounds: Bounds) -> String {
    let named =
        [(bounds.glare, "glare"), (bounds.red, "red"), (bounds.gain, "gain"), (bounds.night, "night")];
    named.iter().filter(|(acted, _)| *acted).map(|(_, name)| *name).collect::<Vec<_>>().join(", ")
}
