//! Which images are read and where their results go: what can be refused before work begins is refused here.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::contents::{Contents, File, not_entered};
use super::{Item, RECORD, Record, State};
use crate::depth_network::DepthNetwork;
use crate::files::{FileError, display, refuse_inputs};
use crate::image_file::LISTED;
use crate::pipeline::{DepthSource, DepthSupply, Operation, maps};

/// What is to be made.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Images, or folders of images.
    pub contents: &'a [PathBuf],
    /// Also enter the folders in folders; outputs are then in folders of the same names.
    pub recursive: bool,
    /// A file or a folder for one image, else a folder.
    pub output: &'a Path,
    /// Further inputs, which no output may replace.
    pub inputs: &'a [&'a Path],
    /// Where depth comes from.
    pub depth: &'a DepthSupply,
    /// A folder for the maps that each image is made from.
    pub maps: Option<&'a Path>,
    /// Score each image before and after.
    pub scores: bool,
    /// Replace files that exist.
    pub overwrite: bool,
}

impl<'a> Request<'a> {
    /// Contents and an output, with nothing else asked for.
    pub fn new(contents: &'a [PathBuf], output: &'a Path, depth: &'a DepthSupply) -> Self {
        Self {
            contents,
            recursive: false,
            output,
            inputs: &[],
            depth,
            maps: None,
            scores: false,
            overwrite: false,
        }
    }
}

/// Images to make, each with its output. Made once, by [`Plan::new`]; [`Plan::run`] makes the images.
#[derive(Clone, Debug)]
pub struct Plan {
    items: Vec<Item>,
    /// The folder of all outputs, where there may be several.
    folder: Option<PathBuf>,
    /// Folders that were not entered.
    folders: usize,
    unread: Vec<PathBuf>,
    /// What is read beside the images.
    inputs: Vec<PathBuf>,
    maps: Option<PathBuf>,
    scores: bool,
    overwrite: bool,
}

/// A run cannot begin. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A file or folder cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// An output would replace an input.
    #[error("{} is an input and must not be overwritten; give another output", display(path))]
    Input {
        /// The input.
        path: PathBuf,
    },
    /// A folder is both content and output.
    #[error("{} is both content and output; give another output folder", display(folder))]
    SameFolder {
        /// The folder.
        folder: PathBuf,
    },
    /// The content is a folder, the output a file.
    #[error(
        "{} is a folder, so the output must be a folder too; {} is a file name",
        display(content),
        display(output)
    )]
    NoFolder {
        /// The content.
        content: PathBuf,
        /// The output.
        output: PathBuf,
    },
    /// The folder holds no image.
    #[error(
        "{} holds no {LISTED} ({others} other files{}); name the folder that contains the images",
        display(folder),
        not_entered(*inner)
    )]
    NoImages {
        /// The folder.
        folder: PathBuf,
        /// Files in it.
        others: usize,
        /// Folders in it that were not entered.
        inner: usize,
    },
    /// There are several contents, the output is a file.
    #[error("several images go to one folder; {} is a file name. Name a folder with -o", display(output))]
    NoFolderForMany {
        /// The output.
        output: PathBuf,
    },
    /// Two images would have one output.
    #[error("{} and {} would have the same output; rename one of them", display(.one), display(.other))]
    OneOutput {
        /// One image.
        one: PathBuf,
        /// The other.
        other: PathBuf,
    },
    /// Two images would have maps of one name.
    #[error("{} and {} would have maps of the same name; rename one of them", display(.one), display(.other))]
    OneMap {
        /// One image.
        one: PathBuf,
        /// The other.
        other: PathBuf,
    },
    /// Maps are of an image by itself.
    #[error(
        "{} cannot have maps of a sequence: its water comes from several frames; leave out --maps or --sequence",
        display(folder)
    )]
    MapsOfSequence {
        /// The folder for maps.
        folder: PathBuf,
    },
    /// Several outputs exist.
    #[error("{first} ({others} more outputs exist)")]
    Exist {
        /// The first of them.
        first: FileError,
        /// How many more exist.
        others: usize,
    },
}

