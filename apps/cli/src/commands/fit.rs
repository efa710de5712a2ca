//! `aquafuse fit`: a depth model from images whose depth is known.

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
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;

/// Fit the depth model `eq3` to images with known depth, for `--depth-model FILE.toml`.
///
/// PAIRS holds a folder `rgb` of images (PNG, JPEG, TIFF, WebP, BMP) and a folder `depth` of depth maps
/// (PNG, TIFF, OpenEXR, NPY, PFM) of the same stems and sizes. Depth never rises with red nor falls with max(G, B) in the fitted model, and
/// spans 0 to 1 over all colours. A few pairs of one place make a model of that place: look at pairs it was
/// not fitted to.
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Fit {
    /// A folder with `rgb` and `depth` in it.
    pairs: PathBuf,
    /// Where to write: .toml; a missing folder is made.
    #[arg(short, long, value_name = "MODEL.toml")]
    output: PathBuf,
    /// What the values of the depth maps are, which no file says: as for `fuse`. 0 is unknown depth in metres,
    /// millimetres and disparity.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_kind: SuppliedKind,
    /// What the depths of different images have in common.
    #[arg(long, value_enum, default_value_t)]
    scale: ScaleArg,
    /// What of the depths is fitted to.
    #[arg(long, value_enum, default_value_t)]
    target: TargetArg,
    /// Replace MODEL.toml if it exists.
    #[arg(long)]
    overwrite: bool,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum ScaleArg {
    /// Nothing: each image has a scale and a shift of its own.
    #[default]
    PerImage,
    /// One scale and one shift: metres, in one water. Not for inverse depth and disparity.
    Shared,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum TargetArg {
    /// Their numbers.
    #[default]
    Distances,
    /// Which pixel is farther than which, image by image.
    Order,
}

const EXAMPLE: &str = "\
Example:
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
                "--scale shared needs depths with one unit, and {} has another in each image; leave --scale out",
                self.depth_kind.name()
            )));
        }
        let listing = pairs::list(&self.pairs).map_err(Failure::usage)?;
        if listing.pairs.is_empty() {
            let others = listing.without_partner.len();
            return Err(Failure::usage(anyhow!(
                "{} holds no pair: {others} files of rgb/ and depth/ have no partner of the same stem. Name \
                 the two files of a pair alike",
                display(&self.pairs)
            )));
        }
        if !quiet && !listing.without_partner.is_empty() {
            let names = listing.without_partner.join(", ");
            output::complain(&format!("passed over for want of a partner: {names}"));
        }
        make_folder_of(&self.output)?;
        let gathered = self.gather(&listing.pairs, common)?;
        let fit = gathered.fitter.solve().map_err(|error| {
            Failure::work(anyhow!("cannot fit a model to {}: {error}", display(&self.pairs)))
        })?;
        let file = ModelFile { eq3: fit.eq3, fit: Some(self.record(&gathered, &fit)) };
        file.write(&self.output, self.overwrite)?;
        if !quiet {
            output::print(&report(&self.output, &gathered, &fit))?;
        }
        match listing.pairs.len() - gathered.names.len() {
            0 => Ok(()),
            failed => Err(Failure::work(anyhow!(
                "{failed} of {} pairs failed and were left out; the messages above say why",
                listing.pairs.len()
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

/// What is said where fitting has made the order of depth no better.
fn remark(fitted: f64, ours: f64) -> Option<&'static str> {
    (fitted < ours)
        .then_some("eq3 as it is built in orders these pairs better: keep it, or try --target order")
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
        line(format!("    and {} pairs whose order is better", pairs.len() - NAMED));
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
