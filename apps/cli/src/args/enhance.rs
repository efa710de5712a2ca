//! Options of enhancement by fusion with clear water.

use aquafuse::fusion::{Gain, Incidence, Model, Options};
use aquafuse_data::pipeline::DepthEstimator;
use clap::Args;

use crate::args::depth_model::DepthModelArg;
use crate::args::fusion::{gain, incidence, model};
use crate::args::water::WaterArguments;
use crate::failure::Failure;

/// How images are enhanced.
#[derive(Args)]
pub(crate) struct EnhanceSettings {
    /// Fusion model, as in `fuse`.
    #[arg(long, default_value = Model::Physical.name(), value_parser = model())]
    model: Model,
    /// Angle of incidence in degrees: 0 is full strength, 90 no change [default: 0].
    #[arg(long, value_name = "DEG", value_parser = incidence, allow_negative_numbers = true)]
    theta: Option<Incidence>,
    /// Gain on the colour of the clear water, 0 or more; at 0 the veil is only removed.
    #[arg(long, value_name = "A", value_parser = gain, default_value = "0.5", allow_negative_numbers = true)]
    alpha: Gain,
    #[command(flatten)]
    depth_model: DepthModelArg,
    #[command(flatten)]
    pub(crate) waters: WaterArguments,
}

impl EnhanceSettings {
    pub(crate) fn depth_model(&self) -> Result<DepthEstimator, Failure> {
        self.depth_model.get()
    }

    pub(crate) fn options(&self) -> Result<Options, Failure> {
        let incidence = self.theta.unwrap_or(Incidence::from_degrees(0.0).map_err(Failure::usage)?);
        Ok(Options::for_model(self.model).with_incidence(incidence).with_gain(self.alpha))
    }
}