impl Plan {
    /// Lists what is to be made, and refuses what can be refused before an image is read. Nothing is written.
    ///
    /// # Errors
    ///
    /// [`PlanError`] when the content cannot be read, or an output would replace a file that must stay.
    pub fn new(request: &Request<'_>) -> Result<Self, PlanError> {
        let Request { contents, recursive, output, inputs, depth, maps, scores, overwrite } = *request;
        for content in contents {
            content.metadata().map_err(|error| FileError::Read { path: content.to_owned(), error })?;
        }
        let Contents { files, unread, folders } = match contents {
            [content] if !content.is_dir() => Contents::of_file(content, output)?,
            contents => Contents::of_many(contents, output, recursive)?,
        };
        let is_folder = !matches!(contents, [content] if !content.is_dir());
        let kept = is_folder.then(|| depth.kept_in(output));
        let depth = kept.as_ref().unwrap_or(depth);
        let mut depths: HashMap<PathBuf, DepthSupply> = HashMap::new();
        // Resolved once: there may be a hundred thousand outputs.
        let inputs: Vec<PathBuf> = inputs.iter().filter_map(|other| other.canonicalize().ok()).collect();
        let item = |File { input, output, within }: File| {
            if !depths.contains_key(&within) {
                depths.insert(within.clone(), depth.within(&within)?);
            }
            let depth = depths.get(&within).unwrap_or(depth).of(&input)?;
            let map = match &depth {
                DepthSource::Supplied { path, .. } => path.canonicalize().ok(),
                DepthSource::Estimated(_) => None,
            };
            let is_input = |there: PathBuf| inputs.contains(&there) || map.as_ref() == Some(&there);
            if output.canonicalize().is_ok_and(is_input) {
                return Err(PlanError::Input { path: output });
            }
            Ok(Item { input, output, depth })
        };
        let items = files.into_iter().map(item).collect::<Result<_, _>>()?;
        let plan = Self {
            items,
            folder: is_folder.then(|| output.to_owned()),
            folders,
            unread,
            inputs,
            maps: maps.map(Path::to_owned),
            scores,
            overwrite,
        };
        plan.refuse_unrecorded()?;
        Ok(plan)
    }

    /// The images, by name.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The folder of all outputs, in which a run keeps a record; none for one image.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The network that depth comes from, if it does.
    pub fn network(&self) -> Option<&DepthNetwork> {
        self.items.iter().find_map(|item| match &item.depth {
            DepthSource::Estimated(estimator) => estimator.network(),
            DepthSource::Supplied { .. } => None,
        })
    }

    /// How many folders in the contents were not entered, because the run is not recursive.
    pub fn folders_left_out(&self) -> usize {
        self.folders
    }

    /// The pictures of the folder that are in formats that are not read.
    pub fn unread(&self) -> &[PathBuf] {
        &self.unread
    }

    /// Refuses further outputs that stand where something is read, or where an image is written.
    ///
    /// # Errors
    ///
    /// [`FileError::IsInput`] for the first that does.
    pub fn refuse_taken<'a>(&self, outputs: impl IntoIterator<Item = &'a Path>) -> Result<(), FileError> {
        let taken = self.items.iter().flat_map(|Item { input, output, depth }| {
            let map = match depth {
                DepthSource::Supplied { path, .. } => Some(path),
                DepthSource::Estimated(_) => None,
            };
            [Some(input), Some(output), map].into_iter().flatten()
        });
        refuse_inputs(outputs, taken.chain(&self.inputs).map(PathBuf::as_path))
    }

    pub(super) fn maps(&self) -> Option<&Path> {
        self.maps.as_deref()
    }

    pub(super) fn scores(&self) -> bool {
        self.scores
    }

    pub(super) fn overwrite(&self) -> bool {
        self.overwrite
    }

    /// Refuses outputs that exist, unless a record in their folder may say that they are ours.
    fn refuse_unrecorded(&self) -> Result<(), PlanError> {
        let recorded = self.folder.as_ref().is_some_and(|folder| folder.join(RECORD).exists());
        if self.overwrite || recorded {
            return Ok(());
        }
        refuse(self.items.iter().filter(|item| item.output.symlink_metadata().is_ok()))
    }

    /// Refuses outputs that exist and are not ours.
    pub(super) fn refuse_foreign(&self, record: &Record) -> Result<(), PlanError> {
        refuse(self.items.iter().filter(|item| record.state(item, self.overwrite) == State::Foreign))
    }

    /// Refuses maps that exist and would be replaced, and images whose maps would have one name.
    pub(super) fn refuse_maps(
        &self,
        folder: &Path,
        operation: &Operation,
        record: Option<&Record>,
    ) -> Result<(), PlanError> {
        let all = self.items.iter().flat_map(|item| maps::paths(folder, &item.input, operation));
        let all: Vec<PathBuf> = all.collect();
        self.refuse_taken(all.iter().map(PathBuf::as_path))?;
        let mut taken = HashMap::new();
        for item in &self.items {
            let is_new = record.is_none_or(|record| record.state(item, self.overwrite) == State::Missing);
            for path in maps::paths(folder, &item.input, operation) {
                if !self.overwrite && is_new && path.symlink_metadata().is_ok() {
                    return Err(FileError::Exists { path }.into());
                }
                if let Some(other) = taken.insert(path, &item.input) {
                    return Err(PlanError::OneMap { one: item.input.clone(), other: other.clone() });
                }
            }
        }
        Ok(())
    }
}

fn refuse<'a>(mut existing: impl Iterator<Item = &'a Item>) -> Result<(), PlanError> {
    let Some(first) = existing.next() else { return Ok(()) };
    let first = FileError::Exists { path: first.output.clone() };
    match existing.count() {
        0 => Err(first.into()),
        others => Err(PlanError::Exist { first, others }),
    }
}
