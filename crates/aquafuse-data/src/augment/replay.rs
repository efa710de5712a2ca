//! A variant made again from its manifest.

use std::path::{Path, PathBuf};

use aquafuse::depth::{DepthModel, Eq3, SuppliedKind};
use aquafuse::fusion::Options;

use super::header::{Header, StoredDepth};
use super::line::Variant;
use super::manifest::Manifest;
use super::{AugmentError, DepthPlan, Draws, OnDoubtful, Recipe, Water, depth};
use crate::dataset::{Layout, inside, split};
use crate::depth_network::{DepthNetwork, NetworkKind, NetworkOptions};
use crate::files::{FileError, make_folder_within, refuse_inputs, sha256, stays_within, write_bytes};
use crate::image_file::{ImageFile, ReadOptions};
use crate::pipeline::{DepthEstimator, MapSize, PixelEncoding};
use crate::run::Budget;
use crate::water_file::WaterFileError;

/// The outcome of making variants again.
#[derive(Debug, Default)]
pub struct Replayed {
    /// Files that equal the manifest.
    pub equal: Vec<PathBuf>,
    /// Files that differ from the manifest.
    pub different: Vec<PathBuf>,
    /// Variants that failed, and why.
    pub failed: Vec<(String, FileError)>,
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
    /// Replace files that exist.
    pub overwrite: bool,
    /// How to read.
    pub reading: ReadOptions,
    /// The encoding that the manifest must be of.
    pub encoding: PixelEncoding,
}

/// Makes variants again. The waters come from the manifest.
///
/// # Errors
///
/// [`AugmentError`] when the manifest cannot be read, was written in another encoding, or no variant is of
/// that name.
pub fn replay(manifest: &Path, again: &Again<'_>) -> Result<Replayed, AugmentError> {
    let Again { only, dataset, output, overwrite, reading, encoding } = *again;
    let found = Manifest::read(manifest, &reading)?;
    let recipe: Recipe = found.header.recipe(manifest, encoding)?;
    let settings = &found.header.settings;
    let border = settings.border.parse();
    let border = border.map_err(|_| AugmentError::Manifest { path: manifest.to_owned(), line: 1 })?;
    let reading = ReadOptions { lenient: settings.lenient, border, ..reading };
    let root = dataset.map_or_else(|| PathBuf::from(&found.header.dataset), Path::to_owned);
    let wanted = |variant: &Variant| only.is_none_or(|only| only == variant.key || only == variant.output);
    let variants: Vec<(&Variant, Option<&str>)> =
        found.variants().filter(|(variant, _)| wanted(variant)).collect();
    if let (true, Some(only)) = (variants.is_empty(), only) {
        if found.is_carried(only) {
            return Err(AugmentError::Carried { path: manifest.to_owned(), key: only.to_owned() });
        }
        return Err(AugmentError::NoSuchKey { path: manifest.to_owned(), key: only.to_owned() });
    }
    let maps = depth::Maps::of(&recipe.depth, variants.iter().map(|(variant, _)| variant.key.as_str()))?;
    let layout = Layout::from_name(&found.header.layout);
    let layout = layout.ok_or_else(|| AugmentError::Manifest { path: manifest.to_owned(), line: 1 })?;
    let budget = Budget::new(reading.max_memory);
    let mut replayed = Replayed::default();
    for (variant, container) in variants {
        let make = || {
            let named = |cause: &str| FileError::Damaged {
                path: manifest.to_owned(),
                cause: format!("{}: {cause}", variant.output),
            };
            let named_inside =
                |name: &str| inside(name).map_err(|cause| named(&format!("{name:?} is {cause}")));
            let key = named_inside(&variant.key)?;
            let within = named_inside(&variant.output)?;
            let path = output.join(&within);
            let none = || named("it refers to a water that it does not contain");
            let draw = variant.draw(recipe.waters.len()).ok_or_else(none)?;
            let water = recipe.water(draw).ok_or_else(none)?;
            let source = root.join(container.map_or_else(|| Ok(key.clone()), named_inside)?);
            if source.exists() && !stays_within(&root, &source) {
                return Err(FileError::LeadsOut { path: source });
            }
            refuse_inputs([path.as_path()], [source.as_path()])?;
            let opened = match container {
                None => ImageFile::open(&source, &reading)?,
                Some(_) => super::containers::image_of(layout, &source, &key, &reading)?,
            };
            let read = recipe.read(opened, &maps.source(&key)?, &budget)?;
            let (image, _) = recipe.fused(&read, &water, draw);
            let bytes = recipe.encoded(image, &path)?;
            make_folder_within(output, split(&within).0)?;
            write_bytes(&path, &bytes, overwrite)?;
            Ok((path, sha256(&bytes) == variant.sha256))
        };
        match make() {
            Ok((path, true)) => replayed.equal.push(path),
            Ok((path, false)) => replayed.different.push(path),
            Err(error) => replayed.failed.push((variant.output.clone(), error)),
        }
    }
    Ok(replayed)
}

impl Header {
    /// The recipe that it records.
    fn recipe(&self, manifest: &Path, wanted: PixelEncoding) -> Result<Recipe, AugmentError> {
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
            depth: settings.depth.plan()?.ok_or_else(unknown)?,
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
    fn plan(&self) -> Result<Option<DepthPlan>, FileError> {
        let estimated = |model: DepthModel| DepthPlan::Estimated(model.into());
        Ok(match self {
            Self::Eq3(mu) => Eq3::new(*mu).ok().map(|eq3| estimated(DepthModel::Eq3(eq3))),
            Self::Model(name) => name.parse().ok().map(estimated),
            Self::Network { file, sha256, kind, side } => {
                let kind = NetworkKind::ALL.iter().copied().find(|known| known.name() == kind);
                let network = DepthNetwork::read(file.as_ref(), &NetworkOptions { kind, side: *side })?;
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
