//! The variants of each image. What cannot be made is refused here.

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use aquafuse::waterbody::AttenuationError;

use super::{Augmentation, DepthPlan, Draws, Recipe, Sea};
use crate::dataset::{Companion, Dataset, Sample, Splits, join, split, stem};
use crate::files::display;
use crate::image_file::Format;

/// The variants of a dataset.
///
/// It stores the rule, and computes the variants image by image.
#[derive(Clone, Debug)]
pub struct Plan<'d> {
    dataset: &'d Dataset,
    /// The indices of the images that take part.
    indices: Vec<usize>,
    rule: Rule,
}

/// How variants are drawn and named.
#[derive(Clone, Debug)]
struct Rule {
    draws: Draws,
    /// How waters are called in names, as far as they are not of the sea; a draw chooses one of `choices`.
    slugs: Vec<String>,
    choices: usize,
    /// Variants of each image; none of files of many, of which is not known what they hold before they are read.
    per_image: u32,
    keep_originals: bool,
    keep_share: f64,
    splits: Splits,
}

impl<'d> Plan<'d> {
    /// The files of the dataset that take part.
    pub fn files(&self) -> usize {
        self.indices.len()
    }

    /// Variants of them; 0 where [files hold many](crate::dataset::Layout::holds_many), which are not opened yet.
    pub fn variants(&self) -> usize {
        let multiplied = self.files().saturating_sub(self.carried());
        multiplied.saturating_mul(usize::try_from(self.rule.per_image).unwrap_or(usize::MAX))
    }

    /// The files that are copied beside their variants; 0 where files hold many.
    pub fn originals(&self) -> usize {
        let is_copied = |sample: &&Sample| self.rule.splits.hold(sample) && self.rule.keeps(sample);
        if self.rule.per_image == 0 { 0 } else { self.samples().filter(is_copied).count() }
    }

    /// The files that are carried over unchanged, because their split is not multiplied.
    pub fn carried(&self) -> usize {
        self.samples().filter(|sample| !self.rule.splits.hold(sample)).count()
    }

    /// The indices of those files in the dataset.
    pub(super) fn indices(&self) -> &[usize] {
        &self.indices
    }

    /// Those files.
    pub(super) fn samples(&self) -> impl Iterator<Item = &'d Sample> {
        self.indices.iter().filter_map(|&index| self.dataset.samples.get(index))
    }

    /// The variants of the image of an index.
    pub(super) fn planned(&self, index: usize) -> Option<Planned<'d>> {
        Some(self.rule.planned(self.dataset.samples.get(index)?, index))
    }

    /// The folders that outputs go to.
    pub(super) fn folders(&self) -> BTreeSet<String> {
        let mut folders = BTreeSet::new();
        for planned in self.indices.iter().filter_map(|&index| self.planned(index)) {
            for folder in planned.folders().filter(|&folder| !folders.contains(folder)).collect::<Vec<_>>() {
                folders.insert(folder.to_owned());
            }
        }
        folders
    }
}

/// An image, and what is to be made of it.
#[derive(Clone, Debug)]
pub(super) struct Planned<'a> {
    /// Its index in the dataset.
    pub(super) index: usize,
    pub(super) key: &'a str,
    pub(super) companions: &'a [Companion],
    pub(super) variants: Vec<PlannedVariant>,
    /// Whether it is carried over unchanged, because its split is not multiplied.
    pub(super) is_carried: bool,
}

/// A variant that is to be made.
#[derive(Clone, Debug)]
pub(super) struct PlannedVariant {
    pub(super) number: u32,
    /// Its path within the output.
    pub(super) output: String,
    /// Where its companions go, in their order.
    pub(super) companions: Vec<String>,
}

impl Planned<'_> {
    /// The folders that its outputs go to.
    fn folders(&self) -> impl Iterator<Item = &str> {
        let own = self.companions.iter().map(|companion| companion.path.as_str());
        let new = self.variants.iter().map(|variant| variant.output.as_str());
        own.chain(new).chain([self.key]).map(|path| split(path).0)
    }
}

