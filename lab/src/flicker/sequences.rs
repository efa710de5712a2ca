//! The sequences that flicker is measured on, and their optical flow.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use aquafuse::formation::form;
use aquafuse::image::Image;
use aquafuse::truth::{Pose, Scene, Size, View, waters};
use aquafuse_data::image_file::{ImageFile, ReadOptions, WriteOptions, list};
use xtask::shell::{command, run, say, target};

use crate::pages::real_images;

/// Frames, with what is needed to judge what is made of them.
pub(crate) struct Sequence {
    pub(crate) name: &'static str,
    pub(crate) frames: Vec<Image<u8>>,
    /// For each frame but the first, where its pixels were in the frame before.
    pub(crate) flows: Vec<Vec<[f32; 2]>>,
    /// An image of the water that it is fused with.
    pub(crate) reference: Image<u8>,
    /// What each frame is in that water, where it is known.
    truth: Option<Vec<Image<f32>>>,
}

/// Folders of frames in the folder of real images, and the image whose water they are fused with.
const REAL: [(&str, &str); 2] =
    [("pool", "sequence_subvo_pool/images"), ("clip", "video/deepfish_7434_F1/frames")];
const REFERENCE: &str = "scenes/greenish_01.jpg";

pub(crate) fn all() -> Result<Vec<Sequence>> {
    let data = PathBuf::from(real_images()?);
    let reference = read(&data.join(REFERENCE))?;
    let real = |(name, folder): (&'static str, &str)| {
        let mut paths = list(&data.join(folder))?.images;
        paths.sort();
        let frames = paths.iter().map(|path| read(path)).collect::<Result<Vec<_>>>()?;
        let flows = flows(name, &frames)?;
        Ok(Sequence { name, frames, flows, reference: reference.clone(), truth: None })
    };
    REAL.into_iter().map(real).chain([synthetic()]).collect()
}

fn read(path: &Path) -> Result<Image<u8>> {
    Ok(ImageFile::open(path, &ReadOptions::default())?.decode()?.bytes().into_owned())
}

/// A camera that moves ahead and turns, while the light becomes a quarter less and comes back.
fn synthetic() -> Result<Sequence> {
    const FRAMES: u16 = 28;
    const SIZE: Size = Size { width: 384, height: 256 };
    say("Rendering a sequence");
    let [own, other] = [0, 1].map(|i| waters()[i].water);
    let (mut frames, mut truth) = (Vec::new(), Vec::new());
    for frame in 0..FRAMES {
        let t = f32::from(frame) / f32::from(FRAMES - 1);
        let pose = Pose { moved: [0.6 * t, 0.0, 0.8 * t], yaw: 0.15 * t, pitch: 0.15, ..Pose::default() };
        let scene = Scene::from(View::default(), 5, &pose, SIZE);
        let light = 1.0 - 0.25 * (std::f32::consts::PI * t).sin();
        let lit = |image: &Image<f32>| {
            let values = image.as_raw().iter().map(|value| light * value).collect();
            Image::<f32>::from_raw(SIZE.width, SIZE.height, values)
        };
        frames.push(lit(&scene.seen_through(&own))?.convert());
        truth.push(form(&lit(&scene.clear)?, &scene.depth, &other)?);
    }
    let reference = Scene::new(9, SIZE).seen_through(&other).convert();
    Ok(Sequence { name: "truth", flows: flows("truth", &frames)?, frames, reference, truth: Some(truth) })
}

impl Sequence {
    /// How much of the way to the truth was gone, in mean absolute differences; none where the truth is not known.
    pub(crate) fn share_of_truth(&self, made: &[Image<u8>]) -> Option<f64> {
        let truth = self.truth.as_ref()?;
        let off = |images: &[Image<u8>]| -> f64 {
            let values =
                images.iter().zip(truth).flat_map(|(image, truth)| image.as_raw().iter().zip(truth.as_raw()));
            values.map(|(value, truth)| f64::from((f32::from(*value) / 255.0 - truth).abs())).sum()
        };
        Some(1.0 - off(made) / off(&self.frames))
    }
}

/// The optical flow of each frame to the one before, by OpenCV's DIS.
fn flows(name: &str, frames: &[Image<u8>]) -> Result<Vec<Vec<[f32; 2]>>> {
    let folder = target().join("flicker").join(name);
    fs::create_dir_all(&folder).context("cannot make a folder for flows")?;
    let shown = |i: usize, extension: &str| folder.join(format!("{i:03}.{extension}"));
    for (i, frame) in frames.iter().enumerate() {
        let writing = WriteOptions { overwrite: true, ..WriteOptions::default() };
        ImageFile::new(frame.clone()).write(&shown(i, "png"), &writing)?;
    }
    say(&format!("Optical flow of {name}"));
    run(command(xtask::setup::python()?, &["lab/src/flicker/flow.py", &folder.to_string_lossy()]))?;
    let read = |i: usize| -> Result<Vec<[f32; 2]>> {
        let bytes = fs::read(shown(i, "flow")).context("cannot read a flow")?;
        let values: Vec<f32> = bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        Ok(values.as_chunks().0.to_vec())
    };
    (1..frames.len()).map(read).collect()
}
