//! `aquafuse inspect`: what a picture tells about its depth and its water.

use std::fmt::Write;
use std::path::PathBuf;

use aquafuse::depth::{DepthKind, SuppliedKind};
use aquafuse::image::Encoding;
use aquafuse::waterbody::{Estimate, Intervals, Quality, Reason, VeilingLight, VeilingLightSource, Verdict};
use aquafuse_data::analysis::{Analysis, DepthSource, analyse};
use aquafuse_data::picture::{Picture, shown};
use clap::Args;
use serde::Serialize;

use crate::depth_arguments::{DepthArguments, turned_round};
use crate::depth_model::DepthModelArg;
use crate::failure::Failure;
use crate::output;
use crate::reading::Reading;

/// Show what a picture tells about its depth and its water.
///
/// `fuse` uses exactly these estimates: depth z, the veiling light B∞ (the colour of open water), how fast
/// backscatter grows with z (β_B) and how fast the scene's own light fades (β_D). At the far end, β z is the
/// thickness of the water seen through: .1 is hardly any, 1 is much, 3 hides nearly everything.
#[derive(Args)]
// Nothing is left to estimate here where depth is given; `fuse` still needs the model, for its reference.
#[command(mut_arg("depth_model", |model| model.conflicts_with("depth")))]
pub(crate) struct Inspect {
    /// PNG, JPEG, TIFF, WebP, BMP or GIF.
    image: PathBuf,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    model: DepthModelArg,
    /// Print JSON for programs.
    #[arg(long)]
    json: bool,
}

impl Inspect {
    pub(crate) fn run(&self, reading: &Reading) -> Result<(), Failure> {
        let picture = reading.read(&self.image)?;
        let supply = self.depth.supply(false, self.model.get()).map_err(Failure::usage)?;
        let source = supply.of(&self.image).map_err(Failure::usage)?;
        let found = analyse(&picture, &source)?;
        if self.json {
            let report = Report::new(&picture, &found);
            let json = serde_json::to_string_pretty(&report).map_err(Failure::work)?;
            output::print(&format!("{json}\n"))
        } else {
            output::print(&text(&picture, &found))
        }
    }
}

/// The JSON of `inspect`; `schema` changes when a field changes its meaning or goes.
#[derive(Serialize)]
struct Report {
    schema: u32,
    image: Size,
    depth: Depth,
    waterbody: Water,
    intervals: Intervals,
    veiling_light_source: VeilingLightSource,
    veiling_light_share: f32,
    quality: Quality,
}

#[derive(Serialize)]
struct Size {
    width: usize,
    height: usize,
}

impl Size {
    fn of(picture: &Picture) -> Self {
        let (width, height) = picture.pixels.size();
        Self { width, height }
    }
}

#[derive(Serialize)]
struct Depth {
    source: &'static str,
    kind: DepthKind,
    mean: f32,
    p05: f32,
    p95: f32,
    supplied: Option<Supplied>,
}

