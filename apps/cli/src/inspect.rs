//! `aquafuse inspect`: what a picture tells about its depth and its water.

use std::fmt::Write;
use std::path::PathBuf;

use aquafuse::depth::{DepthKind, DepthMap};
use aquafuse::waterbody::{VeilingLight, VeilingLightSource};
use aquafuse_data::analysis::{Analysis, analyse};
use aquafuse_data::picture::Picture;
use clap::Args;
use serde::Serialize;

use crate::failure::Failure;
use crate::output;

/// Show what a picture tells about its depth and its water.
///
/// `fuse` uses exactly these estimates.
#[derive(Args)]
pub(crate) struct Inspect {
    /// PNG or JPEG, 8 bit.
    image: PathBuf,
    /// Print JSON for programs.
    #[arg(long)]
    json: bool,
}

impl Inspect {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let picture = Picture::read(&self.image)?;
        let report = Report::new(&picture, &analyse(&picture));
        if self.json {
            let json = serde_json::to_string_pretty(&report).map_err(Failure::work)?;
            output::print(&format!("{json}\n"))
        } else {
            output::print(&report.text())
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
    veiling_light_source: VeilingLightSource,
    veiling_light_share: f32,
}

#[derive(Serialize)]
struct Size {
    width: usize,
    height: usize,
}

#[derive(Serialize)]
struct Depth {
    source: &'static str,
    kind: DepthKind,
    mean: f32,
    p05: f32,
    p95: f32,
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
            image: Size { width: picture.image.width(), height: picture.image.height() },
            depth: Depth::new(&found.depth),
            waterbody: Water {
                veiling_light: water.veiling_light,
                backscatter_coefficient: water.backscatter_coefficient,
                attenuation: water.attenuation.map(|curve| curve.mu()),
                attenuation_held_beyond: water.attenuation.map(|curve| curve.held_beyond()),
            },
            veiling_light_source: estimate.veiling_light_source,
            veiling_light_share: estimate.veiling_light_share,
        }
    }

    fn text(&self) -> String {
        let (size, depth, water) = (&self.image, &self.depth, &self.waterbody);
        let [r, g, b] = water.veiling_light.rgb();
        let bytes = [r, g, b].map(|v| (v * 255.0).round() as u8);
        let [beta_r, beta_g, beta_b] = water.backscatter_coefficient;
        let tau = water.backscatter_coefficient.map(|beta| beta * depth.p95);
        let mut text = String::new();
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<26}{value}");
        };
        line("size", format!("{} x {}", size.width, size.height));
        line(
            "depth z (eq3, relative)",
            format!("mean {:.2}, 5 % below {:.2}, 95 % below {:.2}", depth.mean, depth.p05, depth.p95),
        );
        line(
            "veiling light B∞",
            format!("{r:.3} {g:.3} {b:.3}   #{:02x}{:02x}{:02x}", bytes[0], bytes[1], bytes[2]),
        );
        line("  read from", self.source_in_words());
        line("backscatter β_B", format!("{beta_r:.2} {beta_g:.2} {beta_b:.2} per unit of z"));
        line("  at the far end, β_B z95", format!("{:.2} {:.2} {:.2}", tau[0], tau[1], tau[2]));
        text
    }

    fn source_in_words(&self) -> String {
        let share = 100.0 * self.veiling_light_share;
        match self.veiling_light_source {
            VeilingLightSource::Farthest => format!("the farthest {share:.1} % of the pixels"),
            VeilingLightSource::TopCorners => "the top corners: nothing far has the water's colour".into(),
            VeilingLightSource::BottomCorners => {
                "the bottom corners: neither the far end nor the top has the water's colour".into()
            }
            VeilingLightSource::Unfiltered => {
                format!("the farthest {share:.1} %, whatever their colour: no water was found")
            }
        }
    }
}

impl Depth {
    fn new(depth: &DepthMap) -> Self {
        Self {
            source: "eq3",
            kind: depth.kind(),
            mean: depth.mean(),
            p05: depth.percentile(0.05),
            p95: depth.percentile(0.95),
        }
    }
}
