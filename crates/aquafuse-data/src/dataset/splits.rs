//! Which images are to train on, and which to validate or test: as the dataset says, or else as its folders are called.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::str::FromStr;

use super::tree::Tree;
use super::yolo::splits_of_config;
use super::{Dataset, DatasetError, Index, Sample, named, split, stem};

/// A part of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Split {
    /// To train on.
    Train,
    /// To choose a model by.
    Val,
    /// To judge a model by.
    Test,
}

impl Split {
    /// All splits.
    pub const ALL: &'static [Self] = &[Self::Train, Self::Val, Self::Test];

    /// Its name on the command line and in manifests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Val => "val",
            Self::Test => "test",
        }
    }

    /// The split that a folder or a list of this name is of. `trainval` is of none.
    pub(super) fn of_name(name: &str) -> Option<Self> {
        let mut found = words(name).into_iter().filter_map(|word| match word.as_str() {
            "train" | "training" | "trainset" => Some(Self::Train),
            "val" | "valid" | "validation" | "validate" | "dev" | "eval" => Some(Self::Val),
            "test" | "testing" | "testset" => Some(Self::Test),
            _ => None,
        });
        let first = found.next()?;
        found.all(|other| other == first).then_some(first)
    }
}

/// The words of a name, in small letters, without the number of a year behind them: `Instances_train2017` has two.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in name.chars() {
        if !letter.is_alphabetic() || (was_small && letter.is_uppercase()) {
            words.push(String::new());
        }
        was_small = letter.is_lowercase();
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphabetic()) {
            word.extend(letter.to_lowercase());
        }
    }
    words
}

/// The splits that are multiplied; images of other splits are carried over unchanged.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Splits {
    /// Every image is multiplied, whatever its split.
    #[default]
    All,
    /// The images of these splits, and those that are of none.
    Only(BTreeSet<Split>),
}

impl Splits {
    /// Whether an image is multiplied.
    pub fn hold(&self, sample: &Sample) -> bool {
        match (self, sample.split) {
            (Self::All, _) | (_, None) => true,
            (Self::Only(splits), Some(split)) => splits.contains(&split),
        }
    }
}

impl fmt::Display for Splits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str("all"),
            Self::Only(splits) => {
                let names: Vec<&str> = splits.iter().map(|split| split.name()).collect();
                f.write_str(&names.join(","))
            }
        }
    }
}

impl FromStr for Splits {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self::All);
        }
        let split = |name: &str| {
            let found = Split::ALL.iter().copied().find(|split| split.name() == name.trim());
            found.ok_or_else(|| format!("{name:?} is not a split; give all, or some of train,val,test"))
        };
        Ok(Self::Only(text.split(',').map(split).collect::<Result<_, _>>()?))
    }
}

impl Dataset {
    /// How many images there are of each split; `None` for those of none.
    pub fn split_counts(&self) -> BTreeMap<Option<Split>, usize> {
        let mut counts = BTreeMap::new();
        for sample in &self.samples {
            let count: &mut usize = counts.entry(sample.split).or_default();
            *count = count.saturating_add(1);
        }
        counts
    }

    /// The splits to multiply: those that are given; else the training split, if there are others beside it, or all.
    ///
    /// # Errors
    ///
    /// [`DatasetError::NoSplit`] when the dataset has no image of a given split.
    pub fn splits(&self, given: Option<&Splits>) -> Result<Splits, DatasetError> {
        let counts = self.split_counts();
        let has = |split| counts.contains_key(&Some(split));
        match given {
            Some(Splits::Only(splits)) => match splits.iter().find(|split| !has(**split)) {
                Some(missing) => {
                    Err(DatasetError::NoSplit { root: self.root.clone(), split: missing.name() })
                }
                None => Ok(Splits::Only(splits.clone())),
            },
            Some(Splits::All) => Ok(Splits::All),
            None if has(Split::Train) && (has(Split::Val) || has(Split::Test)) => {
                Ok(Splits::Only([Split::Train].into()))
            }
            None => Ok(Splits::All),
        }
    }
}

