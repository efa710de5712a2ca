//! The estimate of an image's depth and water.

use std::path::PathBuf;

use aquafuse::depth::{DepthMap, DepthModel, SuppliedKind, SuppliedReport};
use aquafuse::image::{Encoded, Encoding, SizeError};
use aquafuse::waterbody::{self, Estimate, EstimateOptions, Evidence, Reason};

use crate::depth_file;
use crate::files::FileError;
use crate::image_file::ImageFile;

/// How the depth of an image is obtained.
#[derive(Clone, Debug, PartialEq)]
pub enum DepthSource {
    /// From colour.
    Estimated(DepthModel),
    /// From a file.
    Supplied {
        /// The file, of the image's size in stored order.
        path: PathBuf,
        /// The kind of its values.
        kind: SuppliedKind,
    },
}

impl Default for DepthSource {
    /// The default model.
    fn default() -> Self {
        Self::Estimated(DepthModel::default())
    }
}

impl DepthSource {
    /// The name used in reports: the model, or `supplied`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Estimated(model) => model.name(),
            Self::Supplied { .. } => "supplied",
        }
    }
}

/// An image's depth and water, estimated.
#[derive(Clone, Debug)]
pub struct Analysis<E: Encoding = Encoded> {
    /// Depth from colour, or as supplied.
    pub depth: DepthMap,
    /// How it was obtained.
    pub depth_source: DepthSource,
    /// The report on supplied depth; `None` for depth from colour.
    pub supplied: Option<SuppliedReport>,
    /// Its water, with intervals and verdict.
    pub estimate: Estimate<E>,
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
/// use aquafuse::image::{Encoded, Image};
/// use aquafuse_data::pipeline::{DepthSource, analyse};
/// use aquafuse_data::image_file::ImageFile;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("z.pfm");
/// let distances = [2.0_f32, 3.0];
/// std::fs::write(&path, [&b"Pf 2 1 -1\n"[..], &distances.map(f32::to_le_bytes).concat()].concat())?;
///
/// let image = ImageFile::new(Image::<u8>::from_raw(2, 1, vec![90, 100, 110, 20, 100, 120])?);
/// let found = analyse::<Encoded>(&image, &DepthSource::Supplied { path, kind: SuppliedKind::Metres })?;
/// assert_eq!(found.depth.distances(), distances);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyse<E: Encoding>(image: &ImageFile, source: &DepthSource) -> Result<Analysis<E>, FileError> {
    let top = image.top_edge();
    // Estimators count in 256 steps: what lies between is of no use to them.
    let bytes = image.bytes();
    let (depth, supplied) = match source {
        DepthSource::Estimated(model) => (image.pixels.depth(model, top), None),
        DepthSource::Supplied { path, kind } => {
            let turned = image.metadata.orientation() > 4;
            let unfit = |error| FileError::UnfitDepth { path: path.clone(), error, turned };
            let map = depth_file::read_for(path, *kind, bytes.size()).map_err(|refused| match refused {
                FileError::UnfitDepth { error, .. } => unfit(error),
                other => other,
            })?;
            let found = map.seen_with(&bytes, top).map_err(unfit)?;
            (found.depth, Some(found.report))
        }
    };
    let mut estimate =
        waterbody::estimate(&bytes, &depth, &options(image)).expect("the depth map was made for this image");
    if supplied.is_some_and(|report| report.looks_turned_round()) {
        estimate.quality = estimate.quality.with(Reason::InvertedDepth);
    }
    Ok(Analysis { depth, depth_source: source.clone(), supplied, estimate })
}

/// The data that the water of [`Analysis::estimate`] was fitted to, read again from the `image` that was analysed.
///
/// # Errors
///
/// [`SizeError`] when it is another image, of another size.
pub fn evidence(image: &ImageFile, found: &Analysis) -> Result<Evidence, SizeError> {
    waterbody::evidence::<Encoded>(&image.bytes(), &found.depth, &options(image))
}

fn options(image: &ImageFile) -> EstimateOptions {
    EstimateOptions { top: image.top_edge(), ..EstimateOptions::default() }
}
