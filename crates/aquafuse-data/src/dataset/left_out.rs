//! What a dataset is read without: files that no layout reads, images that no annotation names, masks of nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

use serde::de::IgnoredAny;

use super::masks::{is_mask, without_end};
use super::tree::{NO_TEXT, Tree, is_manifest};
use super::{Dataset, Fault, Index, foreign, split, stem};
use crate::files::display;
use crate::image_file::Format;

/// Names that are given of each kind.
const NAMED: usize = 3;
/// Extensions of files that hold annotations more often than anything else.
const OF_LABELS: [&str; 38] = [
    "json",
    "jsonl",
    "ndjson",
    "geojson",
    "xml",
    "csv",
    "tsv",
    "mat",
    "npy",
    "npz",
    "pkl",
    "pickle",
    "h5",
    "hdf5",
    "lst",
    "odgt",
    "tfrecord",
    "tfrecords",
    "record",
    "parquet",
    "arrow",
    "db",
    "sqlite",
    "ann",
    "zip",
    "tar",
    "gz",
    "tgz",
    "zst",
    "bz2",
    "xz",
    "7z",
    "rar",
    "lmdb",
    "xlsx",
    "xls",
    "ods",
    "mdb",
];
/// Extensions of files that cameras and their programs write beside images.
const OF_CAMERAS: [&str; 5] = ["xmp", "thm", "aae", "pp3", "dop"];

/// What kind of file was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// It looks like annotations.
    Labels,
    /// It looks like annotations or a mask, and is hidden.
    HiddenLabels,
    /// It looks like a mask or a map of an image.
    Mask,
    /// A picture.
    Picture,
    /// A hidden picture.
    HiddenPicture,
    /// Anything else.
    Other,
}

/// Files of one kind and extension.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Group {
    count: usize,
    /// The first ones.
    first: Vec<String>,
}

/// The files in the folder of a dataset that are not part of it: [`Display`](fmt::Display) names and counts them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    groups: BTreeMap<(Kind, String), Group>,
    /// What the annotations seem to be.
    seems: Option<foreign::Format>,
}

impl LeftOut {
    /// How many files there are of a kind.
    pub fn count(&self, kind: Kind) -> usize {
        let of_kind = self.groups.iter().filter(|((own, _), _)| *own == kind);
        of_kind.fold(0, |sum, (_, group)| sum.saturating_add(group.count))
    }

    /// Whether every file is part of the dataset.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Whether there are annotations or masks among them.
    pub fn has_labels(&self) -> bool {
        [Kind::Labels, Kind::HiddenLabels, Kind::Mask].into_iter().any(|kind| self.count(kind) > 0)
    }

    /// How to have the annotations read.
    pub fn remedy(&self) -> String {
        match self.seems {
            Some(foreign::Format { name, remedy }) => format!("They seem to be {name}: {remedy}"),
            None if self.count(Kind::Labels) == 0 && self.count(Kind::HiddenLabels) > 0 => {
                "Names that begin with a dot are hidden, and not read: rename them".to_owned()
            }
            None if self.count(Kind::Labels) == 0 => {
                "Put masks into a folder masks/ beside the folder images/ of their images".to_owned()
            }
            None => {
                "Convert them to COCO, YOLO or Pascal VOC, or give the --format that they have".to_owned()
            }
        }
    }

    fn add(&mut self, kind: Kind, path: &str) {
        let name = split(path).1;
        let extension =
            Path::new(name).extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let extension =
            extension.map_or_else(|| "without extension".to_owned(), |extension| format!(".{extension}"));
        let group = self.groups.entry((kind, extension)).or_default();
        group.count = group.count.saturating_add(1);
        if group.first.len() < NAMED {
            group.first.push(path.to_owned());
        }
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, ((kind, extension), group)) in self.groups.iter().enumerate() {
            let kind = match kind {
                Kind::Mask => " like masks",
                Kind::HiddenLabels => " hidden, like annotations",
                Kind::HiddenPicture => " hidden",
                _ => "",
            };
            let names: Vec<String> =
                group.first.iter().map(|name| display(Path::new(name)).to_string()).collect();
            let more = if group.count > names.len() { ", …" } else { "" };
            let between = if number == 0 { "" } else { "; " };
            write!(f, "{between}{} {extension}{kind} ({}{more})", group.count, names.join(", "))?;
        }
        Ok(())
    }
}