/// Where depth was supplied.
#[derive(Serialize)]
struct Supplied {
    file: String,
    kind: SuppliedKind,
    invalid_share: f64,
    agreement: Option<f64>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Water {
    veiling_light: VeilingLight,
    backscatter_coefficient: [f32; 3],
    attenuation: [[f32; 4]; 3],
    attenuation_held_beyond: [f32; 3],
}

impl Report {
    fn new(picture: &Picture, found: &Analysis) -> Self {
        let estimate = &found.estimate;
        let water = &estimate.water;
        Self {
            schema: 1,
            image: Size::of(picture),
            depth: Depth::new(found),
            waterbody: Water {
                veiling_light: water.veiling_light,
                backscatter_coefficient: water.backscatter_coefficient,
                attenuation: water.attenuation.map(|curve| curve.mu()),
                attenuation_held_beyond: water.attenuation.map(|curve| curve.held_beyond()),
            },
            intervals: estimate.intervals,
            veiling_light_source: estimate.veiling_light_source,
            veiling_light_share: estimate.veiling_light_share,
            quality: estimate.quality,
        }
    }
}

/// The report for people.
fn text(picture: &Picture, found: &Analysis) -> String {
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
    let Size { width, height } = Size::of(picture);
    line("size", format!("{width} x {height}"));
    if let Some(damage) = &picture.damage {
        line("  WARNING", format!("the file is damaged: {damage}"));
    }
    let unit = match depth.kind {
        DepthKind::Metres => "metres",
        _ => "relative: 0 near, 1 far; it has no unit",
    };
    line("depth z", format!("{}, {unit}", depth.source));
    if let Some(supplied) = &depth.supplied {
        let invalid = 100.0 * supplied.invalid_share;
        line("  file", format!("{}, {}", shown(supplied.file.as_ref()), supplied.kind.name()));
        line("  without a value", format!("{invalid:.1} % of the pixels: depth from colour there"));
        for warning in &supplied.warnings {
            line("  WARNING", format!("the map {warning}"));
        }
    }
    line("  mean, 5 %, 95 %", format!("{:.2} {:.2} {:.2}", depth.mean, depth.p05, depth.p95));
    line("veiling light B∞", format!("{r:.3} {g:.3} {b:.3} (red, green, blue)   {}", hex([r, g, b])));
    line("  nine in ten within", ranges(found.estimate.intervals.veiling_light, 3));
    line("  read from", source(&found.estimate));
    line("backscatter β_B", format!("{beta_r:.2} {beta_g:.2} {beta_b:.2} per unit of z"));
    line("  nine in ten within", ranges(found.estimate.intervals.backscatter_coefficient, 2));
    line("  at the far end, β_B z95", format!("{tau_r:.2} {tau_g:.2} {tau_b:.2}"));
    line("attenuation", "the curve β_D(z), in --json".to_owned());
    line("  at the far end, β_D z95", format!("{fade_r:.2} {fade_g:.2} {fade_b:.2}"));
    text
}

/// Three ranges.
fn ranges(of: [[f32; 2]; 3], decimals: usize) -> String {
    of.map(|[low, high]| format!("{low:.decimals$}-{high:.decimals$}")).join(" ")
}

/// What speaks against an estimate, in words.
pub(crate) fn reasons(quality: Quality) -> String {
    quality.reasons.iter().map(Reason::describe).collect::<Vec<_>>().join(", ")
}

pub(crate) fn hex(rgb: [f32; 3]) -> String {
    let [r, g, b] = rgb.map(|value| (value * 255.0).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Where the veiling light was read, and from how much of the picture.
fn source<E: Encoding>(estimate: &Estimate<E>) -> String {
    let share = 100.0 * estimate.veiling_light_share;
    match estimate.veiling_light_source {
        VeilingLightSource::OpenWater => format!("smooth open water, {share:.1} % of the picture"),
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

/// One line on a water: its colour, where that was read, and what speaks against it.
pub(crate) fn veiling_light<E: Encoding>(estimate: &Estimate<E>) -> String {
    let light = format!(
        "veiling light {}, from {}",
        hex(estimate.water.veiling_light.rgb().map(E::to_encoded)),
        source(estimate)
    );
    match estimate.quality.verdict {
        Verdict::Good => light,
        verdict => format!("{light}; {}: {}", verdict.name(), reasons(estimate.quality)),
    }
}

impl Depth {
    fn new(found: &Analysis) -> Self {
        let depth = &found.depth;
        Self {
            source: found.depth_source.name(),
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
        let (DepthSource::Supplied { path, kind }, Some(report)) = (&found.depth_source, &found.supplied)
        else {
            return None;
        };
        let warning = report.looks_turned_round().then(|| turned_round(report));
        Some(Self {
            file: path.to_string_lossy().into_owned(),
            kind: *kind,
            invalid_share: report.invalid_share(),
            agreement: report.agreement,
            warnings: warning.into_iter().collect(),
        })
    }
}
