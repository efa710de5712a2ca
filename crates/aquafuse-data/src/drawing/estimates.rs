//! One sheet with all that the estimates of an image rest on, to be read from left to right.

mod charts;
mod numbers;
mod panels;
mod view;

use crate::image_file::ImageFile;
use crate::pipeline::{Analysis, DepthEstimator, DepthSource};
use aquafuse::depth::{DepthKind, DepthMap, DepthModel};
use aquafuse::image::Image;
use aquafuse::waterbody::Evidence;

use super::DrawError;
use charts::{Chart, Charts};
use panels::{Panel, Sheet};
use view::View;

/// Share of the pixels that is drawn black in a depth map.
const NEAREST: f32 = 0.02;
const NAMES: [&str; 3] = ["R", "G", "B"];

/// What the sheet says in words.
#[derive(Clone, Copy, Debug)]
pub struct Captions<'a> {
    /// The name of the image.
    pub name: &'a str,
    /// The colour of the veiling light, and where it was read.
    pub veiling_light: &'a str,
}

/// Draws what was found in an image, and the evidence it was found by.
///
/// # Errors
///
/// [`DrawError`] when `found` is of an image of another size.
pub fn estimates(
    captions: Captions<'_>,
    image: &ImageFile,
    found: &Analysis,
    evidence: &Evidence,
) -> Result<Image<u8>, DrawError> {
    let view = View::new(image, panels::ROOM);
    let z = view.depth(&found.depth);
    let water = &found.estimate.water;
    let unit = unit(found.depth.kind());
    let depth_factors = found.estimate.depth_factors.as_ref();
    let charts = Charts { water, depth_factors, evidence, unit };
    Sheet::draw(&format!("{}: depth and water, estimated", captions.name), |sheet| {
        let shown = view.content();
        let mut panels = sheet.panels(shown.height());
        let mut next = |title: &str| panels.next(title);

        let content = next("content U")?;
        content.image(&shown)?;
        let (width, height) = image.pixels.size();
        content.caption(&format!("{width} x {height} pixels"))?;
        let red = next("its red channel, R")?;
        red.image(&view.grey(|[r, _, _]| r))?;
        red.caption("water takes red away first: dark is far, or was dark to begin with")?;
        let stronger = next("the stronger of green and blue, M = max(G, B)")?;
        stronger.image(&view.grey(|[_, g, b]| g.max(b)))?;
        stronger.caption("depth from colour is estimated from R and M")?;
        depth(
            &next(&depth_title(&found.depth_source))?,
            &view,
            &z,
            [found.depth.percentile(NEAREST), evidence.z95],
        )?;

        let mask = next("where the veiling light B∞ was read: white")?;
        mask.image(&view.mask(&evidence.read_from))?;
        let veil = water.veiling_light.rgb();
        mask.swatch(veil.map(|value| (255.0 * value).round() as u8))?;
        mask.caption_beside(captions.veiling_light)?;
        charts.draw(Chart::Backscatter, &next("backscatter B(z) = B∞ (1 − e^(−β_B z))")?)?;
        charts.draw(Chart::Attenuation, &next("attenuation coefficient β_D(z)")?)?;
        match found.depth_source {
            DepthSource::Estimated(DepthEstimator::Colour(_)) => {
                charts.draw(Chart::Illumination, &next("illumination E(z) = e^(−β_D(z) z)")?)?;
            }
            DepthSource::Estimated(DepthEstimator::Network(_)) | DepthSource::Supplied { .. } => {
                let model = DepthModel::default();
                let from_colour = image.pixels.depth(&model, image.top_edge());
                let z = view.depth(&from_colour);
                let title = format!("for comparison: depth z from colour ({})", model.name());
                depth(&next(&title)?, &view, &z, [NEAREST, 0.95].map(|share| from_colour.percentile(share)))?;
            }
        }

        let [_, green, blue] = veil;
        let m = if green > blue { 1 } else { 2 };
        for (channel, what) in [(0, "R".to_owned()), (m, format!("M (here {})", NAMES[m]))] {
            let map = next(&format!("illumination map E for {what}"))?;
            map.image(&view.grey_of(&z, |z| water.illumination(z)[channel]))?;
            map.bar("0: none of the light left", "1: all of it")?;
        }
        let restored = next("restored I = (U − B) / E")?;
        restored.image(&view.restored(&z, &found.estimate)?)?;
        restored
            .caption("as `aquafuse restore` makes it: its gain is limited, so that highlights do not clip")?;
        numbers::write(&next("")?, found, unit)
    })
}

fn unit(kind: DepthKind) -> &'static str {
    if kind == DepthKind::Metres { "m" } else { "relative" }
}

fn depth_title(source: &DepthSource) -> String {
    match source {
        DepthSource::Estimated(DepthEstimator::Colour(model)) => {
            format!("depth z from colour ({})", model.name())
        }
        DepthSource::Estimated(DepthEstimator::Network(_)) => "depth z, by a network".to_owned(),
        DepthSource::Supplied { kind, .. } => format!("depth z, supplied ({})", kind.name()),
    }
}

/// A depth map, black up to the nearer end of the range, white from the farther one on.
fn depth(panel: &Panel<'_>, view: &View<'_>, z: &DepthMap, [near, far]: [f32; 2]) -> Result<(), DrawError> {
    let width = (far - near).max(f32::MIN_POSITIVE);
    panel.image(&view.grey_of(z, |z| (z - near) / width))?;
    let unit = unit(z.kind());
    panel.bar(&format!("near: {near:.2} {unit}"), &format!("far: {far:.2} {unit}"))
}
