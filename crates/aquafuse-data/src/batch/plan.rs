//! Which images are read and where their results go: what can be refused before work begins is refused here.

use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::{Item, RECORD, Record, State};
use crate::files::{FileError, display};
use crate::image_file::{self, Format, LISTED, WRITTEN};
use crate::pipeline::{DepthSource, DepthSupply, Operation, maps};

/// What is to be made.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// An image, or a folder of images.
    pub content: &'a Path,
    /// A file or a folder for an image, a folder for a folder.
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
    /// A content and an output, with nothing else asked for.
    pub fn new(content: &'a Path, output: &'a Path, depth: &'a DepthSupply) -> Self {
        Self { content, output, inputs: &[], depth, maps: None, scores: false, overwrite: false }
    }
}

/// Images to make, each with its output. Made once, by [`Plan::new`]; [`Plan::run`] makes the images.
#[derive(Clone, Debug)]
pub struct Plan {
    items: Vec<Item>,
    is_folder: bool,
    unread: Vec<PathBuf>,
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
        "{} holds no {LISTED} ({others} other files; folders inside it are not entered); name the folder that contains the images",
        display(folder)
    )]
    NoImages {
        /// The folder.
        folder: PathBuf,
        /// Files in it.
        others: usize,
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
        "{} cannot have maps of a sequence, whose water is that of several frames; ask for maps without the sequence",
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
        let Request { content, output, inputs, depth, maps, scores, overwrite } = *request;
        let about =
            content.metadata().map_err(|error| FileError::Read { path: content.to_owned(), error })?;
        let is_folder = about.is_dir();
        let (files, unread) = match is_folder {
            true => of_folder(content, output)?,
            false => (vec![of_file(content, output)?], Vec::new()),
        };
        // Resolved once: there may be a hundred thousand outputs.
        let inputs: Vec<PathBuf> = inputs.iter().filter_map(|other| other.canonicalize().ok()).collect();
        let item = |(input, output): (PathBuf, PathBuf)| {
            let depth = depth.of(&input)?;
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
        let plan = Self { items, is_folder, unread, maps: maps.map(Path::to_owned), scores, overwrite };
        plan.refuse_unrecorded()?;
        Ok(plan)
    }

    /// The images, by name.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// Whether the content is a folder, whose run keeps a record.
    pub fn is_folder(&self) -> bool {
        self.is_folder
    }

    /// The pictures of the folder that are in formats that are not read.
    pub fn unread(&self) -> &[PathBuf] {
        &self.unread
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
        let recorded = self.items.first().is_some_and(|item| item.output.with_file_name(RECORD).exists());
        if self.overwrite || (self.is_folder && recorded) {
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

/// Input and output of one image.
fn of_file(content: &Path, output: &Path) -> Result<(PathBuf, PathBuf), PlanError> {
    let is_folder = output.is_dir() || output.as_os_str().as_encoded_bytes().ends_with(b"/");
    let output = match content.file_name() {
        Some(name) if is_folder => output.join(name),
        _ => output.to_owned(),
    };
    if Format::written(&output).is_none() {
        return Err(FileError::UnknownExtension { path: output, expected: WRITTEN }.into());
    }
    if same(content, &output) {
        return Err(PlanError::Input { path: output });
    }
    Ok((content.to_owned(), output))
}

/// Inputs, each with its output.
type Pairs = Vec<(PathBuf, PathBuf)>;

/// Input and output of each image of a folder, by name; and the pictures that are not read.
fn of_folder(content: &Path, output: &Path) -> Result<(Pairs, Vec<PathBuf>), PlanError> {
    if same(content, output) {
        return Err(PlanError::SameFolder { folder: content.to_owned() });
    }
    let named_as_a_file = Format::of(output).is_some() && !output.is_dir();
    if output.is_file() || named_as_a_file {
        return Err(PlanError::NoFolder { content: content.to_owned(), output: output.to_owned() });
    }
    let listing = image_file::list(content)?;
    if listing.images.is_empty() {
        let others = listing.others.saturating_add(listing.unread.len());
        return Err(PlanError::NoImages { folder: content.to_owned(), others });
    }
    let mut taken: HashMap<PathBuf, PathBuf> = HashMap::new();
    for input in listing.images {
        let output = output.join(output_name(&input));
        if let Some(other) = taken.insert(output, input.clone()) {
            return Err(PlanError::OneOutput { one: input, other });
        }
    }
    let mut files: Vec<_> = taken.into_iter().map(|(output, input)| (input, output)).collect();
    files.sort();
    Ok((files, listing.unread))
}

/// The name of an output: the input's, with .png appended where we do not write its format.
fn output_name(input: &Path) -> OsString {
    let mut name = input.file_name().unwrap_or_default().to_owned();
    if Format::written(input).is_none() {
        name.push(".png");
    }
    name
}

fn same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
