//! The estimate of an image's depth and water.

use std::path::PathBuf;

use aquafuse::depth::{DepthMap, Supplied, SuppliedDepth, SuppliedError, SuppliedKind, SuppliedReport};
use aquafuse::image::{Encoded, Encoding, Image, ImageError, Linear};
use aquafuse::waterbody::{self, Estimate, EstimateOptions, Evidence, Reason, WaterShare};

use super::encoding::{PixelEncoding, Space, WaterEstimate};
use super::{DepthEstimator, SUPPLIED};
use crate::depth_file;
use crate::depth_network::{refined, scaled};
use crate::files::{FileError, Step, count};
use crate::image_file::ImageFile;

/// How the depth of an image is obtained.
#[derive(Clone, Debug, PartialEq)]
pub enum DepthSource {
    /// From the image, by a model of its colours or by a network.
    Estimated(DepthEstimator),
    /// From a file.
    Supplied {
        /// The file, of the whole image's size in stored order; empty for values that came from memory
        /// ([`analyse_supplied`]).
        path: PathBuf,
        /// The kind of its values.
        kind: SuppliedKind,
        /// Whether it must have the image's size.
        size: MapSize,
    },
}

/// The size that a depth map may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapSize {
    /// That of the image.
    #[default]
    Exact,
    /// Any of the image's proportions: it is scaled to the image's size by nearest neighbour.
    Scaled,
}

impl Default for DepthSource {
    /// The default model.
    fn default() -> Self {
        Self::Estimated(DepthEstimator::default())
    }
}

impl DepthSource {
    /// What it takes in bytes beside an image of so many pixels.
    pub(crate) fn memory(&self, pixels: u64) -> u64 {
        match self {
            Self::Estimated(estimator) => estimator.memory(pixels),
            Self::Supplied { size: MapSize::Exact, .. } => pixels.saturating_mul(SUPPLIED),
            // A map may have four times the pixels of its image, which take 8 bytes each until it is scaled.
            Self::Supplied { size: MapSize::Scaled, .. } => pixels.saturating_mul(SUPPLIED.saturating_mul(3)),
        }
    }

    /// The name used in reports: the model, or `supplied`.
    pub fn name(&self) -> &str {
        match self {
            Self::Estimated(estimator) => estimator.name(),
            Self::Supplied { .. } => "supplied",
        }
    }
}

/// An image's depth and water, estimated. The estimate is of a type that says its encoding, or a [`WaterEstimate`],
/// whose encoding is a value.
#[derive(Clone, Debug)]
pub struct Analysis<W = Estimate<Encoded>> {
    /// Depth from colour, or as supplied.
    pub depth: DepthMap,
    /// How it was obtained.
    pub depth_source: DepthSource,
    /// The report on supplied depth, and on depth by a network; `None` for depth from colour.
    pub supplied: Option<SuppliedReport>,
    /// How much of each pixel is open water.
    pub share: WaterShare,
    /// Its water, with intervals and verdict.
    pub estimate: W,
}

impl From<Analysis> for Analysis<WaterEstimate> {
    fn from(found: Analysis) -> Self {
        let Analysis { depth, depth_source, supplied, share, estimate } = found;
        Self { depth, depth_source, supplied, share, estimate: estimate.into() }
    }
}

/// Estimates depth and water of an image. Every command that needs either calls this.
///
/// The water has the encoding `E`: encoded values as in the file, or linear light.
///
/// # Errors
///
/// [`FileError`] when supplied depth cannot be read or does not fit the image; depth from colour never fails.
///
/// # Examples
///
/// ```
/// use aquafuse::depth::SuppliedKind;
/// use aquafuse::image::Image;
/// use aquafuse_data::image_file::ImageFile;
/// use aquafuse_data::pipeline::{DepthSource, MapSize, analyse};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("z.pfm");
/// let distances = [2.0_f32, 3.0];
/// std::fs::write(&path, [&b"Pf 2 1 -1\n"[..], &distances.map(f32::to_le_bytes).concat()].concat())?;
///
/// let image = ImageFile::new(Image::<u8>::from_raw(2, 1, vec![90, 100, 110, 20, 100, 120])?);
/// let depth = DepthSource::Supplied { path, kind: SuppliedKind::Metres, size: MapSize::Exact };
/// let found = analyse(&image, &depth)?;
/// assert_eq!(found.depth.distances(), distances);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyse(image: &ImageFile, source: &DepthSource) -> Result<Analysis, FileError> {
    analyse_typed(image, source)
}

