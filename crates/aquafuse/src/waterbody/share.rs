//! How much of each pixel is open water.

use super::cells::Cells;
use super::far_region::Region;
use super::glimpse::Glimpse;
use super::{EstimateOptions, VeilingLight};
use crate::depth::DepthMap;
use crate::guided::{self, Guided};
use crate::image::{Encoding, ImageError, ImageRef, Sample};
use crate::simd::{self, Work};

/// A cell with so much less evidence than the far region is no water.
const REACH: f32 = 1.4;
/// Cells of the water's colour are water, though things beside them speak against it: to this share, and if they are
/// this near, across the line from black through the water's colour and along it.
const BY_COLOUR: f32 = 0.8;
const ACROSS: f32 = 0.1;
const ALONG: f32 = 0.25;
/// Likelihoods of open water between which the share grows from nothing to the whole.
const UNLIKELY: f32 = 0.25;
const LIKELY: f32 = 0.65;
/// Water whose brightest channel (encoded) is fainter cannot be distinguished from shadow: black would count as water.
pub(super) const FAINTEST_WATER: f32 = 0.14;
/// Variance of colours below which they do not guide the share.
const FLAT: f32 = 1e-3;
/// A pixel that is surely water is this share of it: evidence is never whole.
const MOST: f32 = 0.98;

/// The share of water w: how much of each pixel is open water, in `[0, 1]`.
///
/// Open water lets nothing through, whatever depth it is taken for, so that the depth factor of a pixel is
/// `F = (1 - w) F'(z)`; F' is the depth factor of things. w is 1 where the image is like its far region and 0 on things; where no
/// open water is in view it is 0 everywhere, and so it is where depth was measured: F' vanishes in open water by itself there. It is
/// found in small cells and refined with the image as guide, so that it
/// ends where things begin: near a place, w is an affine function of colour.
///
/// All fusion models but [`Model::Aquafuse`](crate::fusion::Model::Aquafuse) read it.
///
/// # Examples
///
/// ```
/// use aquafuse::{depth, image::Image, truth, waterbody};
///
/// let scene = truth::Scene::new(1, truth::Size { width: 96, height: 64 });
/// let image: Image<u8> = scene.seen_through(&truth::waters()[0].water).convert();
/// let z = depth::estimate(&image);
/// let (found, share) = waterbody::estimate_with_share::<aquafuse::image::Encoded>(&image, &z, &Default::default())?;
/// println!("open water is in view with a likelihood of {}", share.seen());
/// let [top, bottom] = [0, 63].map(|y| share.at(48, y, image.pixels()[96 * y + 48].map(|v| f32::from(v) / 255.0)));
/// assert!(top > bottom + 0.5, "{top} {bottom}");
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct WaterShare {
    width: usize,
    height: usize,
    seen: f32,
    mean: f32,
    /// What is left of w where it is not sure that water is in view.
    sure: f32,
    /// w before that; none where it is 0 everywhere.
    map: Option<Guided>,
}

/// The share of water of an image whose water is known, from another frame for example. Where the water is not known,
/// [`estimate_with_share`](super::estimate_with_share) estimates both at once.
///
/// # Errors
///
/// [`ImageError`] when image and depth map differ in size.
pub fn water_share<'a, E: Encoding>(
    image: impl Into<ImageRef<'a, u8>>,
    depth: &DepthMap,
    veiling_light: &VeilingLight<E>,
    options: &EstimateOptions,
) -> Result<WaterShare, ImageError> {
    let veil = veiling_light.rgb().map(E::to_encoded);
    water_share_by(image.into(), depth, options, &mut Glimpse::default(), |seen| (veil, sureness(seen)))
}

/// [`water_share`] by the water's colour and how sure it is that water is in view, which may depend on the likelihood.
pub(crate) fn water_share_by(
    image: ImageRef<'_, u8>,
    depth: &DepthMap,
    options: &EstimateOptions,
    glimpse: &mut Glimpse,
    water: impl FnOnce(f32) -> ([f32; 3], f32),
) -> Result<WaterShare, ImageError> {
    depth.check_fits(image.size())?;
    let region = match depth.is_measured_everywhere() {
        true => None,
        false => {
            let cells = Cells::new(image, &depth.quantised().levels);
            Region::by(options, cells, image, depth.model().is_none(), glimpse)
        }
    };
    let Some(region) = region else {
        water(0.0);
        return Ok(WaterShare::none(image.size()));
    };
    let (veil, sure) = water(region.seen);
    Ok(WaterShare::of(depth, &region, veil, sure))
}

/// What is left of w where open water is in view with this likelihood.
pub(crate) fn sureness(seen: f32) -> f32 {
    let within = ((seen - UNLIKELY) / (LIKELY - UNLIKELY)).clamp(0.0, 1.0);
    within * within * (3.0 - 2.0 * within)
}

impl WaterShare {
    /// No water in view in an image of this size: w is 0 everywhere.
    #[must_use]
    pub fn none((width, height): (usize, usize)) -> Self {
        Self { width, height, seen: 0.0, mean: 0.0, sure: 0.0, map: None }
    }

