//! The maps behind a fusion or restoration, as images.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use aquafuse::depth::DepthMap;
use aquafuse::formation::form;
use aquafuse::image::{Encoding, Image};
use aquafuse::scene_area::SceneArea;
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
/// Mid grey, which stands for no change.
const UNCHANGED: u8 = 128;
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
    let area = image_file.area();
    depth_file::write(&depth, &whole_depth(&found.depth, area), &options)?;
    // Where there is no scene, there is no light, and nothing changes.
    let write = |image: Image<u8>, path: &Path, outside: [u8; 3]| {
        ImageFile::new(whole(image, area, outside)).write(path, &options)
    };
    let [veil, light] = with_estimate!(&found.estimate, estimate => {
        let water = &estimate.water;
        let without_veil = Waterbody { veiling_light: VeilingLight::new([0.0; 3]), ..*water };
        [seen(0.0, &found.depth, water), seen(1.0, &found.depth, &without_veil)]
    });
    write(veil, &backscatter, [0; 3])?;
    write(light, &illumination, [0; 3])?;
    write(changed(image_file, found, operation), &change, [UNCHANGED; 3])?;
    match operation.depth_factors(&image_file.pixels, found) {
        Some(factors) => {
            let factors = area.map_or_else(|| factors.clone(), |area| area.spread(&factors, &[0.0; 3]));
            let size = image_file.whole_size();
            depth_file::write_channels(&file(folder, input, FACTOR), size, &factors, &options)
        }
        None => Ok(()),
    }
}

/// A map of the scene as one of the whole image.
fn whole(scene: Image<u8>, area: Option<&SceneArea>, outside: [u8; 3]) -> Image<u8> {
    let Some(area) = area else { return scene };
    let (width, height) = area.image_size();
    let pixels = area.spread(scene.pixels(), &outside).into_flattened();
    Image::from_raw(width, height, pixels).expect("one value for each pixel")
}

/// A depth map of the scene as one of the whole image; what is no scene has z = 0.
fn whole_depth<'a>(scene: &'a DepthMap, area: Option<&SceneArea>) -> Cow<'a, DepthMap> {
    let Some(area) = area else { return Cow::Borrowed(scene) };
    let (width, height) = area.image_size();
    let distances = area.spread(&scene.distances(), &0.0);
    Cow::Owned(DepthMap::from_distances(width, height, scene.kind(), distances).expect("they are distances"))
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
        UNCHANGED.saturating_add(after.saturating_sub(*before)).saturating_sub(before.saturating_sub(*after))
    };
    let samples = after.into_bytes().as_raw().iter().zip(before.as_raw()).map(difference).collect();
    Image::from_raw(width, height, samples).expect("of one size")
}
