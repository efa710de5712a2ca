//! `aquafuse scene render`: a trained scene as its cameras see it, or from an orbit, through any water.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse::depth::{DepthKind, DepthMap};
use aquafuse_data::batch::{Item, Record};
use aquafuse_data::depth_file;
use aquafuse_data::files::{display, make_folder, place_of, remove_stale_parts, sha256};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_data::pipeline::DepthSource;
use aquafuse_scene::around::Around;
use aquafuse_scene::camera::Camera;
use aquafuse_scene::compare::{distances, image};
use aquafuse_scene::files::{PosedImage, read_cameras, write_transforms};
use aquafuse_scene::lens::Lens;
use aquafuse_scene::medium::Medium;
use aquafuse_scene::model::Model;
use aquafuse_scene::render::{memory, render};
use aquafuse_scene::splats::{MAX_SH_DEGREE, Splats};
use clap::Args;
use serde_json::json;

use super::looked_through::LookedThrough;
use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;

/// Render a trained scene from its cameras, or from an orbit around it.
///
/// The cameras of the views are written beside them, transforms.json: the folder is a scene, for other programs too.
#[derive(Args)]
#[command(after_help = "\
Renders through the learned water unless --water names another. A unit of the scene counts as a metre unless
--metres-per-unit says more. To continue a run that was stopped, repeat the command.

Examples:
  aquafuse scene render reef.ply reef/ -o views/
  aquafuse scene render reef.ply reef/ -o dewatered/ --water none            stills for other programs
  aquafuse scene render reef.ply reef/ -o coast/ --water preset:jerlov-3C --depth
  aquafuse scene render reef.ply reef/ -o murky/ --water preset:jerlov-5C --visibility 4 --metres-per-unit 0.2
  aquafuse scene render reef.ply reef/ -o orbit/ --orbit 120       orbit/orbit_000.png, ...; frames of a film")]
pub(crate) struct Render {
    /// A trained scene.
    splats: PathBuf,
    /// The folder with its cameras.
    scene: PathBuf,
    /// Folder to write into, NAME.png for each camera; made if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    medium: LookedThrough,
    /// Render this many views of an orbit instead of the cameras' own: a full circle if the cameras surround the scene,
    /// otherwise an arc along them. The last view precedes the first.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    orbit: Option<u32>,
    /// Also write distances, NAME.depth.tiff, in units of the scene; 0 where nothing is opaque.
    #[arg(long)]
    depth: bool,
    /// Render at this many pixels on the longer side.
    #[arg(long, value_name = "PIXELS", default_value_t = 400, value_parser = clap::value_parser!(u32).range(16..=16384))]
    longest: u32,
    /// Replace images that exist.
    #[arg(long)]
    overwrite: bool,
}

