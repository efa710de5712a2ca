//! Datasets: images, and what other files say of them.
//!
//! A dataset is read into [`Sample`]s, each an image with the files that are about it alone, and [`Index`] files,
//! which are about all of them. Both are known by paths within the dataset, with `/` between their parts.

pub(crate) mod coco;
mod fault;
mod folder;
mod index;
mod masks;
pub(crate) mod shards;
pub(crate) mod tables;
mod tree;
mod voc;
mod yolo;

use std::path::{Path, PathBuf};

pub use fault::{Fault, Faults};
pub use index::Index;
pub(crate) use tree::{Tree, inside};
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
    /// Images in folders, and nothing about them.
    Folder,
    /// Files of JSON with `images` and `annotations`: instances, keypoints, captions.
    Coco,
    /// A text file an image, in `labels/` where the image stands in `images/`: detection, segmentation, pose.
    Yolo,
    /// An XML file an image, in `Annotations/` where the image stands in `JPEGImages/`.
    Voc,
    /// WebDataset: tar files, in which all about one image has its name.
    Shards,
    /// An image an image, in `masks/` where the image stands in `images/`.
    Masks,
    /// Parquet: tables with a column of images, as Hugging Face lays them out. Read with the feature `parquet`.
    Parquet,
}

impl Layout {
    /// All of them.
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

    /// The layout of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|layout| layout.name() == name)
    }

    /// Whether a file of it holds many images, and is made as a whole.
    pub fn holds_many(self) -> bool {
        matches!(self, Self::Shards | Self::Parquet)
    }

    /// What in the dataset speaks for this layout, in words; nothing speaks for [`Layout::Folder`] but images.
    fn evidence(self, tree: &Tree) -> Result<Option<String>, FileError> {
        Ok(match self {
            Self::Folder => None,
            Self::Coco => coco::evidence(tree)?,
            Self::Yolo => yolo::evidence(tree)?,
            Self::Voc => voc::evidence(tree),
            Self::Masks => masks::evidence(tree),
            Self::Shards => shards::evidence(tree),
            Self::Parquet => tables::evidence(tree),
        })
    }
}

/// A dataset as it was found.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// Its folder.
    pub root: PathBuf,
    /// How it is laid out.
    pub layout: Layout,
    /// Its images, sorted by key.
    pub samples: Vec<Sample>,
    /// The files about all of its images.
    pub indices: Vec<Index>,
    /// What is wrong with its annotations.
    pub faults: Faults,
}

/// An image of a dataset, with the files that are about it alone; or a file that [holds many](Layout::holds_many).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The path of the image, which names the sample.
    pub key: String,
    /// Its place in the dataset.
    pub rank: u64,
    /// The files about it.
    pub companions: Vec<Companion>,
}

/// A file about one image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Companion {
    /// Its path.
    pub path: String,
    /// Whether it is XML that names the image, and must name the variant.
    pub names_image: bool,
}

impl Sample {
    pub(crate) fn new(key: impl Into<String>, companions: Vec<Companion>) -> Self {
        Self { key: key.into(), rank: 0, companions }
    }
}

impl Companion {
    /// A file that is the same for every variant.
    fn carried(path: String) -> Self {
        Self { path, names_image: false }
    }

    /// What stands in the file for a variant of this file name.
    ///
    /// # Errors
    ///
    /// [`FileError`] when it cannot be read.
    pub fn for_variant(&self, root: &Path, image: &str, reading: &ReadOptions) -> Result<Vec<u8>, FileError> {
        let bytes = read_beside(&root.join(&self.path), reading)?;
        Ok(if self.names_image { voc::renamed(&bytes, image) } else { bytes })
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
    #[error("{} may be {one} or {other}; say which by --format", display(root))]
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
        "{} holds tables of Parquet, which this build does not read; build it with --features parquet",
        display(root)
    )]
    NotBuilt {
        /// The dataset.
        root: PathBuf,
    },
    /// There is no image in it.
    #[error(
        "{} holds no images of a dataset of layout {layout}; name the folder above them, or the right --format",
        display(root)
    )]
    Empty {
        /// The dataset.
        root: PathBuf,
        /// The layout it was read as.
        layout: &'static str,
    },
}

impl Dataset {
    /// Reads a dataset: which images it holds, and what is about them. No image is opened.
    ///
    /// The layout is told by looking where none is given. No file about images may be larger than a quarter of the
    /// memory that `reading` allows.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] when its folder cannot be read, more than one layout fits, or it holds no image. What is
    /// wrong with annotations is no error but among the [`Dataset::faults`].
    pub fn open(root: &Path, layout: Option<Layout>, reading: &ReadOptions) -> Result<Self, DatasetError> {
        let tree = Tree::of(root, reading)?;
        let layout = match layout {
            Some(layout) => layout,
            None => recognise(root, &tree)?,
        };
        let mut dataset = Self {
            root: root.to_owned(),
            layout,
            samples: Vec::new(),
            indices: Vec::new(),
            faults: tree.faults.clone(),
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
        dataset.samples.sort_by(|a, b| a.key.cmp(&b.key));
        for (sample, rank) in dataset.samples.iter_mut().zip(0..) {
            sample.rank = rank;
        }
        if dataset.samples.is_empty() && dataset.faults.is_empty() {
            return Err(DatasetError::Empty { root: root.to_owned(), layout: layout.name() });
        }
        Ok(dataset)
    }
}

/// The layout of a dataset, told by what stands in it.
fn recognise(root: &Path, tree: &Tree) -> Result<Layout, DatasetError> {
    let mut fits = Vec::new();
    for layout in Layout::ALL {
        let evidence = layout.evidence(tree).map_err(or_say_which)?;
        fits.extend(evidence.map(|evidence| (layout, evidence)));
    }
    let said = |(layout, evidence): &(Layout, String)| format!("{} ({evidence})", layout.name());
    match fits.as_slice() {
        [] => Ok(Layout::Folder),
        [(layout, _)] => Ok(*layout),
        [one, other, ..] => {
            Err(DatasetError::Ambiguous { root: root.to_owned(), one: said(one), other: said(other) })
        }
    }
}

/// What else may be done about a file that is too large to tell whether it speaks for a layout.
fn or_say_which(error: FileError) -> FileError {
    match error {
        FileError::TooLarge { path, cause } => FileError::TooLarge {
            path,
            cause: format!(
                "{cause}; if it is about something else, say by --format how the dataset is laid out"
            ),
        },
        other => other,
    }
}

/// The folder of a path, as a prefix of what stands in it, and the name.
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
