//! Masks, and other images about images: each has the name of its image and is in a folder whose name says masks.
//!
//! `images/a.jpg` has `masks/a.png` or `masks/a_mask.png`; with a mask for each class, `masks/CLASS/a.png` too;
//! `train/a.jpg` has `train_labels/a.png`.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};

use super::places::{IMAGES, ONLY_IMAGES, is_one_of, without};
use super::tree::Tree;
use super::{Companion, Dataset, Fault, Sample, split, stem};

/// What the words of the names of folders of masks, or of maps, begin with.
const BEGINS: [&str; 11] = [
    "mask",
    "label",
    "annot",
    "segment",
    "groundtruth",
    "gtfine",
    "gtcoarse",
    "trimap",
    "semantic",
    "parsing",
    "matte",
];
/// Words that are whole.
const WORDS: [&str; 9] = ["gt", "gts", "seg", "segs", "ann", "anns", "lbl", "msk", "truth"];
/// Names of folders that hold maps of distance; other folders with such a word may say how deep a dive was.
const MAPS: [&str; 6] = ["depth", "depths", "depth_map", "depth_maps", "disparity", "disparities"];
/// Splits: a folder of images and the folder of their masks share one.
const SPLITS: [&str; 4] = ["train", "val", "test", "dev"];

/// Whether a folder of this name holds masks or maps.
fn names_masks(folder: &str) -> bool {
    let is_word =
        |word: &String| WORDS.contains(&word.as_str()) || BEGINS.iter().any(|begin| word.starts_with(begin));
    is_one_of(folder, &MAPS) || words(folder).iter().any(is_word)
}

/// The words of a name, in small letters: `trainMasks_png` has three, and `trainannot` two.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in name.chars() {
        if !letter.is_alphanumeric() || (was_small && letter.is_uppercase()) {
            words.push(String::new());
        }
        was_small = letter.is_lowercase();
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphanumeric()) {
            word.extend(letter.to_lowercase());
        }
    }
    let parts = words.iter().flat_map(|word| {
        let rest = SPLITS.iter().find_map(|split| word.strip_prefix(split)).filter(|rest| !rest.is_empty());
        [Some(word.as_str()), rest].into_iter().flatten().map(str::to_owned)
    });
    parts.collect()
}

/// The split that a name says, if it says one.
fn split_in(name: &str) -> Option<&'static str> {
    let words = words(name);
    SPLITS.into_iter().find(|split| words.iter().any(|word| word.starts_with(split)))
}

/// Whether a file stands where masks do: in a folder of masks, and in none of images below it.
pub(super) fn is_mask(path: &str) -> bool {
    let mut parts = split(path).0.rsplit('/');
    let last = parts.find(|part| names_masks(part) || is_one_of(part, &ONLY_IMAGES));
    last.is_some_and(names_masks)
}

/// What may stand behind the name of the image in that of its mask.
const ENDS: [&str; 12] = [
    "_mask",
    "-mask",
    "_masks",
    "_gt",
    "_seg",
    "_label",
    "_labels",
    "_labelids",
    "_segmentation",
    "_instance",
    "_semantic",
    "_depth",
];

/// The name that the image of a mask has, if the name of the mask says more than that.
pub(super) fn without_end(stem: &str) -> Option<&str> {
    let end = |end: &&str| {
        let at = stem.len().checked_sub(end.len()).filter(|at| *at > 0)?;
        stem.get(at..)?.eq_ignore_ascii_case(end).then(|| stem.get(..at))?
    };
    ENDS.iter().find_map(end)
}

/// The masks of a dataset, found by where their images stand and what those are called.
pub(super) struct Masks<'t>(HashMap<u64, Vec<&'t String>>);

impl<'t> Masks<'t> {
    pub(super) fn of(tree: &'t Tree) -> Self {
        let mut masks: HashMap<u64, Vec<&String>> = HashMap::new();
        for path in tree.pictures().filter(|path| is_mask(path)) {
            let (folder, name) = split(path);
            let names = [Some(stem(name)), without_end(stem(name))];
            for (rest, split) in rests_of_masks(folder) {
                let keys = names.into_iter().flatten().map(|name| digest(&rest, split, name));
                keys.for_each(|key| masks.entry(key).or_default().push(path));
            }
        }
        Self(masks)
    }

