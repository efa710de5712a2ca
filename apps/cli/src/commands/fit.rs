//! `aquafuse fit`: a depth model from images with known depth.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse::depth::fit::{self, Options, Scale, Target};
use aquafuse::depth::{Eq3, SuppliedKind};
use aquafuse_data::files::{FileError, display, make_folder_of};
use aquafuse_data::model_file::{self, FitRecord, ModelFile, PairScore};
use aquafuse_data::pairs::{self, Gathered};
use clap::{Args, ValueEnum};

use crate::args::common::Common;
use crate::args::depth::kind;
use crate::args::pairs::list_pairs;
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;

/// Fit the depth model `eq3` to images with known depth, for `--depth-model FILE.toml`.
///
/// PAIRS holds a folder `rgb` of images (PNG, JPEG, TIFF, WebP, BMP) and a folder `depth` of depth maps
/// (PNG, TIFF, OpenEXR, NPY, PFM) with the same stems and sizes. In the fitted model, depth never rises with red,
/// never falls with max(G, B), and spans 0 to 1 over all colours. A few pairs of one place give a model of that
/// place only: check it on other pairs.
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Fit {
    /// A folder that contains `rgb` and `depth`.
    pairs: PathBuf,
    /// Output file (.toml); a missing folder is created.
    #[arg(short, long, value_name = "MODEL.toml")]
    output: PathBuf,
    /// Kind of the values of the depth maps, as in `fuse`. In metres, millimetres and disparity, 0 means unknown.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_kind: SuppliedKind,
    /// Scale that the depths of different images share.
    #[arg(long, value_enum, default_value_t)]
    scale: ScaleArg,
    /// What to fit.
    #[arg(long, value_enum, default_value_t)]
    target: TargetArg,
    /// Replace an existing MODEL.toml.
    #[arg(long)]
    overwrite: bool,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum ScaleArg {
    /// None: each image has its own scale and shift.
    #[default]
    #[value(alias = "per-picture")]
    PerImage,
    /// One scale and one shift, for depth in metres in one water. Not for inverse depth and disparity.
    Shared,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum TargetArg {
    /// The distances.
    #[default]
    Distances,
    /// The order of the distances in each image.
    Order,
}

const EXAMPLE: &str = "\
Examples:
  aquafuse fit reef/ -o reef.toml --depth-kind metres
  aquafuse fuse dive.jpg green.jpg -o fused.jpg --depth-model reef.toml";

impl Fit {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let quiet = common.quiet;
        model_file::check_name(&self.output)?;
        if !self.overwrite && self.output.symlink_metadata().is_ok() {
            return Err(FileError::Exists { path: self.output.clone() }.into());
        }
        let scale_of_its_own = matches!(self.depth_kind, SuppliedKind::Inverse | SuppliedKind::Disparity);
        if scale_of_its_own && matches!(self.scale, ScaleArg::Shared) {
            return Err(Failure::usage(anyhow!(
                "--scale shared needs depths in one unit, but the unit of {} differs between images; leave --scale out",
                self.depth_kind.name()
            )));
        }
        let pairs = list_pairs(&self.pairs, quiet)?;
        make_folder_of(&self.output)?;
        let gathered = self.gather(&pairs, common)?;
        let fit = gathered.fitter.solve().map_err(|error| {
            Failure::work(anyhow!("cannot fit a model to {}: {error}", display(&self.pairs)))
        })?;
        let file = ModelFile { eq3: fit.eq3, fit: Some(self.record(&gathered, &fit)) };
        file.write(&self.output, self.overwrite)?;
        if !quiet {
            output::print(&report(&self.output, &gathered, &fit))?;
        }
        match pairs.len() - gathered.names.len() {
            0 => Ok(()),
            failed => Err(Failure::work(anyhow!(
                "{failed} of {} pairs failed and were left out; see the messages above",
                pairs.len()
            ))),
        }
    }

    fn gather(&self, pairs: &[pairs::Pair], common: &Common) -> Result<Gathered, Failure> {
        let options = Options::default().with_scale(self.scale.into()).with_target(self.target.into());
        let progress = Progress::new(common.quiet);
        let gathered = pairs::gather(pairs, self.depth_kind, options, &common.run_options(), &|event| {
            progress.show(&event, |pair| pair.name.clone());
        });
        progress.finish();
        gathered.map_err(Failure::work)
    }

    fn record(&self, gathered: &Gathered, fit: &fit::Fit) -> FitRecord {
        let whole = self.pairs.canonicalize().unwrap_or_else(|_| self.pairs.clone());
        let scores = gathered.names.iter().zip(&fit.rank_scores);
        FitRecord {
            data: whole.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            pairs: gathered.names.len(),
            depth_kind: self.depth_kind.name().into(),
            scale: name(&self.scale),
            target: name(&self.target),
            rank_score: fit.rank_score,
            loss: fit.loss,
            doubts: fit.doubts.iter().map(ToString::to_string).collect(),
            scores: scores.map(|(name, &rank_score)| PairScore { name: name.clone(), rank_score }).collect(),
        }
    }
}

fn name(argument: &impl ValueEnum) -> String {
    argument.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

impl From<TargetArg> for Target {
    fn from(target: TargetArg) -> Self {
        match target {
            TargetArg::Distances => Self::Distances,
            TargetArg::Order => Self::Order,
        }
    }
}

impl From<ScaleArg> for Scale {
    fn from(scale: ScaleArg) -> Self {
        match scale {
            ScaleArg::PerImage => Self::PerImage,
            ScaleArg::Shared => Self::Shared,
        }
    }
}

/// The remark if the fitted model orders depth worse than the built-in one.
fn remark(fitted: f64, ours: f64) -> Option<&'static str> {
    (fitted < ours).then_some("the built-in eq3 orders these pairs better: keep it, or try --target order")
}

/// Pairs named one by one; of more, the worst.
const NAMED: usize = 12;

fn report(output: &Path, gathered: &Gathered, fit: &fit::Fit) -> String {
    let [mu0, mu1, mu2, mu3, mu4] = fit.eq3.mu;
    let ours = gathered.fitter.rank_scores(&Eq3::OURS);
    let mean = |scores: &[f64]| scores.iter().sum::<f64>() / scores.len() as f64;
    let mut text = String::new();
    let mut line = |line: String| {
        let _ = writeln!(text, "{line}");
    };
    line(format!("{}: written, fitted to {} pairs", display(output), gathered.names.len()));
    line(format!(
        "  d = {mu0:.6} {mu1:+.6} e^({mu2:.3} R) {mu3:+.6} e^({mu4:.3} M), M the larger of G and B"
    ));
    line(format!(
        "  order of depth (rank correlation, 1 is right)  fitted {:.3}, eq3 {:.3}",
        fit.rank_score,
        mean(&ours)
    ));
    if let Some(remark) = remark(fit.rank_score, mean(&ours)) {
        line(format!("  {remark}"));
    }
    let mut pairs: Vec<_> = gathered.names.iter().zip(fit.rank_scores.iter().zip(&ours)).collect();
    pairs.sort_by(|a, b| a.1.0.total_cmp(b.1.0));
    for (name, (fitted, ours)) in pairs.iter().take(NAMED) {
        line(format!("    {name:<42} fitted {fitted:.3}, eq3 {ours:.3}"));
    }
    if pairs.len() > NAMED {
        line(format!("    and {} pairs with a better order", pairs.len() - NAMED));
    }
    for doubt in &fit.doubts {
        line(format!("  doubtful: {doubt}"));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_that_orders_worse_than_what_is_built_in_is_remarked_on() {
        assert_eq!((remark(0.8, 0.7), remark(0.8, 0.8)), (None, None));
        assert!(remark(0.7, 0.8).is_some_and(|remark| remark.contains("--target order")));
    }
}
