//! `aquafuse scene`: scenes in 3D.

mod compare;
mod export;
mod fuse;
mod looked_through;
mod render;
mod sfm;
mod train;
mod view;

use std::path::Path;

use aquafuse_data::files::display;
use aquafuse_scene::capture::CaptureError;
use aquafuse_scene::files::{ChosenModel, SceneFileError};
use aquafuse_scene::model::ModelError;
use clap::{Args, Subcommand};

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;

/// Scenes in 3D: Gaussian splats trained on a CPU, with the water in them.
#[derive(Args)]
#[command(after_help = "\
SCENE is a folder with images (in images/, or directly in it) and their cameras, as structure from
motion writes them: COLMAP's cameras, images and points3D (.bin or .txt, in SCENE, sparse/0, sparse
or colmap_text), or transforms.json. Of several models, sparse/0, sparse/1, ..., the one with the
most images is used.

Examples:
  aquafuse scene sfm photos/ -o reef/
  aquafuse scene train reef/ -o reef.ply --water learn
  aquafuse scene render reef.ply reef/ -o dewatered/ --water none
  aquafuse scene view reef.ply reef/ -o reef.html
  aquafuse scene fuse reef/ green.jpg -o reef_green/
  aquafuse scene train reef_green/ -o reef_green.ply
  aquafuse scene compare reef/ reef_green/ --original reef.ply --fused reef_green.ply -o reef.html")]
pub(crate) struct Scene {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Sfm(sfm::Sfm),
    Train(train::Train),
    Render(render::Render),
    Fuse(fuse::Fuse),
    Compare(compare::Compare),
    Export(export::Export),
    View(view::View),
}

/// Says which model of a scene is used, where there are several.
fn say_model(scene: &Path, common: &Common) {
    if let Some(ChosenModel { model, images, others: others @ 1.. }) = ChosenModel::of(scene)
        && !common.quiet
    {
        let (scene, model) = (display(scene), display(&model));
        output::remark(&format_args!(
            "{scene}: {model} is used, with {images} images; {others} other models have no more"
        ));
    }
}

impl Scene {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        match &self.command {
            Command::Sfm(sfm) => sfm.run(common),
            Command::Train(train) => train.run(common),
            Command::Render(render) => render.run(common),
            Command::Fuse(fuse) => fuse.run(common),
            Command::Compare(compare) => compare.run(common),
            Command::Export(export) => export.run(common),
            Command::View(view) => view.run(common),
        }
    }
}

impl From<SceneFileError> for Failure {
    fn from(error: SceneFileError) -> Self {
        match error {
            SceneFileError::File(error) => error.into(),
            SceneFileError::NoCameras { .. } => Self::usage(error),
            error => Self::work(error),
        }
    }
}

impl From<CaptureError> for Failure {
    fn from(error: CaptureError) -> Self {
        match error {
            CaptureError::Image(error) => error.into(),
            error @ CaptureError::Missing { .. } => Self::usage(error),
            error => Self::work(error),
        }
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::File(error) => error.into(),
            ModelError::Splats(error) => error.into(),
            ModelError::Water(error) => error.into(),
            error => Self::work(error),
        }
    }
}
