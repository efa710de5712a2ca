//! TIFF: as fine as the pixels are, deflated, with EXIF in the file's own directories.

use std::io;

use ::tiff::TiffError;
use ::tiff::encoder::colortype::{ColorType, RGB8, RGB16, RGB32Float};
use ::tiff::encoder::{Compression, DeflateLevel, Rational, TiffEncoder, TiffValue};
use ::tiff::tags::{ExtraSamples, Predictor, ResolutionUnit as Unit, Tag};
use aquafuse::image::Sample;

use super::super::exif::Exif;
use super::super::metadata::{Metadata, Resolution, ResolutionUnit};
use super::super::pixels::{Layers, Pixels};
use super::{ImageFile, side, whole};
use crate::files::Output;

pub(super) fn encode(out: &mut dyn Output, image_file: &ImageFile, metadata: &Metadata) -> io::Result<()> {
    let encoded = match &image_file.pixels {
        Pixels::Bytes(layers) => layered::<RGB8, u8>(out, layers, Predictor::Horizontal, metadata),
        Pixels::Words(layers) => layered::<RGB16, u16>(out, layers, Predictor::Horizontal, metadata),
        Pixels::Floats(layers) => layered::<RGB32Float, f32>(out, layers, Predictor::None, metadata),
    };
    encoded.map_err(|error| match error {
        TiffError::IoError(error) => error,
        other => io::Error::other(other),
    })
}

fn layered<C: ColorType<Inner = T>, T: Sample>(
    out: &mut dyn Output,
    layers: &Layers<T>,
    predictor: Predictor,
    metadata: &Metadata,
) -> Result<(), TiffError>
where
    [T]: TiffValue,
{
    // Opacity as a fourth sample confuses the encoder's predictor, which counts three.
    let predictor = if layers.alpha.is_some() { Predictor::None } else { predictor };
    let mut encoder = TiffEncoder::new(out)?
        .with_compression(Compression::Deflate(DeflateLevel::Fast))
        .with_predictor(predictor);
    let exif = metadata.exif.as_deref().and_then(Exif::read).unwrap_or_default();
    let inner = exif.write_inner(&mut encoder)?;
    let (width, height) = layers.image.size();
    let mut image = encoder.new_image::<C>(side(width), side(height))?;
    if layers.alpha.is_some() {
        image.extra_samples(&[ExtraSamples::UnassociatedAlpha])?;
    }
    let directory = image.encoder();
    if let Some(resolution) = metadata.resolution {
        write_resolution(directory, resolution)?;
    }
    exif.write_fields(directory, &inner)?;
    if let Some(profile) = &metadata.icc_profile {
        // As "undefined", which the specification of profiles asks for.
        let entry = directory.write_entry_bytes(::tiff::tags::Type::UNDEFINED, profile)?;
        directory.extend_from(&::tiff::Directory::from_iter([(Tag::IccProfile, entry)]));
    }
    image.write_data(&layers.interleaved())
}

fn write_resolution<W: io::Write + io::Seek>(
    directory: &mut ::tiff::encoder::DirectoryEncoder<'_, W, ::tiff::encoder::TiffKindStandard>,
    resolution: Resolution,
) -> Result<(), TiffError> {
    let resolution = resolution.without_metres();
    let unit = match resolution.unit {
        ResolutionUnit::Inch | ResolutionUnit::Metre => Unit::Inch,
        ResolutionUnit::Centimetre => Unit::Centimeter,
        ResolutionUnit::Unknown => Unit::None,
    };
    // Thousandths keep what a metre, 39.37 inches, makes of whole numbers.
    let ratio = |density: f64| Rational { n: whole(1000.0 * density), d: 1000 };
    directory.write_tag(Tag::XResolution, ratio(resolution.density.0))?;
    directory.write_tag(Tag::YResolution, ratio(resolution.density.1))?;
    directory.write_tag(Tag::ResolutionUnit, unit.to_u16())
}
