//! What is to be made of each picture: refused here where it cannot be.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use super::{Augmentation, DepthPlan, Draw};
use crate::dataset::{Companion, join, split, stem};
use crate::picture::{Format, shown};
use crate::treatment::Space;

/// What is to be made of a data set, in full.
#[derive(Clone, Debug)]
pub struct Plan(pub(super) Vec<Planned>);

impl Plan {
    /// The files of the data set that take part.
    pub fn files(&self) -> usize {
        self.0.len()
    }

    /// Variants of them; 0 where [files hold many](crate::dataset::Layout::holds_many), which are not opened yet.
    pub fn variants(&self) -> usize {
        self.0.iter().map(|sample| sample.variants.len()).fold(0, usize::saturating_add)
    }
}

/// A picture, and what is to be made of it.
#[derive(Clone, Debug)]
pub(super) struct Planned {
    pub(super) key: String,
    pub(super) companions: Vec<Companion>,
    pub(super) variants: Vec<PlannedVariant>,
}

/// A variant that is to be made.
#[derive(Clone, Debug)]
pub(super) struct PlannedVariant {
    pub(super) number: u32,
    pub(super) draw: Draw,
    /// Its path within the output.
    pub(super) output: String,
    /// Where its companions go, in their order.
    pub(super) companions: Vec<String>,
}

impl Planned {
    /// The folders that its outputs go to.
    fn folders(&self) -> impl Iterator<Item = &str> {
        let own = self.companions.iter().map(|companion| companion.path.as_str());
        let new = self.variants.iter().map(|variant| variant.output.as_str());
        own.chain(new).chain([self.key.as_str()]).map(|path| split(path).0)
    }
}

/// What is to be made cannot be.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Two variants would have one name.
    #[error("{one} and {other} would both make {output}; rename one of them")]
    OneName {
        /// A picture.
        one: String,
        /// Another one.
        other: String,
        /// The name.
        output: String,
    },
    /// Some variants of a picture would be equal.
    #[error(
        "{per_image} variants of a picture, but only {waters} waters and neither a range of theta nor one of alpha: \
         some would be equal. Give more waters, a range, or a smaller --per-image"
    )]
    Equal {
        /// Variants.
        per_image: u32,
        /// Waters.
        waters: usize,
    },
    /// Depth maps of pictures that stand in files of many.
    #[error(
        "depth maps cannot be told apart for pictures in shards or tables; unpack them, or leave --depth out"
    )]
    MapsOfMany,
    /// A table is asked for of a build that writes none.
    #[error(
        "this build writes no Parquet; build it with --features parquet, or leave --manifest parquet out"
    )]
    NotBuilt,
    /// There is no water to draw.
    #[error("every water is doubtful, and doubtful ones are skipped; give others, or --on-doubtful flag")]
    NoWater,
    /// The output lies in the data set, or the other way round.
    #[error("{} and {} lie in one another; give an output elsewhere", shown(dataset), shown(output))]
    Nested {
        /// The data set.
        dataset: PathBuf,
        /// The output.
        output: PathBuf,
    },
    /// The output holds something else.
    #[error("{} holds files, and no manifest of ours; give a new folder", shown(output))]
    Foreign {
        /// The output.
        output: PathBuf,
    },
}

impl<E: Space> Augmentation<E> {
    /// What is to be made of each picture of the shard. Nothing is written.
    ///
    /// # Errors
    ///
    /// [`PlanError`] when it cannot be made.
    pub fn plan(&self) -> Result<Plan, PlanError> {
        if cfg!(not(feature = "parquet")) && self.conduct.manifest_table {
            return Err(PlanError::NotBuilt);
        }
        let recipe = &self.recipe;
        let draws = &recipe.draws;
        if recipe.waters.is_empty() {
            return Err(PlanError::NoWater);
        }
        let fixed = draws.theta.0 == draws.theta.1 && draws.alpha.0 == draws.alpha.1;
        let many = usize::try_from(recipe.per_image).unwrap_or(usize::MAX);
        if fixed && !draws.with_replacement && many > recipe.waters.len() {
            let (per_image, waters) = (recipe.per_image, recipe.waters.len());
            return Err(PlanError::Equal { per_image, waters });
        }
        if self.dataset.layout.holds_many() && matches!(recipe.depth, DepthPlan::Maps { .. }) {
            return Err(PlanError::MapsOfMany);
        }
        self.check_place()?;
        let slugs: Vec<String> = recipe.waters.iter().map(super::Water::slug).collect();
        let mut owners: BTreeMap<String, &str> = BTreeMap::new();
        let mut plan = Vec::new();
        for sample in self.dataset.samples.iter().filter(|sample| self.shard.holds(&sample.key)) {
            let variant = |number| {
                let draw = draws.draw(&sample.key, number, slugs.len());
                let slug = slugs.get(draw.water).map_or("", String::as_str);
                let (folder, name) = split(&sample.key);
                let new_stem = format!("{}__{slug}__{number}", stem(name));
                let output = join(folder, &format!("{new_stem}.{}", extension(name)));
                let companion = |companion: &Companion| {
                    let (folder, name_of) = split(&companion.path);
                    let rest =
                        name_of.strip_prefix(stem(name)).filter(|rest| rest.starts_with(['.', '_', '-']));
                    let rest = rest.map_or_else(|| format!(".{}", extension(name_of)), str::to_owned);
                    join(folder, &format!("{new_stem}{rest}"))
                };
                let companions = sample.companions.iter().map(companion).collect();
                PlannedVariant { number, draw, output, companions }
            };
            // What is in a file of many is not known before it is read.
            let many = if self.dataset.layout.holds_many() { 0 } else { recipe.per_image };
            let variants: Vec<PlannedVariant> = (0..many).map(variant).collect();
            let own = recipe.keep_originals.then_some(&sample.key).into_iter();
            for output in own.chain(variants.iter().map(|variant| &variant.output)) {
                if let Some(other) = owners.insert(output.clone(), &sample.key) {
                    let (one, other) = (sample.key.clone(), other.to_owned());
                    return Err(PlanError::OneName { one, other, output: output.clone() });
                }
            }
            let (key, companions) = (sample.key.clone(), sample.companions.clone());
            plan.push(Planned { key, companions, variants });
        }
        Ok(Plan(plan))
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

/// The folders that outputs go to.
pub(super) fn folders(plan: &[Planned]) -> BTreeSet<&str> {
    plan.iter().flat_map(Planned::folders).collect()
}

/// The extension of a variant: that of its picture, if we write that format.
fn extension(name: &str) -> &str {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    let is_picture = Format::of(name.as_ref()).is_some();
    if is_picture && Format::written(name.as_ref()).is_none() { "png" } else { extension }
}