impl Render {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        super::say_model(&self.scene, common);
        let Model { splats, medium } = Model::read(&self.splats, &common.reading.options())?;
        let medium = self.medium.medium(medium, common)?;
        let views = self.views(&splats, common)?;
        make_folder(&self.output)?;
        remove_stale_parts(&self.output);
        // A run that was stopped goes on where all of this is the same.
        let cameras = format!("{:?}", views.iter().map(|(_, camera)| camera).collect::<Vec<_>>());
        let made_with = json!({
            "medium": format!("{medium:?}"),
            "cameras": sha256(cameras.as_bytes()),
            "longest": self.longest,
            "depth": self.depth,
        });
        let record = Record::open(&self.output, &made_with, self.overwrite)?;
        let progress = Progress::new(common.quiet);
        progress.start(views.len());
        let mut skipped = 0;
        for (name, camera) in &views {
            let output = self.output.join(format!("{name}.png"));
            let item = Item { input: self.splats.clone(), output, depth: DepthSource::default() };
            let write =
                |overwrite| self.view(name, camera, (&splats, &medium), &item.output, overwrite, common);
            skipped += usize::from(record.make(&item, self.overwrite, write)?);
            progress.done(&display(&item.output).to_string());
        }
        progress.finish();
        // The cameras that were rendered from, which may lie in that folder, are never replaced.
        if place_of(&self.output) != place_of(&self.scene) {
            let posed = views.iter().map(|(name, camera)| PosedImage {
                name: format!("{name}.png").into(),
                lens: Lens { camera: self.scaled(camera), distortion: [0.0; 4] },
            });
            let path = self.output.join("transforms.json");
            write_transforms(&path, &posed.collect::<Vec<_>>(), Path::new(""), self.overwrite)?;
        }
        let skipped = match skipped {
            0 => String::new(),
            skipped => format!("; {skipped} were rendered by an earlier run"),
        };
        let text =
            format!("{}: {} views of {} splats{skipped}\n", display(&self.output), views.len(), splats.len());
        if common.quiet { Ok(()) } else { output::print(&text) }
    }

    /// Renders a view, and writes it and its distances.
    fn view(
        &self,
        name: &str,
        camera: &Camera,
        (splats, medium): (&Splats<f32>, &Medium<f32>),
        path: &Path,
        overwrite: bool,
        common: &Common,
    ) -> Result<(), Failure> {
        let camera = self.scaled(camera);
        let (needed, most) =
            (memory(splats, MAX_SH_DEGREE, &camera, medium), common.reading.options().max_memory);
        if needed > most {
            return Err(Failure::work(anyhow!(
                "{name} takes {needed} bytes to render, more than the {most} of --max-memory; raise that, or lower --longest"
            )));
        }
        let rendered = render(splats, MAX_SH_DEGREE, &camera, medium).rendering;
        let writing = WriteOptions { overwrite, ..WriteOptions::default() };
        ImageFile::new(image(&rendered).convert::<u8>()).write(path, &writing)?;
        if self.depth {
            let known = distances(&rendered).into_iter().map(|distance| distance.unwrap_or(0.0)).collect();
            let map = DepthMap::from_distances(camera.width, camera.height, DepthKind::Metres, known);
            depth_file::write(&path.with_extension("depth.tiff"), &map.map_err(Failure::work)?, &writing)?;
        }
        Ok(())
    }

    /// The camera on the pixels that are asked for.
    fn scaled(&self, camera: &Camera) -> Camera {
        let scale = f64::from(self.longest) / camera.width.max(camera.height) as f64;
        let side = |length: usize| ((length as f64 * scale).round() as usize).max(1);
        camera.scaled_to(side(camera.width), side(camera.height))
    }

    /// The views to render: a name and a camera each.
    fn views(&self, splats: &Splats<f32>, common: &Common) -> Result<Vec<(String, Camera)>, Failure> {
        let posed = read_cameras(&self.scene, &common.reading.options())?.images;
        if let Some(count) = self.orbit {
            let cameras: Vec<&Camera> = posed.iter().map(|one| &one.lens.camera).collect();
            let around = Around::new(&cameras, splats).ok_or_else(|| {
                Failure::usage(anyhow!(
                    "the cameras of {} have no common direction; leave out --orbit",
                    display(&self.scene)
                ))
            })?;
            let digits = (count - 1).to_string().len().max(3);
            let orbit = around.orbit(count as usize).into_iter().enumerate();
            return Ok(orbit.map(|(i, camera)| (format!("orbit_{i:0digits$}"), camera)).collect());
        }
        let views: Vec<_> = posed.into_iter().map(|one| (flat(&one.name), one.lens.camera)).collect();
        if views.iter().map(|(name, _)| name).collect::<BTreeSet<_>>().len() < views.len() {
            return Err(Failure::usage(anyhow!(
                "{} has images whose names differ only in their extension; rename one of each",
                display(&self.scene)
            )));
        }
        Ok(views)
    }
}

/// An image's name without folders and extension, so that all outputs fit into one folder. Only the last dot begins an
/// extension.
fn flat(name: &Path) -> String {
    let parts: Vec<_> = name.iter().map(|part| part.to_string_lossy()).collect();
    let whole = parts.join("__");
    whole.rsplit_once('.').map_or(whole.as_str(), |(stem, _)| stem).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_all_but_their_extension() {
        assert_eq!(flat("left/frame_08.500.jpg".as_ref()), "left__frame_08.500");
        assert_eq!(flat("frame".as_ref()), "frame");
    }
}
