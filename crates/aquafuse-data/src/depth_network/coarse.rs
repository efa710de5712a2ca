//! What a network gives, brought to the size of the image that it saw.

use aquafuse::depth::{Supplied, SuppliedDepth, SuppliedError};
use aquafuse::image::{Image, TopEdge};
use image::RgbImage;
use image::imageops::{self, FilterType};

/// An image scaled to these columns and rows, bicubic.
pub(crate) fn scaled(image: &Image<u8>, (width, height): (usize, usize)) -> Image<u8> {
    if image.size() == (width, height) {
        return image.clone();
    }
    let side = |side: usize| u32::try_from(side).expect("sides of images are below 2^28");
    let whole = RgbImage::from_raw(side(image.width()), side(image.height()), image.as_raw().to_vec());
    let whole = whole.expect("three bytes a pixel");
    let scaled = imageops::resize(&whole, side(width), side(height), FilterType::CatmullRom);
    Image::from_raw(width, height, scaled.into_raw()).expect("three bytes a pixel")
}

/// The depth of an image by a map of another size: holes are filled from the colours of `small`, the image at the size of the map,
/// and the image refines what comes of it.
pub(crate) fn refined(
    map: &Supplied,
    small: &Image<u8>,
    image: &Image<u8>,
    top: TopEdge,
) -> Result<SuppliedDepth, SuppliedError> {
    let mut found = map.seen_with(small, top)?;
    found.depth = found.depth.refined_by(image);
    Ok(found)
}