/// As [`analyse`], with the encoding as a value: the water of encoded values, or of the light behind them.
///
/// # Errors
///
/// As [`analyse`].
pub fn analyse_in(
    encoding: PixelEncoding,
    image: &ImageFile,
    source: &DepthSource,
) -> Result<Analysis<WaterEstimate>, FileError> {
    Ok(match encoding {
        PixelEncoding::Encoded => wrapped::<Encoded>(analyse_typed(image, source)?),
        PixelEncoding::Linear => wrapped::<Linear>(analyse_typed(image, source)?),
    })
}

/// As [`analyse_in`], with what the estimate was fitted to.
pub(crate) fn analyse_in_with_evidence(
    encoding: PixelEncoding,
    image: &ImageFile,
    source: &DepthSource,
) -> Result<(Analysis<WaterEstimate>, Evidence), FileError> {
    Ok(match encoding {
        PixelEncoding::Encoded => {
            let (found, seen) = analyse_typed_with_evidence::<Encoded>(image, source)?;
            (wrapped(found), seen)
        }
        PixelEncoding::Linear => {
            let (found, seen) = analyse_typed_with_evidence::<Linear>(image, source)?;
            (wrapped(found), seen)
        }
    })
}

fn wrapped<E: Space>(found: Analysis<Estimate<E>>) -> Analysis<WaterEstimate> {
    let Analysis { depth, depth_source, supplied, share, estimate } = found;
    Analysis { depth, depth_source, supplied, share, estimate: E::wrap(estimate) }
}

fn analyse_typed<E: Encoding>(
    image: &ImageFile,
    source: &DepthSource,
) -> Result<Analysis<Estimate<E>>, FileError> {
    analyse_by(image, source, |bytes, depth| estimated(image, bytes, depth)).map(|(found, ())| found)
}

fn estimated<E: Encoding>(
    image: &ImageFile,
    bytes: &Image<u8>,
    depth: &DepthMap,
) -> Result<(Estimate<E>, WaterShare, ()), ImageError> {
    let (estimate, share) = waterbody::estimate_with_share(bytes, depth, &options(image))?;
    Ok((estimate, share, ()))
}

/// As [`analyse`], with what the estimate was fitted to; both come of one pass.
///
/// # Errors
///
/// As [`analyse`].
pub fn analyse_with_evidence(
    image: &ImageFile,
    source: &DepthSource,
) -> Result<(Analysis, Evidence), FileError> {
    analyse_typed_with_evidence(image, source)
}

fn analyse_typed_with_evidence<E: Encoding>(
    image: &ImageFile,
    source: &DepthSource,
) -> Result<(Analysis<Estimate<E>>, Evidence), FileError> {
    analyse_by(image, source, |bytes, depth| waterbody::estimate_with_evidence(bytes, depth, &options(image)))
}

/// Obtains the depth of an image, whose pixels as bytes are `bytes`, without its water.
///
/// # Errors
///
/// As [`analyse`].
pub(crate) fn depth_of(
    image: &ImageFile,
    bytes: &Image<u8>,
    source: &DepthSource,
) -> Result<(DepthMap, Option<SuppliedReport>), FileError> {
    Ok(match source {
        DepthSource::Estimated(estimator) => estimator.depth(image, bytes)?,
        DepthSource::Supplied { path, kind, size } => {
            let read = match size {
                MapSize::Exact => depth_file::read_for,
                MapSize::Scaled => depth_file::read_scaled,
            };
            let turned = image.metadata.orientation() > 4;
            let unfit = |error| FileError::UnfitDepth { path: path.clone(), error, turned };
            let map = read(path, *kind, image.whole_size()).map_err(|refused| match refused {
                FileError::UnfitDepth { error, .. } => unfit(error),
                other => other,
            })?;
            let found = supplied_depth(image, bytes, map).map_err(unfit)?;
            (found.depth, Some(found.report))
        }
    })
}

/// The depth of an image, whose pixels as bytes are `bytes`, from a map of the whole image's size.
fn supplied_depth(
    image: &ImageFile,
    bytes: &Image<u8>,
    map: Supplied,
) -> Result<SuppliedDepth, SuppliedError> {
    let whole = image.whole_size();
    if map.size() != whole {
        return Err(SuppliedError::Size { map: map.size(), image: whole });
    }
    let map = match image.area() {
        Some(area) => map.cut(area).expect("the map has the size of the whole image"),
        None => map,
    };
    map.seen_with(bytes, image.top_edge())
}

