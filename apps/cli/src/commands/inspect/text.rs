//! What `inspect` prints for people.

use std::fmt::Write;
use std::path::Path;

use aquafuse::depth::DepthKind;
use aquafuse::waterbody::{VeilingLightSource, Verdict, WaterShare};
use aquafuse_data::files::display;
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::pipeline::Analysis;

use super::report::{Depth, Size};
use crate::report::border;
use crate::report::water::{hex, reasons, source};

/// The report for people.
pub(super) fn text(image: &ImageFile, found: &Analysis, plot: Option<&Path>) -> String {
    let (depth, water) = (Depth::new(found), &found.estimate.water);
    let [r, g, b] = water.veiling_light.rgb();
    let [beta_r, beta_g, beta_b] = water.backscatter_coefficient;
    let [tau_r, tau_g, tau_b] = water.backscatter_coefficient.map(|beta| beta * depth.p95);
    let [fade_r, fade_g, fade_b] = water.attenuation.map(|curve| curve.optical_depth(depth.p95));
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<28}{value}");
    };
    let quality = found.estimate.quality;
    line(
        "verdict",
        match quality.verdict {
            Verdict::Good => "good".to_owned(),
            other => format!("{}: {}", other.name(), reasons(quality)),
        },
    );
    let Size { width, height } = Size::of(image);
    line("size", format!("{width} x {height}"));
    if let Some(area) = image.area() {
        line("border, left out", border::words(area));
    }
    if let Some(damage) = &image.damage {
        line("  WARNING", format!("the file is damaged: {damage}"));
    }
    let unit = match depth.kind {
        DepthKind::Metres => "metres",
        _ => "relative, without a unit: 0 near, 1 far",
    };
    line("depth z", format!("{}, {unit}", depth.source));
    if let Some(supplied) = &depth.supplied {
        let invalid = 100.0 * supplied.invalid_share;
        line("  file", format!("{}, {}", display(supplied.file.as_ref()), supplied.kind.name()));
        line(
            "  invalid",
            format!("{invalid:.1} % of the pixels; they are filled from others and from colour"),
        );
        for warning in &supplied.warnings {
            line("  WARNING", format!("the map {warning}"));
        }
    }
    line("  mean, 5 %, 95 %", format!("{:.2} {:.2} {:.2}", depth.mean, depth.p05, depth.p95));
    line("veiling light B∞", format!("{r:.3} {g:.3} {b:.3} (red, green, blue)   {}", hex([r, g, b])));
    line("  90 % interval", ranges(found.estimate.intervals.veiling_light, 3));
    line("  read from", source((found.estimate.veiling_light_source, found.estimate.veiling_light_share)));
    line("backscatter β_B", format!("{beta_r:.2} {beta_g:.2} {beta_b:.2} per unit of z"));
    line("  90 % interval", ranges(found.estimate.intervals.backscatter_coefficient, 2));
    line("  at the far end, β_B z95", format!("{tau_r:.2} {tau_g:.2} {tau_b:.2}"));
    if found.estimate.depth_factors.is_some() {
        line(
            "  for `physical`",
            "a table of F by z for objects instead of e^(−β_B z); see --json".to_owned(),
        );
    }
    line("open water", open_water(&found.share, found.estimate.veiling_light_source));
    line("attenuation", "a curve β_D(z); see --json".to_owned());
    line("  at the far end, β_D z95", format!("{fade_r:.2} {fade_g:.2} {fade_b:.2}"));
    if let Some(path) = plot {
        line("plot", display(path).to_string());
    }
    text
}

/// How much of the image is open water, and how likely it is that any is in view.
fn open_water(share: &WaterShare, source: VeilingLightSource) -> String {
    let [mean, seen] = [share.mean(), share.seen()].map(|share| 100.0 * share);
    match (share.is_none(), source) {
        (true, _) => format!("none; probability that any is in view: {seen:.1} %"),
        (false, VeilingLightSource::OpenWater) => {
            format!("{mean:.0} % of the image; probability that any is in view: {seen:.1} %")
        }
        (false, _) => {
            format!("not found; {mean:.0} % of the image may be some, with a probability of {seen:.1} %")
        }
    }
}

/// Three ranges.
fn ranges(of: [[f32; 2]; 3], decimals: usize) -> String {
    of.map(|[low, high]| format!("{low:.decimals$}-{high:.decimals$}")).join(" ")
}
