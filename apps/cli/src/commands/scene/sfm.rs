//! `aquafuse scene sfm`: the cameras of a folder of images, found by an external program.

mod tools;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse_data::files::{
    FileError, display, make_folder, make_work_folder, remove_stale_parts, write_bytes, write_text,
};
use aquafuse_data::image_file;
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use aquafuse_scene::files::{Cameras, read_cameras};
use clap::Args;

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;
use crate::tool;
use tools::{Job, STEPS, Tool};

/// Find the cameras of a folder of images with pycolmap or COLMAP, and write a scene.
#[derive(Args)]
#[command(after_help = "\
Structure from motion is done by COLMAP, which must be installed: `python3 -m pip install pycolmap` on any system, or
Debian's package `colmap`. SCENE gets the images (images/), and cameras and points (sparse/0/).

Examples:
  aquafuse scene sfm photos/ -o reef/
  aquafuse scene sfm frames/ -o dive/ --in-order           frames of a video
  aquafuse scene sfm photos/ -o reef/ --python venv/bin/python")]
pub(crate) struct Sfm {
    /// A folder of images of one place, taken from many sides.
    images: PathBuf,
    /// Output folder of the scene; created if missing.
    #[arg(short, long, value_name = "SCENE")]
    output: PathBuf,
    /// The images are frames of a video in the order of their names: match each with its neighbours only.
    #[arg(long)]
    in_order: bool,
    /// The Python that has pycolmap [default: python3, if it has it].
    #[arg(long, value_name = "PROGRAM")]
    python: Option<PathBuf>,
    /// Path of COLMAP's command, used instead of pycolmap [default: colmap if pycolmap is not installed].
    #[arg(long, value_name = "PROGRAM", conflicts_with = "python")]
    colmap: Option<PathBuf>,
    /// Write into a folder that is not empty, and replace its model and images of the same names.
    #[arg(long)]
    overwrite: bool,
}

/// The program's work folder in the scene's folder; a run that failed leaves it.
const WORK: &str = ".aquafuse-sfm";
/// Where a scene keeps models of COLMAP.
const MODEL: &str = "sparse/0";
const MODEL_FILES: [&str; 3] = ["cameras.bin", "images.bin", "points3D.bin"];

impl Sfm {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let names = self.names()?;
        let tool = self.tool()?;
        if !self.overwrite {
            output::refuse_filled(&self.output, &[WORK])?;
        }
        let work = self.output.join(WORK);
        make_work_folder(&work)?;
        make_folder(&work.join("models"))?;
        write_text(&work.join("images.txt"), &(names.join("\n") + "\n"), false)?;
        let job = Job {
            images: &self.images,
            work: &work,
            is_one_camera: self.is_one_size(&names, common)?,
            in_order: self.in_order,
        };

        let progress = Progress::new(common.quiet);
        progress.start(STEPS.len());
        for step in STEPS {
            tool::run(&mut tool.command(step, &job), &work.join("log.txt"))
                .map_err(|error| Failure::work(anyhow!("{error}").context(format!("finding {step}"))))?;
            progress.done(step);
        }
        progress.finish();
        let (model, found) = largest(&work.join("models"), &common.reading.options())?;
        self.write(&names, &model)?;
        // Its duty is done; the next run would remove it too.
        let _ = std::fs::remove_dir_all(&work);
        if common.quiet { Ok(()) } else { output::print(&self.summary(&tool, &names, &found)) }
    }

    fn tool(&self) -> Result<Tool, Failure> {
        match (&self.python, &self.colmap) {
            (Some(python), _) => Tool::pycolmap(python).ok_or_else(|| {
                Failure::usage(anyhow!(
                    "{} has no pycolmap; install it: {0} -m pip install pycolmap",
                    display(python)
                ))
            }),
            (_, Some(colmap)) => Tool::colmap(colmap)
                .ok_or_else(|| Failure::usage(anyhow!("{} is not COLMAP's command", display(colmap)))),
            (None, None) => Tool::installed().ok_or_else(|| {
                Failure::usage(anyhow!(
                    "finding cameras takes pycolmap or COLMAP, and neither is installed. Install one: `python3 -m pip \
                     install pycolmap` (then --python names its Python, if that is not python3), or your system's \
                     package, as `apt install colmap`"
                ))
            }),
        }
    }

    /// The images, by name.
    fn names(&self) -> Result<Vec<String>, Failure> {
        let listed = image_file::list(&self.images)?;
        let name = |path: &PathBuf| path.file_name().and_then(|name| name.to_str()).map(str::to_owned);
        let names: Vec<String> = listed.images.iter().filter_map(name).collect();
        if names.len() < listed.images.len() {
            return Err(Failure::usage(anyhow!(
                "{} has file names that are not UTF-8; rename them",
                display(&self.images)
            )));
        }
        if names.len() < 3 {
            return Err(Failure::usage(anyhow!(
                "{} has {} images; a scene takes three at least, of the same things from different places",
                display(&self.images),
                names.len()
            )));
        }
        Ok(names)
    }

    /// Whether all images have one size, as those of one lens have.
    fn is_one_size(&self, names: &[String], common: &Common) -> Result<bool, Failure> {
        let mut sizes = BTreeSet::new();
        for name in names {
            sizes.insert(ImageFile::open(&self.images.join(name), &common.reading.options())?.size());
        }
        Ok(sizes.len() == 1)
    }

    /// The images first: a folder with a model is a whole scene.
    fn write(&self, names: &[String], model: &Path) -> Result<(), Failure> {
        let (images, into) = (self.output.join("images"), self.output.join(MODEL));
        for folder in [&images, &into] {
            make_folder(folder)?;
            remove_stale_parts(folder);
        }
        for name in names {
            copy(&self.images.join(name), &images.join(name))?;
        }
        for name in MODEL_FILES {
            copy(&model.join(name), &into.join(name))?;
        }
        Ok(())
    }

    fn summary(&self, tool: &Tool, names: &[String], found: &Cameras) -> String {
        let posed: BTreeSet<&Path> = found.images.iter().map(|one| one.name.as_path()).collect();
        let lost: Vec<&str> =
            names.iter().map(String::as_str).filter(|name| !posed.contains(Path::new(name))).collect();
        let mut text = format!(
            "{}: {} of {} images have a camera, {} points; by {}\n",
            display(&self.output),
            found.images.len(),
            names.len(),
            found.points.len(),
            tool.name()
        );
        if !lost.is_empty() {
            text += &format!("  no camera was found for {}\n", lost.join(", "));
        }
        text
    }
}

/// The model with the most images: where parts of a scene do not hang together, each has its own.
fn largest(models: &Path, reading: &ReadOptions) -> Result<(PathBuf, Cameras), Failure> {
    let entries = models.read_dir().map_err(|error| FileError::Read { path: models.to_owned(), error })?;
    let mut folders: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    folders.sort();
    let mut best: Option<(PathBuf, Cameras)> = None;
    for folder in folders.into_iter().filter(|folder| folder.join(MODEL_FILES[0]).is_file()) {
        let found = read_cameras(&folder, reading)?;
        if best.as_ref().is_none_or(|(_, other)| found.images.len() > other.images.len()) {
            best = Some((folder, found));
        }
    }
    best.ok_or_else(|| {
        Failure::work(anyhow!(
            "no cameras were found: images must show the same things from different places, sharp, with much in \
             common from one to the next"
        ))
    })
}

fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    let bytes = std::fs::read(from).map_err(|error| FileError::Read { path: from.to_owned(), error })?;
    Ok(write_bytes(to, &bytes, true)?)
}
