//! Training by Brush, an engine for graphics cards: an installed program runs on the same images and points.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, anyhow};
use aquafuse_data::files::{FileError, make_folder, make_work_folder};
use aquafuse_data::image_file::{ImageFile, ReadOptions, WriteOptions};
use aquafuse_scene::files::{Cameras, PosedImage, read_splats, write_cameras};
use aquafuse_scene::lens::Lens;
use aquafuse_scene::medium::Medium;
use aquafuse_scene::model::Model;
use aquafuse_scene::training::{Request, Training};

use crate::failure::Failure;
use crate::tool;

/// The names of its program, in releases and when built from source.
const PROGRAMS: [&str; 3] = ["brush", "brush_app", "brush-cli"];
/// Added to the output's name: the folder in which it works.
const WORK: &str = ".brush";
const SPLATS: &str = "splats.ply";

pub(super) struct Brush {
    program: PathBuf,
    /// Its option for the number of steps, which was renamed once.
    steps: &'static str,
}

impl Brush {
    /// The program of this name, or the first that is installed.
    pub(super) fn find(program: Option<&Path>) -> Result<Self, Failure> {
        let named: Vec<&Path> = match program {
            Some(program) => vec![program],
            None => PROGRAMS.iter().map(Path::new).collect(),
        };
        named.into_iter().find_map(Self::asked).ok_or_else(|| {
            Failure::usage(anyhow!(
                "--engine brush needs Brush, and no program {} answers. Install it from a release of ArthurBrussee/brush \
                 and name it with --brush, or train with --engine cpu",
                program.map_or(PROGRAMS.join(", "), |program| program.display().to_string())
            ))
        })
    }

    fn asked(program: &Path) -> Option<Self> {
        let answer = Command::new(program).arg("--help").stdin(Stdio::null()).output().ok()?;
        let help = String::from_utf8_lossy(&answer.stdout).into_owned();
        let steps = ["--total-train-iters", "--total-steps"].into_iter().find(|name| help.contains(name))?;
        Some(Self { program: program.to_owned(), steps })
    }

    fn command(&self, training: &Training, scene: &Path, into: &Path) -> Command {
        let Request { options, sh_degree, .. } = training.request();
        let mut command = Command::new(&self.program);
        let iterations = options.iterations.to_string();
        command.arg(scene).args([self.steps, &iterations, "--export-every", &iterations]);
        command.arg("--export-path").arg(into).args(["--export-name", SPLATS]);
        command.args(["--sh-degree", &sh_degree.to_string(), "--seed", &options.seed.to_string()]);
        command.args(["--max-splats", &options.max_splats.to_string()]);
        command
    }

    /// Trains to the end, in a folder beside the output.
    pub(super) fn train(&self, training: &Training, reading: &ReadOptions) -> Result<Model, Failure> {
        let work = training.beside(WORK);
        make_work_folder(&work)?;
        // The program may resolve paths from another folder.
        let work = std::path::absolute(&work).map_err(|error| FileError::Read { path: work, error })?;
        let (scene, into) = (work.join("scene"), work.join("out"));
        write(training, &scene)?;
        make_folder(&into)?;
        tool::run(&mut self.command(training, &scene, &into), &work.join("log.txt"))
            .context("Brush did not train")
            .map_err(Failure::work)?;
        let splats = read_splats(&into.join(SPLATS), reading)?;
        Ok(Model { splats, medium: Medium::Air })
    }

    /// Removes the folder it worked in, once the output is written.
    pub(super) fn clear(training: &Training) {
        let _ = std::fs::remove_dir_all(training.beside(WORK));
    }
}

/// Writes the views that our own engine would train on, undistorted and of their size, as a scene of its own.
fn write(training: &Training, scene: &Path) -> Result<(), Failure> {
    let [folder, model] = ["images", "sparse/0"].map(|name| scene.join(name));
    make_folder(&folder)?;
    make_folder(&model)?;
    let views = &training.views().training;
    let mut images = Vec::with_capacity(views.len());
    for (number, view) in views.iter().enumerate() {
        let name = PathBuf::from(format!("{number:05}.png"));
        ImageFile::new(view.image.convert::<u8>()).write(&folder.join(&name), &WriteOptions::default())?;
        let lens = Lens { camera: view.camera.clone(), distortion: [0.0; 4] };
        images.push(PosedImage { name, lens });
    }
    let cameras = Cameras { images, points: training.points().to_vec(), model: PathBuf::new() };
    Ok(write_cameras(&model, &cameras, false)?)
}