/// As [`analyse_in`], with depth that is in memory already, of the whole image's size.
///
/// # Errors
///
/// [`SuppliedError`] when the map does not fit the image or its kind.
///
/// # Examples
///
/// ```
/// use aquafuse::depth::{Supplied, SuppliedKind};
/// use aquafuse::image::Image;
/// use aquafuse_data::image_file::ImageFile;
/// use aquafuse_data::pipeline::{PixelEncoding, analyse_supplied};
///
/// let image = ImageFile::new(Image::<u8>::from_raw(2, 1, vec![90, 100, 110, 20, 100, 120])?);
/// let map = Supplied::new(2, 1, vec![2.0, 3.0], SuppliedKind::Metres)?;
/// let found = analyse_supplied(PixelEncoding::Encoded, &image, map)?;
/// assert_eq!(found.depth.distances(), [2.0, 3.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyse_supplied(
    encoding: PixelEncoding,
    image: &ImageFile,
    map: Supplied,
) -> Result<Analysis<WaterEstimate>, SuppliedError> {
    let bytes = image.bytes();
    let kind = map.kind();
    Ok(analyse_found(encoding, image, &bytes, kind, supplied_depth(image, &bytes, map)?))
}

/// As [`analyse_supplied`], with depth that another program estimated from the scene ([`ImageFile::bytes`]): the map may have any
/// size, covers the scene as a whole, and is refined by it as the map of a network is.
///
/// # Errors
///
/// [`SuppliedError`] when the map does not fit its kind.
///
/// # Examples
///
/// ```
/// use aquafuse::depth::{Supplied, SuppliedKind};
/// use aquafuse::image::Image;
/// use aquafuse_data::image_file::ImageFile;
/// use aquafuse_data::pipeline::{PixelEncoding, analyse_coarse};
///
/// let grey = Image::<u8>::from_raw(40, 20, vec![90; 40 * 20 * 3])?;
/// let near_to_far = Supplied::new(4, 2, vec![1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0], SuppliedKind::Metres)?;
/// let found = analyse_coarse(PixelEncoding::Encoded, &ImageFile::new(grey), &near_to_far)?;
/// assert_eq!(found.depth.size(), (40, 20));
/// assert!(found.depth.at(5, 10) < found.depth.at(35, 10));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyse_coarse(
    encoding: PixelEncoding,
    image: &ImageFile,
    map: &Supplied,
) -> Result<Analysis<WaterEstimate>, SuppliedError> {
    let bytes = image.bytes();
    let found = refined(map, &scaled(&bytes, map.size()), &bytes, image.top_edge())?;
    Ok(analyse_found(encoding, image, &bytes, map.kind(), found))
}

/// The water at a depth that came from memory.
fn analyse_found(
    encoding: PixelEncoding,
    image: &ImageFile,
    bytes: &Image<u8>,
    kind: SuppliedKind,
    SuppliedDepth { depth, report, .. }: SuppliedDepth,
) -> Analysis<WaterEstimate> {
    let source = DepthSource::Supplied { path: PathBuf::new(), kind, size: MapSize::Exact };
    let found = (depth, Some(report));
    match encoding {
        PixelEncoding::Encoded => {
            let estimate = |bytes: &Image<u8>, depth: &DepthMap| estimated(image, bytes, depth);
            wrapped::<Encoded>(analyse_at(bytes, found, &source, estimate).0)
        }
        PixelEncoding::Linear => {
            let estimate = |bytes: &Image<u8>, depth: &DepthMap| estimated(image, bytes, depth);
            wrapped::<Linear>(analyse_at(bytes, found, &source, estimate).0)
        }
    }
}

/// Obtains depth, then the water by `estimate`, which may return more than the estimate.
fn analyse_by<E: Encoding, M>(
    image: &ImageFile,
    source: &DepthSource,
    estimate: impl FnOnce(&Image<u8>, &DepthMap) -> Result<(Estimate<E>, WaterShare, M), ImageError>,
) -> Result<(Analysis<Estimate<E>>, M), FileError> {
    // Estimators count in 256 steps: what lies between is of no use to them.
    let bytes = image.bytes();
    let depth = depth_of(image, &bytes, source)?;
    Ok(analyse_at(&bytes, depth, source, estimate))
}

/// Obtains the water at a known depth.
fn analyse_at<E: Encoding, M>(
    bytes: &Image<u8>,
    (depth, supplied): (DepthMap, Option<SuppliedReport>),
    source: &DepthSource,
    estimate: impl FnOnce(&Image<u8>, &DepthMap) -> Result<(Estimate<E>, WaterShare, M), ImageError>,
) -> (Analysis<Estimate<E>>, M) {
    count(Step::WaterEstimated);
    let (mut estimate, share, more) = estimate(bytes, &depth).expect("the depth map was made for this image");
    if supplied.is_some_and(|report| report.looks_inverted()) {
        estimate.quality = estimate.quality.with(Reason::InvertedDepth);
    }
    (Analysis { depth, depth_source: source.clone(), supplied, share, estimate }, more)
}

fn options(image: &ImageFile) -> EstimateOptions {
    EstimateOptions::default().with_top(image.top_edge()).with_water_map(image.water_map())
}
