//! `aquafuse scene compare`: how alike a scene and the same one fused are.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse_data::files::display;
use aquafuse_scene::capture::{self, Shown, images_of};
use aquafuse_scene::compare::{CompareError, Comparison, Model, Side};
use clap::Args;

use super::splats_file::Trained;
use crate::args::common::Common;
use crate::args::evaluation::{LpipsArguments, ReportArguments};
use crate::failure::Failure;
use crate::report::published;

/// Compare a trained scene with the same one fused: PSNR and SSIM of views, and how far surfaces lean away.
#[derive(Args)]
#[command(after_help = "\
SND is the mean angle between the normals of both scenes' surfaces, of 180 degrees, over pixels opaque in both,
1 - cos its mean. The floor is what two runs on the originals differ by: train twice with other --seed.
A page (-o FILE.html) shows what cameras took, what splats show, their surfaces, and the scene from above.

Example:
  aquafuse scene train reef/ -o a.ply --hold 8 && aquafuse scene train reef/ -o b.ply --hold 8 --seed 1
  aquafuse scene train reef_green/ -o green.ply --hold 8
  aquafuse scene compare reef/ reef_green/ --original a.ply --fused green.ply --floor b.ply -o reef.html")]
pub(crate) struct Compare {
    /// The folder of the scene.
    original_scene: PathBuf,
    /// The folder of the same scene, fused; several for several waters or models.
    #[arg(required = true)]
    fused_scenes: Vec<PathBuf>,
    /// What was trained on the first.
    #[arg(long, value_name = "FILE.ply")]
    original: PathBuf,
    /// What was trained on the fused one; as often as there are fused ones, in their order.
    #[arg(long, value_name = "FILE.ply", required = true)]
    fused: Vec<PathBuf>,
    /// What was trained on the first with another seed.
    #[arg(long, value_name = "FILE.ply")]
    floor: Option<PathBuf>,
    /// Every Nth image is compared: those that `scene train --hold N` held back.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    hold: u32,
    /// Images are compared at this many pixels on their longer side.
    #[arg(long, value_name = "PIXELS", default_value_t = 400, value_parser = clap::value_parser!(u32).range(16..=65535))]
    longest: u32,
    #[command(flatten)]
    lpips: LpipsArguments,
    #[command(flatten)]
    report: ReportArguments,
}

impl Compare {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        if self.fused.len() != self.fused_scenes.len() {
            return Err(Failure::usage(anyhow!(
                "{} fused scenes, but --fused is given {} times; give it once for each, in their order",
                self.fused_scenes.len(),
                self.fused.len()
            )));
        }
        self.report.check()?;
        let side = |scene: &Path, trained: &Path| -> Result<Side, Failure> {
            Ok(Side { name: name(scene), held: self.held(scene, common)?, model: model(trained)? })
        };
        let original = side(&self.original_scene, &self.original)?;
        let floor = self.floor.as_deref().map(model).transpose()?;
        let fused = self.fused_scenes.iter().zip(&self.fused).map(|(scene, trained)| side(scene, trained));
        let fused: Vec<Side> = fused.collect::<Result<_, _>>()?;
        let comparison = Comparison::new(original, floor, fused, self.lpips.network()?)?;
        let published = published::reconstruction().map_err(Failure::work)?;
        self.report.run(
            common,
            |listener| comparison.report(listener),
            |report| report.tables.push(published),
        )
    }

    fn held(&self, scene: &Path, common: &Common) -> Result<Vec<Shown>, Failure> {
        let taken =
            capture::read(scene, &images_of(scene), self.longest as usize, &common.reading.options())?;
        let kept = taken.shown.into_iter().enumerate().filter(|(i, _)| i.is_multiple_of(self.hold as usize));
        Ok(kept.map(|(_, one)| one).collect())
    }
}

fn model(path: &Path) -> Result<Model, Failure> {
    let Trained { splats, medium } = Trained::read(path)?;
    Ok(Model { splats, medium })
}

/// A folder by its own name.
fn name(folder: &Path) -> String {
    display(folder.file_name().map_or(folder, Path::new)).to_string()
}

impl From<CompareError> for Failure {
    fn from(error: CompareError) -> Self {
        Self::usage(error)
    }
}
