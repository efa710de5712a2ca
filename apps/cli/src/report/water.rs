//! Words for an estimate: the veiling light, its source, and the reasons of the verdict.

use aquafuse::waterbody::{Estimate, Quality, Reason, VeilingLightSource, Verdict};
use aquafuse_data::pipeline::WaterEstimate;

/// The reasons of a verdict, in words.
pub(crate) fn reasons(quality: Quality) -> String {
    quality.reasons.iter().map(Reason::describe).collect::<Vec<_>>().join(", ")
}

/// A verdict, with its reasons unless it is good.
pub(crate) fn verdict(quality: Quality) -> String {
    match quality.verdict {
        Verdict::Good => "good".into(),
        verdict => format!("{} ({})", verdict.name(), reasons(quality)),
    }
}

/// How many estimates have which verdict.
pub(crate) fn estimate_counts(verdicts: &(impl Iterator<Item = Verdict> + Clone)) -> String {
    let count = |wanted| verdicts.clone().filter(|verdict| *verdict == wanted).count();
    let [good, doubtful, failed] = [Verdict::Good, Verdict::Doubtful, Verdict::Failed].map(count);
    format!("estimates: {good} good, {doubtful} doubtful, {failed} failed")
}

pub(crate) fn hex(rgb: [f32; 3]) -> String {
    let [r, g, b] = rgb.map(|value| (value * 255.0).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Which pixels gave the veiling light, and their share of the image.
pub(crate) fn source((source, share): (VeilingLightSource, f32)) -> String {
    let share = 100.0 * share;
    match source {
        VeilingLightSource::OpenWater => format!("smooth open water, {share:.1} % of the image"),
        VeilingLightSource::FarRegion => {
            format!("what looks most like open water, {share:.1} % of the image")
        }
        VeilingLightSource::Farthest => format!("the farthest {share:.1} % of the pixels"),
        VeilingLightSource::TopCorners => "the top corners: no far pixel has the colour of water".into(),
        VeilingLightSource::BottomCorners => {
            "the bottom corners: no far or top pixel has the colour of water".into()
        }
        VeilingLightSource::Unfiltered => {
            format!("the farthest {share:.1} % of any colour: no water was found")
        }
        VeilingLightSource::Given => "supplied values".into(),
    }
}

/// The veiling light, and where it was read.
pub(crate) fn veiling_light_in_short(estimate: &Estimate) -> String {
    format!(
        "B∞ {}, from {}",
        hex(estimate.water.veiling_light.rgb()),
        source((estimate.veiling_light_source, estimate.veiling_light_share))
    )
}

/// One line on a water: its colour, the source of that colour, and the verdict with its reasons unless it is good.
pub(crate) fn veiling_light(estimate: &WaterEstimate) -> String {
    let light = format!(
        "veiling light {}, from {}",
        hex(estimate.veiling_light_as_seen()),
        source(estimate.veiling_light_source())
    );
    let quality = estimate.quality();
    match quality.verdict {
        Verdict::Good => light,
        _ => format!("{light}; estimate {}", verdict(quality)),
    }
}
