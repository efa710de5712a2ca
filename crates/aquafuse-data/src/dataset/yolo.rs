//! A text file an image, an object a line: `class x y width height`, or `class x1 y1 x2 y2 ...` for outlines, with
//! key points behind the box for poses. All lengths are shares of the image's sides.

mod classes;
mod config;
mod label;

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};

pub(super) use config::splits_of_config;

use super::tree::{NO_TEXT, Tree};
use super::{Companion, Dataset, Fault, Faults, Index, Sample, places, split, stem};
use crate::files::FileError;
use crate::image_file::ImageFile;

/// What folders of labels are called.
const LABELS: [&str; 5] = ["labels", "label", "annotations", "yolo", "txt"];
/// Files about all labels that are carried over as they are.
const ABOUT_ALL: [&str; 5] = ["classes.txt", "obj.names", "obj.data", "notes.json", "_darknet.labels"];
/// Ends of the names of such files of darknet, which calls them as it likes.
const OF_DARKNET: [&str; 2] = [".names", ".data"];

/// The label of an image: `NAME.txt`, or `NAME.jpg.txt`, as some tools call it.
fn label<'t>(tree: &'t Tree, key: &str) -> Option<&'t String> {
    let name = split(key).1;
    let path = places::find(tree, key, &LABELS, &[stem(name), name].map(|name| format!("{name}.txt")))?;
    (!is_about_all(path)).then_some(path)
}

fn is_about_all(path: &str) -> bool {
    let name = split(path).1.to_lowercase();
    ABOUT_ALL.contains(&name.as_str()) || OF_DARKNET.iter().any(|end| name.ends_with(end))
}

fn is_config(path: &str) -> bool {
    split(path).0.is_empty() && (path.ends_with(".yaml") || path.ends_with(".yml"))
}

pub(super) fn evidence(tree: &Tree) -> Result<Option<String>, FileError> {
    for config in tree.files.iter().filter(|path| is_config(path)) {
        if tree.read(config)?.is_some_and(|text| classes::are_named(&text)) {
            return Ok(Some(format!("{config} names classes")));
        }
    }
    let labelled = |key: &String| {
        let path = label(tree, key)?;
        // Elsewhere may stand any text.
        let is_label = places::is_in(path, &["labels"]) || holds_boxes(tree, path);
        is_label.then(|| format!("{path} is about {key}"))
    };
    if let Some(found) = tree.images().find_map(labelled) {
        return Ok(Some(found));
    }
    let beside = ABOUT_ALL.into_iter().find(|name| !name.ends_with(".json") && tree.holds(name));
    Ok(beside.map(|name| format!("{name} names classes")))
}

/// Whether a text has boxes, and nothing else.
fn holds_boxes(tree: &Tree, path: &str) -> bool {
    let text = tree.read(path).ok().flatten().unwrap_or_default();
    let mut lines = text.lines().filter(|line| !line.trim().is_empty()).peekable();
    lines.peek().is_some() && lines.all(|line| label::check(line, None, &|| None).is_ok())
}

pub(super) fn read(tree: &Tree, dataset: &mut Dataset) -> Result<(), FileError> {
    let configs: Vec<&String> = tree.files.iter().filter(|path| is_config(path)).collect();
    let carried: Vec<&String> = tree.files.iter().filter(|path| is_about_all(path)).collect();
    let classes = classes::count(tree, configs.iter().chain(&carried))?;
    let labels: BTreeMap<&String, &String> =
        tree.images().filter_map(|key| Some((key, label(tree, key)?))).collect();
    // Images without a label are background, where others have one or labels would be looked for.
    let folders: BTreeSet<&str> = labels.keys().map(|key| split(key).0).collect();
    let in_images = |key: &&String| places::is_in(key, &places::IMAGES);
    let are_some = !labels.is_empty() || tree.images().any(|key| in_images(&key));
    let belongs = |key: &&String| !are_some || in_images(key) || folders.contains(split(key).0);
    // Two images of one label cannot have variants that differ in their labels' names.
    let mut owners: BTreeMap<&String, &String> = BTreeMap::new();
    for key in tree.images().filter(belongs) {
        let mut companions = Vec::new();
        if let Some(path) = labels.get(key) {
            if let Some(other) = owners.insert(path, key) {
                let cause = format!("it shares the label {path} with {other}");
                dataset.faults.add(Fault::new(key, cause).of(key));
            }
            look(tree, path, key, classes, &mut dataset.faults)?;
            companions.push(Companion::carried((*path).clone()));
        }
        dataset.samples.push(Sample::new(key, companions));
    }
    for path in tree.ending(".txt").filter(|path| !owners.contains_key(path) && !is_about_all(path)) {
        if places::is_in(path, &["labels"]) {
            dataset.faults.add(Fault::new(path, "no image belongs to this label"));
        } else if split(path).0.is_empty() && tree.read(path)?.is_none() {
            // It may be the list of images that the configuration names.
            dataset.faults.add(Fault::new(path, NO_TEXT));
        }
    }
    dataset.indices.extend(configs.into_iter().map(|path| Index::Config { path: path.clone() }));
    dataset.indices.extend(carried.into_iter().map(|path| Index::Carried { path: path.clone() }));
    Ok(())
}

/// Looks for faults in the label of an image.
fn look(
    tree: &Tree,
    path: &str,
    key: &str,
    classes: Option<usize>,
    faults: &mut Faults,
) -> Result<(), FileError> {
    let Some(text) = tree.read(path)? else {
        faults.add(Fault::new(path, NO_TEXT).of(key));
        return Ok(());
    };
    // The image is opened where a box reaches over its edge, and only there.
    let opened = OnceCell::new();
    let size = || {
        let open = || ImageFile::open(&tree.root.join(key), &tree.reading).ok().map(|image| image.size());
        *opened.get_or_init(open)
    };
    for (line, number) in text.lines().zip(1_usize..) {
        if let Err(cause) = label::check(line, classes, &size) {
            faults.add(Fault::new(format!("{path}:{number}"), cause).of(key));
        }
    }
    Ok(())
}

/// Reads a text as a label, a configuration and a list, for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(text: &str) {
    label::try_parse(text);
    let _ = (classes::of_config(text), splits_of_config(text));
    for line in text.lines() {
        let _ = super::named(line, |name| name == "images/a.jpg");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_file::ReadOptions;

    #[test]
    fn labels_stand_where_the_images_stand_in_images() {
        for (key, path) in [
            ("images/train/a.b.jpg", "labels/train/a.b.txt"),
            ("train/images/a.jpg", "train/labels/a.txt"),
            ("Images/A.JPG", "Labels/a.TXT"),
            ("train/a.jpg", "train/labels/a.txt"),
            ("images/a.jpg", "labels/a.jpg.txt"),
            ("a.jpg", "a.txt"),
        ] {
            let files = [key, path].map(str::to_owned).into_iter().collect();
            let tree = Tree::holding("".into(), files, &ReadOptions::default());
            assert_eq!(label(&tree, key).map(String::as_str), Some(path));
        }
    }
}
