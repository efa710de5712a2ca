//! `aquafuse water show`: a water in numbers, and the sources of a preset.

use std::fmt::Write;
use std::path::PathBuf;

use aquafuse::depth::{DepthKind, DepthModel};
use aquafuse::image::{Encoded, Linear};
use aquafuse::waterbody::presets::{Assumptions, Conditions, Preset, Residual};
use aquafuse_data::pipeline::PixelEncoding;
use aquafuse_data::water_file::{Numbers, WaterFile};
use clap::Args;
use serde_json::{Value, json};

use crate::args::common::{Common, encoding};
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::output;
use crate::report::water::{hex, reasons};

/// Show the numbers of a water and their sources.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  aquafuse water show preset:jerlov-3C\n  aquafuse water show harbour.water.json"
)]
pub(super) struct Show {
    /// preset:NAME, sea:NUMBER, NAME.water.json, or an image.
    water: PathBuf,
    #[command(flatten)]
    waters: WaterArguments,
    /// Show the water in linear light instead of encoded values.
    #[arg(long)]
    linear: bool,
    /// Print JSON; for a preset, with all spectra and their sources.
    #[arg(long)]
    json: bool,
}

impl Show {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let encoding = encoding(self.linear);
        let source = WaterSource::parse(&self.water)?;
        let file = self.waters.read(&source, &DepthModel::default().into(), encoding, &common.reading)?;
        match (&source, self.json) {
            (WaterSource::Preset(preset), true) => {
                output::print(&format!("{:#}\n", preset_json(*preset, &self.waters.conditions()?)))
            }
            (_, true) => output::print(&file.to_text()),
            (WaterSource::Preset(preset), false) => {
                let conditions = self.waters.conditions()?;
                let residual = match encoding {
                    PixelEncoding::Encoded => preset.derive::<Encoded>(&conditions).residual,
                    PixelEncoding::Linear => preset.derive::<Linear>(&conditions).residual,
                };
                output::print(&(numbers(&file) + &basis(&preset.assumptions(&conditions), &residual)))
            }
            (_, false) => output::print(&numbers(&file)),
        }
    }
}

/// A preset with its spectra and sources, as JSON.
pub(super) fn preset_json(preset: Preset, conditions: &Conditions) -> Value {
    let (encoded, linear) = (preset.derive::<Encoded>(conditions), preset.derive::<Linear>(conditions));
    json!({
        "name": preset.name(),
        "unit": "metre",
        "encoded": Numbers::from(&encoded.water),
        "encoded_residual": encoded.residual,
        "linear": Numbers::from(&linear.water),
        "linear_residual": linear.residual,
        "assumptions": preset.assumptions(conditions),
    })
}

fn numbers(file: &WaterFile) -> String {
    let Numbers { veiling_light: [r, g, b], backscatter_coefficient: [x, y, z], .. } =
        Numbers::from(&file.estimate);
    let unit = if file.depth_kind == DepthKind::Metres { "metre" } else { "unit of relative depth" };
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<26}{value}");
    };
    line("water of", file.from.join(", "));
    line("values", format!("{}, coefficients per {unit}", file.estimate.encoding()));
    line(
        "veiling light B∞",
        format!("{r:.3} {g:.3} {b:.3}   {}", hex(file.estimate.veiling_light_as_seen())),
    );
    line("backscatter beta_B", format!("{x:.3} {y:.3} {z:.3}"));
    let places: &[f32] =
        if file.depth_kind == DepthKind::Metres { &[1.0, 5.0, 15.0] } else { &[0.2, 0.5, 1.0] };
    for &z in places {
        let [r, g, b] = file.estimate.illumination(z);
        line(&format!("  light left at z = {z}"), format!("{r:.3} {g:.3} {b:.3}"));
    }
    let quality = file.estimate.quality();
    if !quality.reasons.is_empty() {
        line("verdict", format!("{}: {}", quality.verdict.name(), reasons(quality)));
    }
    text
}

fn basis(assumed: &Assumptions, residual: &Residual) -> String {
    let mut text = String::from("\nsources\n");
    for spectrum in &assumed.spectra {
        let _ = writeln!(text, "  {}, {}: {}", spectrum.quantity, spectrum.unit, spectrum.source);
    }
    for constant in &assumed.constants {
        let _ = writeln!(
            text,
            "  {} = {} ({}): {}",
            constant.quantity, constant.value, constant.unit, constant.source
        );
    }
    let conditions = &assumed.conditions;
    let _ = writeln!(
        text,
        "  scene {} m below the surface, white at {}, curves fitted to {} m, veil factor {}: {}",
        conditions.depth_below_surface_m(),
        conditions.white_level(),
        conditions.range_m(),
        conditions.veil_factor(),
        assumed.veil_factor_source
    );
    let worst = |of: [f32; 3]| of.into_iter().fold(0.0, f32::max);
    let _ = writeln!(
        text,
        "one curve per channel differs from the sum over the spectrum by at most {:.3} (backscatter), {:.3} (a grey card)",
        worst(residual.backscatter),
        worst(residual.seen)
    );
    text
}
