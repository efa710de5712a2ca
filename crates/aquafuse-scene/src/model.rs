//! A trained scene: splats and the medium they are seen through, in memory and on disk.
//!
//! On disk it is FILE.ply, and FILE.water.json beside it where a water was learned.

use std::path::{Path, PathBuf};

use aquafuse::depth::DepthKind;
use aquafuse::image::Encoded;
use aquafuse::waterbody::{AttenuationError, Estimate, VeilingLight, Waterbody};
use aquafuse_data::files::{FileError, display, write_bytes};
use aquafuse_data::image_file::ReadOptions;
use aquafuse_data::pipeline::{PixelEncoding, WaterEstimate};
use aquafuse_data::water_file::{WaterFile, WaterFileError};

use crate::files::{SceneFileError, ply_bytes, read_splats};
use crate::medium::Medium;
use crate::splats::Splats;

/// Splats and the medium they are seen through.
#[derive(Clone, Debug)]
pub struct Model {
    /// The splats.
    pub splats: Splats<f32>,
    /// Air, or the water of the scene.
    pub medium: Medium<f32>,
}

/// A trained scene cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The splats cannot be read or written.
    #[error(transparent)]
    Splats(#[from] SceneFileError),
    /// The water cannot be read or written.
    #[error(transparent)]
    Water(#[from] WaterFileError),
    /// The file has no splats.
    #[error("{} holds no splats; train it again", display(path))]
    NoSplats {
        /// The file.
        path: PathBuf,
    },
    /// Training ended in a water that is no water.
    #[error("the learned water is unusable: {0}. Train again with another seed")]
    LearnedWater(#[from] AttenuationError),
    /// The water of the splats that are replaced cannot be removed.
    #[error("cannot remove the old water {}: {cause}", display(path))]
    OldWater {
        /// The water's file.
        path: PathBuf,
        /// What the system said.
        cause: String,
    },
}

/// The water's name beside FILE.ply.
pub fn water_beside(path: &Path) -> PathBuf {
    path.with_extension("water.json")
}

/// Refuses a name that does not end in `.ply`.
///
/// # Errors
///
/// [`FileError::UnknownExtension`].
pub fn check_name(path: &Path) -> Result<(), FileError> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply")) {
        return Ok(());
    }
    Err(FileError::UnknownExtension { path: path.to_owned(), expected: ".ply" })
}

impl Model {
    /// Reads splats, and the water beside them if there is one.
    ///
    /// # Errors
    ///
    /// [`ModelError`] when one of them cannot be read, or there are no splats.
    pub fn read(path: &Path, reading: &ReadOptions) -> Result<Self, ModelError> {
        let splats = read_splats(path, reading)?;
        if splats.is_empty() {
            return Err(ModelError::NoSplats { path: path.to_owned() });
        }
        let beside = water_beside(path);
        let medium = match beside.is_file() {
            true => Medium::of_file(&WaterFile::read(&beside, PixelEncoding::Encoded)?),
            false => Medium::Air,
        };
        Ok(Self { splats, medium })
    }

    /// Writes the splats, and a learned water beside them; `from` is the scene that the water came from.
    ///
    /// Without a learned water, one that is there already belonged to the splats that are replaced: it is removed.
    /// A file that holds the same bytes already is left as it is.
    ///
    /// # Errors
    ///
    /// [`ModelError`] when a file holds something else and may not be replaced, or the system refuses.
    pub fn write(&self, path: &Path, from: &Path, overwrite: bool) -> Result<(), ModelError> {
        let beside = water_beside(path);
        if let Medium::Learned(water) = &self.medium {
            let file = WaterFile {
                from: vec![display(from).to_string()],
                depth_kind: DepthKind::Metres,
                estimate: Estimate::<Encoded>::given(water.body()?).into(),
            };
            write(&beside, file.to_text().as_bytes(), overwrite)?;
        } else if overwrite && beside.is_file() {
            std::fs::remove_file(&beside)
                .map_err(|error| ModelError::OldWater { path: beside.clone(), cause: error.to_string() })?;
        }
        Ok(write(path, &ply_bytes(&self.splats), overwrite)?)
    }
}

/// Writes a file that does not hold these bytes already.
fn write(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), FileError> {
    let holds = || std::fs::read(path).is_ok_and(|held| held == bytes);
    if !overwrite && holds() { Ok(()) } else { write_bytes(path, bytes, overwrite) }
}

impl Medium<f32> {
    /// The water of a file; a unit of the scene counts as a metre. Splats have encoded colours: a water of linear light
    /// keeps its coefficients, and its veiling light is encoded.
    pub fn of_file(file: &WaterFile) -> Self {
        let water = match file.estimate {
            WaterEstimate::Encoded(estimate) => estimate.water,
            WaterEstimate::Linear(Estimate { water, .. }) => Waterbody {
                veiling_light: VeilingLight::new(file.estimate.veiling_light_as_seen()),
                backscatter_coefficient: water.backscatter_coefficient,
                attenuation: water.attenuation,
            },
        };
        Self::Known { water, per_unit: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::Water;

    #[test]
    fn a_water_is_written_beside_its_splats_and_goes_with_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("reef.ply");
        let mut splats = Splats::<f32>::new(0);
        splats.push(&Splats::<f32>::ball(0, [1.0, 2.0, 3.0], 0.5, 0.5, [0.5; 3]));
        let water = Water::new([0.1, 0.4, 0.5], [0.3; 3], [0.5; 3]);
        let wet = Model { splats: splats.clone(), medium: Medium::Learned(water) };
        wet.write(&path, folder.path(), false).unwrap();
        assert!(matches!(Model::read(&path, &ReadOptions::default()).unwrap().medium, Medium::Known { .. }));
        wet.write(&path, folder.path(), false).unwrap();
        let other = Model { splats: Splats::new(0), ..wet.clone() };
        assert!(other.write(&path, folder.path(), false).is_err());

        let dry = Model { splats, medium: Medium::Air };
        dry.write(&path, folder.path(), true).unwrap();
        assert!(!water_beside(&path).exists());
        assert_eq!(Model::read(&path, &ReadOptions::default()).unwrap().medium, Medium::Air);
    }
}
