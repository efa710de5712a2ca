//! A text file an image, one object a line: `class x y width height`, or `class x1 y1 x2 y2 ...` for outlines, with
//! key points behind the box for poses. All lengths are shares of the image's sides.

use std::collections::BTreeMap;

use super::tree::{NO_TEXT, Tree};
use super::{Companion, Dataset, Fault, Index, Sample, join, split, stem};
use crate::files::FileError;

/// As far as this beyond the image's edge, in shares of its side, a box is rounded rather than wrong.
const ROUNDED: f64 = 2e-3;
/// Files beside the images that are carried over as they are.
const LISTS_OF_CLASSES: [&str; 4] = ["classes.txt", "obj.names", "notes.json", "_darknet.labels"];

/// The label of an image: `labels` for the last `images` of its path, beside it where there is none.
fn label(key: &str) -> String {
    let (folder, name) = split(key);
    let mut parts: Vec<&str> = folder.split('/').collect();
    if let Some(last) = parts.iter_mut().rev().find(|part| **part == "images") {
        *last = "labels";
    }
    join(&parts.join("/"), &format!("{}.txt", stem(name)))
}

fn is_config(path: &str) -> bool {
    split(path).0.is_empty() && (path.ends_with(".yaml") || path.ends_with(".yml"))
}

/// Whether a text of YAML says what classes there are.
fn names_classes(text: &str) -> bool {
    text.lines().any(|line| line.starts_with("names:") || line.starts_with("nc:"))
}

pub(super) fn evidence(tree: &Tree) -> Result<Option<String>, FileError> {
    for config in tree.files.iter().filter(|path| is_config(path)) {
        if tree.read(config)?.is_some_and(|text| names_classes(&text)) {
            return Ok(Some(format!("{config} names classes")));
        }
    }
    let labelled = |key: &&String| key.split('/').any(|part| part == "images") && tree.holds(&label(key));
    if let Some(key) = tree.images().find(labelled) {
        return Ok(Some(format!("{} is about {key}", label(key))));
    }
    let beside = LISTS_OF_CLASSES.into_iter().find(|name| *name != "notes.json" && tree.holds(name));
    Ok(beside.map(|name| format!("{name} names classes")))
}

pub(super) fn read(tree: &Tree, dataset: &mut Dataset) -> Result<(), FileError> {
    let configs: Vec<&String> = tree.files.iter().filter(|path| is_config(path)).collect();
    let in_images = |key: &&String| key.split('/').any(|part| part == "images");
    let nested = tree.images().any(|key| in_images(&key));
    // Two images of one label cannot have variants that differ in their labels' names.
    let mut owners: BTreeMap<String, String> = BTreeMap::new();
    for key in tree.images().filter(|key| !nested || in_images(key)) {
        let path = label(key);
        let mut companions = Vec::new();
        if tree.holds(&path) {
            if let Some(other) = owners.insert(path.clone(), key.clone()) {
                let cause = format!("it shares the label {path} with {other}");
                dataset.faults.add(Fault::new(key, cause).of(key));
            }
            let text = tree.read(&path)?;
            if text.is_none() {
                dataset.faults.add(Fault::new(&path, NO_TEXT).of(key));
            }
            for (line, number) in text.iter().flat_map(|text| text.lines()).zip(1_usize..) {
                if let Err(cause) = check(line) {
                    dataset.faults.add(Fault::new(format!("{path}:{number}"), cause).of(key));
                }
            }
            companions.push(Companion::carried(path));
        }
        dataset.samples.push(Sample::new(key, companions));
    }
    let in_labels = |path: &&String| split(path).0.split('/').any(|part| part == "labels");
    for path in tree.ending(".txt").filter(in_labels) {
        if !owners.contains_key(path) && !LISTS_OF_CLASSES.contains(&split(path).1) {
            dataset.faults.add(Fault::new(path, "no image belongs to this label"));
        }
    }
    dataset.indices.extend(configs.into_iter().map(|path| Index::Config { path: path.clone() }));
    for path in tree.files.iter().filter(|path| split(path).0.is_empty()) {
        if LISTS_OF_CLASSES.contains(&path.as_str()) {
            dataset.indices.push(Index::Carried { path: path.clone() });
        } else if path.ends_with(".txt") && !owners.contains_key(path) {
            let names_images = |line: &str| super::inside(line).is_ok_and(|name| tree.holds(&name));
            match tree.read(path)? {
                Some(text) if text.lines().any(names_images) => {
                    dataset.indices.push(Index::Paths { path: path.clone() });
                }
                Some(_) => {}
                // It may be the list of images that the configuration names.
                None => dataset.faults.add(Fault::new(path, NO_TEXT)),
            }
        }
    }
    Ok(())
}

