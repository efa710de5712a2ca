//! The maps behind a fusion or restoration, as images.

use std::path::{Path, PathBuf};

use aquafuse::depth::DepthMap;
use aquafuse::formation::form;
use aquafuse::image::{Encoding, Image};
use aquafuse::waterbody::{VeilingLight, Waterbody};

use crate::depth_file;
use crate::files::FileError;
use crate::image_file::{ImageFile, Pixels, WriteOptions};
use crate::pipeline::Analysis;
use crate::pipeline::{Operation, WaterEstimate, with_estimate};

/// Bytes per pixel that the maps take: a map in floats, and the image before and after the operation.
pub(crate) const BYTES_A_PIXEL: u64 = 40;

/// The maps, by what is put between an image's stem and `.png`.
const NAMES: [&str; 4] = ["depth", "backscatter", "illumination", "change"];

/// The files that hold the maps of an image: depth z (16 bits: 65535 is relative depth 1, or the unit is a
/// millimetre), backscatter B, illumination E, and what the operation changes (mid grey: nothing).
pub(crate) fn paths(folder: &Path, input: &Path) -> [PathBuf; 4] {
    NAMES.map(|name| {
        let mut file = input.file_stem().unwrap_or_default().to_owned();
        file.push(format!(".{name}.png"));
        folder.join(file)
    })
}

/// Writes the maps of an image, replacing those of an earlier run.
pub(crate) fn write(
    folder: &Path,
    input: &Path,
    image_file: &ImageFile,
    found: &Analysis<WaterEstimate>,
    operation: &Operation,
) -> Result<(), FileError> {
    let options = WriteOptions { overwrite: true, ..WriteOptions::default() };
    let [depth, backscatter, illumination, change] = paths(folder, input);
    depth_file::write(&depth, &found.depth, &options)?;
    let write = |image: Image<u8>, path: &Path| ImageFile::new(image).write(path, &options);
    let [veil, light] = with_estimate!(&found.estimate, estimate => {
        let water = &estimate.water;
        let without_veil = Waterbody { veiling_light: VeilingLight::new([0.0; 3]), ..*water };
        [seen(0.0, &found.depth, water), seen(1.0, &found.depth, &without_veil)]
    });
    write(veil, &backscatter)?;
    write(light, &illumination)?;
    write(changed(image_file, found, operation), &change)
}

/// A clear image of one value everywhere, put into a water.
fn seen<E: Encoding>(value: f32, depth: &DepthMap, water: &Waterbody<E>) -> Image<u8> {
    let (width, height) = depth.size();
    let flat = Image::<f32, E>::from_raw(width, height, [value; 3].repeat(width.saturating_mul(height)));
    let flat = flat.expect("a depth map has places");
    form(&flat, depth, water).expect("it was made for this depth map").to_encoded().convert()
}

/// The difference that an operation makes, about mid grey.
fn changed(image_file: &ImageFile, found: &Analysis<WaterEstimate>, operation: &Operation) -> Image<u8> {
    let before = image_file.bytes().into_owned();
    let mut after = Pixels::from(before.clone());
    operation.apply(&mut after, found).expect("the depth map is this image's");
    let (width, height) = before.size();
    let difference = |(after, before): (&u8, &u8)| {
        128_u8.saturating_add(after.saturating_sub(*before)).saturating_sub(before.saturating_sub(*after))
    };
    let samples = after.into_bytes().as_raw().iter().zip(before.as_raw()).map(difference).collect();
    Image::from_raw(width, height, samples).expect("of one size")
}
