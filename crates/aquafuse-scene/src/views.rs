//! A trained scene as its cameras see it, or from an orbit around it: planned once, then rendered, with resume.
//!
//! [`Plan::new`] reads the splats and the cameras, [`Plan::through`] takes another medium than the one learned, and [`Plan::run`]
//! renders every view that an earlier run has not.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use aquafuse::depth::{DepthError, DepthKind, DepthMap};
use aquafuse_data::batch::{Item, Record};
use aquafuse_data::depth_file;
use aquafuse_data::files::{FileError, display, make_folder, place_of, remove_stale_parts, sha256};
use aquafuse_data::image_file::{ImageFile, ReadOptions, WriteOptions};
use aquafuse_data::pipeline::DepthSource;
use aquafuse_data::run::{self, Event, RunOptions, Stopped, Summary};
use serde_json::json;

use crate::around::Around;
use crate::camera::Camera;
use crate::compare::{distances, image};
use crate::files::{PosedImage, SceneFileError, read_cameras, write_transforms};
use crate::lens::Lens;
use crate::medium::Medium;
use crate::model::{Model, ModelError};
use crate::render::{memory, render};
use crate::splats::{MAX_SH_DEGREE, Splats};

/// What is to be rendered.
#[derive(Clone, Debug)]
pub struct Request {
    /// A trained scene.
    pub splats: PathBuf,
    /// The folder with its cameras.
    pub scene: PathBuf,
    /// The folder of the views, NAME.png for each camera; made if it is missing.
    pub output: PathBuf,
    /// So many views of an orbit instead of those of the cameras; `None`: those of the cameras.
    pub orbit: Option<u32>,
    /// Whether distances are written too, NAME.depth.tiff, in units of the scene; 0 where nothing is opaque.
    pub distances: bool,
    /// Pixels on the longer side.
    pub longest: usize,
    /// Replace images that exist.
    pub overwrite: bool,
}

/// A request whose splats and cameras are read.
#[derive(Clone, Debug)]
pub struct Plan {
    request: Request,
    splats: Splats<f32>,
    medium: Medium<f32>,
    /// A name and a camera each.
    views: Vec<(String, Camera)>,
}

/// Whoever listens to a run: an item is the image of a view.
pub type Listener<'a> = run::Listener<'a, Path>;

/// A scene cannot be rendered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewsError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(FileError),
    /// The cameras cannot be read, or those of the views not written.
    #[error(transparent)]
    Cameras(#[from] SceneFileError),
    /// The splats cannot be read.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Two images would have one output.
    #[error("{} has images whose names differ only in their extension; rename one of each", display(scene))]
    SameNames {
        /// The scene.
        scene: PathBuf,
    },
    /// There is no circle through the cameras.
    #[error("the cameras of {} have no common direction; leave out --orbit", display(scene))]
    NoOrbit {
        /// The scene.
        scene: PathBuf,
    },
    /// A view would take too much memory.
    #[error(
        "{view} takes {needed} bytes to render, more than the {most} of --max-memory; raise that, or lower --longest"
    )]
    Memory {
        /// The view's name.
        view: String,
        /// Bytes that it takes.
        needed: u64,
        /// Bytes that are allowed.
        most: u64,
    },
    /// A view shows nothing whose distance could be written.
    #[error("{view} has no distances to write: {cause}. Leave out --depth, or train the scene longer")]
    NoDistances {
        /// The view's name.
        view: String,
        /// What is wrong with them.
        cause: DepthError,
    },
    /// The run was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl From<FileError> for ViewsError {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Stopped { .. } => Self::Stopped(Stopped),
            error => Self::File(error),
        }
    }
}

impl Plan {
    /// Reads the splats and the cameras. Nothing is written.
    ///
    /// # Errors
    ///
    /// [`ViewsError`] when they cannot be read, two views would have one name, or there is no orbit.
    pub fn new(request: Request, reading: &ReadOptions) -> Result<Self, ViewsError> {
        let Model { splats, medium } = Model::read(&request.splats, reading)?;
        let posed = read_cameras(&request.scene, reading)?.images;
        let scene = request.scene.clone();
        let views: Vec<(String, Camera)> = match request.orbit {
            Some(count) => {
                let cameras: Vec<&Camera> = posed.iter().map(|one| &one.lens.camera).collect();
                let around = Around::new(&cameras, &splats).ok_or(ViewsError::NoOrbit { scene })?;
                let digits = count.saturating_sub(1).to_string().len().max(3);
                let orbit = around.orbit(count as usize).into_iter().enumerate();
                orbit.map(|(i, camera)| (format!("orbit_{i:0digits$}"), camera)).collect()
            }
            None => {
                let views: Vec<_> = posed.into_iter().map(|one| (flat(&one.name), one.lens.camera)).collect();
                if views.iter().map(|(name, _)| name).collect::<BTreeSet<_>>().len() < views.len() {
                    return Err(ViewsError::SameNames { scene });
                }
                views
            }
        };
        Ok(Self { request, splats, medium, views })
    }

