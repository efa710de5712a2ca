//! Pictures with known depth: a folder with `rgb/` and `depth/`, whose files share their stems.

mod read;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use aquafuse::depth::fit::{Fitter, LabelError, Options};
use aquafuse::image::Image;
use rayon::prelude::*;

use crate::picture::FileError;
pub use read::{read_depth, read_rgb};

/// What the numbers of a depth file are. Nothing is guessed: the same numbers can be any of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LabelKind {
    /// Metres; 0 and less is unknown.
    Metres,
    /// Millimetres; 0 and less is unknown.
    Millimetres,
    /// Distance without a unit, larger is farther; 0 is near, less is unknown.
    Relative,
    /// 1 / distance, larger is nearer; 0 and less is unknown.
    Inverse,
    /// Disparity in pixels: 1 / distance but for a factor; 0 and less is unknown.
    Disparity,
}

impl LabelKind {
    /// All kinds.
    pub const ALL: [Self; 5] =
        [Self::Metres, Self::Millimetres, Self::Relative, Self::Inverse, Self::Disparity];

    /// The name used on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metres => "metres",
            Self::Millimetres => "millimetres",
            Self::Relative => "relative",
            Self::Inverse => "inverse",
            Self::Disparity => "disparity",
        }
    }

    /// The kind of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The distance that a stored number stands for; NaN where it stands for none.
    fn distance(self, stored: f32) -> f32 {
        let known = match self {
            Self::Relative => stored >= 0.0,
            _ => stored > 0.0,
        };
        match self {
            _ if !known || !stored.is_finite() => f32::NAN,
            Self::Metres | Self::Relative => stored,
            Self::Millimetres => stored / 1000.0,
            Self::Inverse | Self::Disparity => stored.recip(),
        }
    }
}

/// Two files that belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pair {
    /// The stem that they share.
    pub name: String,
    /// The picture.
    pub rgb: PathBuf,
    /// Its depth.
    pub depth: PathBuf,
}

/// Depth as read: one distance a pixel, NaN where it is not known.
#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Distances, row by row from the top, larger is farther.
    pub distances: Vec<f32>,
}

/// What stands in a folder of pairs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// Pairs, by name.
    pub pairs: Vec<Pair>,
    /// Stems that stand in one of the two folders only.
    pub without_partner: Vec<String>,
}

/// A pair, or a folder of them, cannot be used. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PairError {
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file is of a kind we do not read.
    #[error("cannot read {}: {found}; {expected}", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// What it is.
        found: String,
        /// What is read.
        expected: &'static str,
    },
    /// Two files of a folder have one stem.
    #[error("{} and {} share their stem; leave one of them in the folder", .one.display(), .other.display())]
    Ambiguous {
        /// One file.
        one: PathBuf,
        /// The other.
        other: PathBuf,
    },
    /// Picture and depth differ in size.
    #[error(
        "{} is {}x{}, its picture {}x{}; scale one of them to the other",
        path.display(), .depth.0, .depth.1, .rgb.0, .rgb.1
    )]
    Size {
        /// The depth file.
        path: PathBuf,
        /// Columns and rows of the depth.
        depth: (usize, usize),
        /// Columns and rows of the picture.
        rgb: (usize, usize),
    },
    /// The depth cannot be fitted to.
    #[error("cannot use {}: {error}. Check --depth-kind, or take the pair out", path.display())]
    Labels {
        /// The depth file.
        path: PathBuf,
        /// Why not.
        error: LabelError,
    },
}

/// Lists the pairs in `folder`: each file of `rgb/` with the file of `depth/` of the same stem.
///
/// # Errors
///
/// [`PairError`] when one of the two cannot be listed, or two files of one share a stem.
pub fn list(folder: &Path) -> Result<Listing, PairError> {
    let rgb = by_stem(&folder.join("rgb"))?;
    let mut depth = by_stem(&folder.join("depth"))?;
    let mut listing = Listing::default();
    for (name, rgb) in rgb {
        match depth.remove(&name) {
            Some(depth) => listing.pairs.push(Pair { name, rgb, depth }),
            None => listing.without_partner.push(name),
        }
    }
    listing.without_partner.extend(depth.into_keys());
    Ok(listing)
}

fn by_stem(folder: &Path) -> Result<BTreeMap<String, PathBuf>, PairError> {
    let failed = |error| FileError::Read { path: folder.to_owned(), error };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        paths.push(entry.map_err(failed)?.path());
    }
    paths.sort();
    let mut files = BTreeMap::new();
    for path in paths {
        let hidden = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        let Some(stem) = path.file_stem().filter(|_| !hidden && path.is_file()) else { continue };
        if let Some(one) = files.insert(stem.to_string_lossy().into_owned(), path.clone()) {
            return Err(PairError::Ambiguous { one, other: path });
        }
    }
    Ok(files)
}

impl Pair {
    /// Reads picture and depth.
    ///
    /// # Errors
    ///
    /// [`PairError`] when a file cannot be read or the two differ in size.
    pub fn read(&self, kind: LabelKind) -> Result<(Image<u8>, Labels), PairError> {
        let image = read_rgb(&self.rgb)?;
        let labels = read_depth(&self.depth, kind)?;
        if image.size() != (labels.width, labels.height) {
            let depth = (labels.width, labels.height);
            return Err(PairError::Size { path: self.depth.clone(), depth, rgb: image.size() });
        }
        Ok((image, labels))
    }
}

/// What reading pairs says as it goes.
#[derive(Debug)]
#[non_exhaustive]
pub enum Message<'a> {
    /// A pair is in.
    Done {
        /// Which.
        pair: &'a Pair,
    },
    /// A pair cannot be used; the others go on.
    Failed {
        /// Which.
        pair: &'a Pair,
        /// Why.
        error: PairError,
    },
}

/// Pairs, ready to be fitted to.
#[derive(Clone, Debug, Default)]
pub struct Gathered {
    /// What they tell.
    pub fitter: Fitter,
    /// Their names, in the order of the fitter's scores.
    pub names: Vec<String>,
}

/// Reads pairs on the threads of the pool it is called in; what of each is kept does not grow with its pixels.
///
/// The result does not depend on the number of threads: pairs come out in the order they are given in.
pub fn gather(
    pairs: &[Pair],
    kind: LabelKind,
    options: Options,
    listener: &(dyn Fn(Message<'_>) + Sync),
) -> Gathered {
    let none = || Gathered { fitter: Fitter::new(options), names: Vec::new() };
    let add = |mut gathered: Gathered, pair: &Pair| {
        let labels = |error| PairError::Labels { path: pair.depth.clone(), error };
        let added = pair
            .read(kind)
            .and_then(|(image, depth)| gathered.fitter.add(&image, &depth.distances).map_err(labels));
        match added {
            Ok(()) => {
                gathered.names.push(pair.name.clone());
                listener(Message::Done { pair });
            }
            Err(error) => listener(Message::Failed { pair, error }),
        }
        gathered
    };
    let join = |mut left: Gathered, right: Gathered| {
        left.fitter.merge(right.fitter);
        left.names.extend(right.names);
        left
    };
    pairs.par_iter().fold(none, add).reduce(none, join)
}

#[cfg(test)]
mod tests;
