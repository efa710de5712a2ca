//! A variant made again from its manifest.

use std::path::{Path, PathBuf};

use aquafuse::depth::{DepthModel, Eq3, SuppliedKind};
use aquafuse::fusion::Options;

use super::depth::Maps;
use super::header::{Header, StoredDepth};
use super::line::Variant;
use super::manifest::{Manifest, Part};
use super::{AugmentError, DepthPlan, Draws, OnDoubtful, Recipe, Water, containers};
use crate::dataset::{Layout, inside, split};
use crate::depth_network::{DepthNetwork, NetworkKind, NetworkOptions};
use crate::files::{
    FileError, make_folder_within, refuse_inputs, sha256, sha256_of, stays_within, write_bytes,
};
use crate::image_file::{ImageFile, ReadOptions};
use crate::pipeline::{DepthEstimator, MapSize, PixelEncoding};
use crate::run::Budget;
use crate::water_file::WaterFileError;

/// What became of a variant that was to be made again.
#[derive(Debug)]
pub enum Replayed {
    /// It equals the manifest.
    Equal(PathBuf),
    /// It was there already and equals the manifest: an earlier replay made it.
    Kept(PathBuf),
    /// It differs from the manifest.
    Different(PathBuf),
    /// It could not be made.
    Failed(FileError),
}

/// Which variants to make again, from what and where to.
#[derive(Clone, Copy, Debug)]
pub struct Again<'a> {
    /// The variant with this path, or the variants of the image with this key; `None`: all.
    pub only: Option<&'a str>,
    /// The folder of the dataset; `None`: as in the manifest.
    pub dataset: Option<&'a Path>,
    /// The folder to write to.
    pub output: &'a Path,
    /// Make files again that exist, and replace them.
    pub overwrite: bool,
    /// How to read.
    pub reading: ReadOptions,
    /// The encoding that the manifest must be of.
    pub encoding: PixelEncoding,
    /// Seconds that reading the manifest's network of depth, or one image, may take; `None`: [`NetworkOptions::SECONDS`].
    pub network_seconds: Option<u32>,
}

/// Makes variants again, and gives `each` what became of them, one by one. The waters come from the manifest.
///
/// A variant that is there as the manifest says is kept, so that a replay that was stopped goes on.
///
/// # Errors
///
/// [`AugmentError`] when the manifest cannot be read, was written in another encoding, or no variant is of
/// that name.
pub fn replay(
    manifest: &Path,
    again: &Again<'_>,
    mut each: impl FnMut(Replayed),
) -> Result<(), AugmentError> {
    let Again { only, dataset, output, overwrite, reading, encoding, network_seconds } = *again;
    let mut stored = Manifest::open(manifest, &reading)?;
    let header = stored.header.clone();
    let recipe: Recipe = header.recipe(manifest, encoding, network_seconds)?;
    let settings = &header.settings;
    let unknown = || AugmentError::Manifest { path: manifest.to_owned(), line: 1 };
    let border = settings.border.parse().map_err(|_| unknown())?;
    let water_map = settings.water_map.parse().map_err(|_| unknown())?;
    let reading = ReadOptions { lenient: settings.lenient, border, water_map, ..reading };
    let mut remaker = Remaker {
        manifest,
        root: dataset.map_or_else(|| PathBuf::from(&header.dataset), Path::to_owned),
        output,
        overwrite,
        layout: Layout::from_name(&header.layout).ok_or_else(unknown)?,
        recipe: &recipe,
        maps: Maps::of(&recipe.depth, None)?,
        reading,
        budget: Budget::new(reading.max_memory),
    };
    let (mut is_found, mut is_carried) = (only.is_none(), false);
    let shown = stored.show(|part| {
        let Part::Entry(key, entry) = part else { return };
        is_carried |= only == Some(key) && entry.is_carried();
        for (variant, container) in entry.all_variants() {
            if only.is_none_or(|only| only == variant.key || only == variant.output) {
                is_found = true;
                each(remaker.remake(variant, container).unwrap_or_else(Replayed::Failed));
            }
        }
    });
    shown.map_err(|error| error.of(manifest))?;
    match only {
        Some(key) if !is_found => {
            let (path, key) = (manifest.to_owned(), key.to_owned());
            Err(if is_carried {
                AugmentError::Carried { path, key }
            } else {
                AugmentError::NoSuchKey { path, key }
            })
        }
        _ => Ok(()),
    }
}

/// Makes variants again, one after the other.
struct Remaker<'a> {
    manifest: &'a Path,
    /// The folder of the dataset.
    root: PathBuf,
    output: &'a Path,
    overwrite: bool,
    layout: Layout,
    recipe: &'a Recipe,
    maps: Maps,
    reading: ReadOptions,
    budget: Budget,
}