impl Rule {
    fn planned<'a>(&self, sample: &'a Sample, index: usize) -> Planned<'a> {
        let variants = (0..self.count(sample)).map(|number| self.variant(sample, number)).collect();
        let is_carried = !self.splits.hold(sample);
        Planned { index, key: &sample.key, companions: &sample.companions, variants, is_carried }
    }

    /// How many variants an image has.
    fn count(&self, sample: &Sample) -> u32 {
        if self.splits.hold(sample) { self.per_image } else { 0 }
    }

    fn variant(&self, sample: &Sample, number: u32) -> PlannedVariant {
        let draw = self.draws.draw(&sample.key, number, self.choices);
        let slug = self.slugs.get(draw.water).map_or(Sea::SLUG, String::as_str);
        let (folder, name) = split(&sample.key);
        let new_stem = format!("{}__{slug}__{number}", stem(name));
        let output = join(folder, &format!("{new_stem}.{}", extension(name)));
        let companion = |companion: &Companion| {
            let (folder, name_of) = split(&companion.path);
            // `NAME.jpg.txt` is of `NAME.jpg`, whatever that becomes.
            let whole = name_of.strip_prefix(name).filter(|rest| rest.starts_with('.'));
            if let Some(rest) = whole {
                return join(folder, &format!("{}{rest}", split(&output).1));
            }
            let rest = name_of.strip_prefix(stem(name)).filter(|rest| rest.starts_with(['.', '_', '-']));
            let rest =
                rest.or_else(|| name_of.rfind('.').and_then(|at| name_of.get(at..))).unwrap_or_default();
            join(folder, &format!("{new_stem}{rest}"))
        };
        let companions = sample.companions.iter().map(companion).collect();
        PlannedVariant { number, output, companions }
    }

    /// Whether an image is copied beside its variants.
    fn keeps(&self, sample: &Sample) -> bool {
        self.keep_originals || self.draws.keeps(&sample.key, self.per_image, self.keep_share)
    }

    /// The images that are made of one.
    fn outputs(&self, sample: &Sample) -> impl Iterator<Item = String> {
        let is_kept = !self.splits.hold(sample) || self.keeps(sample);
        let own = is_kept.then(|| sample.key.clone());
        let variants: Vec<String> =
            (0..self.count(sample)).map(|number| self.variant(sample, number).output).collect();
        own.into_iter().chain(variants)
    }

    /// Refuses two images that would make one file.
    fn check_names<'a>(&self, samples: impl Iterator<Item = &'a Sample> + Clone) -> Result<(), PlanError> {
        let digest = |output: &String| {
            let mut hasher = DefaultHasher::new();
            output.hash(&mut hasher);
            hasher.finish()
        };
        // Names themselves are held only where digests say that some may be equal: datasets are large.
        let mut digests: Vec<u64> =
            samples.clone().flat_map(|sample| self.outputs(sample)).map(|output| digest(&output)).collect();
        digests.sort_unstable();
        if !digests.windows(2).any(|pair| pair.first() == pair.last()) {
            return Ok(());
        }
        let mut owners: BTreeMap<String, &str> = BTreeMap::new();
        for sample in samples {
            for output in self.outputs(sample) {
                if let Some(other) = owners.insert(output.clone(), &sample.key) {
                    let (one, other) = (sample.key.clone(), other.to_owned());
                    return Err(PlanError::OneName { one, other, output });
                }
            }
        }
        Ok(())
    }
}

/// The requested variants cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Two variants would have one name.
    #[error("{one} and {other} would both be written to {output}; rename one of them")]
    OneName {
        /// An image.
        one: String,
        /// Another one.
        other: String,
        /// The name.
        output: String,
    },
    /// Some variants of an image would be equal.
    #[error(
        "{per_image} variants per image from only {waters} waters, without a range of theta or alpha: some would be equal. \
         Give more waters, a range, or a smaller --per-image"
    )]
    Equal {
        /// Variants.
        per_image: u32,
        /// Waters.
        waters: usize,
    },
    /// A share is none.
    #[error("{share} of the images cannot be copies of originals; give a share from 0 to 1")]
    Share {
        /// What was given.
        share: f64,
    },
    /// A water of the sea is impossible per unit of this depth.
    #[error("waters of the sea cannot be drawn: {0}; give another --metres-at-one or --visibility")]
    Sea(#[from] AttenuationError),
    /// Depth maps for images in files that hold many.
    #[error("images in shards or tables cannot be matched to depth maps; unpack them, or leave --depth out")]
    MapsOfMany,
    /// A Parquet table is requested from a build that cannot write it.
    #[error(
        "this build cannot write Parquet; build with --features parquet, or leave --manifest parquet out"
    )]
    NotBuilt,
    /// There is no water to sample.
    #[error(
        "every water is doubtful, and doubtful waters are skipped; give other waters, or --on-doubtful flag"
    )]
    NoWater,
    /// The output lies in the dataset, or the other way round.
    #[error(
        "one of {} and {} contains the other; give an output elsewhere",
        display(dataset),
        display(output)
    )]
    Nested {
        /// The dataset.
        dataset: PathBuf,
        /// The output.
        output: PathBuf,
    },
    /// The output holds something else.
    #[error("{} holds files but no manifest of `aquafuse augment`; give a new folder", display(output))]
    Foreign {
        /// The output.
        output: PathBuf,
    },
}

