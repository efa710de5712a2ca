//! Others in the same run: the pipeline in OpenCV, transfers of colour, augmentations, medians.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::turns::Turns;
use xtask::setup::python_environment;
use xtask::shell::{cargo, command, output, root, run as call, target};

/// How the rivals beside the pipeline are called in the table, and what of ours they stand beside.
pub(super) const OTHERS: [(&str, &str, &str); 8] = [
    ("color-matcher-mkl", "color-matcher, mkl", "cached"),
    ("color-matcher-reinhard", "color-matcher, reinhard", "cached"),
    ("match-histograms", "scikit-image, match_histograms", "cached"),
    ("color-jitter", "Albumentations, ColorJitter", "cached"),
    ("random-fog", "Albumentations, RandomFog", "cached"),
    ("opencv-median", "OpenCV, medianBlur of one channel, 7x7", "depth"),
    ("imageproc", "imageproc, median_filter of one channel, 7x7", "depth"),
    ("libblur", "libblur, median_blur of one channel, 7x7", "depth"),
];
const MEDIANS: &str = "benches/medians/Cargo.toml";

/// One turn of the pipeline in OpenCV: `cached`, `estimated`, `smoothed`.
pub(super) fn pipeline(python: &Path, turns: &mut Turns, images: &Path, frames: &str) -> Result<()> {
    let [content, reference] = names(images);
    let script = ["benches/opencv_pipeline.py", "time", &content, &reference, "--frames", frames];
    turns.read(&output(command(python, &script))?);
    Ok(())
}

/// The programs of [`OTHERS`].
pub(super) struct Others {
    python: PathBuf,
}

impl Others {
    pub(super) fn set_up() -> Result<Self> {
        call(cargo(&["build", "--release", "--quiet", "--locked", "--manifest-path", MEDIANS]))?;
        let environment = python_environment("python-rivals", "benches/requirements.txt")?;
        Ok(Self { python: environment.join("bin/python") })
    }

    pub(super) fn turn(&self, turns: &mut Turns, images: &Path) -> Result<()> {
        let [content, reference] = names(images);
        let script = ["benches/rivals.py", &content, &reference, "--frames", "3"];
        turns.read(&output(command(&self.python, &script))?);
        let own = root().join("benches/medians/target");
        let built = std::env::var_os("CARGO_TARGET_DIR").map_or(own, |_| target());
        turns.read(&output(command(built.join("release/medians"), &[&content, "3"]))?);
        Ok(())
    }
}

fn names(images: &Path) -> [String; 2] {
    ["blue.ppm", "green.ppm"].map(|name| images.join(name).to_string_lossy().into_owned())
}
