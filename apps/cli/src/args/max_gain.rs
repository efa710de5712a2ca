//! `--max-gain`: how far a restoration amplifies.

use aquafuse::formation::RestoreOptions;
use clap::Args;

#[derive(Args)]
pub(crate) struct MaxGain {
    /// Upper limit of the gain on the light of the scene, 1 to 100. The gain amplifies noise too.
    #[arg(long, value_name = "N", default_value_t = RestoreOptions::default().max_gain[0], value_parser = gain)]
    max_gain: f32,
}

impl MaxGain {
    pub(crate) fn get(&self) -> f32 {
        self.max_gain
    }

    pub(crate) fn options(&self) -> RestoreOptions {
        RestoreOptions::default().with_max_gain([self.max_gain; 3])
    }
}

fn gain(text: &str) -> Result<f32, String> {
    let gain: f32 = text.parse().map_err(|_| "not a number")?;
    if (1.0..=100.0).contains(&gain) { Ok(gain) } else { Err("give a number from 1 to 100".into()) }
}