/// Names what a dataset was read without; `masks` are images that were taken from it. JSON that is none is a fault.
pub(super) fn look(tree: &Tree, masks: &BTreeSet<String>, dataset: &mut Dataset) {
    let mut left = LeftOut::default();
    let mut used: BTreeSet<&str> = BTreeSet::new();
    for sample in &dataset.samples {
        used.insert(&sample.key);
        used.extend(sample.companions.iter().map(|companion| companion.path.as_str()));
    }
    used.extend(dataset.indices.iter().map(Index::path));
    let stems: BTreeSet<String> = tree.images().map(|path| stem(split(path).1).to_lowercase()).collect();
    let mut faults = Vec::new();
    for path in tree.files.iter().filter(|path| !used.contains(path.as_str()) && !is_ours(tree, path)) {
        let kind = if masks.contains(path) { Kind::Mask } else { kind(tree, path, &stems) };
        if kind == Kind::Labels {
            let text = tree.read(path);
            if left.seems.is_none() {
                left.seems = foreign::Format::of(path, text.as_ref().ok().and_then(Option::as_deref));
            }
            if path.to_lowercase().ends_with(".json")
                && let Ok(text) = text
                && let Some(cause) = no_json(text.as_deref())
            {
                faults.push(Fault::new(path, cause));
            }
        }
        left.add(kind, path);
    }
    for path in &tree.hidden {
        match kind(tree, path, &stems) {
            Kind::Labels | Kind::Mask => left.add(Kind::HiddenLabels, path),
            Kind::Picture if is_mask(path) => left.add(Kind::HiddenLabels, path),
            Kind::Picture => left.add(Kind::HiddenPicture, path),
            _ => {}
        }
    }
    let known: BTreeSet<String> = dataset.faults.first().iter().map(|fault| fault.place.clone()).collect();
    for fault in faults.into_iter().filter(|fault| !known.contains(&fault.place)) {
        dataset.faults.add(fault);
    }
    dataset.left_out = left;
}

/// Whether a file is a manifest that `augment` wrote.
fn is_ours(tree: &Tree, path: &str) -> bool {
    let small = path.to_lowercase();
    match small.rsplit_once('.') {
        Some((name, "jsonl")) if name.starts_with("manifest") => is_manifest(&tree.root.join(path)),
        Some((name, "parquet")) => name == "manifest" || name.starts_with("manifest."),
        _ => false,
    }
}

/// What a file looks like, by its name, and where that does not say it, by its first line.
fn kind(tree: &Tree, path: &str, stems: &BTreeSet<String>) -> Kind {
    let name = split(path).1.trim_start_matches('.');
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension).to_lowercase();
    let own = stem(name).to_lowercase();
    let is_about_image = stems.contains(&own) || without_end(&own).is_some_and(|own| stems.contains(own));
    if Format::listed(Path::new(name)) || Format::is_other(Path::new(name)) {
        return Kind::Picture;
    }
    match extension.as_str() {
        "gif" if is_about_image && is_mask(path) => Kind::Mask,
        "gif" => Kind::Picture,
        known if OF_LABELS.contains(&known) => Kind::Labels,
        known if OF_CAMERAS.contains(&known) => Kind::Other,
        // A file with the name of an image is about that image, whatever it is.
        _ if is_about_image || stems.contains(stem(&own)) => Kind::Labels,
        _ if name.to_lowercase().contains(".tfrecord") => Kind::Labels,
        "txt" if is_mask(path) || foreign::is_table(tree, path) => Kind::Labels,
        // JSON or XML whatever it is called.
        _ if !is_of_text(&extension) && foreign::is_marked_up(tree, path) => Kind::Labels,
        _ => Kind::Other,
    }
}

/// Whether files of this extension are for people or programs, and may begin with any sign.
fn is_of_text(extension: &str) -> bool {
    const TEXTS: [&str; 16] = [
        "txt", "md", "rst", "html", "htm", "svg", "py", "ipynb", "sh", "m", "r", "js", "ts", "css", "yaml",
        "yml",
    ];
    TEXTS.contains(&extension)
}

/// Why a text is no JSON, if it is none.
fn no_json(text: Option<&str>) -> Option<String> {
    let Some(text) = text else { return Some(NO_TEXT.to_owned()) };
    let error = serde_json::from_str::<IgnoredAny>(text).err()?;
    Some(super::coco::no_json(text, &error))
}
