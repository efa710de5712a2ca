//! Datasets: images and their annotations.
//!
//! A dataset is read into [`Sample`]s, each an image with the files about it, and [`Index`] files, which are about all
//! images. Paths are relative to the dataset, with `/` between their parts.

pub(crate) mod coco;
mod fault;
mod folder;
mod foreign;
mod index;
mod left_out;
mod lists;
mod marks;
mod masks;
mod places;
pub(crate) mod shards;
mod sidecars;
mod splits;
mod suspects;
pub(crate) mod tables;
mod tree;
mod voc;
mod yolo;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

pub use fault::{Fault, Faults};
pub use index::Index;
pub use left_out::{Kind, LeftOut};
pub(crate) use lists::named;
pub(crate) use marks::{
    MOST as MOST_MARKS, Outline, of_coco as marks_of_coco, of_companion as marks_of_companion,
};
pub use splits::{Split, Splits};
pub(crate) use tree::{PREVIEW, Tree, inside};
#[cfg(feature = "fuzz-targets")]
pub(crate) use {
    shards::try_parse as try_shards, tables::try_parse as try_tables, voc::try_parse as try_voc,
    yolo::try_parse as try_yolo,
};

use crate::files::{FileError, display};
use crate::image_file::{ReadOptions, read_beside};

/// How a dataset is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Images in folders, without annotations. Detected only where nothing looks like annotations.
    Folder,
    /// Files of JSON with `images` and `annotations`: instances, keypoints, captions.
    Coco,
    /// One text file per image, in `labels/` for an image in `images/`: detection, segmentation, pose.
    Yolo,
    /// One XML file per image, in `Annotations/` for an image in `JPEGImages/`, or beside it.
    Voc,
    /// WebDataset: tar files in which all members of a sample share its name.
    Shards,
    /// One mask per image, in `masks/` for an image in `images/`.
    Masks,
    /// Parquet: tables with a column of images, as Hugging Face lays them out. Read with the feature `parquet`.
    Parquet,
}

impl Layout {
    /// All layouts.
    pub const ALL: [Self; 7] =
        [Self::Folder, Self::Coco, Self::Yolo, Self::Voc, Self::Masks, Self::Shards, Self::Parquet];

    /// Its name on the command line and in manifests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Folder => "folder",
            Self::Coco => "coco",
            Self::Yolo => "yolo",
            Self::Voc => "voc",
            Self::Masks => "masks",
            Self::Shards => "shards",
            Self::Parquet => "parquet",
        }
    }

    /// The layout with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|layout| layout.name() == name)
    }

    /// Whether one file holds many images, and is written as a whole.
    pub fn holds_many(self) -> bool {
        matches!(self, Self::Shards | Self::Parquet)
    }

    /// The evidence for this layout in the dataset, in words; for [`Layout::Folder`] there is none but images.
    fn evidence(self, tree: &Tree) -> Result<Option<String>, FileError> {
        Ok(match self {
            Self::Folder => None,
            Self::Coco => coco::evidence(tree)?,
            Self::Yolo => yolo::evidence(tree)?,
            Self::Voc => voc::evidence(tree)?,
            Self::Masks => masks::evidence(tree),
            Self::Shards => shards::evidence(tree),
            Self::Parquet => tables::evidence(tree),
        })
    }
}

/// A dataset on disk.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// Its folder.
    pub root: PathBuf,
    /// Its layout.
    pub layout: Layout,
    /// Its images, sorted by key.
    pub samples: Vec<Sample>,
    /// The files about all of its images.
    pub indices: Vec<Index>,
    /// The faults of its annotations.
    pub faults: Faults,
    /// The files in its folder that are not part of it.
    pub left_out: LeftOut,
}

/// An image of a dataset, with the files that are about it alone; or a file that [holds many](Layout::holds_many).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The path of the image, which names the sample.
    pub key: String,
    /// Its index in the dataset.
    pub rank: u64,
    /// The split that it is of, if the dataset says one.
    pub split: Option<Split>,
    /// The files about it.
    pub companions: Vec<Companion>,
}

/// A file about one image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Companion {
    /// Its path.
    pub path: String,
    /// How it names the image, and must name the variant.
    pub naming: Naming,
}

/// How a file names the image that it is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Naming {
    /// Not at all: it is the same for every variant.
    Nothing,
    /// As Pascal VOC, in XML.
    Voc,
    /// Anywhere in it.
    Anywhere,
}

