//! The figures of `inspect`, and their JSON.

use aquafuse::depth::{DepthKind, SuppliedKind};
use aquafuse::waterbody::{Intervals, Quality, VeilingLight, VeilingLightSource};
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::pipeline::{Analysis, DepthSource};
use serde::Serialize;

use crate::args::depth::{inverted, inverted_by_network};
use crate::report::border::BorderRecord;

/// The JSON of `inspect`; `schema` changes when a field changes its meaning or goes.
#[derive(Serialize)]
pub(super) struct Report {
    schema: u32,
    image: Size,
    /// What surrounds the scene, which the figures are about; `null` if every pixel is scene.
    border: Option<BorderRecord>,
    depth: Depth,
    waterbody: Water,
    water_share: Share,
    /// F' of things by the 256 levels of z, from 0 to 1, where it is a table. F of a pixel is (1 - w) F'.
    #[serde(skip_serializing_if = "Option::is_none")]
    depth_factor: Option<Vec<[f32; 3]>>,
    intervals: Intervals,
    veiling_light_source: VeilingLightSource,
    veiling_light_share: f32,
    quality: Quality,
}

#[derive(Serialize)]
pub(super) struct Size {
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Size {
    pub(super) fn of(image_file: &ImageFile) -> Self {
        let (width, height) = image_file.whole_size();
        Self { width, height }
    }
}

#[derive(Serialize)]
pub(super) struct Depth {
    pub(super) source: String,
    pub(super) kind: DepthKind,
    pub(super) mean: f32,
    pub(super) p05: f32,
    pub(super) p95: f32,
    pub(super) supplied: Option<Supplied>,
}

/// Where depth was supplied.
#[derive(Serialize)]
pub(super) struct Supplied {
    pub(super) file: String,
    pub(super) kind: SuppliedKind,
    pub(super) invalid_share: f64,
    agreement: Option<f64>,
    pub(super) warnings: Vec<String>,
}

/// How much of the image is open water.
#[derive(Serialize)]
struct Share {
    /// The mean of w, the share of open water in each pixel.
    mean: f32,
    /// How likely it is that open water is in view.
    seen: f32,
}

#[derive(Serialize)]
struct Water {
    veiling_light: VeilingLight,
    backscatter_coefficient: [f32; 3],
    attenuation: [[f32; 4]; 3],
    attenuation_held_beyond: [f32; 3],
}

impl Report {
    pub(super) fn new(image_file: &ImageFile, found: &Analysis) -> Self {
        let estimate = &found.estimate;
        let water = &estimate.water;
        Self {
            schema: 1,
            image: Size::of(image_file),
            border: image_file.area().map(BorderRecord::of),
            depth: Depth::new(found),
            waterbody: Water {
                veiling_light: water.veiling_light,
                backscatter_coefficient: water.backscatter_coefficient,
                attenuation: water.attenuation.map(|curve| curve.mu()),
                attenuation_held_beyond: water.attenuation.map(|curve| curve.held_beyond()),
            },
            water_share: Share { mean: found.share.mean(), seen: found.share.seen() },
            depth_factor: estimate.depth_factors.map(|table| levels().map(|z| table.at(z)).collect()),
            intervals: estimate.intervals,
            veiling_light_source: estimate.veiling_light_source,
            veiling_light_share: estimate.veiling_light_share,
            quality: estimate.quality,
        }
    }
}

/// z of each level of depth from colour.
fn levels() -> impl Iterator<Item = f32> {
    (0..=u8::MAX).map(|level| f32::from(level) / f32::from(u8::MAX))
}

impl Depth {
    pub(super) fn new(found: &Analysis) -> Self {
        let depth = &found.depth;
        Self {
            source: found.depth_source.name().to_owned(),
            kind: depth.kind(),
            mean: depth.mean(),
            p05: depth.percentile(0.05),
            p95: depth.percentile(0.95),
            supplied: Supplied::new(found),
        }
    }
}

impl Supplied {
    fn new(found: &Analysis) -> Option<Self> {
        let report = found.supplied.as_ref()?;
        let (file, warning) = match &found.depth_source {
            DepthSource::Supplied { path, .. } => (path.to_string_lossy().into_owned(), inverted(report)),
            DepthSource::Estimated(network) => (network.name().to_owned(), inverted_by_network(report.kind)),
        };
        let warning = report.looks_inverted().then_some(warning);
        Some(Self {
            file,
            kind: report.kind,
            invalid_share: report.invalid_share(),
            agreement: report.agreement,
            warnings: warning.into_iter().collect(),
        })
    }
}
