//! What belongs to all images: the manifest's first line, and the files about the whole dataset.

use std::io::{self, ErrorKind};

use super::annotations::{self, Made};
use super::header::{Header, Settings, StoredDepth};
use super::journal::{Journal, Slot};
use super::line::Written;
use super::{Augmentation, DepthPlan, Draws, OnDoubtful, Plan, Water};
use crate::dataset::{join, split};
use crate::files::Hashed;
use crate::files::{FileError, make_folder_within, write_atomically};
use crate::pipeline::MapSize;

impl Augmentation {
    /// The first line of the manifest.
    pub(super) fn header(&self) -> Header {
        let Self { dataset, recipe, .. } = self;
        let Draws { seed, with_replacement, theta, alpha } = recipe.draws;
        let settings = Settings {
            seed,
            per_image: recipe.per_image,
            with_replacement,
            theta_range: theta,
            alpha_range: alpha,
            model: recipe.options.model.name().to_owned(),
            most_gain: recipe.options.max_gain,
            smooth: recipe.smoothing.name().to_owned(),
            depth: StoredDepth::of(&recipe.depth),
            on_doubtful: match &recipe.on_doubtful {
                OnDoubtful::Flag => "flag".to_owned(),
                OnDoubtful::Skip => "skip".to_owned(),
                OnDoubtful::Instead(water) => water.name.clone(),
            },
            on_bad_annotation: recipe.on_bad_annotation.to_owned(),
            keep_originals: recipe.keep_originals,
            keep_share: recipe.keep_share,
            splits: recipe.splits.to_string(),
            quality: recipe.quality,
            lenient: self.run_options.reading.lenient,
            border: self.run_options.reading.border.to_string(),
            water_map: self.run_options.reading.water_map.name().to_owned(),
        };
        let instead = match &recipe.on_doubtful {
            OnDoubtful::Instead(water) => Some(water.stored()),
            _ => None,
        };
        let waters = recipe.waters.iter().map(Water::stored).collect();
        let root = dataset.root.to_string_lossy().into_owned();
        Header::new(
            root,
            dataset.layout.name(),
            recipe.encoding.name(),
            settings,
            waters,
            recipe.sea,
            instead,
        )
    }

    /// Writes the files about all images, for what was made of them.
    pub(super) fn write_indices(
        &self,
        plan: &Plan<'_>,
        journal: &Journal,
    ) -> Result<Vec<Written>, FileError> {
        let variants = |place: usize| {
            let slots = journal.slots(place);
            let is_made = slots.iter().any(|slot| matches!(slot, Slot::Original | Slot::Variant(_)));
            let planned = plan.planned(place).filter(|_| is_made)?;
            let made = planned.variants.into_iter().map(|variant| (variant.number, variant.output));
            Some(made.filter(|(number, _)| slots.contains(&Slot::Variant(*number))).collect())
        };
        let made = Made {
            samples: &self.dataset.samples,
            variants: &variants,
            per_image: self.recipe.per_image,
            originals: self.recipe.keep_originals,
            keeps: &|sample| !self.recipe.splits.hold(sample) || self.recipe.keeps(&sample.key, true),
        };
        let write = |index: &crate::dataset::Index| {
            let bytes = index.read(&self.dataset.root, &self.run_options.reading)?;
            let (folder, name) = split(index.path());
            // Files that say where images are, or nothing of them, are the same for every shard.
            let name = match (index.is_shared(), name.rsplit_once('.')) {
                (false, Some((stem, extension))) => format!("{stem}{}.{extension}", self.shard.infix()),
                _ => name.to_owned(),
            };
            let output = join(folder, &name);
            make_folder_within(&self.output, folder)?;
            let path = self.output.join(&output);
            let (mut digest, mut changed) = ((0, String::new()), None);
            let result = write_atomically(&path, true, |out| -> io::Result<()> {
                let mut hashed = Hashed::new(out);
                let written = annotations::write(index, &bytes, &made, &mut hashed);
                digest = hashed.result();
                changed = written
                    .as_ref()
                    .err()
                    .filter(|error| error.kind() == ErrorKind::InvalidData)
                    .map(ToString::to_string);
                written
            });
            if let Some(cause) = changed {
                let path = self.dataset.root.join(index.path());
                return Err(FileError::Damaged { path, cause });
            }
            result?;
            let (bytes, sha256) = digest;
            Ok(Written { output, bytes, sha256 })
        };
        let mut written: Vec<Written> =
            self.dataset.indices.iter().map(write).collect::<Result<_, FileError>>()?;
        #[cfg(feature = "parquet")]
        if self.manifest_table {
            let (name, header) = (self.shard.manifest_table(), self.header());
            let entries = plan.indices().iter().map(|&place| journal.entry(place));
            written.push(super::manifest_table::write(&self.output, name, &header, entries)?);
        }
        written.extend(self.write_preview(plan, journal)?);
        written.sort_by(|a, b| a.output.cmp(&b.output));
        Ok(written)
    }
}

impl StoredDepth {
    fn of(plan: &DepthPlan) -> Self {
        use aquafuse::depth::DepthModel;

        use crate::depth_network::NetworkKind;
        use crate::pipeline::DepthEstimator;

        match plan {
            DepthPlan::Estimated(DepthEstimator::Colour(DepthModel::Eq3(fitted))) => Self::Eq3(fitted.mu),
            DepthPlan::Estimated(DepthEstimator::Colour(model)) => Self::Model(model.name().to_owned()),
            DepthPlan::Estimated(DepthEstimator::Network(network)) => {
                let (file, sha256, options) = network.origin();
                Self::Network {
                    file: file.to_string_lossy().into_owned(),
                    sha256: sha256.to_owned(),
                    kind: options.kind.map_or("", NetworkKind::name).to_owned(),
                    side: options.side,
                }
            }
            DepthPlan::Maps { folder, kind, size } => Self::Maps {
                folder: folder.to_string_lossy().into_owned(),
                kind: kind.name().to_owned(),
                is_scaled: *size == MapSize::Scaled,
            },
        }
    }
}
