//! `aquafuse scene view`: a trained scene as a page for a browser.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse_data::files::{FileError, display, make_folder_of, remove_stale_parts, write_text};
use aquafuse_scene::files::read_cameras;
use aquafuse_scene::model::Model;
use aquafuse_scene::page::{outside, page};
use clap::Args;

use super::looked_through::LookedThrough;
use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;

/// Write a trained scene as one HTML page: turn it, step from camera to camera, remove its water.
#[derive(Args)]
#[command(after_help = "\
The page is self-contained: it opens from a disk, without a network. It renders by WebGL 2 and ignores view dependence
(train --sh-degree). PAGE#view=3&water=0 opens it at the third camera, without water.

Examples:
  aquafuse scene view reef.ply reef/ -o reef.html
  aquafuse scene view reef.ply -o coast.html --water preset:jerlov-3C        without cameras, in another water")]
pub(crate) struct View {
    /// A trained scene.
    splats: PathBuf,
    /// The folder with its cameras; without it, the page has one camera that sees most of the scene.
    scene: Option<PathBuf>,
    /// Where to write, PAGE.html.
    #[arg(short, long, value_name = "PAGE.html")]
    output: PathBuf,
    #[command(flatten)]
    medium: LookedThrough,
    /// Replace PAGE.html if it exists.
    #[arg(long)]
    overwrite: bool,
}

impl View {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let path = &self.output;
        if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("html")) {
            return Err(FileError::UnknownExtension { path: path.clone(), expected: ".html" }.into());
        }
        let Model { splats, medium } = Model::read(&self.splats, &common.reading.options())?;
        let model = Model { splats, medium: self.medium.medium(medium, common)? };
        self.scene.iter().for_each(|scene| super::say_model(scene, common));
        let cameras = match &self.scene {
            Some(scene) => read_cameras(scene, &common.reading.options())?
                .images
                .into_iter()
                .map(|one| (display(&one.name).to_string(), one.lens.camera))
                .collect(),
            None => vec![("from outside".to_owned(), outside(&model.splats))],
        };
        remove_stale_parts(make_folder_of(path)?);
        let name = self.splats.file_name().map_or(self.splats.as_path(), Path::new);
        let page = page(name, &model, &cameras).ok_or_else(|| {
            Failure::usage(anyhow!("the cameras have no common direction; leave out the scene"))
        })?;
        write_text(path, &page, self.overwrite)?;
        let text = format!("{}: {} splats, {} views\n", display(path), model.splats.len(), cameras.len());
        if common.quiet { Ok(()) } else { output::print(&text) }
    }
}
