//! `lab networks`: networks of depth in the shapes that people have, by the command's runtime and by ONNX Runtime.
//!
//! Their weights are random: nothing is said of how right depth is, only whether both compute the same, how fast, in what memory.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use aquafuse::image::{Image, TopEdge};
use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::depth_network::{DepthNetwork, NetworkKind, NetworkOptions};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use xtask::setup::python_environment;
use xtask::shell::{command, output, run as call, say, target};

use crate::bench::apart::kilobytes;
use crate::pages::{RESULTS, show_section};
use crate::programs;

/// Their names, and whether they take colours by mean and deviation of ImageNet, or from 0 to 1.
const NETWORKS: [(&str, &str, bool); 4] = [
    (
        "transformer-static",
        "vision transformer, Small, with a dense head (as Depth Anything V2), fixed size",
        true,
    ),
    ("transformer-dynamic", "the same, any size", true),
    ("u-net", "small U-Net", true),
    ("several", "transformer that gives points, depth and a mask (as MoGe)", false),
];
const SCRIPT: &str = "lab/depth_networks/networks.py";
const SIDE: usize = 518;
const TURNS: usize = 3;
/// How far two runtimes may be apart, of the range of the map.
const SAME: f32 = 1e-4;
const HEADING: &str = "| network | file, MB | largest difference, of the range of the map | ours, ms | ONNX Runtime, ms | times as long | ours, \
    reading the file, ms | ours, peak MiB | ONNX Runtime in Python, peak MiB |\n|---|---|---|---|---|---|---|---|---|\n";

pub(crate) fn run() -> Result<()> {
    let python = python_environment("python-networks", "lab/depth_networks/requirements.txt")?;
    let python = python.join("bin/python");
    let folder = target().join("networks");
    std::fs::create_dir_all(&folder)?;
    say("Exporting networks with random weights");
    call(command(&python, &[SCRIPT, "export", &folder.to_string_lossy()]))?;
    let scene = Scene::new(1, Size { width: SIDE, height: SIDE });
    let image: Image<u8> = scene.seen_through(&waters()[0].water).convert();
    let photo = folder.join("image.png");
    let write = WriteOptions { overwrite: true, ..WriteOptions::default() };
    ImageFile::new(image.clone()).write(&photo, &write)?;
    say("Running them by both (some minutes on one core)");
    let mut table = HEADING.to_owned();
    let mut worst = 0.0_f32;
    for (name, described, by_imagenet) in NETWORKS {
        let file = folder.join(name).with_extension("onnx");
        let input = folder.join("input.f32");
        std::fs::write(&input, bytes(&numbers(&image, by_imagenet)))?;
        let (ours, theirs) = (folder.join("ours.f32"), folder.join("theirs.f32"));
        let of = |paths: [&Path; 3]| paths.map(|path| path.to_string_lossy().into_owned());
        let [a, b, c] = of([&file, &input, &theirs]);
        let other = figures::<2>(&output(command(&python, &[SCRIPT, "run", &a, &b, &c]))?)?;
        let [a, b, c] = of([&file, &photo, &ours]);
        let own = figures::<3>(&output(command(programs::lab()?, &["network", &a, &b, &c]))?)?;
        let difference = difference(&floats(&ours)?, &floats(&theirs)?)?;
        worst = worst.max(difference);
        let size = std::fs::metadata(&file)?.len() as f64 / 1e6;
        writeln!(
            table,
            "| {described} | {size:.1} | {difference:.1e} | {:.0} | {:.0} | {:.1} | {:.0} | {:.0} | {:.0} |",
            own[0],
            other[0],
            own[0] / other[0],
            own[1],
            own[2],
            other[1],
        )?;
    }
    show_section(RESULTS, "networks", &table)?;
    ensure!(worst <= SAME, "the two runtimes are {worst} apart, and {SAME} is allowed");
    Ok(())
}

