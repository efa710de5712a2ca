//! Options of fusion.

use anyhow::anyhow;
use aquafuse::depth::DepthModel;
use aquafuse::fusion::{Gain, Incidence, Model, Options};
use aquafuse::scene_area::Border;
use aquafuse::smooth::Smoothing;
use aquafuse::waterbody::WaterMap;
pub(crate) use aquafuse_data::evaluate::Settings;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::args::border::BorderArgument;
use crate::args::common::Common;
use crate::args::depth_model::DepthModelArg;
use crate::failure::Failure;

pub(crate) const HELP: &str = "\
Models. D is alpha times the veiling light of WATER minus the veiling light of CONTENT.
F falls with distance, from 1 at the camera to 0 in open water.
  physical   Adds cos(theta) (1 - F) D, the whole veil: open water gets the colour of WATER, as in
             the figures of the paper. Visibility stays as in CONTENT. The default.
  aquafuse   The equations of the paper to the letter: adds cos(theta) F (1 - F) D, a veil over the
             middle distance. Open water keeps its colour.
  relight    As physical, and near things look lit by the water of WATER: their colour goes most of
             the way to the colour of its near things, within bounds. If WATER is known per metre
             (preset:NAME, sea:NUMBER), or both images have depth maps in one unit, the water also
             becomes thicker or clearer, by a factor of 2 at most.
  exchange   Replaces the water of CONTENT by WATER, with its attenuation, weighted by cos(theta).
             The strongest change, and the most sensitive to wrong estimates: supply depth.
             Faded colours, and their noise, are amplified at most 2 times.

--as-published means --model aquafuse --theta 45 --alpha 1.5 --smooth bilateral
--depth-model eq3-median, --water-map published and --border none. The paper states no settings; these reproduce its scores
best.

Example:
  aquafuse fuse reef.jpg green.jpg -o fused.jpg --theta 30";

#[derive(Args)]
pub(crate) struct SettingsArgs {
    /// Fusion model: `physical` the whole veil, `relight` its light, too, `aquafuse` the paper's equations and subtle, `exchange` the
    /// whole water.
    #[arg(long, default_value = Model::default().name(), value_parser = model())]
    model: Model,
    /// Angle of incidence in degrees: 0 is full strength, 90 no change [default: 0; aquafuse: 45].
    #[arg(long, value_name = "DEG", value_parser = incidence, allow_negative_numbers = true)]
    theta: Option<Incidence>,
    /// Gain on the colour of the reference water, 0 or more; above 1: brighter [default: 1].
    #[arg(long, value_name = "A", value_parser = gain, allow_negative_numbers = true)]
    alpha: Option<Gain>,
    /// Smoothing of the fused image: `bilateral` keeps edges, removes noise and fine texture.
    #[arg(long, value_name = "HOW", default_value = Smoothing::default().name(), value_parser = smoothing())]
    smooth: Smoothing,
    #[command(flatten)]
    depth_model: DepthModelArg,
    /// Use the settings that reproduce the published scores best, instead of --model, --theta, --alpha, --smooth and
    /// --depth-model.
    #[arg(long, conflicts_with_all = ["model", "theta", "alpha", "smooth", "depth_model"])]
    as_published: bool,
}

impl SettingsArgs {
    /// Refuses a setting that is both swept and given.
    pub(crate) fn refuse_beside(&self, swept: &str) -> anyhow::Result<()> {
        let given = if swept == "theta" { self.theta.is_some() } else { self.alpha.is_some() };
        if given {
            Err(anyhow!("--sweep {swept}=... and --{swept} set the same value; leave one of them out"))
        } else {
            Ok(())
        }
    }

    /// The common options, with images cut to their scene; the published method takes every pixel, and reads B∞ in the farthest ones.
    pub(crate) fn cutting(&self, border: &BorderArgument, common: &Common) -> Common {
        match self.as_published {
            true => common.clone().with_border(Border::None).with_water_map(WaterMap::Published),
            false => border.cutting(common),
        }
    }

    pub(crate) fn is_as_published(&self) -> bool {
        self.as_published
    }

    pub(crate) fn get(&self) -> Result<Settings, Failure> {
        if self.as_published {
            return Ok(Settings {
                depth_model: DepthModel::Eq3Median.into(),
                options: Options::as_published(),
                smoothing: Smoothing::Bilateral,
                ..Settings::default()
            });
        }
        let defaults = Options::for_model(self.model);
        Ok(Settings {
            depth_model: self.depth_model.get()?,
            options: defaults
                .with_incidence(self.theta.unwrap_or(defaults.incidence))
                .with_gain(self.alpha.unwrap_or(defaults.gain)),
            smoothing: self.smooth,
            ..Settings::default()
        })
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