impl Sample {
    pub(crate) fn new(key: impl Into<String>, companions: Vec<Companion>) -> Self {
        Self { key: key.into(), rank: 0, split: None, companions }
    }
}

impl Companion {
    /// A file that is the same for every variant.
    fn carried(path: String) -> Self {
        Self { path, naming: Naming::Nothing }
    }

    /// The content of the file for a variant with the file name `variant` of the image with the file name `image`.
    ///
    /// # Errors
    ///
    /// [`FileError`] when it cannot be read.
    pub fn for_variant(
        &self,
        root: &Path,
        image: &str,
        variant: &str,
        reading: &ReadOptions,
    ) -> Result<Vec<u8>, FileError> {
        let bytes = read_beside(&root.join(&self.path), reading)?;
        Ok(match self.naming {
            Naming::Nothing => bytes,
            Naming::Voc => voc::renamed(&bytes, variant),
            Naming::Anywhere => sidecars::renamed(&bytes, image, variant),
        })
    }
}

/// A dataset cannot be used. The message names it, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// Two layouts fit.
    #[error("{} may be {one} or {other}; choose one with --format", display(root))]
    Ambiguous {
        /// The dataset.
        root: PathBuf,
        /// A layout, and what speaks for it.
        one: String,
        /// The other one.
        other: String,
    },
    /// Its layout is one that this build does not read.
    #[error(
        "cannot read {} as Parquet tables: this build has no Parquet; build with --features parquet",
        display(root)
    )]
    NotBuilt {
        /// The dataset.
        root: PathBuf,
    },
    /// There are annotations in it, and the layout reads none of them.
    #[error(
        "{} has files that look like annotations, and layout {layout} reads none of them: {left_out}. {}; or add --format \
         folder to leave them out",
        display(root),
        left_out.remedy()
    )]
    Unread {
        /// The dataset.
        root: PathBuf,
        /// The layout it was read as.
        layout: &'static str,
        /// The files.
        left_out: Box<LeftOut>,
    },
    /// There is no image of a split that was asked for.
    #[error(
        "{} has no image of the split {split}; its folders, lists or configuration name none. Give other --splits, or all",
        display(root)
    )]
    NoSplit {
        /// The dataset.
        root: PathBuf,
        /// The split.
        split: &'static str,
    },
    /// There is no image in it.
    #[error(
        "{} holds no images in layout {layout}; name the top folder of the dataset, or another --format",
        display(root)
    )]
    Empty {
        /// The dataset.
        root: PathBuf,
        /// The layout it was read as.
        layout: &'static str,
    },
}

/// How a dataset is read.
#[derive(Clone, Debug, Default)]
pub struct DatasetOptions {
    /// Its layout. Default: detected.
    pub layout: Option<Layout>,
    /// Extensions of files, without a dot, that belong to the image with their stem and go with each variant; the name of
    /// the image in them becomes the variant's name. Default: none.
    pub sidecars: Vec<String>,
    /// How files are read.
    pub reading: ReadOptions,
}

impl Dataset {
    /// Reads a dataset: its images and annotations. Of images only headers are read, and only where annotations leave a
    /// question: a box that reaches over the edge, an image that may be a mask.
    ///
    /// Without a given layout, the layout is detected. No file about images may be larger than a quarter of the
    /// memory that `reading` allows. What the folder holds beside is in [`Dataset::left_out`].
    ///
    /// # Errors
    ///
    /// [`DatasetError`] when its folder cannot be read, more than one layout fits, it holds no image, or it holds
    /// annotations of which none is read and the layout is not given as [`Layout::Folder`]. Faults of annotations are
    /// no error; they are in [`Dataset::faults`].
    pub fn open(root: &Path, given: Option<Layout>, reading: &ReadOptions) -> Result<Self, DatasetError> {
        Self::open_with(root, &DatasetOptions { layout: given, reading: *reading, ..Default::default() })
    }