    /// The same through another medium.
    #[must_use]
    pub fn through(self, medium: Medium<f32>) -> Self {
        Self { medium, ..self }
    }

    /// What the scene is seen through: first, what it was trained with.
    pub fn medium(&self) -> &Medium<f32> {
        &self.medium
    }

    /// How many views there are.
    pub fn views(&self) -> usize {
        self.views.len()
    }

    /// How many splats the scene has.
    pub fn splats(&self) -> usize {
        self.splats.len()
    }

    /// Renders the views that no run before this one has rendered, and writes their cameras beside them, `transforms.json`.
    ///
    /// One view after the other, each on the thread pool of the caller.
    ///
    /// # Errors
    ///
    /// [`ViewsError`] when a view cannot be rendered or written, an image is not ours, or the run was stopped.
    pub fn run(&self, options: &RunOptions, listener: Listener<'_>) -> Result<Summary, ViewsError> {
        let Request { splats, scene, output, longest, distances, overwrite, .. } = &self.request;
        make_folder(output)?;
        remove_stale_parts(output);
        // A run that was stopped goes on where all of this is the same.
        let cameras = format!("{:?}", self.views.iter().map(|(_, camera)| camera).collect::<Vec<_>>());
        let made_with = json!({
            "medium": format!("{:?}", self.medium),
            "cameras": sha256(cameras.as_bytes()),
            "longest": longest,
            "depth": distances,
        });
        let record = Record::open(output, &made_with, *overwrite)?;
        listener(Event::Started { total: self.views.len() });
        let mut summary = Summary::default();
        for (name, camera) in &self.views {
            let path = output.join(format!("{name}.png"));
            options.stop.check(&path)?;
            let item = Item { input: splats.clone(), output: path, depth: DepthSource::default() };
            let write =
                |may_replace| self.write(name, camera, &item.output, may_replace, options.reading.max_memory);
            if record.make(&item, *overwrite, write)? {
                summary.skipped += 1;
                listener(Event::Skipped { item: &item.output });
            } else {
                summary.done += 1;
                listener(Event::Done { item: &item.output, result: () });
            }
        }
        // The cameras that were rendered from, which may lie in that folder, are never replaced.
        if place_of(output) != place_of(scene) {
            let posed = self.views.iter().map(|(name, camera)| PosedImage {
                name: format!("{name}.png").into(),
                lens: Lens { camera: scaled(camera, *longest), distortion: [0.0; 4] },
            });
            let path = output.join("transforms.json");
            write_transforms(&path, &posed.collect::<Vec<_>>(), Path::new(""), *overwrite)?;
        }
        Ok(summary)
    }

    /// Renders a view, and writes it and its distances.
    fn write(
        &self,
        name: &str,
        camera: &Camera,
        path: &Path,
        overwrite: bool,
        most: u64,
    ) -> Result<(), ViewsError> {
        let camera = &scaled(camera, self.request.longest);
        let needed = memory(&self.splats, MAX_SH_DEGREE, camera, &self.medium);
        if needed > most {
            return Err(ViewsError::Memory { view: name.to_owned(), needed, most });
        }
        let rendered = render(&self.splats, MAX_SH_DEGREE, camera, &self.medium).rendering;
        let writing = WriteOptions { overwrite, ..WriteOptions::default() };
        ImageFile::new(image(&rendered).convert::<u8>()).write(path, &writing)?;
        if self.request.distances {
            let known = distances(&rendered).into_iter().map(|distance| distance.unwrap_or(0.0)).collect();
            let map = DepthMap::from_distances(camera.width, camera.height, DepthKind::Metres, known)
                .map_err(|cause| ViewsError::NoDistances { view: name.to_owned(), cause })?;
            depth_file::write(&path.with_extension("depth.tiff"), &map, &writing)?;
        }
        Ok(())
    }
}

/// A camera with so many pixels on its longer side.
fn scaled(camera: &Camera, longest: usize) -> Camera {
    let scale = longest as f64 / camera.width.max(camera.height) as f64;
    let side = |length: usize| ((length as f64 * scale).round() as usize).max(1);
    camera.scaled_to(side(camera.width), side(camera.height))
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
