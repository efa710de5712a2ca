//! `aquafuse scene compare`: a scene beside the same scene fused.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse_data::files::display;
use aquafuse_scene::capture::{self, Split, View, images_of};
use aquafuse_scene::compare::{CompareError, Comparison, Side};
use aquafuse_scene::files::read_cameras;
use aquafuse_scene::model::Model;
use clap::Args;

use crate::args::common::Common;
use crate::args::evaluation::{LpipsArguments, ReportArguments};
use crate::failure::Failure;
use crate::report::published;

/// Compare a trained scene with the same scene fused: PSNR and SSIM of held-out views, and surface-normal deviation.
#[derive(Args)]
#[command(after_help = "\
SND is the mean angle between the surface normals of both scenes, as a share of 180 degrees, over pixels that are
opaque in both; 1 - cos is the mean of that. The floor is the difference between two runs on the original images:
train twice with another --seed. A page (-o FILE.html) shows images, renderings, surfaces, and the scene from above.

Example:
  aquafuse scene train reef/ -o a.ply --hold 8 && aquafuse scene train reef/ -o b.ply --hold 8 --seed 1
  aquafuse scene train reef_green/ -o green.ply --hold 8
  aquafuse scene compare reef/ reef_green/ --original a.ply --fused green.ply --floor b.ply -o reef.html")]
pub(crate) struct Compare {
    /// The folder of the scene.
    original_scene: PathBuf,
    /// The folder of the same scene, fused; several folders for several waters or models.
    #[arg(required = true)]
    fused_scenes: Vec<PathBuf>,
    /// The splats trained on the original scene.
    #[arg(long, value_name = "FILE.ply")]
    original: PathBuf,
    /// Splats trained on a fused scene. Repeat the option for each fused scene, in the order of the scenes.
    #[arg(long, value_name = "FILE.ply", required = true)]
    fused: Vec<PathBuf>,
    /// The splats trained on the original scene with another seed.
    #[arg(long, value_name = "FILE.ply")]
    floor: Option<PathBuf>,
    /// Compare every Nth image: those that `scene train --hold N` held out.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    hold: u32,
    /// Scale images to this many pixels on the longer side before comparing.
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
            Ok(Side {
                name: name(scene),
                held_out: self.held_out(scene, common)?,
                model: Model::read(trained, &common.reading.options())?,
            })
        };
        let original = side(&self.original_scene, &self.original)?;
        let floor =
            self.floor.as_deref().map(|floor| Model::read(floor, &common.reading.options())).transpose()?;
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

    fn held_out(&self, scene: &Path, common: &Common) -> Result<Vec<View>, Failure> {
        super::say_model(scene, common);
        let cameras = read_cameras(scene, &common.reading.options())?;
        let images = images_of(scene, &cameras);
        let views = capture::read(&cameras, &images, self.longest as usize, &common.reading.options())?;
        Ok(Split::new(views, self.hold as usize).held_out)
    }
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
