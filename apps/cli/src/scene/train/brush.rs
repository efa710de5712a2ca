//! Training by Brush, an engine for graphics cards: an installed program is run on the same images and points.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, anyhow};
use aquafuse_data::image_file::{FileError, ImageFile, WriteOptions};
use aquafuse_scene::files::{Cameras, Taken, read_ply, write_cameras};
use aquafuse_scene::lens::Lens;
use aquafuse_scene::medium::Medium;

use super::engine::{Engine, Task};
use crate::failure::Failure;
use crate::output;
use crate::scene::splats_file::Trained;
use crate::tool;

/// Its program, as it is called in releases and where it is built from source.
const PROGRAMS: [&str; 3] = ["brush", "brush_app", "brush-cli"];
/// Behind the output's name: the folder in which it works.
const WORK: &str = ".brush";
const SPLATS: &str = "splats.ply";

pub(super) struct Brush {
    program: PathBuf,
    /// What it calls the number of steps, which was renamed once.
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

    fn command(&self, task: &Task<'_>, scene: &Path, into: &Path) -> Command {
        let mut command = Command::new(&self.program);
        let iterations = task.options.iterations.to_string();
        command.arg(scene).args([self.steps, &iterations, "--export-every", &iterations]);
        command.arg("--export-path").arg(into).args(["--export-name", SPLATS]);
        command.args(["--sh-degree", &task.sh_degree.to_string(), "--seed", &task.options.seed.to_string()]);
        command.args(["--max-splats", &task.options.most_splats.to_string()]);
        command
    }
}

impl Engine for Brush {
    fn train(&self, task: &Task<'_>) -> Result<Trained, Failure> {
        let work = task.beside(WORK);
        // Left by a run that was ended.
        let _ = std::fs::remove_dir_all(&work);
        output::make_folder(&work)?;
        // It may take paths to begin elsewhere.
        let work = std::path::absolute(&work).map_err(|error| FileError::Read { path: work, error })?;
        let (scene, into) = (work.join("scene"), work.join("out"));
        write(task, &scene)?;
        output::make_folder(&into)?;
        tool::run(&mut self.command(task, &scene, &into), &work.join("log.txt"))
            .context("Brush did not train")
            .map_err(Failure::work)?;
        let splats = read_ply(&into.join(SPLATS))?;
        Ok(Trained { splats, medium: Medium::Air })
    }

    fn clear(&self, task: &Task<'_>) {
        let _ = std::fs::remove_dir_all(task.beside(WORK));
    }
}

/// Exactly the images that we would train on, straight and of their size, as a scene of its own.
fn write(task: &Task<'_>, scene: &Path) -> Result<(), Failure> {
    let [images, model] = ["images", "sparse/0"].map(|name| scene.join(name));
    output::make_folder(&images)?;
    output::make_folder(&model)?;
    let mut taken = Vec::with_capacity(task.trained_on.len());
    for (number, one) in task.trained_on.iter().enumerate() {
        let name = PathBuf::from(format!("{number:05}.png"));
        ImageFile::new(one.image.convert::<u8>()).write(&images.join(&name), &WriteOptions::default())?;
        taken.push(Taken { name, lens: Lens { camera: one.camera.clone(), distortion: [0.0; 4] } });
    }
    let cameras = Cameras { taken, points: task.taken.points.clone(), model: PathBuf::new() };
    Ok(write_cameras(&model, &cameras, false)?)
}
