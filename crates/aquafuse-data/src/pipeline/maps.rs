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

/// Bytes per pixel that the maps take, one after another: a map in floats with the bytes of its file, or the image before and after
/// the operation.
pub(crate) const BYTES_A_PIXEL: u64 = 40;

/// The images among the maps, by what follows an image's stem.
const IMAGES: [&str; 4] = [".depth.png", ".backscatter.png", ".illumination.png", ".change.png"];
/// The depth factor of a fusion.
const FACTOR: &str = ".factor.npy";

/// The files that hold the maps of an image: depth z (16 bits: 65535 is relative depth 1, or the unit is a
/// millimetre), backscatter B, illumination E, what the operation changes (mid grey: nothing), and, of a fusion, the depth
/// factor F that it used.
pub(crate) fn paths(folder: &Path, input: &Path, operation: &Operation) -> Vec<PathBuf> {
    let factor = operation.fusion().map(|_| FACTOR);
    IMAGES.into_iter().chain(factor).map(|end| file(folder, input, end)).collect()
}

fn file(folder: &Path, input: &Path, end: &str) -> PathBuf {
    let mut name = input.file_stem().unwrap_or_default().to_owned();
    name.push(end);
    folder.join(name)
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
    let [depth, backscatter, illumination, change] = IMAGES.map(|end| file(folder, input, end));
    depth_file::write(&depth, &found.depth, &options)?;
    let write = |image: Image<u8>, path: &Path| ImageFile::new(image).write(path, &options);
    let [veil, light] = with_estimate!(&found.estimate, estimate => {
        let water = &estimate.water;
        let without_veil = Waterbody { veiling_light: VeilingLight::new([0.0; 3]), ..*water };
        [seen(0.0, &found.depth, water), seen(1.0, &found.depth, &without_veil)]
    });
    write(veil, &backscatter)?;
    write(light, &illumination)?;
    write(changed(image_file, found, operation), &change)?;
    match operation.depth_factors(&image_file.pixels, found) {
        Some(factors) => {
            depth_file::write_channels(&file(folder, input, FACTOR), found.depth.size(), &factors, &options)
        }
        None => Ok(()),
    }
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
    operation.apply(&mut after, Some(found)).expect("the depth map is this image's");
    let (width, height) = before.size();
    let difference = |(after, before): (&u8, &u8)| {
        128_u8.saturating_add(after.saturating_sub(*before)).saturating_sub(before.saturating_sub(*after))
    };
    let samples = after.into_bytes().as_raw().iter().zip(before.as_raw()).map(difference).collect();
    Image::from_raw(width, height, samples).expect("of one size")
}
