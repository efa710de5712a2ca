//! From image to file.

mod tiff;

use std::borrow::Cow;
use std::io::{self, Cursor, Write};
use std::path::Path;

use ::image::codecs::webp::WebPEncoder;
use ::image::{ExtendedColorType, ImageEncoder, ImageError};
use ::jpeg_encoder::{EncodingError, PixelDensity, PixelDensityUnit, SamplingFactor};
use ::png::{BitDepth, ColorType, Compression, Encoder, Info, PixelDimensions, Unit};

use super::format::WRITTEN;
use super::metadata::{Metadata, Resolution, ResolutionUnit};
use super::pixels::{Layers, Pixels};
use super::{Format, ImageFile, WriteOptions, exif};
use crate::files::Output;
use crate::files::{FileError, Staged};

/// The most EXIF that a JPEG segment holds beside its length and its name.
const JPEG_EXIF: usize = 65535 - 2 - 6;

pub(super) fn stage(image: &ImageFile, path: &Path, options: &WriteOptions) -> Result<Staged, FileError> {
    let (format, metadata) = ready(image, path)?;
    let fill = |out: &mut dyn Output| encode_as(format, out, image, &metadata, options.quality);
    Staged::fill(path, options.overwrite, fill)
}

pub(super) fn encode(image: &ImageFile, path: &Path, quality: u8) -> Result<Vec<u8>, FileError> {
    let (format, metadata) = ready(image, path)?;
    let mut out = Cursor::new(Vec::new());
    let encoded = encode_as(format, &mut out, image, &metadata, quality);
    encoded.map_err(|error| FileError::Write { path: path.to_owned(), cause: error.to_string() })?;
    Ok(out.into_inner())
}

/// The format that a name asks for, and what goes into the file beside the pixels.
fn ready<'a>(image: &'a ImageFile, path: &Path) -> Result<(Format, Cow<'a, Metadata>), FileError> {
    let Some(format) = Format::written(path) else {
        return Err(FileError::UnknownExtension { path: path.to_owned(), expected: WRITTEN });
    };
    let failed = |cause: String| FileError::Write { path: path.to_owned(), cause };
    let metadata = carried(image).map_err(&failed)?;
    check(image, &metadata, format).map_err(failed)?;
    Ok((format, metadata))
}

fn encode_as(
    format: Format,
    mut out: &mut dyn Output,
    image: &ImageFile,
    metadata: &Metadata,
    quality: u8,
) -> io::Result<()> {
    match format {
        Format::Png => png(&mut out, image, metadata),
        Format::Jpeg => jpeg(&mut out, image, metadata, quality),
        Format::WebP => webp(&mut out, image, metadata),
        _ => tiff::encode(out, image, metadata),
    }
}

/// What goes into the output: no thumbnail, which shows another image, and the mark of damage.
fn carried(image: &ImageFile) -> Result<Cow<'_, Metadata>, String> {
    let mut metadata = Cow::Borrowed(&image.metadata);
    if let Some(damage) = &image.damage {
        let text = format!("made by aquafuse from a damaged file: {damage}");
        let marked = exif::with_description(image.metadata.exif.as_deref(), &text);
        metadata.to_mut().exif = Some(marked.map_err(|error| error.to_string())?);
    } else if metadata.exif.is_some()
        && let Some(block) = &mut metadata.to_mut().exif
    {
        exif::unlink_thumbnail(block);
    }
    Ok(metadata)
}

/// Refuses what a format cannot hold.
fn check(image: &ImageFile, metadata: &Metadata, format: Format) -> Result<(), String> {
    let (width, height) = image.pixels.size();
    let (most, name) = match format {
        Format::Jpeg => (65535, "JPEG"),
        Format::WebP => (16384, "WebP"),
        _ => (i32::MAX as usize, "the format"),
    };
    if width.max(height) > most {
        return Err(format!("{width}x{height} pixels exceed the limit of {name}; write .png or .tif"));
    }
    match (format, &metadata.exif) {
        (Format::Jpeg, _) if image.pixels.has_alpha() => {
            Err("JPEG cannot hold its transparency; write .png, .tif or .webp".into())
        }
        (Format::Jpeg, Some(exif)) if exif.len() > JPEG_EXIF => {
            Err(format!("its EXIF block of {} bytes is too large for JPEG; write .png", exif.len()))
        }
        _ => Ok(()),
    }
}

fn side(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}

/// The nearest whole number, as far as 32 bits go.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "of floats this alone makes whole numbers; what lies outside becomes the nearest one inside"
)]
pub(crate) fn whole(value: f64) -> u32 {
    value.round() as u32
}

