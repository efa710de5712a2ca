//! A mask an image: `masks/` beside `images/`, each mask named as its image, with `_mask` behind it or not.

use std::collections::{BTreeMap, BTreeSet};

use super::tree::Tree;
use super::{Companion, Dataset, Fault, Sample, join, split, stem};

/// What folders of images and their masks are called.
const NAMES: [(&str, &str); 3] = [("images", "masks"), ("image", "mask"), ("imgs", "masks")];
/// What may stand behind the name of the image in that of its mask.
const ENDS: [&str; 3] = ["_mask", "-mask", "_gt"];

/// The folders of masks with those of their images.
fn folders(tree: &Tree) -> BTreeSet<(String, String)> {
    let all: BTreeSet<&str> = tree.files.iter().map(|path| split(path).0).collect();
    let pair = |folder: &&str| {
        let (above, name) = split(folder);
        let (_, masks) = NAMES
            .into_iter()
            .find(|(images, masks)| *images == name && all.contains(join(above, masks).as_str()))?;
        Some(((*folder).to_owned(), join(above, masks)))
    };
    all.iter().filter_map(pair).collect()
}

pub(super) fn evidence(tree: &Tree) -> Option<String> {
    let has_masks = |folder: &str| tree.images_in(folder).next().is_some();
    let (images, masks) = folders(tree).into_iter().find(|(_, masks)| has_masks(masks))?;
    Some(format!("{masks}/ beside {images}/"))
}

pub(super) fn read(tree: &Tree, dataset: &mut Dataset) {
    for (images, masks) in folders(tree) {
        let mut by_stem: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for mask in tree.images_in(&masks) {
            by_stem.entry(stem(split(mask).1).to_owned()).or_default().push(mask.clone());
        }
        for key in tree.images_in(&images) {
            let name = stem(split(key).1);
            let named = ENDS.iter().map(|end| format!("{name}{end}"));
            let found = [name.to_owned()].into_iter().chain(named).find_map(|name| by_stem.remove(&name));
            let masks = found.unwrap_or_default();
            match masks.len() {
                1 => {}
                0 => dataset.faults.add(Fault::new(key, "it has no mask").of(key)),
                n => dataset
                    .faults
                    .add(Fault::new(key, format!("it has {n} masks with its name instead of one")).of(key)),
            }
            let companions = masks.into_iter().map(Companion::carried).collect();
            dataset.samples.push(Sample::new(key, companions));
        }
        for mask in by_stem.into_values().flatten() {
            dataset.faults.add(Fault::new(mask, "no image belongs to this mask"));
        }
    }
}