    /// The masks of an image.
    pub(super) fn of_image(&self, key: &str) -> Vec<&'t String> {
        let (folder, name) = split(key);
        let keys = rests_of_images(folder).into_iter().map(|(rest, split)| digest(&rest, split, stem(name)));
        let found: BTreeSet<&String> = keys.filter_map(|key| self.0.get(&key)).flatten().copied().collect();
        found.into_iter().filter(|mask| mask.as_str() != key).collect()
    }
}

/// A split that a folder is of, if it says one.
type Split = Option<&'static str>;

/// What a folder of masks shares with the folder of their images, and its split: the folder without the part that is
/// whose name says masks, and without one more, the class.
fn rests_of_masks(folder: &str) -> Vec<(String, Split)> {
    let parts: Vec<&str> = folder.split('/').collect();
    let named = (0..parts.len()).filter(|place| parts.get(*place).is_some_and(|part| names_masks(part)));
    let mut rests = Vec::new();
    for place in named {
        let of = parts.get(place).and_then(|part| split_in(part));
        let others: Vec<&str> =
            parts.iter().enumerate().filter(|(own, _)| *own != place).map(|(_, part)| *part).collect();
        rests.push((others.join("/"), of));
        rests.extend((0..others.len()).map(|class| (without(&others, class), of)));
    }
    rests
}

/// The same of a folder of images: the folder itself, and without a part whose name says images or a split.
fn rests_of_images(folder: &str) -> Vec<(String, Split)> {
    let parts: Vec<&str> = folder.split('/').collect();
    let named =
        |part: &str| is_one_of(part, &IMAGES) || words(part).iter().any(|word| word.starts_with("image"));
    let instead = parts.iter().enumerate().filter(|(_, part)| named(part) || split_in(part).is_some());
    let instead = instead.map(|(place, part)| (without(&parts, place), split_in(part)));
    std::iter::once((folder.to_owned(), None)).chain(instead).collect()
}

fn digest(rest: &str, split: Split, name: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    (rest.to_lowercase(), split, name.to_lowercase()).hash(&mut hasher);
    hasher.finish()
}

pub(super) fn evidence(tree: &Tree) -> Option<String> {
    let masks = Masks::of(tree);
    let is_image = |key: &&String| !is_mask(key);
    let mut found =
        tree.images().filter(is_image).filter_map(|key| Some((key, *masks.of_image(key).first()?)));
    let (key, mask) = found.next()?;
    Some(format!("{mask} is about {key}"))
}

/// Gives each image its masks, and takes the masks from the images.
pub(super) fn attach(tree: &Tree, dataset: &mut Dataset) {
    let masks = Masks::of(tree);
    let mut taken = BTreeSet::new();
    for sample in &mut dataset.samples {
        for mask in masks.of_image(&sample.key) {
            if !sample.companions.iter().any(|companion| companion.path == *mask) {
                sample.companions.push(Companion::carried(mask.clone()));
            }
            taken.insert(mask.clone());
        }
    }
    dataset.samples.retain(|sample| !taken.contains(&sample.key));
}

pub(super) fn read(tree: &Tree, dataset: &mut Dataset) {
    let masks = Masks::of(tree);
    let of_images: Vec<(&String, Vec<&String>)> =
        tree.images().filter(|key| !is_mask(key)).map(|key| (key, masks.of_image(key))).collect();
    let folders: BTreeSet<&str> =
        of_images.iter().filter(|(_, found)| !found.is_empty()).map(|(key, _)| split(key).0).collect();
    let mut left: BTreeSet<&String> = tree.pictures().filter(|path| is_mask(path)).collect();
    for &(key, ref found) in of_images.iter().filter(|(key, _)| folders.contains(split(key).0)) {
        let mut by_folder: BTreeMap<&str, usize> = BTreeMap::new();
        for mask in found {
            left.remove(mask);
            let count = by_folder.entry(split(mask).0).or_default();
            *count = count.saturating_add(1);
        }
        match by_folder.into_values().max() {
            None => dataset.faults.add(Fault::new(key, "it has no mask").of(key)),
            Some(1) => {}
            Some(n) => dataset
                .faults
                .add(Fault::new(key, format!("it has {n} masks with its name instead of one")).of(key)),
        }
        dataset.samples.push(Sample::new(key, Vec::new()));
    }
    for mask in left {
        dataset.faults.add(Fault::new(mask, "no image belongs to this mask"));
    }
}