/// `lab network FILE IMAGE OUT`: the depth of an image by a network, in a process of its own. Prints the median time of a run and that
/// of reading the file in milliseconds, and the peak memory in MiB.
pub(crate) fn one(file: &Path, image: &Path, out: &Path) -> Result<()> {
    let began = milliseconds()?;
    // Relative distances keep the numbers of the output, up to their scale.
    let options = NetworkOptions { kind: Some(NetworkKind::Relative), ..NetworkOptions::default() };
    let network = DepthNetwork::read(file, &options)?;
    let reading = milliseconds()? - began;
    let image = ImageFile::read(image)?;
    let mut spent = Vec::new();
    let mut distances = Vec::new();
    for _ in 0..TURNS {
        let began = milliseconds()?;
        distances = network.depth(&image.bytes(), TopEdge::First)?.depth.distances();
        spent.push(milliseconds()? - began);
    }
    spent.sort_by(f64::total_cmp);
    std::fs::write(out, bytes(&distances))?;
    println!("{:.1} {reading:.1} {:.0}", spent[TURNS / 2], kilobytes("VmHWM:")? / 1024.0);
    Ok(())
}

/// The time that this process has had on the processor (Linux, which counts in hundredths of a second): what else runs here does not
/// count.
fn milliseconds() -> Result<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    let (_, fields) = stat.rsplit_once(')').context("the system does not say")?;
    let ticks: Vec<f64> =
        fields.split_whitespace().skip(11).take(2).map(str::parse).collect::<Result<_, _>>()?;
    Ok(10.0 * ticks.iter().sum::<f64>())
}

/// An image as the network takes it, channel by channel.
fn numbers(image: &Image<u8>, by_imagenet: bool) -> Vec<f32> {
    let (mean, deviation) = match by_imagenet {
        true => ([0.485, 0.456, 0.406], [0.229, 0.224, 0.225]),
        false => ([0.0; 3], [1.0; 3]),
    };
    let channel = |c: usize| {
        image.pixels().iter().map(move |pixel| (f32::from(pixel[c]) / 255.0 - mean[c]) / deviation[c])
    };
    (0..3).flat_map(channel).collect()
}

fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn floats(path: &PathBuf) -> Result<Vec<f32>> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(bytes.as_chunks::<4>().0.iter().map(|four| f32::from_le_bytes(*four)).collect())
}

/// The largest difference of two maps whose scales differ, as a share of their range.
fn difference(ours: &[f32], theirs: &[f32]) -> Result<f32> {
    ensure!(ours.len() == theirs.len(), "{} numbers beside {}", ours.len(), theirs.len());
    let most = |values: &[f32]| values.iter().copied().fold(0.0, f32::max);
    let [a, b] = [most(ours), most(theirs)];
    let range = 1.0 - theirs.iter().copied().fold(f32::INFINITY, f32::min) / b;
    let apart = ours.iter().zip(theirs).map(|(x, y)| (x / a - y / b).abs() / range);
    // NaN is no number that `max` would keep.
    let apart = apart.fold(0.0_f32, |most, one| if one > most || one.is_nan() { one } else { most });
    ensure!(apart.is_finite(), "a map holds numbers that are not finite");
    Ok(apart)
}

/// Figures on one line.
fn figures<const N: usize>(said: &str) -> Result<[f64; N]> {
    let values = said.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    values.try_into().map_err(|_| anyhow::anyhow!("expected {N} figures, but it said: {said}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_compared_by_their_range_whatever_their_scale() {
        assert_eq!(difference(&[0.5, 1.0, 2.0], &[1.0, 2.0, 4.0]).unwrap(), 0.0);
        // 0.25 of the largest value, whose range is a half of it.
        assert_eq!(difference(&[0.75, 1.0], &[0.5, 1.0]).unwrap(), 0.5);
        assert!(difference(&[0.0, 1.0], &[1.0]).is_err() && difference(&[f32::NAN], &[1.0]).is_err());
    }
}
