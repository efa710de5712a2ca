//! `fuse --sweep`: one image with several values of one setting, side by side.

use std::str::FromStr;

use anyhow::{anyhow, bail};
use aquafuse::fusion::{Gain, Incidence, Options};
use aquafuse::image::Image;
use aquafuse_data::batch::Item;
use aquafuse_data::drawing::{Cell, contact_sheet};
use aquafuse_data::files::{make_folder_of, remove_stale_parts};
use aquafuse_data::image_file::{Format, ImageFile, WriteOptions};
use aquafuse_data::pipeline::{Operation, WaterEstimate, analyse_in};

use crate::args::batch::BatchArguments;
use crate::args::common::Common;
use crate::args::fusion::Settings;
use crate::failure::Failure;
use crate::report::output;

/// More values make no strip that anyone could look at.
const MOST: usize = 16;
/// Room for an image in the strip, in pixels.
const WIDTH: u32 = 400;

/// Which setting, and its values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Sweep {
    Theta(Vec<(String, Incidence)>),
    Alpha(Vec<(String, Gain)>),
}

impl FromStr for Sweep {
    type Err = anyhow::Error;

    fn from_str(said: &str) -> anyhow::Result<Self> {
        let Some((name, values)) = said.split_once('=') else {
            bail!("give a setting and its values, as theta=0,30,60,90");
        };
        let values: Vec<&str> = values.split(',').map(str::trim).collect();
        if values.len() > MOST {
            bail!("{} values are too many; give at most {MOST}", values.len());
        }
        let number = |value: &str| value.parse::<f32>().map_err(|_| anyhow!("{value:?} is not a number"));
        let theta = |value: &str| Ok((value.to_owned(), Incidence::from_degrees(number(value)?)?));
        let alpha = |value: &str| Ok((value.to_owned(), Gain::new(number(value)?)?));
        match name {
            "theta" => Ok(Self::Theta(values.into_iter().map(theta).collect::<anyhow::Result<_>>()?)),
            "alpha" => Ok(Self::Alpha(values.into_iter().map(alpha).collect::<anyhow::Result<_>>()?)),
            _ => bail!("{name:?} cannot be swept; give theta or alpha"),
        }
    }
}

impl Sweep {
    /// Which setting.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Theta(_) => "theta",
            Self::Alpha(_) => "alpha",
        }
    }

    /// Each value's caption, and the options with it.
    fn steps(&self, options: Options) -> Vec<(String, Options)> {
        let theta = |(said, incidence): &(String, Incidence)| {
            (format!("θ = {said}°"), options.with_incidence(*incidence))
        };
        let alpha = |(said, gain): &(String, Gain)| (format!("α = {said}"), options.with_gain(*gain));
        match self {
            Self::Theta(values) => values.iter().map(theta).collect(),
            Self::Alpha(values) => values.iter().map(alpha).collect(),
        }
    }

    /// Makes the strip.
    pub(super) fn run(
        &self,
        items: &[Item],
        reference: &WaterEstimate,
        settings: &Settings,
        batch: &BatchArguments,
        common: &Common,
    ) -> Result<(), Failure> {
        let [item] = items else {
            return Err(Failure::usage(anyhow!("--sweep takes one image; name an image, not a folder")));
        };
        let steps = self.steps(settings.options);
        let opened = ImageFile::open(&item.input, &common.reading.options())?;
        // The content and each image of the strip, in bytes, and two that are turned and scaled.
        let cells = 3_u64.saturating_mul(opened.pixels()).saturating_mul(steps.len() as u64 + 3);
        opened.memory_until_written(Format::written(&item.output).unwrap_or(Format::Png), cells)?;
        let content = opened.decode()?;
        let found = analyse_in(reference.encoding(), &content, &item.depth)?;
        let seen = |image_file: ImageFile| image_file.upright().pixels.into_bytes();
        let mut cells = vec![Cell { caption: "content".into(), image: Some(seen(content.clone())) }];
        for (caption, options) in steps {
            let mut fused = content.clone();
            let operation = Operation::Fuse { reference: *reference, options };
            operation.apply(&mut fused.pixels, Some(&found)).map_err(Failure::work)?;
            fused.pixels = fused.pixels.smoothed(settings.smoothing);
            cells.push(Cell { caption, image: Some(seen(fused)) });
        }
        let (width, height) = cells[0].image.as_ref().map_or((1, 1), Image::size);
        let room = (u64::from(WIDTH) * height as u64 / width as u64).clamp(1, 4 * u64::from(WIDTH)) as u32;
        let strip = ImageFile::new(contact_sheet(&[cells], WIDTH, room).map_err(Failure::work)?);
        remove_stale_parts(make_folder_of(&item.output)?);
        strip.write(&item.output, &WriteOptions { overwrite: batch.overwrite, quality: batch.quality })?;
        output::written(&item.output, common.quiet)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_is_a_setting_and_its_values() {
        let Ok(Sweep::Theta(values)) = "theta=0,30, 90".parse() else { panic!("three angles") };
        assert_eq!(values.len(), 3);
        assert!("alpha=0.5,1".parse::<Sweep>().is_ok());
        for wrong in ["theta", "theta=", "theta=100", "alpha=-1", "theta=a", "beta=1", "theta=1,,2"] {
            assert!(wrong.parse::<Sweep>().is_err(), "{wrong}");
        }
    }
}