/// Finds the split of each image, `samples` being sorted by key. An image that is in several lists and trained on by one of
/// them is of the training split.
pub(super) fn find(tree: &Tree, dataset: &mut Dataset) {
    let mut declared: BTreeMap<String, BTreeSet<Split>> = BTreeMap::new();
    let mut add = |key: &str, split| {
        declared.entry(key.to_owned()).or_default().insert(split);
    };
    let keys: BTreeSet<&str> = dataset.samples.iter().map(|sample| sample.key.as_str()).collect();
    let by_stem: BTreeMap<String, &str> = keys
        .iter()
        .map(|key| {
            let (folder, name) = split(key);
            (super::join(folder, stem(name)), *key)
        })
        .collect();
    let configs = dataset.indices.iter().filter_map(|index| match index {
        Index::Config { path } => tree.read(path).ok().flatten(),
        _ => None,
    });
    let configured: Vec<(Split, String)> = configs.flat_map(|text| splits_of_config(&text)).collect();
    for index in &dataset.indices {
        let path = index.path();
        let in_config = configured.iter().find(|(_, place)| named(place, |name| name == path).is_some());
        // The name of a file, and for COCO its folder's name: `train/_annotations.coco.json`.
        let of_name = || {
            let (folder, name) = split(path);
            Split::of_name(stem(name)).or_else(|| Split::of_name(split(folder).1))
        };
        let Some(of) = in_config.map(|(split, _)| *split).or_else(of_name) else { continue };
        match index {
            Index::Coco(file) => file.keys.iter().for_each(|key| add(key, of)),
            Index::Paths { .. } => {
                let text = tree.read(path).ok().flatten().unwrap_or_default();
                for line in text.lines() {
                    if let Some(key) = named(line.trim(), |name| keys.contains(name)) {
                        add(&key, of);
                    }
                }
            }
            Index::Stems { folder, .. } => {
                let text = tree.read(path).ok().flatten().unwrap_or_default();
                for name in text.lines().filter_map(|line| line.split_whitespace().next()) {
                    if let Some(key) = by_stem.get(&super::join(folder, name)) {
                        add(key, of);
                    }
                }
            }
            Index::Carried { .. } | Index::Config { .. } => {}
        }
    }
    // Folders that a configuration names.
    for (of, place) in &configured {
        let place = place.trim_start_matches("./").trim_end_matches('/').replace('\\', "/");
        let mut place = place.as_str();
        while !place.is_empty() && !keys.iter().any(|key| is_in(key, place)) {
            // Folders of another machine, or of the folder above, may stand before it.
            place = place.split_once('/').map_or("", |(_, rest)| rest);
        }
        if !place.is_empty() {
            keys.iter().filter(|key| is_in(key, place)).for_each(|key| add(key, *of));
        }
    }
    let holds_many = dataset.layout.holds_many();
    for sample in &mut dataset.samples {
        let by_folder = || {
            let (folder, name) = split(&sample.key);
            let of_file = if holds_many { Split::of_name(stem(name)) } else { None };
            of_file.or_else(|| folder.rsplit('/').find_map(Split::of_name))
        };
        sample.split = match declared.get(&sample.key) {
            Some(splits) => splits.first().copied(),
            None => by_folder(),
        };
    }
}

fn is_in(key: &str, folder: &str) -> bool {
    key.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_their_split_by_whole_words() {
        for (name, split) in [
            ("train", Some(Split::Train)),
            ("instances_train2017", Some(Split::Train)),
            ("Valid", Some(Split::Val)),
            ("validation-00000-of-00001", Some(Split::Val)),
            ("fish_test", Some(Split::Test)),
            ("testImages", Some(Split::Test)),
            ("trainval", None),
            ("train_val", None),
            ("valley", None),
            ("images", None),
            ("contest", None),
        ] {
            assert_eq!(Split::of_name(name), split, "{name}");
        }
    }

    #[test]
    fn splits_are_read_as_they_are_written() {
        for text in ["all", "train", "train,val", "train,val,test"] {
            assert_eq!(text.parse::<Splits>().unwrap().to_string(), text);
        }
        assert!("".parse::<Splits>().is_err() && "valid".parse::<Splits>().is_err());
    }
}
