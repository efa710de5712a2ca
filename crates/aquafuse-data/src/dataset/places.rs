//! Where the files about an image stand: in a folder called `labels` or the like where the image's own is called `images` or
//! the like, in a folder of that name within the image's own, or beside the image. Capitals do not matter.

use std::collections::HashMap;

use super::tree::Tree;
use super::{join, split, stem};

/// What folders of images are called.
pub(super) const IMAGES: [&str; 11] =
    ["images", "image", "imgs", "img", "img_dir", "jpegimages", "pictures", "photos", "rgb", "input", "raw"];

/// The folders in which files about the images of `folder` may stand, `names` being what those are called, the
/// likeliest first. The folder itself is the last.
pub(super) fn about(folder: &str, names: &[&str]) -> Vec<String> {
    let mut places = exchanged(folder, &IMAGES, names);
    places.extend(moved(folder, &IMAGES, names));
    places.extend(names.iter().map(|name| join(folder, name)));
    places.push(folder.to_owned());
    places
}

/// The folders in which the images may stand that the files in `folder` are about: the other way round.
pub(super) fn of_images(folder: &str, names: &[&str]) -> Vec<String> {
    let mut places = exchanged(folder, names, &IMAGES);
    places.extend(moved(folder, names, &IMAGES));
    // `annotations/xmls/` is one folder to them.
    let within: Vec<String> = places.iter().flat_map(|place| places_without(place, names)).collect();
    places.extend(within);
    places.extend(places_without(folder, names));
    places.push(folder.to_owned());
    places
}

/// Names that only folders of images have: images stand here even where the name of a folder above says masks.
pub(super) const ONLY_IMAGES: [&str; 6] = ["images", "image", "imgs", "img", "img_dir", "jpegimages"];

/// Whether a folder in the path is called so, and none below it holds images.
pub(super) fn is_in(path: &str, names: &[&str]) -> bool {
    let mut parts = split(path).0.rsplit('/');
    let last = parts.find(|part| is_one_of(part, names) || is_one_of(part, &ONLY_IMAGES));
    last.is_some_and(|part| is_one_of(part, names))
}

pub(super) fn is_one_of(part: &str, names: &[&str]) -> bool {
    names.iter().any(|name| part.eq_ignore_ascii_case(name))
}

/// The folder with one part of its path that is among `from`, the last first, exchanged for each of `to`.
fn exchanged(folder: &str, from: &[&str], to: &[&str]) -> Vec<String> {
    let parts: Vec<&str> = folder.split('/').collect();
    let places =
        (0..parts.len()).rev().filter(|&place| parts.get(place).is_some_and(|part| is_one_of(part, from)));
    let with = |place: usize, name: &str| {
        let part = |(own, part)| if own == place { name } else { part };
        parts.iter().copied().enumerate().map(part).collect::<Vec<_>>().join("/")
    };
    places
        .flat_map(|place| to.iter().map(move |name| (place, *name)))
        .map(|(place, name)| with(place, name))
        .collect()
}

/// The folder without one part of its path that is among `from`, and with one of `to` elsewhere: `train/images` and
/// `labels/train`.
fn moved(folder: &str, from: &[&str], to: &[&str]) -> Vec<String> {
    let mut places = Vec::new();
    for rest in places_without(folder, from).into_iter().filter(|rest| !rest.is_empty()) {
        let parts: Vec<&str> = rest.split('/').collect();
        for at in 0..=parts.len() {
            let (before, after) = parts.split_at_checked(at).unwrap_or_default();
            places.extend(to.iter().map(|name| [before, &[name], after].concat().join("/")));
        }
    }
    places
}

/// The folder without one part of its path that is among `names`.
fn places_without(folder: &str, names: &[&str]) -> Vec<String> {
    let parts: Vec<&str> = folder.split('/').collect();
    let places =
        (0..parts.len()).rev().filter(|&place| parts.get(place).is_some_and(|part| is_one_of(part, names)));
    places.map(|place| without(&parts, place)).collect()
}

/// The parts of a path but one.
pub(super) fn without(parts: &[&str], place: usize) -> String {
    let kept = parts.iter().enumerate().filter(|(own, _)| *own != place).map(|(_, part)| *part);
    kept.collect::<Vec<_>>().join("/")
}

/// The images of a dataset by their paths without extension, in small letters.
pub(super) struct Stems<'t>(HashMap<String, Vec<&'t String>>);

impl<'t> Stems<'t> {
    pub(super) fn of(paths: impl Iterator<Item = &'t String>) -> Self {
        let mut all: HashMap<String, Vec<&String>> = HashMap::new();
        for path in paths {
            let (folder, name) = split(path);
            all.entry(join(folder, stem(name)).to_lowercase()).or_default().push(path);
        }
        Self(all)
    }

    /// Those with this stem in a folder.
    pub(super) fn get(&self, folder: &str, stem: &str) -> &[&'t String] {
        self.0.get(&join(folder, stem).to_lowercase()).map_or(&[], Vec::as_slice)
    }
}

/// The file about an image with one of these names, in the first place that has one.
pub(super) fn find<'t>(tree: &'t Tree, key: &str, folders: &[&str], names: &[String]) -> Option<&'t String> {
    let places = about(split(key).0, folders);
    let paths = places.iter().flat_map(|place| names.iter().map(move |name| join(place, name)));
    paths.into_iter().find_map(|path| tree.any_case(&path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_about_images_stand_where_people_put_them() {
        let of = |folder| about(folder, &["labels"]);
        let has = |folder, place: &str| of(folder).iter().any(|found| found == place);
        assert_eq!(of("images/train")[0], "labels/train");
        assert!(has("images/train", "train/labels") && has("train/images", "labels/train"));
        assert!(has("Images/img", "Images/labels") && has("Images/img", "Images/img/labels"));
        assert_eq!(of("Images/img").last().map(String::as_str), Some("Images/img"));
        assert_eq!(of(""), ["labels", ""]);
        let back = of_images("a/Labels/train", &["labels"]);
        assert!(
            ["a/images/train", "a/jpegimages/train", "a/train"]
                .iter()
                .all(|place| back.contains(&(*place).to_owned()))
        );
    }
}
