//! A trained scene on disk: FILE.ply, and FILE.water.json beside it where a water was learned.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse::depth::DepthKind;
use aquafuse::image::Encoded;
use aquafuse::waterbody::Estimate;
use aquafuse_data::files::{FileError, display};
use aquafuse_data::water_file::WaterFile;
use aquafuse_scene::files::{read_ply, write_ply};
use aquafuse_scene::medium::Medium;
use aquafuse_scene::splats::Splats;

use crate::failure::Failure;

/// What was trained.
pub(crate) struct Trained {
    pub(crate) splats: Splats<f32>,
    /// What it was trained through: air, or the water that lies beside it.
    pub(crate) medium: Medium<f32>,
}

/// The water's name beside FILE.ply.
pub(crate) fn water_beside(path: &Path) -> PathBuf {
    path.with_extension("water.json")
}

/// Refuses a name that is not one of a PLY file.
pub(crate) fn check_name(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply")) {
        return Ok(());
    }
    Err(FileError::UnknownExtension { path: path.to_owned(), expected: ".ply" }.into())
}

impl Trained {
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let splats = read_ply(path)?;
        if splats.is_empty() {
            return Err(Failure::work(anyhow!("{} holds no splats; train it again", display(path))));
        }
        let beside = water_beside(path);
        let medium = match beside.is_file() {
            true => known(&WaterFile::<Encoded>::read(&beside)?),
            false => Medium::Air,
        };
        Ok(Self { splats, medium })
    }

    /// Writes both, or the splats alone where there is no water; one that lay there was of the splats that are replaced.
    pub(crate) fn write(&self, path: &Path, from: &Path, overwrite: bool) -> Result<(), Failure> {
        let beside = water_beside(path);
        if let Medium::Learned(water) = &self.medium {
            let file = WaterFile::<Encoded> {
                from: vec![display(from).to_string()],
                depth_kind: DepthKind::Metres,
                estimate: Estimate::given(water.body().map_err(Failure::work)?),
            };
            file.write(&beside, overwrite)?;
        } else if overwrite && beside.is_file() {
            std::fs::remove_file(&beside).map_err(|error| {
                Failure::work(anyhow!("cannot remove the old water {}: {error}", display(&beside)))
            })?;
        }
        Ok(write_ply(path, &self.splats, overwrite)?)
    }
}

/// A water to look through; a unit of the scene counts as a metre.
pub(crate) fn known(file: &WaterFile<Encoded>) -> Medium<f32> {
    Medium::Known { water: file.estimate.water, per_unit: 1.0 }
}
