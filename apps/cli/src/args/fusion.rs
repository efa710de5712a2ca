//! How to fuse, as it is said on the command line.

use anyhow::anyhow;
use aquafuse::depth::DepthModel;
use aquafuse::fusion::{Gain, Incidence, Model, Options};
use aquafuse::smooth::Smoothing;
pub(crate) use aquafuse_data::evaluate::Settings;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::args::depth_model::DepthModelArg;

pub(crate) const HELP: &str = "\
Models. D is the difference of the two waters' colours (alpha times WATER's less CONTENT's),
F falls with distance from 1 at the camera to 0 in open water:
  aquafuse   adds cos(theta) F (1 - F) D: a veil over the middle distance, the paper's method
  physical   adds cos(theta) (1 - F) D: the whole veil; open water takes the other water's colour. How
             far one sees stays as it is in CONTENT
  exchange   takes CONTENT's water out and puts the scene into WATER's, fading included, and goes
             cos(theta) of the way there: strongest, and the first to suffer from wrong estimates.
             What has faded more in CONTENT's water is strengthened, noise with it, 2 times at most;
             depth from colour is hardly good enough for it

--as-published stands for --model aquafuse --theta 45 --alpha 1.5 --smooth bilateral
--depth-model eq3: our fit to the paper's scores, which names no settings.

Example:
  aquafuse fuse reef.jpg green.jpg -o fused.jpg --model physical --theta 30";

#[derive(Args)]
pub(crate) struct SettingsArgs {
    /// What is exchanged: `aquafuse` is subtle, `physical` is what people expect to see, `exchange` the whole water.
    #[arg(long, default_value = Model::default().name(), value_parser = model())]
    model: Model,
    /// Strength, as an angle of light from 0 (most) to 90 (none) degrees [default: 45; physical, exchange: 0].
    #[arg(long, value_name = "DEG", value_parser = incidence, allow_negative_numbers = true)]
    theta: Option<Incidence>,
    /// Gain on the reference's water, 0 or more; above 1 it is brighter than it was [default: 1].
    #[arg(long, value_name = "A", value_parser = gain, allow_negative_numbers = true)]
    alpha: Option<Gain>,
    /// How the fused image is smoothed: `bilateral` keeps edges, but takes fine texture with the noise.
    #[arg(long, value_name = "HOW", default_value = Smoothing::default().name(), value_parser = smoothing())]
    smooth: Smoothing,
    #[command(flatten)]
    depth_model: DepthModelArg,
    /// The settings that come nearest to the paper's published scores, instead of the five above.
    #[arg(long, conflicts_with_all = ["model", "theta", "alpha", "smooth", "depth_model"])]
    as_published: bool,
}

impl SettingsArgs {
    /// Refuses a setting that is swept and given too.
    pub(crate) fn refuse_beside(&self, swept: &str) -> anyhow::Result<()> {
        let given = if swept == "theta" { self.theta.is_some() } else { self.alpha.is_some() };
        if given {
            Err(anyhow!("--sweep {swept}=... says what --{swept} is; leave one of them out"))
        } else {
            Ok(())
        }
    }

    pub(crate) fn is_as_published(&self) -> bool {
        self.as_published
    }

    pub(crate) fn get(&self) -> Settings {
        if self.as_published {
            return Settings {
                depth_model: DepthModel::default(),
                options: Options::as_published(),
                smoothing: Smoothing::Bilateral,
                ..Settings::default()
            };
        }
        let defaults = Options::for_model(self.model);
        Settings {
            depth_model: self.depth_model.get(),
            options: defaults
                .with_incidence(self.theta.unwrap_or(defaults.incidence))
                .with_gain(self.alpha.unwrap_or(defaults.gain)),
            smoothing: self.smooth,
            ..Settings::default()
        }
    }
}

pub(crate) fn model() -> impl TypedValueParser<Value = Model> {
    PossibleValuesParser::new(Model::ALL.iter().map(|one| one.name()))
        .map(|name| name.parse::<Model>().unwrap_or_default())
}

pub(crate) fn smoothing() -> impl TypedValueParser<Value = Smoothing> {
    PossibleValuesParser::new(Smoothing::ALL.iter().map(|one| one.name()))
        .map(|name| name.parse::<Smoothing>().unwrap_or_default())
}

pub(crate) fn incidence(text: &str) -> anyhow::Result<Incidence> {
    Ok(Incidence::from_degrees(text.parse().map_err(|_| anyhow!("not a number"))?)?)
}

pub(crate) fn gain(text: &str) -> anyhow::Result<Gain> {
    Ok(Gain::new(text.parse().map_err(|_| anyhow!("not a number"))?)?)
}