/// What is wrong with a line of a label.
fn check(line: &str) -> Result<(), String> {
    let mut numbers = line.split_ascii_whitespace();
    let Some(class) = numbers.next() else { return Ok(()) };
    if class.parse::<u32>().is_err() {
        return Err(format!("the class is {:?}, but must be a whole number, 0 or more", short(class)));
    }
    let values: Vec<f64> = numbers
        .map(|text| text.parse().map_err(|_| format!("{:?} is not a number", short(text))))
        .collect::<Result<_, _>>()?;
    match values.as_slice() {
        // A box, with key points or a confidence behind it or not.
        [x, y, w, h, rest @ ..] if rest.len() != 2 && (rest.len() < 4 || is_pose(rest)) => {
            inside_image("across", *x, *w)?;
            inside_image("down", *y, *h)
        }
        outline if outline.len() >= 6 && outline.len().is_multiple_of(2) => {
            match outline.iter().find(|value| !(-ROUNDED..=1.0 + ROUNDED).contains(*value)) {
                Some(value) => Err(format!("a corner is at {value}, outside the image")),
                None => Ok(()),
            }
        }
        other => Err(format!("it has {} numbers after the class instead of 4", other.len())),
    }
}

/// Whether these are key points: in threes the last of which says whether the point is seen.
fn is_pose(rest: &[f64]) -> bool {
    let seen = |point: &[f64]| point.last().is_some_and(|seen| [0.0, 1.0, 2.0].contains(seen));
    rest.len().is_multiple_of(3) && rest.chunks(3).all(seen)
}

/// Refuses a side that reaches beyond the image.
fn inside_image(way: &str, middle: f64, length: f64) -> Result<(), String> {
    let ends = (middle - length / 2.0, middle + length / 2.0);
    // A number that is none compares with nothing.
    if length >= 0.0 && ends.0 >= -ROUNDED && ends.1 <= 1.0 + ROUNDED {
        return Ok(());
    }
    Err(format!("the box reaches from {:.4} to {:.4} {way}, outside the image", ends.0, ends.1))
}

/// A foreign string, shortened for a message.
fn short(text: &str) -> String {
    text.chars().take(20).collect()
}

/// Reads a label for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(text: &str) {
    for line in text.lines() {
        let _ = check(line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stand_where_the_images_stand_in_images() {
        assert_eq!(label("images/train/a.b.jpg"), "labels/train/a.b.txt");
        assert_eq!(label("train/images/a.jpg"), "train/labels/a.txt");
        assert_eq!(label("a.jpg"), "a.txt");
    }

    #[test]
    fn boxes_outlines_and_poses_are_lines() {
        for line in [
            "",
            "0 0.5 0.5 1 1",
            "3 0.1 0.1 0.2 0.2 0.87",
            "0 0.1 0.1 0.9 0.1 0.5 0.9",
            "0 0.5 0.5 0.2 0.2 0.5 0.5 2 0.1 0.1 0",
        ] {
            assert_eq!(check(line), Ok(()), "{line}");
        }
        for (line, said) in [
            ("fish 0.5 0.5 1 1", "class"),
            ("0 0.5 0.5 1", "3 numbers"),
            ("0 0.5 x 1 1", "not a number"),
            ("0 0.9 0.5 0.4 0.2", "outside the image"),
            ("0 0.5 0.5 nan 0.2", "outside the image"),
            ("0 0.5 0.5 -0.1 0.2", "outside the image"),
            ("0 0.1 0.1 1.9 0.1 0.5 0.9", "corner"),
        ] {
            assert!(check(line).unwrap_err().contains(said), "{line}");
        }
    }
}
