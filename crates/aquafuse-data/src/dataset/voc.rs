//! An XML file an image, which names the image and holds boxes in pixels: `Annotations/NAME.xml` for `JPEGImages/NAME.jpg`,
//! in folders of other names, or beside the image.

mod xml;

use std::collections::{BTreeMap, BTreeSet};

pub(super) use xml::renamed;
#[cfg(feature = "fuzz-targets")]
pub(crate) use xml::try_parse;
use xml::{Annotation, parse};

use super::places::{self, Stems, of_images};
use super::tree::Tree;
use super::{Companion, Dataset, Fault, Naming, Sample, inside, join, split, stem};
use crate::files::FileError;

/// What folders of annotations are called.
const NAMES: [&str; 9] =
    ["annotations", "annotation", "annos", "anno", "xml", "xmls", "box", "boxes", "labels"];
/// Folders of masks with the annotation's name that may stand beside.
const MASKS: [&str; 2] = ["SegmentationClass", "SegmentationObject"];

/// An XML file, and the image that it is about.
struct Found {
    path: String,
    about: Result<Annotation, String>,
    /// Whether the element of annotations begins in it.
    begins: bool,
    image: Option<String>,
}

impl Found {
    /// Whether it is, or should be, an annotation: it says so, or stands where one should.
    fn is_annotation(&self) -> bool {
        self.begins || (self.image.is_some() && places::is_in(&self.path, &NAMES))
    }
}

/// Reads an XML file, and finds its image: by the name in it, or by its own.
fn look(tree: &Tree, stems: &Stems<'_>, path: &str) -> Result<Found, FileError> {
    let bytes = tree.bytes(path)?;
    let text = xml::text(&bytes);
    let begins = text
        .as_ref()
        .is_ok_and(|(text, _)| ["<annotation>", "<annotation "].iter().any(|begin| text.contains(begin)));
    let about = text.and_then(|(text, _)| parse(&text));
    let (folder, name) = split(path);
    let folders = of_images(folder, &NAMES);
    let named = about.as_ref().ok().and_then(|about| inside(about.filename.as_ref()?).ok());
    let by_name = named.and_then(|named| {
        folders
            .iter()
            .find_map(|folder| tree.any_case(&join(folder, &named)))
            .filter(|key| tree.is_image(key))
    });
    let by_stem = || folders.iter().find_map(|folder| stems.get(folder, stem(name)).first().copied());
    let image = by_name.or_else(by_stem).cloned();
    Ok(Found { path: path.to_owned(), about, begins, image })
}

/// The boxes of an annotation, in pixels from the image's left upper corner: left, top, right, bottom.
pub(super) fn boxes(bytes: &[u8]) -> Vec<[f64; 4]> {
    xml::text(bytes).and_then(|(text, _)| parse(&text)).map(Annotation::into_boxes).unwrap_or_default()
}

pub(super) fn evidence(tree: &Tree) -> Result<Option<String>, FileError> {
    let stems = Stems::of(tree.images());
    for path in tree.ending(".xml") {
        let found = look(tree, &stems, path)?;
        if let Some(image) = found.image.as_ref().filter(|_| found.is_annotation()) {
            return Ok(Some(format!("{path} is about {image}")));
        }
    }
    Ok(None)
}

pub(super) fn read(tree: &Tree, dataset: &mut Dataset) -> Result<(), FileError> {
    let stems = Stems::of(tree.images());
    let mut taken: BTreeMap<String, String> = BTreeMap::new();
    for path in tree.ending(".xml") {
        let found = look(tree, &stems, path)?;
        if !found.is_annotation() {
            continue;
        }
        let Some(key) = found.image else {
            dataset.faults.add(Fault::new(path, "the dataset does not have its image"));
            continue;
        };
        if let Some(other) = taken.get(&key) {
            dataset.faults.add(Fault::new(path, format!("{other} is about {key} too")).of(&key));
            continue;
        }
        match &found.about {
            Err(cause) => dataset.faults.add(Fault::new(path, cause.clone()).of(&key)),
            Ok(about) => {
                let named = about.filename.as_ref().map(|said| (said, inside(said)));
                if let Some((said, Err(cause))) = named {
                    dataset.faults.add(Fault::new(path, format!("{said:?} is {cause}")).of(&key));
                }
                about.faults().for_each(|cause| dataset.faults.add(Fault::new(path, cause).of(&key)));
            }
        }
        let mut companions = vec![Companion { path: path.clone(), naming: Naming::Voc }];
        let (folder, name) = split(path);
        let masks = MASKS.map(|masks| join(&join(split(folder).0, masks), &format!("{}.png", stem(name))));
        companions.extend(masks.into_iter().filter(|mask| tree.holds(mask)).map(Companion::carried));
        dataset.samples.push(Sample::new(&key, companions));
        taken.insert(key, path.clone());
    }
    // Images without an annotation, where others have one.
    let folders: BTreeSet<&str> = taken.keys().map(|key| split(key).0).collect();
    let unsaid = tree.images().filter(|key| folders.contains(split(key).0) && !taken.contains_key(*key));
    dataset.samples.extend(unsaid.map(|key| Sample::new(key, Vec::new())));
    Ok(())
}