impl Remaker<'_> {
    /// Makes a variant again; `container` is the file that holds it where it is none itself.
    fn remake(&mut self, variant: &Variant, container: Option<&str>) -> Result<Replayed, FileError> {
        let named = |cause: &str| FileError::Damaged {
            path: self.manifest.to_owned(),
            cause: format!("{}: {cause}", variant.output),
        };
        let named_inside = |name: &str| inside(name).map_err(|cause| named(&format!("{name:?} is {cause}")));
        let key = named_inside(&variant.key)?;
        let within = named_inside(&variant.output)?;
        let path = self.output.join(&within);
        let none = || named("it refers to a water that it does not contain");
        let draw = variant.draw(self.recipe.waters.len()).ok_or_else(none)?;
        let water = self.recipe.water(draw).ok_or_else(none)?;
        let source = self.root.join(container.map_or_else(|| Ok(key.clone()), named_inside)?);
        if source.exists() && !stays_within(&self.root, &source) {
            return Err(FileError::LeadsOut { path: source });
        }
        refuse_inputs([path.as_path()], [source.as_path()])?;
        if !self.overwrite && self.is_there(&path, variant) {
            return Ok(Replayed::Kept(path));
        }
        let opened = match container {
            None => ImageFile::open(&source, &self.reading)?,
            Some(_) => containers::image_of(self.layout, &source, &key, &self.reading)?,
        };
        self.maps.know(&key)?;
        let read = self.recipe.read(opened, &self.maps.source(&key)?, &self.budget)?;
        let (image, _) = self.recipe.fused(&read, &water, draw);
        let bytes = self.recipe.encoded(image, &path)?;
        make_folder_within(self.output, split(&within).0)?;
        write_bytes(&path, &bytes, self.overwrite)?;
        let is_equal = sha256(&bytes) == variant.sha256;
        Ok(if is_equal { Replayed::Equal(path) } else { Replayed::Different(path) })
    }

    /// Whether an earlier replay made it.
    fn is_there(&self, path: &Path, variant: &Variant) -> bool {
        path.metadata().is_ok_and(|about| about.is_file() && about.len() == variant.bytes)
            && stays_within(self.output, path)
            && sha256_of(path).is_ok_and(|found| found == variant.sha256)
    }
}

impl Header {
    /// The recipe that it records.
    fn recipe(
        &self,
        manifest: &Path,
        wanted: PixelEncoding,
        network_seconds: Option<u32>,
    ) -> Result<Recipe, AugmentError> {
        let settings = &self.settings;
        let unknown = || AugmentError::Manifest { path: manifest.to_owned(), line: 1 };
        let encoding: PixelEncoding = self.encoding.parse().map_err(|_| unknown())?;
        if encoding != wanted {
            return Err(
                WaterFileError::Encoding { path: manifest.to_owned(), found: encoding, wanted }.into()
            );
        }
        let model = settings.model.parse().map_err(|_| unknown())?;
        let waters: Vec<Water> =
            self.waters.iter().map(|water| water.restored(manifest, encoding)).collect::<Result<_, _>>()?;
        let instead = self.instead.as_ref().map(|water| water.restored(manifest, encoding)).transpose()?;
        Ok(Recipe {
            waters,
            sea: self.sea,
            encoding,
            per_image: settings.per_image,
            draws: Draws {
                seed: settings.seed,
                with_replacement: settings.with_replacement,
                theta: settings.theta_range,
                alpha: settings.alpha_range,
            },
            options: Options::for_model(model).with_max_gain(settings.most_gain),
            smoothing: settings.smooth.parse().map_err(|_| unknown())?,
            depth: settings.depth.plan(network_seconds)?.ok_or_else(unknown)?,
            on_doubtful: instead.map_or(OnDoubtful::Flag, |water| OnDoubtful::Instead(Box::new(water))),
            on_bad_annotation: "",
            keep_originals: settings.keep_originals,
            keep_share: settings.keep_share,
            splits: settings.splits.parse().map_err(|_| unknown())?,
            quality: settings.quality,
        })
    }
}

impl StoredDepth {
    /// `None` where it is no record of ours.
    fn plan(&self, seconds: Option<u32>) -> Result<Option<DepthPlan>, FileError> {
        let estimated = |model: DepthModel| DepthPlan::Estimated(model.into());
        Ok(match self {
            Self::Eq3(mu) => Eq3::new(*mu).ok().map(|eq3| estimated(DepthModel::Eq3(eq3))),
            Self::Model(name) => name.parse().ok().map(estimated),
            Self::Network { file, sha256, kind, side } => {
                let kind = NetworkKind::ALL.iter().copied().find(|known| known.name() == kind);
                let options = NetworkOptions { kind, side: *side, seconds };
                let network = DepthNetwork::read(file.as_ref(), &options)?;
                if network.origin().1 != sha256 {
                    return Err(FileError::UnfitNetwork {
                        path: file.into(),
                        cause: "it is another file than the one that the images were made with".into(),
                        remedy: format!("Get the one whose SHA-256 is {sha256}"),
                    });
                }
                Some(DepthPlan::Estimated(DepthEstimator::Network(network)))
            }
            Self::Maps { folder, kind, is_scaled } => {
                kind.parse::<SuppliedKind>().ok().map(|kind| DepthPlan::Maps {
                    folder: folder.into(),
                    kind,
                    size: if *is_scaled { MapSize::Scaled } else { MapSize::Exact },
                })
            }
        })
    }
}

#[cfg(all(test, feature = "onnx"))]
mod tests;
