//! Words for an estimate: the veiling light, where it was read, and what speaks against it.

use aquafuse::waterbody::{Estimate, Quality, Reason, VeilingLightSource, Verdict};
use aquafuse_data::pipeline::WaterEstimate;

/// What speaks against an estimate, in words.
pub(crate) fn reasons(quality: Quality) -> String {
    quality.reasons.iter().map(Reason::describe).collect::<Vec<_>>().join(", ")
}

pub(crate) fn hex(rgb: [f32; 3]) -> String {
    let [r, g, b] = rgb.map(|value| (value * 255.0).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Where the veiling light was read, and from how much of the image.
pub(crate) fn source((source, share): (VeilingLightSource, f32)) -> String {
    let share = 100.0 * share;
    match source {
        VeilingLightSource::OpenWater => format!("smooth open water, {share:.1} % of the image"),
        VeilingLightSource::Farthest => format!("the farthest {share:.1} % of the pixels"),
        VeilingLightSource::TopCorners => "the top corners: nothing far has the water's colour".into(),
        VeilingLightSource::BottomCorners => {
            "the bottom corners: neither the far end nor the top has the water's colour".into()
        }
        VeilingLightSource::Unfiltered => {
            format!("the farthest {share:.1} %, whatever their colour: no water was found")
        }
        VeilingLightSource::Given => "what is known of it".into(),
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

/// One line on a water: its colour, where that was read, and what speaks against it.
pub(crate) fn veiling_light(estimate: &WaterEstimate) -> String {
    let light = format!(
        "veiling light {}, from {}",
        hex(estimate.veiling_light_as_seen()),
        source(estimate.veiling_light_source())
    );
    let quality = estimate.quality();
    match quality.verdict {
        Verdict::Good => light,
        verdict => format!("{light}; {}: {}", verdict.name(), reasons(quality)),
    }
}