fn png(out: &mut dyn Write, image: &ImageFile, metadata: &Metadata) -> io::Result<()> {
    let (width, height) = image.pixels.size();
    let mut info = Info::with_size(side(width), side(height));
    info.color_type = if image.pixels.has_alpha() { ColorType::Rgba } else { ColorType::Rgb };
    info.icc_profile = metadata.icc_profile.as_deref().map(Cow::Borrowed);
    info.exif_metadata = metadata.exif.as_deref().map(Cow::Borrowed);
    info.pixel_dims = metadata.resolution.map(|resolution| {
        let Resolution { density: (x, y), unit } = resolution.into_unit(ResolutionUnit::Metre);
        let unit = if unit == ResolutionUnit::Metre { Unit::Meter } else { Unit::Unspecified };
        PixelDimensions { xppu: whole(x), yppu: whole(y), unit }
    });
    let big_endian = |layers: &Layers<u16>| -> Vec<u8> {
        layers.interleaved().iter().flat_map(|word| word.to_be_bytes()).collect()
    };
    let (depth, samples) = match &image.pixels {
        Pixels::Bytes(layers) => (BitDepth::Eight, layers.interleaved()),
        Pixels::Words(layers) => (BitDepth::Sixteen, big_endian(layers).into()),
        Pixels::Floats(layers) => (BitDepth::Sixteen, big_endian(&layers.convert()).into()),
    };
    info.bit_depth = depth;
    encode_png(out, info, &samples)
}

fn encode_png(out: &mut dyn Write, info: Info<'_>, samples: &[u8]) -> io::Result<()> {
    let mut encoder = Encoder::with_info(out, info)?;
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(samples)?;
    writer.finish()?;
    Ok(())
}

/// Encodes one grey channel of 16 bits as PNG.
pub(crate) fn encode_grey16(
    out: &mut dyn Write,
    width: usize,
    height: usize,
    values: &[u16],
) -> io::Result<()> {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_be_bytes()).collect();
    let mut info = Info::with_size(side(width), side(height));
    (info.color_type, info.bit_depth) = (ColorType::Grayscale, BitDepth::Sixteen);
    encode_png(out, info, &bytes)
}

fn jpeg(out: &mut dyn Write, image: &ImageFile, metadata: &Metadata, quality: u8) -> io::Result<()> {
    let mut encoder = jpeg_encoder::Encoder::new(out, quality.clamp(1, 100));
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    if let Some(resolution) = metadata.resolution {
        encoder.set_density(density(resolution));
    }
    if let Some(exif) = &metadata.exif {
        encoder.add_exif_metadata(exif).map_err(refusal)?;
    }
    if let Some(profile) = &metadata.icc_profile {
        encoder.add_icc_profile(profile).map_err(refusal)?;
    }
    let layers = as_bytes(&image.pixels);
    let (width, height) = layers.image.size();
    let [width, height] = [width, height].map(|side| u16::try_from(side).unwrap_or(u16::MAX));
    encoder.encode(layers.image.as_raw(), width, height, jpeg_encoder::ColorType::Rgb).map_err(refusal)
}

/// What the system said, and not which library it was said to.
fn refusal(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

fn as_bytes(pixels: &Pixels) -> Cow<'_, Layers<u8>> {
    match pixels {
        Pixels::Bytes(layers) => Cow::Borrowed(layers),
        Pixels::Words(layers) => Cow::Owned(layers.convert()),
        Pixels::Floats(layers) => Cow::Owned(layers.convert()),
    }
}

fn density(resolution: Resolution) -> PixelDensity {
    let resolution = resolution.without_metres();
    let unit = match resolution.unit {
        ResolutionUnit::Inch | ResolutionUnit::Metre => PixelDensityUnit::Inches,
        ResolutionUnit::Centimetre => PixelDensityUnit::Centimeters,
        ResolutionUnit::Unknown => PixelDensityUnit::PixelAspectRatio,
    };
    let (x, y) = resolution.density;
    let short = |density: f64| u16::try_from(whole(density)).unwrap_or(u16::MAX).max(1);
    PixelDensity { density: (short(x), short(y)), unit }
}

fn webp(out: &mut dyn Write, image: &ImageFile, metadata: &Metadata) -> io::Result<()> {
    let mut encoder = WebPEncoder::new_lossless(out);
    let unsupported = |error| failure(ImageError::Unsupported(error));
    if let Some(profile) = &metadata.icc_profile {
        encoder.set_icc_profile(profile.clone()).map_err(unsupported)?;
    }
    if let Some(exif) = &metadata.exif {
        encoder.set_exif_metadata(exif.clone()).map_err(unsupported)?;
    }
    let layers = as_bytes(&image.pixels);
    let colour = if layers.alpha.is_some() { ExtendedColorType::Rgba8 } else { ExtendedColorType::Rgb8 };
    let (width, height) = layers.image.size();
    encoder.write_image(&layers.interleaved(), side(width), side(height), colour).map_err(failure)
}

/// As [`refusal`].
fn failure(error: ImageError) -> io::Error {
    match error {
        ImageError::IoError(error) => error,
        other => io::Error::other(other),
    }
}
