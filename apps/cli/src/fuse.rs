//! `aquafuse fuse`: a picture, or a folder of them, in another picture's water.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::{Context, anyhow};
use aquafuse::fusion::{Gain, Incidence, Model, Options};
use aquafuse::waterbody::VeilingLightSource;
use aquafuse_data::analysis::analyse;
use aquafuse_data::folder;
use aquafuse_data::job::{self, Item, Message, Report};
use aquafuse_data::picture::{FileError, Format, Picture, WriteOptions};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::failure::Failure;
use crate::inspect::veiling_light;
use crate::output;
use crate::progress::Progress;

/// Put a picture, or a folder of them, into another picture's water.
#[derive(Args)]
#[command(after_help = MODELS)]
pub(crate) struct Fuse {
    /// A PNG or JPEG picture, or a folder of them: the objects.
    content: PathBuf,
    /// The picture whose water is taken.
    water: PathBuf,
    /// Where to write: a file for a file, a folder for a folder.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Which part of the backscatter is exchanged.
    #[arg(long, default_value = Model::default().name(), value_parser = model())]
    model: Model,
    /// Incidence θ in degrees: 0 fuses most, 90 not at all [default: 45, physical: 0].
    #[arg(long, value_name = "DEG", value_parser = incidence, allow_negative_numbers = true)]
    theta: Option<Incidence>,
    /// Gain α on the reference's veiling light [default: 1].
    #[arg(long, value_name = "A", value_parser = gain, allow_negative_numbers = true)]
    alpha: Option<Gain>,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Replace pictures that exist.
    #[arg(long)]
    overwrite: bool,
}

const MODELS: &str = "\
Models, with F = e^(-β_B z) and D = α B∞(water) - B∞(content):
  aquafuse   adds cosθ F (1 - F) D: a veil over the middle distance, the paper's method
  physical   adds cosθ (1 - F) D: the whole veil; open water takes the other water's colour";

fn model() -> impl TypedValueParser<Value = Model> {
    PossibleValuesParser::new(Model::ALL.map(Model::name))
        .map(|name| Model::from_name(&name).unwrap_or_default())
}

fn incidence(text: &str) -> anyhow::Result<Incidence> {
    Ok(Incidence::from_degrees(text.parse()?)?)
}

fn gain(text: &str) -> anyhow::Result<Gain> {
    Ok(Gain::new(text.parse()?)?)
}

impl Fuse {
    pub(crate) fn run(&self, quiet: bool) -> Result<(), Failure> {
        let items = self.items().map_err(Failure::usage)?;
        let reference = analyse(&Picture::read(&self.water)?).estimate;
        self.make_output_folder()?;
        let job = job::Fuse {
            items,
            water: reference.water,
            options: self.options(),
            writing: WriteOptions { overwrite: self.overwrite, quality: self.quality },
        };
        let progress = Progress::new(quiet || job.items.len() == 1);
        let reports = Mutex::new(Vec::new());
        let summary = job.run(&|message| {
            progress.show(&message);
            if let (Message::Done { item, report }, Ok(mut reports)) = (&message, reports.lock()) {
                reports.push(((*item).clone(), *report));
            }
        });
        progress.finish();
        let reports = reports.into_inner().unwrap_or_default();
        if !quiet {
            let water = format!("{}: {}\n", self.water.display(), veiling_light(&reference));
            output::print(&(water + &self.summary(&reports)))?;
        }
        match summary.failed {
            0 => Ok(()),
            failed => Err(Failure::work(anyhow!(
                "{failed} of {} pictures failed; the messages above say why",
                job.items.len()
            ))),
        }
    }

    fn options(&self) -> Options {
        let defaults = Options::for_model(self.model);
        Options {
            incidence: self.theta.unwrap_or(defaults.incidence),
            gain: self.alpha.unwrap_or(defaults.gain),
            ..defaults
        }
    }

    /// What is to be read and written; everything that can be refused before work begins is.
    fn items(&self) -> anyhow::Result<Vec<Item>> {
        let about =
            self.content.metadata().with_context(|| format!("cannot read {}", self.content.display()))?;
        let items = if about.is_dir() { self.items_of_folder()? } else { vec![self.item_of_file()?] };
        if !self.overwrite {
            let mut existing = items.iter().filter(|item| item.output.symlink_metadata().is_ok());
            if let Some(first) = existing.next() {
                let others = existing.count();
                let exists = FileError::Exists { path: first.output.clone() };
                return Err(match others {
                    0 => exists.into(),
                    _ => anyhow!("{exists} ({others} more outputs exist)"),
                });
            }
        }
        Ok(items)
    }

    fn item_of_file(&self) -> anyhow::Result<Item> {
        let output = match self.content.file_name() {
            Some(name) if self.output.is_dir() => self.output.join(name),
            _ => self.output.clone(),
        };
        if Format::of(&output).is_none() {
            return Err(FileError::UnknownExtension { path: output, expected: ".png, .jpg or .jpeg" }.into());
        }
        Ok(Item { input: self.content.clone(), output })
    }

    fn items_of_folder(&self) -> anyhow::Result<Vec<Item>> {
        let folder = &self.content;
        if same_folder(folder, &self.output) {
            return Err(anyhow!(
                "{} is both content and output; give another output folder",
                folder.display()
            ));
        }
        if self.output.is_file() {
            return Err(anyhow!(
                "{} is a folder, so the output must be one; {} is a file",
                folder.display(),
                self.output.display()
            ));
        }
        let listing = folder::list(folder)?;
        if listing.pictures.is_empty() {
            return Err(anyhow!(
                "{} holds no .png, .jpg or .jpeg ({} other files); folders inside it are not entered",
                folder.display(),
                listing.others
            ));
        }
        let output = |input: &Path| self.output.join(input.file_name().unwrap_or_default());
        Ok(listing.pictures.into_iter().map(|input| Item { output: output(&input), input }).collect())
    }

    fn make_output_folder(&self) -> Result<(), Failure> {
        let folder = if self.content.is_dir() { Some(self.output.as_path()) } else { self.output.parent() };
        let Some(folder) = folder.filter(|folder| !folder.as_os_str().is_empty()) else { return Ok(()) };
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))
            .map_err(Failure::work)
    }

    fn summary(&self, reports: &[(Item, Report)]) -> String {
        let clipped = |report: &Report| 100.0 * report.clipping.share();
        match reports {
            [] => String::new(),
            [(item, report)] if !self.content.is_dir() => {
                let mut text =
                    format!("{}: {:.2} % of the values clipped", item.output.display(), clipped(report));
                if report.veiling_light_source != VeilingLightSource::Farthest {
                    text += "; the content's veiling light is a fallback, see `aquafuse inspect`";
                }
                text + "\n"
            }
            _ => {
                let mean =
                    reports.iter().map(|(_, report)| clipped(report)).sum::<f64>() / reports.len() as f64;
                let fallbacks = reports
                    .iter()
                    .filter(|(_, report)| report.veiling_light_source != VeilingLightSource::Farthest)
                    .count();
                format!(
                    "{}: {} pictures, {mean:.2} % of the values clipped, {fallbacks} with a fallback for the veiling light\n",
                    self.output.display(),
                    reports.len()
                )
            }
        }
    }
}

fn same_folder(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