    /// The share of an image, by the region that is likeliest to be water; `veil` is the water's colour, encoded, and
    /// `sure` what is left of w.
    pub(super) fn of(depth: &DepthMap, region: &Region, veil: [f32; 3], sure: f32) -> Self {
        let none = Self { seen: region.seen, ..Self::none(depth.size()) };
        if sure == 0.0 || veil.iter().all(|&channel| channel < FAINTEST_WATER) {
            return none;
        }
        let colours: Vec<[f32; 3]> =
            region.cells.all().iter().map(|cell| cell.mean.map(|v| v / 255.0)).collect();
        let of_cell =
            |i: usize| share_of_cell(region, i, &colours[i], &veil) * may_be_water(depth, region, i);
        let map: Vec<f32> = (0..colours.len()).map(of_cell).collect();
        let mean = map.iter().map(|&share| f64::from(share)).sum::<f64>() / map.len() as f64;
        let map = Guided::new(region.cells.grid(), &colours, &map, FLAT);
        Self { sure, mean: (f64::from(sure) * mean) as f32, map: Some(map), ..none }
    }

    /// What is left of w where it is not sure that water is in view.
    pub(crate) fn sure(&self) -> f32 {
        self.sure
    }

    /// The same where it is as sure as this.
    pub(crate) fn with_sure(self, sure: f32) -> Self {
        // Neither is known where there are no fits.
        if self.is_none() || sure == self.sure {
            return self;
        }
        let mean = if self.sure > 0.0 { self.mean * sure / self.sure } else { 0.0 };
        Self { sure, mean, ..self }
    }

    /// Columns and rows of the image.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// How likely it is that open water is in view, in `[0, 1]`.
    pub fn seen(&self) -> f32 {
        self.seen
    }

    /// The mean of w over the image, by cells.
    pub fn mean(&self) -> f32 {
        self.mean
    }

    /// Whether w is 0 everywhere.
    pub fn is_none(&self) -> bool {
        self.map.is_none()
    }

    /// w at column `x`, row `y` where the image has this encoded colour, in `[0, 1]`.
    ///
    /// # Panics
    ///
    /// When the place lies outside the image.
    pub fn at(&self, x: usize, y: usize, rgb: [f32; 3]) -> f32 {
        assert!(x < self.width && y < self.height, "({x}, {y}) lies outside {:?}", self.size());
        self.map.as_ref().map_or(0.0, |map| self.share(map.at(x, y, rgb)))
    }

    /// w of row after row.
    pub(crate) fn rows(&self) -> Rows<'_> {
        Rows { share: self, map: self.map.as_ref().map(Guided::rows), none: vec![0.0; self.width] }
    }

    #[inline(always)]
    fn share(&self, mapped: f32) -> f32 {
        self.sure * mapped.clamp(0.0, 1.0)
    }
}

/// w of one row at a time, in memory of its own.
pub(crate) struct Rows<'a> {
    share: &'a WaterShare,
    map: Option<guided::Rows<'a>>,
    none: Vec<f32>,
}

impl Rows<'_> {
    /// w of the pixels of row `y`.
    pub(crate) fn row<T: Sample, E: Encoding>(&mut self, y: usize, pixels: &[[T; 3]]) -> &[f32] {
        let Some(map) = &mut self.map else { return &self.none };
        let row = map.row::<T, E>(y, pixels);
        simd::widest(ToShares { share: self.share, values: row });
        row
    }
}

/// What was mapped becomes w.
struct ToShares<'a> {
    share: &'a WaterShare,
    values: &'a mut [f32],
}

impl Work for ToShares<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.values.iter_mut().for_each(|value| *value = self.share.share(*value));
    }
}

/// How much of a cell may be open water by its depth: where that was measured, F' vanishes in open water by itself.
fn may_be_water(depth: &DepthMap, region: &Region, cell: usize) -> f32 {
    let [x, y] = region.cells.place(cell).map(|pixels| pixels.start + pixels.len() / 2);
    depth.may_be_water(x, y)
}

/// How much of a cell is water: by evidence, or else by its colour; or by what a network sees there, or by either.
fn share_of_cell(region: &Region, cell: usize, colour: &[f32; 3], veil: &[f32; 3]) -> f32 {
    let network = region.logits.as_ref().map_or(0.0, |logits| by_network(logits[cell], colour, veil));
    if region.alone { network } else { by_rules(region, cell, colour, veil).max(network) }
}

fn by_rules(region: &Region, cell: usize, colour: &[f32; 3], veil: &[f32; 3]) -> f32 {
    let by_evidence = (1.0 - (region.typical - region.evidence[cell]) / REACH).clamp(0.0, 1.0);
    let length = veil.iter().map(|value| value * value).sum::<f32>().sqrt().max(1e-3);
    let off: [f32; 3] = std::array::from_fn(|c| colour[c] - veil[c]);
    let along = (0..3).map(|c| off[c] * veil[c] / length).sum::<f32>();
    let across = (off.iter().map(|off| off * off).sum::<f32>() - along * along).max(0.0);
    let alike = (-across / (ACROSS * ACROSS) - (along / ALONG).powi(2)).exp();
    MOST * (1.0 - (1.0 - by_evidence) * (1.0 - BY_COLOUR * alike))
}

/// How near to the water's colour a cell is that is like it.
const ALIKE: f32 = 0.12;
/// The power of what the network says, where a cell is like the water: unsure cells then count nearly whole.
const UNSURE: f32 = 0.25;

/// How much of a cell is water by a network's logit: `.98 max(l p^.25, p)`, l its likeness to the water.
fn by_network(logit: f32, colour: &[f32; 3], veil: &[f32; 3]) -> f32 {
    let p = (1.0 + (-logit).exp()).recip();
    let off = (0..3).map(|c| (colour[c] - veil[c]).powi(2)).sum::<f32>();
    let alike = (-off / (ALIKE * ALIKE)).exp();
    MOST * p.max(alike * p.powf(UNSURE))
}
