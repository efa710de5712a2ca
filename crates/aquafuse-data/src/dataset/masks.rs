//! Masks, and other images about images: each is called as its image, in a folder that is called as masks are.
//!
//! `images/a.jpg` has `masks/a.png` or `masks/a_mask.png`; with a mask for each class, `masks/CLASS/a.png` too.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::places::{self, about, is_in};
use super::tree::Tree;
use super::{Companion, Dataset, Fault, Sample, split, stem};

/// What folders of masks, and of other images about images, are called.
pub(super) const NAMES: [&str; 22] = [
    "masks",
    "mask",
    "labels",
    "label",
    "ann_dir",
    "annotations",
    "annotation",
    "gt",
    "gts",
    "groundtruth",
    "ground_truth",
    "segmentation",
    "segmentations",
    "seg",
    "segmentationclass",
    "segmentationobject",
    "segmentationclasspng",
    "segmentationobjectpng",
    "semantic",
    "trimaps",
    "depth",
    "depths",
];
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

/// The masks of a dataset, found by what their images are called.
pub(super) struct Masks<'t> {
    by_name: HashMap<String, Vec<&'t String>>,
    /// Their folders, and those above them, in small letters.
    folders: HashSet<String>,
}

impl<'t> Masks<'t> {
    pub(super) fn of(tree: &'t Tree) -> Self {
        let mut masks = Self { by_name: HashMap::new(), folders: HashSet::new() };
        for path in tree.pictures().filter(|path| is_in(path, &NAMES)) {
            let (folder, name) = split(path);
            let name = stem(name);
            for name in [Some(name), without_end(name)].into_iter().flatten() {
                masks.by_name.entry(name.to_lowercase()).or_default().push(path);
            }
            let mut above = folder.to_lowercase();
            while !above.is_empty() && masks.folders.insert(above.clone()) {
                above = split(&above).0.to_owned();
            }
        }
        masks
    }

    /// The folders in which the masks of a folder of images stand.
    fn places(&self, folder: &str) -> Vec<String> {
        let mut places = about(folder, &NAMES);
        // Beside its image a mask is a question.
        places.pop();
        let places = places.into_iter().map(|place| place.to_lowercase());
        places.filter(|place| self.folders.contains(place)).collect()
    }

    /// Whether the images of a folder have masks elsewhere.
    fn belong_to(&self, folder: &str) -> bool {
        !self.places(folder).is_empty()
    }

    /// The masks of an image.
    pub(super) fn of_image(&self, key: &str) -> Vec<&'t String> {
        let (folder, name) = split(key);
        let Some(named) = self.by_name.get(&stem(name).to_lowercase()) else { return Vec::new() };
        let places = self.places(folder);
        let fits = |mask: &&&String| {
            let folder = split(mask).0.to_lowercase();
            mask.as_str() != key && places.iter().any(|place| is_of(place, &folder))
        };
        named.iter().filter(fits).copied().collect()
    }
}

/// Whether the masks of `place` stand in this folder: it is that one, or has one part more, the class.
fn is_of(place: &str, folder: &str) -> bool {
    let parts: Vec<&str> = folder.split('/').collect();
    folder == place || (0..parts.len()).any(|class| places::without(&parts, class) == place)
}

pub(super) fn evidence(tree: &Tree) -> Option<String> {
    let masks = Masks::of(tree);
    let is_image = |key: &&String| !is_in(key, &NAMES);
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
    let is_image = |key: &&String| !is_in(key, &NAMES) && masks.belong_to(split(key).0);
    let mut left: BTreeSet<&String> = masks.by_name.values().flatten().copied().collect();
    for key in tree.images().filter(is_image) {
        let found = masks.of_image(key);
        let mut by_folder: BTreeMap<&str, usize> = BTreeMap::new();
        for mask in &found {
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
