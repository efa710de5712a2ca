//! `aquafuse crossover`: two images, each in the other's water.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse_data::files::{FileError, display, make_folder, remove_stale_parts};
use aquafuse_data::image_file::WriteOptions;
use aquafuse_data::pipeline::Operation;
use aquafuse_data::pipeline::{DepthSource, analyse_in};
use clap::{ArgGroup, Args};

use crate::args::border::BorderArgument;
use crate::args::common::{Common, encoding};
use crate::args::fusion::{Settings, SettingsArgs};
use crate::failure::Failure;
use crate::report::output;
use crate::report::water::veiling_light;

/// Put each of two images into the water of the other.
///
/// Writes DIR/A__B.png, the scene of A in the water of B, and DIR/B__A.png (named without extensions).
#[derive(Args)]
#[command(after_help = "Example:\n  aquafuse crossover reef.jpg harbour.jpg -o crossed/", group = ArgGroup::new("area").args(["border", "water_map"]).multiple(true).conflicts_with("as_published"))]
pub(crate) struct Crossover {
    /// The first image.
    a: PathBuf,
    /// The second image.
    b: PathBuf,
    /// Output folder; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    border: BorderArgument,
    /// Compute in linear light instead of encoded values.
    #[arg(long)]
    linear: bool,
    /// Replace existing outputs.
    #[arg(long)]
    overwrite: bool,
}

impl Crossover {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.settings.cutting(&self.border, common);
        let encoding = encoding(self.linear);
        let outputs = self.outputs()?;
        let Settings { depth_model, options, smoothing, .. } = self.settings.get()?;
        let source = DepthSource::Estimated(depth_model);
        let (a, b) = (common.reading.read(&self.a)?, common.reading.read(&self.b)?);
        let waters = [analyse_in(encoding, &a, &source)?, analyse_in(encoding, &b, &source)?];
        remove_stale_parts(&self.output);
        let says: Vec<String> = [(&self.a, &waters[0]), (&self.b, &waters[1])]
            .map(|(path, found)| format!("{}: {}\n", display(path), veiling_light(&found.estimate)))
            .into();
        if !common.quiet {
            output::print(&says.concat())?;
        }
        for (i, (mut image, path)) in [a, b].into_iter().zip(&outputs).enumerate() {
            let operation = Operation::Fuse { reference: waters[1 - i].estimate, options };
            let outcome = operation.apply(&mut image.pixels, Some(&waters[i])).map_err(Failure::work)?;
            image.pixels = image.pixels.smoothed(smoothing);
            image.write(path, &WriteOptions { overwrite: self.overwrite, ..WriteOptions::default() })?;
            if !common.quiet {
                let clipped = 100.0 * outcome.clipping.share();
                output::print(&format!(
                    "{}: written, {clipped:.2} % of the values clipped\n",
                    display(path)
                ))?;
            }
        }
        Ok(())
    }

    /// Where both go, once it is sure that nothing is replaced.
    fn outputs(&self) -> Result<[PathBuf; 2], Failure> {
        let (a, b) = (stem(&self.a), stem(&self.b));
        if a == b {
            return Err(Failure::usage(anyhow!(
                "{} and {} would both be written to {}__{}.png; rename one of them",
                display(&self.a),
                display(&self.b),
                display(a.as_ref()),
                display(b.as_ref())
            )));
        }
        make_folder(&self.output)?;
        let named = |of: &OsString, water: &OsString| {
            let mut name = of.clone();
            name.push("__");
            name.push(water);
            name.push(".png");
            self.output.join(name)
        };
        let outputs = [named(&a, &b), named(&b, &a)];
        let existing = outputs.iter().find(|path| !self.overwrite && path.symlink_metadata().is_ok());
        match existing {
            Some(path) => Err(FileError::Exists { path: path.clone() }.into()),
            None => Ok(outputs),
        }
    }
}

fn stem(path: &Path) -> OsString {
    path.file_stem().unwrap_or_default().to_owned()
}