impl Recipe {
    /// How many waters a draw chooses from: the sea is as many as all others, so that every second variant is in a water of its.
    pub(super) fn choices(&self) -> usize {
        let named = self.waters.len();
        named.saturating_add(self.sea.map_or(0, |_| named.max(1)))
    }
}

impl Augmentation {
    /// The variants of each image of the shard. Nothing is written.
    ///
    /// # Errors
    ///
    /// [`PlanError`] when it cannot be made.
    pub fn plan(&self) -> Result<Plan<'_>, PlanError> {
        if cfg!(not(feature = "parquet")) && self.manifest_table {
            return Err(PlanError::NotBuilt);
        }
        let recipe = &self.recipe;
        let draws = &recipe.draws;
        if recipe.choices() == 0 {
            return Err(PlanError::NoWater);
        }
        let many = usize::try_from(recipe.per_image).unwrap_or(usize::MAX);
        let is_only_sea = recipe.waters.is_empty();
        if draws.are_fixed() && !draws.with_replacement && many > recipe.choices() && !is_only_sea {
            let (per_image, waters) = (recipe.per_image, recipe.choices());
            return Err(PlanError::Equal { per_image, waters });
        }
        if !(0.0..=1.0).contains(&recipe.keep_share) {
            return Err(PlanError::Share { share: recipe.keep_share });
        }
        if let Some(sea) = &recipe.sea {
            sea.water(0, recipe.encoding)?;
        }
        if self.dataset.layout.holds_many() && matches!(recipe.depth, DepthPlan::Maps { .. }) {
            return Err(PlanError::MapsOfMany);
        }
        self.check_place()?;
        let rule = Rule {
            draws: *draws,
            slugs: recipe.waters.iter().map(super::Water::slug).collect(),
            choices: recipe.choices(),
            per_image: if self.dataset.layout.holds_many() { 0 } else { recipe.per_image },
            keep_originals: recipe.keep_originals,
            keep_share: recipe.keep_share,
            splits: recipe.splits.clone(),
        };
        let holds = |sample: &Sample| self.shard.holds(&sample.key);
        let all = self.dataset.samples.iter();
        rule.check_names(all.clone().filter(|sample| holds(sample)))?;
        let indices = all.enumerate().filter(|(_, sample)| holds(sample)).map(|(index, _)| index).collect();
        Ok(Plan { dataset: &self.dataset, indices, rule })
    }

    /// Refuses an output that is not ours to fill.
    fn check_place(&self) -> Result<(), PlanError> {
        let (dataset, output) = (self.dataset.root.clone(), self.output.clone());
        let Ok(there) = output.canonicalize() else {
            // Not there yet: it lies where its parent does.
            let inside = std::path::absolute(&output).ok().zip(std::path::absolute(&dataset).ok());
            return match inside {
                Some((out, set)) if out.starts_with(&set) => Err(PlanError::Nested { dataset, output }),
                _ => Ok(()),
            };
        };
        if let Ok(set) = dataset.canonicalize()
            && (there.starts_with(&set) || set.starts_with(&there))
        {
            return Err(PlanError::Nested { dataset, output });
        }
        let mut names = std::fs::read_dir(&there)
            .into_iter()
            .flatten()
            .filter_map(Result::ok)
            .map(|entry| entry.file_name());
        let is_ours = super::journal::manifests(&there).is_ok_and(|found| !found.is_empty());
        match is_ours || names.all(|name| name.as_encoded_bytes().starts_with(b".")) {
            true => Ok(()),
            false => Err(PlanError::Foreign { output }),
        }
    }
}

/// The extension of a variant: its image's own, if we write that format.
fn extension(name: &str) -> &str {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    let is_image = Format::of(name.as_ref()).is_some();
    if is_image && Format::written(name.as_ref()).is_none() { "png" } else { extension }
}
