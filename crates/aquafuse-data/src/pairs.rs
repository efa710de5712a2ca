//! Images with known depth: a folder with `rgb/` and `depth/`, whose files share their stems.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use aquafuse::depth::fit::{Fitter, LabelError, Options};
use aquafuse::depth::{SuppliedError, SuppliedKind};
use aquafuse::image::Image;

use crate::depth_file;
use crate::files::{FileError, display};
use crate::image_file::{ImageFile, ReadOptions};
use crate::run::{self, Budget, Event, Reservation, RunOptions, Stopped};

/// Bytes a pixel of the map as it is read, of its labels and of their order.
const BYTES_OF_DEPTH: u64 = 16;

/// An image and its depth map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pair {
    /// The stem that they share.
    pub name: String,
    /// The image.
    pub rgb: PathBuf,
    /// Its depth.
    pub depth: PathBuf,
}

/// The content of a folder of pairs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// Pairs, by name.
    pub pairs: Vec<Pair>,
    /// Stems in only one of the two folders.
    pub without_partner: Vec<String>,
}

/// A pair, or a folder of them, cannot be used. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PairError {
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// Two files of a folder have one stem.
    #[error("{} and {} share their stem; remove one of them from the folder", display(.one), display(.other))]
    Ambiguous {
        /// One file.
        one: PathBuf,
        /// The other.
        other: PathBuf,
    },
    /// The depth cannot be used for a fit.
    #[error("cannot use {}: {error}. Check --depth-kind, or remove the pair", display(path))]
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
        let stem = display(stem.as_ref()).to_string();
        if let Some(one) = files.insert(stem, path.clone()) {
            return Err(PairError::Ambiguous { one, other: path });
        }
    }
    Ok(files)
}

impl Pair {
    /// Reads image and depth: one distance a pixel, NaN where it is not known
    /// ([`Supplied::labels`](aquafuse::depth::Supplied::labels)).
    ///
    /// # Errors
    ///
    /// [`PairError`] when a file cannot be read, or the depth does not suit the image or its kind.
    pub fn read(
        &self,
        kind: SuppliedKind,
        options: &ReadOptions,
    ) -> Result<(Image<u8>, Vec<f32>), PairError> {
        self.read_within(kind, options, &Budget::new(options.max_memory))
            .map(|(image, labels, _)| (image, labels))
    }

    /// As [`Pair::read`], when what it takes is free of a budget; and the part of it that was reserved.
    fn read_within<'a>(
        &self,
        kind: SuppliedKind,
        options: &ReadOptions,
        budget: &'a Budget,
    ) -> Result<(Image<u8>, Vec<f32>, Reservation<'a>), PairError> {
        let opened = ImageFile::open(&self.rgb, options)?;
        let maps = opened.pixels().saturating_mul(BYTES_OF_DEPTH);
        let room = budget.reserve(opened.memory().saturating_add(maps));
        let image_file = opened.decode()?;
        let path = || self.depth.clone();
        let labels = depth_file::read_for(&self.depth, kind, image_file.pixels.size())?
            .labels(&image_file.bytes())
            .map_err(|error| match error {
                // Said as of labels that are flat in metres.
                SuppliedError::Flat { value } => {
                    PairError::Labels { path: path(), error: LabelError::Flat { value } }
                }
                error => {
                    let turned = image_file.metadata.orientation() > 4;
                    FileError::UnfitDepth { path: path(), error, turned }.into()
                }
            })?;
        Ok((image_file.pixels.into_bytes(), labels, room))
    }
}

/// Whoever listens while pairs are read.
pub type Listener<'a> = run::Listener<'a, Pair, (), PairError>;

/// Pairs, ready to be fitted to.
#[derive(Clone, Debug, Default)]
pub struct Gathered {
    /// Their samples.
    pub fitter: Fitter,
    /// Their names, in the order of the fitter's scores.
    pub names: Vec<String>,
}

/// Reads pairs on the threads of a run, within its memory; what is kept of each does not grow with its pixels.
///
/// The result does not depend on the number of threads: pairs come out in the order they are given in.
///
/// # Errors
///
/// [`Stopped`] when the run was stopped. A pair that cannot be used is an event, and the others go on.
pub fn gather(
    pairs: &[Pair],
    kind: SuppliedKind,
    options: Options,
    run: &RunOptions,
    listener: Listener<'_>,
) -> Result<Gathered, Stopped> {
    let budget = run.budget();
    listener(Event::Started { total: pairs.len() });
    let add = |pair: &Pair| {
        let labels = |error| PairError::Labels { path: pair.depth.clone(), error };
        let mut fitter = Fitter::new(options);
        let added = pair
            .read_within(kind, &run.reading, &budget)
            .and_then(|(image, distances, _room)| fitter.add(&image, &distances).map_err(labels));
        match added {
            Ok(()) => {
                listener(Event::Done { item: pair, result: () });
                Some(fitter)
            }
            Err(error) => {
                listener(Event::Failed { item: pair, error });
                None
            }
        }
    };
    let read = run.map(pairs, add)?;
    let mut gathered = Gathered { fitter: Fitter::new(options), names: Vec::new() };
    for (pair, fitter) in pairs.iter().zip(read) {
        if let Some(fitter) = fitter {
            gathered.fitter.merge(fitter);
            gathered.names.push(pair.name.clone());
        }
    }
    Ok(gathered)
}

#[cfg(test)]
mod tests;
