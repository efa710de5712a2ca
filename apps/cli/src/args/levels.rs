//! How levels are set: of what is restored, and of an image that is enhanced.

use aquafuse::levels::{LevelsOptions, Setting};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// `--white`, `--exposure` and `--strength`.
#[derive(Args)]
pub(crate) struct LevelsArguments {
    /// White balance. `auto`: each channel has its own black, white and brightness, within bounds, so that the colour of the water
    /// goes; where red is weak, some of it is made from green. `none`: all channels are treated alike.
    #[arg(long, value_name = "W", default_value = "auto", value_parser = setting())]
    white: Setting,
    /// Exposure. `auto`: the darkest and the brightest values become black and white, and the mean comes nearer to medium grey.
    /// `none`: brightness stays.
    #[arg(long, value_name = "E", default_value = "auto", value_parser = setting())]
    exposure: Setting,
    /// How much of the change is applied, from 0 (none) to 1 (all).
    #[arg(
        long,
        value_name = "S",
        default_value_t = 1.0,
        value_parser = strength,
        allow_negative_numbers = true
    )]
    strength: f32,
}

impl LevelsArguments {
    pub(crate) fn options(&self) -> LevelsOptions {
        let options = LevelsOptions::default().with_white(self.white).with_exposure(self.exposure);
        options.with_strength(self.strength)
    }
}

fn setting() -> impl TypedValueParser<Value = Setting> {
    PossibleValuesParser::new(Setting::ALL.iter().map(|one| one.name()))
        .map(|name| name.parse::<Setting>().unwrap_or_default())
}

fn strength(text: &str) -> Result<f32, String> {
    let strength: f32 = text.parse().map_err(|_| "not a number")?;
    if (0.0..=1.0).contains(&strength) { Ok(strength) } else { Err("give a number from 0 to 1".into()) }
}
