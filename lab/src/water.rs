//! `lab water`: how near B∞ of photographs is to their open water, which was marked by eye.

use std::path::Path;

use anyhow::{Context, Result};
use aquafuse::depth;
use aquafuse::image::{Encoded, Image};
use aquafuse::metrics::lab;
use aquafuse::waterbody::{EstimateOptions, VeilingLightSource, Verdict, WaterMap, estimate};
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use serde_json::Value;
use xtask::shell::say;

use crate::pages::{RESULTS, real_images, show_section};

pub(crate) fn run() -> Result<()> {
    let data = real_images()?;
    say("Reading the water of photographs");
    show_section(RESULTS, "water", &table(&photographs(Path::new(&data))?)?)
}

/// A photograph, and what a person says of its open water.
struct Photograph {
    image: Image<u8>,
    marked: String,
    /// The marked colour in Lab, where open water is seen.
    veil: Option<[f64; 3]>,
}

fn photographs(data: &Path) -> Result<Vec<Photograph>> {
    let labels = std::fs::read(data.join("open_water.json")).context("no open_water.json")?;
    let labels: Value = serde_json::from_slice(&labels)?;
    let pictures = labels["pictures"].as_object().context("no pictures")?;
    let photograph = |(name, label): (&String, &Value)| {
        let file = ImageFile::open(&data.join(name), &ReadOptions::default())?.decode()?;
        let rgb = label["veil_srgb"]
            .as_array()
            .map(|rgb| lab(std::array::from_fn(|c| rgb[c].as_f64().unwrap_or(0.0) as f32 / 255.0)));
        let marked = label["verdict"].as_str().unwrap_or_default().to_owned();
        Ok(Photograph { image: file.bytes().into_owned(), marked, veil: rgb })
    };
    pictures.iter().map(photograph).collect()
}

/// B∞ by one way, and whether it says that open water is in view, and that it is sure.
struct Found {
    veil: [f32; 3],
    is_open_water: Option<bool>,
    is_good: Option<bool>,
}

/// The table over all of them, and over both halves: each second photograph, from the first and from the second on.
fn table(photographs: &[Photograph]) -> Result<String> {
    let of = |first: usize, step: usize| photographs.iter().skip(first).step_by(step).collect::<Vec<_>>();
    let mut table = String::from(
        "| B∞ by | median ΔE | mean | 90th percentile | open water found | found where none is | `good` where a person is unsure |\n\
         |---|---|---|---|---|---|---|\n",
    );
    table += &rows(&of(0, 1), "")?;
    table += &rows(&of(0, 2), ", first half")?;
    table += &rows(&of(1, 2), ", second half")?;
    Ok(table)
}

fn rows(photographs: &[&Photograph], part: &str) -> Result<String> {
    let ours = |options: EstimateOptions| {
        move |image: &Image<u8>| -> Result<Found> {
            let found = estimate::<Encoded>(image, &depth::estimate(image), &options)?;
            let is_open_water = Some(found.veiling_light_source == VeilingLightSource::OpenWater);
            let is_good = Some(found.quality.verdict == Verdict::Good);
            Ok(Found { veil: found.water.veiling_light.rgb(), is_open_water, is_good })
        }
    };
    let colour = |of: fn(&Image<u8>) -> [f32; 3]| {
        move |image: &Image<u8>| Ok(Found { veil: of(image), is_open_water: None, is_good: None })
    };
    let mut table = String::new();
    let mut add = |name: &str, row: &dyn Fn(&str) -> Result<String>| -> Result<()> {
        table += &row(&format!("{name}{part}"))?;
        Ok(())
    };
    let network = EstimateOptions::default().with_water_map(WaterMap::Network);
    add("the far region by rules", &|name| row(name, photographs, ours(EstimateOptions::default())))?;
    add("the far region by the network", &|name| row(name, photographs, ours(network)))?;
    let both = EstimateOptions::default().with_water_map(WaterMap::Both);
    add("the far region by both (default)", &|name| row(name, photographs, ours(both)))?;
    if part.is_empty() {
        let published = EstimateOptions::as_published();
        add("the farthest 5 % (the paper)", &|name| row(name, photographs, ours(published)))?;
        add("median of the top tenth of the rows", &|name| row(name, photographs, colour(top_rows)))?;
        add("dark channel, brightest 0.1 %", &|name| row(name, photographs, colour(dark_channel)))?;
    }
    Ok(table)
}

fn row(name: &str, photographs: &[&Photograph], way: impl Fn(&Image<u8>) -> Result<Found>) -> Result<String> {
    let found = photographs.iter().map(|one| way(&one.image)).collect::<Result<Vec<_>>>()?;
    let all = || photographs.iter().zip(&found);
    let mut off: Vec<f64> = all()
        .filter_map(|(one, found)| {
            let (marked, own) = (one.veil?, lab(found.veil));
            Some((0..3).map(|c| (own[c] - marked[c]).powi(2)).sum::<f64>().sqrt())
        })
        .collect();
    off.sort_by(f64::total_cmp);
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    let share = |marked: &str, holds: fn(&Found) -> Option<bool>| -> String {
        let said: Option<Vec<bool>> =
            all().filter(|(one, _)| one.marked == marked).map(|(_, found)| holds(found)).collect();
        said.map_or_else(String::new, |said| {
            format!("{} of {}", said.iter().filter(|holds| **holds).count(), said.len())
        })
    };
    Ok(format!(
        "| {name} | {:.1} | {mean:.1} | {:.1} | {} | {} | {} |\n",
        off[off.len() / 2],
        off[off.len() * 9 / 10],
        share("seen", |found| found.is_open_water),
        share("none", |found| found.is_open_water),
        share("unsure", |found| found.is_good),
    ))
}

/// The median of the top tenth of the rows.
fn top_rows(image: &Image<u8>) -> [f32; 3] {
    let rows = image.height().div_ceil(10);
    median(&image.pixels()[..rows * image.width()])
}

/// The dark channel's way: of the pixels whose darkest channel around them is brightest, the median.
fn dark_channel(image: &Image<u8>) -> [f32; 3] {
    const REACH: usize = 7;
    let (width, height) = image.size();
    let least = |values: &dyn Fn(usize) -> u8, place: usize, length: usize| {
        (place.saturating_sub(REACH)..(place + REACH + 1).min(length)).map(values).min().unwrap_or(0)
    };
    let pixels = image.pixels();
    let across: Vec<u8> = (0..pixels.len())
        .map(|i| {
            let (x, y) = (i % width, i / width);
            least(&|x| *pixels[y * width + x].iter().min().unwrap_or(&0), x, width)
        })
        .collect();
    let dark: Vec<u8> =
        (0..pixels.len()).map(|i| least(&|y| across[y * width + i % width], i / width, height)).collect();
    let mut order: Vec<usize> = (0..pixels.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(dark[i]));
    median(&order[..pixels.len().div_ceil(1000)].iter().map(|&i| pixels[i]).collect::<Vec<_>>())
}

fn median(pixels: &[[u8; 3]]) -> [f32; 3] {
    std::array::from_fn(|c| {
        let mut values: Vec<u8> = pixels.iter().map(|pixel| pixel[c]).collect();
        values.sort_unstable();
        f32::from(values[values.len() / 2]) / 255.0
    })
}
