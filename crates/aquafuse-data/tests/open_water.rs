//! The water of real photographs whose open water was marked by eye.
//!
//! Needs the folder `AQUAFUSE_TEST_DATA`.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod borders;

use std::path::{Path, PathBuf};

use aquafuse::metrics::lab;
use aquafuse::waterbody::{VeilingLightSource, Verdict};
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use aquafuse_data::pipeline::{DepthSource, analyse};
use serde_json::Value;

fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("AQUAFUSE_TEST_DATA").map(PathBuf::from);
    let folder = folder.filter(|folder| folder.join("open_water.json").is_file());
    if folder.is_none() {
        eprintln!("skipped: AQUAFUSE_TEST_DATA names no folder with open_water.json");
    }
    folder
}

struct Found {
    name: String,
    marked: String,
    flags: Vec<String>,
    /// ΔE of B∞ to the marked colour.
    off: Option<f64>,
    is_open_water: bool,
    verdict: Verdict,
}

fn look(folder: &Path, name: &str, label: &Value) -> Found {
    let image = ImageFile::open(&folder.join(name), &ReadOptions::default()).unwrap().decode().unwrap();
    let found = analyse(&image, &DepthSource::default()).unwrap().estimate;
    let marked = label["veil_srgb"].as_array().map(|rgb| {
        let rgb: Vec<f32> = rgb.iter().map(|value| value.as_f64().unwrap() as f32 / 255.0).collect();
        lab([rgb[0], rgb[1], rgb[2]])
    });
    let own = lab(found.water.veiling_light.rgb());
    Found {
        name: name.to_owned(),
        marked: label["verdict"].as_str().unwrap().to_owned(),
        flags: label["flags"]
            .as_array()
            .unwrap()
            .iter()
            .map(|flag| flag.as_str().unwrap().to_owned())
            .collect(),
        off: marked.map(|marked| (0..3).map(|c| (own[c] - marked[c]).powi(2)).sum::<f64>().sqrt()),
        is_open_water: found.veiling_light_source == VeilingLightSource::OpenWater,
        verdict: found.quality.verdict,
    }
}

#[test]
fn the_water_of_photographs_is_the_marked_one() {
    let Some(folder) = folder() else { return };
    let labels = std::fs::read(folder.join("open_water.json")).unwrap();
    let labels: Value = serde_json::from_slice(&labels).unwrap();
    let found: Vec<Found> = labels["pictures"]
        .as_object()
        .unwrap()
        .iter()
        .map(|(name, label)| look(&folder, name, label))
        .collect();
    let mut off: Vec<f64> = found.iter().filter_map(|one| one.off).collect();
    off.sort_by(f64::total_cmp);
    let (mean, ninetieth) = (off.iter().sum::<f64>() / off.len() as f64, off[off.len() * 9 / 10]);
    let named = |marked: &str, is_open: bool| -> Vec<&str> {
        let wanted = found.iter().filter(|one| one.marked == marked && one.is_open_water == is_open);
        wanted.map(|one| one.name.as_str()).collect()
    };
    let (missed, mistaken) = (named("seen", false), named("none", true));
    println!(
        "ΔE of B∞: mean {mean:.1}, 90th percentile {ninetieth:.1}; missed {missed:?}, mistaken {mistaken:?}"
    );
    assert!(mean <= 3.5 && ninetieth <= 7.0, "{mean} {ninetieth}");
    assert!(missed.len() <= 3, "{missed:?}");
    assert!(mistaken.len() <= 1, "{mistaken:?}");
    let sure: Vec<&str> = found
        .iter()
        .filter(|one| one.marked == "unsure" && one.verdict == Verdict::Good)
        .filter(|one| one.flags.iter().any(|flag| flag == "night" || flag == "closeup"))
        .map(|one| one.name.as_str())
        .collect();
    assert!(sure.is_empty(), "good, though nobody can say whether water is in view: {sure:?}");
}
