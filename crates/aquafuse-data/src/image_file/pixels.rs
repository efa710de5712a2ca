//! The pixels of an image, as fine as its file holds them.

use std::borrow::Cow;

use aquafuse::depth::{DepthMap, DepthModel};
use aquafuse::image::{Image, ImageError, Sample, TopEdge};
use aquafuse::smooth::Smoothing;

/// Pixels of 8 or 16 bits or in floats, encoded; fused as they are, so that nothing of 16 bits is lost.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// 8 bits a sample.
    Bytes(Layers<u8>),
    /// 16 bits a sample.
    Words(Layers<u16>),
    /// Floats from 0 to 1.
    Floats(Layers<f32>),
}

/// Colour, and how opaque it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers<T> {
    /// The colours.
    pub image: Image<T>,
    /// Opacity of each pixel, none where the file holds none. It passes through fusion untouched.
    pub alpha: Option<Vec<T>>,
}

/// The same work on whatever the samples are.
macro_rules! each {
    ($pixels:expr, $layers:ident => $work:expr) => {
        match $pixels {
            Pixels::Bytes($layers) => $work,
            Pixels::Words($layers) => $work,
            Pixels::Floats($layers) => $work,
        }
    };
}

impl From<Image<u8>> for Pixels {
    fn from(image: Image<u8>) -> Self {
        Self::Bytes(Layers { image, alpha: None })
    }
}

impl From<Image<u16>> for Pixels {
    fn from(image: Image<u16>) -> Self {
        Self::Words(Layers { image, alpha: None })
    }
}

impl From<Image<f32>> for Pixels {
    fn from(image: Image<f32>) -> Self {
        Self::Floats(Layers { image, alpha: None })
    }
}

impl Pixels {
    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        each!(self, layers => layers.image.size())
    }

    /// Whether there is an opacity to each pixel.
    pub fn has_alpha(&self) -> bool {
        each!(self, layers => layers.alpha.is_some())
    }

    /// The colours in bytes.
    pub fn bytes(&self) -> Cow<'_, Image<u8>> {
        match self {
            Self::Bytes(layers) => Cow::Borrowed(&layers.image),
            Self::Words(layers) => Cow::Owned(layers.image.convert()),
            Self::Floats(layers) => Cow::Owned(layers.image.convert()),
        }
    }

    /// The colours in bytes, without a copy where they are.
    pub fn into_bytes(self) -> Image<u8> {
        match self {
            Self::Bytes(layers) => layers.image,
            other => other.bytes().into_owned(),
        }
    }

    /// Depth from colour, as fine as the samples.
    pub fn depth(&self, model: &DepthModel, top: TopEdge) -> DepthMap {
        each!(self, layers => model.estimate_oriented(&layers.image, top))
    }

    /// The image, smoothed; opacity is left as it is.
    pub fn smoothed(self, smoothing: Smoothing) -> Self {
        fn layers<T: Sample>(Layers { image, alpha }: Layers<T>, smoothing: Smoothing) -> Layers<T> {
            Layers { image: smoothing.apply(image), alpha }
        }
        match self {
            Self::Bytes(bytes) => Self::Bytes(layers(bytes, smoothing)),
            Self::Words(words) => Self::Words(layers(words, smoothing)),
            Self::Floats(floats) => Self::Floats(layers(floats, smoothing)),
        }
    }

    /// The image turned as an EXIF orientation of 1 to 8 asks for; other values turn nothing.
    pub fn turned(self, orientation: u8) -> Self {
        match self {
            Self::Bytes(layers) => Self::Bytes(layers.turned(orientation)),
            Self::Words(layers) => Self::Words(layers.turned(orientation)),
            Self::Floats(layers) => Self::Floats(layers.turned(orientation)),
        }
    }
}

impl<T: Sample> Layers<T> {
    /// Colour and opacity taken apart.
    pub(super) fn of_rgba(width: usize, height: usize, all: &[T]) -> Result<Self, ImageError> {
        let pixels = all.as_chunks().0;
        let colours = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        let image = Image::from_raw(width, height, colours)?;
        Ok(Self { image, alpha: Some(pixels.iter().map(|&[.., a]| a).collect()) })
    }

    /// Grey as colour.
    pub(super) fn of_grey(width: usize, height: usize, all: &[T]) -> Result<Self, ImageError> {
        let colours = all.iter().flat_map(|&grey| [grey; 3]).collect();
        Ok(Self { image: Image::from_raw(width, height, colours)?, alpha: None })
    }

    /// Grey as colour, and opacity.
    pub(super) fn of_grey_alpha(width: usize, height: usize, all: &[T]) -> Result<Self, ImageError> {
        let pixels = all.as_chunks().0;
        let colours = pixels.iter().flat_map(|&[grey, _]| [grey; 3]).collect();
        let image = Image::from_raw(width, height, colours)?;
        Ok(Self { image, alpha: Some(pixels.iter().map(|&[_, a]| a).collect()) })
    }

    /// Colour and opacity side by side.
    pub(super) fn interleaved(&self) -> Cow<'_, [T]> {
        match &self.alpha {
            None => Cow::Borrowed(self.image.as_raw()),
            Some(alpha) => {
                let pixels = self.image.pixels().iter().zip(alpha);
                Cow::Owned(pixels.flat_map(|(&[r, g, b], &a)| [r, g, b, a]).collect())
            }
        }
    }

    /// The same in other samples.
    pub(super) fn convert<U: Sample>(&self) -> Layers<U> {
        let alpha = |alpha: &Vec<T>| alpha.iter().map(|value| U::from_unit(value.to_unit())).collect();
        Layers { image: self.image.convert(), alpha: self.alpha.as_ref().map(alpha) }
    }

    fn turned(self, orientation: u8) -> Self {
        if !(2..=8).contains(&orientation) {
            return self;
        }
        let (width, height) = self.image.size();
        let (across, down) = if orientation > 4 { (height, width) } else { (width, height) };
        let colours = turned(self.image.pixels(), width, orientation).into_flattened();
        let image = Image::from_raw(across, down, colours).expect("as many pixels as before");
        Self { image, alpha: self.alpha.map(|alpha| turned(&alpha, width, orientation)) }
    }
}

/// What is stored row by row, as an EXIF orientation of 2 to 8 shows it.
fn turned<P: Copy>(stored: &[P], width: usize, orientation: u8) -> Vec<P> {
    let rows = stored.chunks_exact(width);
    let column = |x: usize| stored.iter().skip(x).step_by(width);
    let mut seen = Vec::with_capacity(stored.len());
    match orientation {
        2 => seen.extend(rows.flat_map(|row| row.iter().rev())),
        3 => seen.extend(stored.iter().rev()),
        4 => seen.extend(rows.rev().flatten()),
        5 => seen.extend((0..width).flat_map(column)),
        6 => seen.extend((0..width).flat_map(|x| column(x).rev())),
        7 => seen.extend((0..width).rev().flat_map(|x| column(x).rev())),
        _ => seen.extend((0..width).rev().flat_map(column)),
    }
    seen
}