    /// As [`open`](Self::open), with further options.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] as [`open`](Self::open).
    pub fn open_with(root: &Path, options: &DatasetOptions) -> Result<Self, DatasetError> {
        let DatasetOptions { layout: given, sidecars, reading } = options;
        let given = *given;
        let tree = Tree::of(root, reading)?;
        let layout = match given {
            Some(layout) => layout,
            None => recognise(root, &tree)?,
        };
        let mut dataset = Self {
            root: root.to_owned(),
            layout,
            samples: Vec::new(),
            indices: Vec::new(),
            faults: tree.faults.clone(),
            left_out: LeftOut::default(),
        };
        match layout {
            Layout::Folder => folder::read(&tree, &mut dataset),
            Layout::Coco => coco::read(&tree, &mut dataset)?,
            Layout::Yolo => yolo::read(&tree, &mut dataset)?,
            Layout::Voc => voc::read(&tree, &mut dataset)?,
            Layout::Masks => masks::read(&tree, &mut dataset),
            Layout::Shards => shards::read(&tree, &mut dataset),
            Layout::Parquet if cfg!(not(feature = "parquet")) => {
                return Err(DatasetError::NotBuilt { root: root.to_owned() });
            }
            Layout::Parquet => tables::read(&tree, &mut dataset),
        }
        dataset.complete(&tree, sidecars);
        let (root, layout_name) = (root.to_owned(), layout.name());
        if dataset.is_without_annotations() && given != Some(Layout::Folder) && dataset.left_out.has_labels()
        {
            let left_out = Box::new(dataset.left_out);
            return Err(DatasetError::Unread { root, layout: layout_name, left_out });
        }
        if dataset.samples.is_empty() && dataset.faults.is_empty() {
            return Err(DatasetError::Empty { root, layout: layout_name });
        }
        Ok(dataset)
    }

    /// Adds what any layout may have beside its own annotations, sorts the samples, and names what is left.
    fn complete(&mut self, tree: &Tree, sidecars: &[String]) {
        self.samples.sort_by(|a, b| a.key.cmp(&b.key));
        let mut masks = BTreeSet::new();
        if !self.layout.holds_many() {
            if self.layout != Layout::Folder {
                masks::attach(tree, self);
            }
            sidecars::attach(tree, sidecars, self);
            masks = suspects::suspects(tree);
            let is_named = self.layout == Layout::Coco;
            self.samples
                .retain(|sample| is_named || !sample.companions.is_empty() || !masks.contains(&sample.key));
            lists::attach(tree, self);
        }
        for (sample, rank) in self.samples.iter_mut().zip(0..) {
            sample.rank = rank;
        }
        splits::find(tree, self);
        left_out::look(tree, &masks, self);
    }

    /// Whether no annotation was read, and none was found to be bad.
    fn is_without_annotations(&self) -> bool {
        let is_coco = |index: &Index| matches!(index, Index::Coco(_));
        !self.layout.holds_many()
            && self.faults.is_empty()
            && self.samples.iter().all(|sample| sample.companions.is_empty())
            && !self.indices.iter().any(is_coco)
    }
}

/// The layout of a dataset, detected from its files.
fn recognise(root: &Path, tree: &Tree) -> Result<Layout, DatasetError> {
    let mut fits = Vec::new();
    for layout in Layout::ALL {
        let evidence = layout.evidence(tree).map_err(or_say_which)?;
        fits.extend(evidence.map(|evidence| (layout, evidence)));
    }
    let said = |(layout, evidence): &(Layout, String)| format!("{} ({evidence})", layout.name());
    // Every layout carries masks too.
    if fits.len() > 1 {
        fits.retain(|(layout, _)| *layout != Layout::Masks);
    }
    match fits.as_slice() {
        [] => Ok(Layout::Folder),
        [(layout, _)] => Ok(*layout),
        [one, other, ..] => {
            Err(DatasetError::Ambiguous { root: root.to_owned(), one: said(one), other: said(other) })
        }
    }
}

/// Another remedy for a file that is too large to detect a layout from it.
fn or_say_which(error: FileError) -> FileError {
    match error {
        FileError::TooLarge { path, cause } => FileError::TooLarge {
            path,
            cause: format!("{cause}; if it holds no annotations, choose the layout with --format"),
        },
        other => other,
    }
}

/// The folder of a path, as a prefix of its files, and the name.
pub(crate) fn split(path: &str) -> (&str, &str) {
    match path.rsplit_once('/') {
        Some((folder, name)) => (folder, name),
        None => ("", path),
    }
}

/// A path of a folder and a name in it.
pub(crate) fn join(folder: &str, name: &str) -> String {
    if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }
}

/// A name without its extension.
pub(crate) fn stem(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => name,
    }
}

#[cfg(test)]
mod tests;
