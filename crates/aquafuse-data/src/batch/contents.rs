//! The images of a run and where their results go: of one image, of several, of folders and of the folders within them.

use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::PlanError;
use crate::files::FileError;
use crate::image_file::{self, Format, WRITTEN};

/// Folders within folders; deeper ones are a mistake.
const DEEPEST: usize = 32;

/// What a run is about.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// The images, by the paths of their results.
    pub(super) files: Vec<File>,
    /// Pictures in formats that are not read.
    pub(super) unread: Vec<PathBuf>,
    /// Folders that were not entered.
    pub(super) folders: usize,
}

/// An image and its result.
#[derive(Debug)]
pub(super) struct File {
    pub(super) input: PathBuf,
    pub(super) output: PathBuf,
    /// The folder of the image within its content; empty where it stands there itself.
    pub(super) within: PathBuf,
}

impl Contents {
    /// One image, whose output is a file or a folder.
    pub(super) fn of_file(content: &Path, output: &Path) -> Result<Self, PlanError> {
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
        let file = File { input: content.to_owned(), output, within: PathBuf::new() };
        Ok(Self { files: vec![file], ..Self::default() })
    }

    /// Images and folders of images, whose output is a folder: by name, and by folder where folders are entered.
    pub(super) fn of_many(contents: &[PathBuf], output: &Path, recursive: bool) -> Result<Self, PlanError> {
        let mut all = Self::default();
        let named_as_a_file = Format::of(output).is_some() && !output.is_dir();
        if output.is_file() || named_as_a_file {
            let content = contents.first().cloned().unwrap_or_default();
            return Err(match contents {
                [_] => PlanError::NoFolder { content, output: output.to_owned() },
                _ => PlanError::NoFolderForMany { output: output.to_owned() },
            });
        }
        let mut taken = HashMap::new();
        for content in contents {
            if content.is_dir() {
                if same(content, output) {
                    return Err(PlanError::SameFolder { folder: content.clone() });
                }
                let before = all.files.len();
                all.enter(content, Path::new(""), output, recursive, 0, &mut taken)?;
                if all.files.len() == before {
                    let others = image_file::list(content)?;
                    let others = others.others.saturating_add(others.unread.len());
                    let inner = if recursive { 0 } else { all.folders };
                    return Err(PlanError::NoImages { folder: content.clone(), others, inner });
                }
            } else {
                all.add(content.clone(), Path::new(""), output, &mut taken)?;
            }
        }
        all.files.sort_by(|a, b| a.input.cmp(&b.input));
        Ok(all)
    }

    /// Adds the images of a folder, and of those in it on request. Links to folders are not followed, hidden folders and the
    /// output are not entered.
    fn enter(
        &mut self,
        content: &Path,
        within: &Path,
        output: &Path,
        recursive: bool,
        depth: usize,
        taken: &mut HashMap<PathBuf, PathBuf>,
    ) -> Result<(), PlanError> {
        let folder = if within.as_os_str().is_empty() { content.to_owned() } else { content.join(within) };
        let listing = image_file::list(&folder)?;
        self.unread.extend(listing.unread);
        for input in listing.images {
            self.add(input, within, output, taken)?;
        }
        let mut inner = listing.folders;
        inner.sort();
        if !recursive {
            self.folders = self.folders.saturating_add(inner.len());
            return Ok(());
        }
        for name in inner {
            let within = within.join(name);
            if depth >= DEEPEST {
                let cause = "it lies too deep within other folders; name it as content".to_owned();
                return Err(FileError::Folder { path: content.join(within), cause }.into());
            }
            if !same(&content.join(&within), output) {
                self.enter(content, &within, output, recursive, depth.saturating_add(1), taken)?;
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        input: PathBuf,
        within: &Path,
        output: &Path,
        taken: &mut HashMap<PathBuf, PathBuf>,
    ) -> Result<(), PlanError> {
        let output = output.join(within).join(output_name(&input));
        if same(&input, &output) {
            return Err(PlanError::Input { path: output });
        }
        if let Some(other) = taken.insert(output.clone(), input.clone()) {
            return Err(PlanError::OneOutput { one: input, other });
        }
        self.files.push(File { input, output, within: within.to_owned() });
        Ok(())
    }
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

/// The folders that were not entered, as an error says it.
pub(super) fn not_entered(inner: usize) -> String {
    match inner {
        0 => String::new(),
        inner => format!(" and {inner} folders, which --recursive enters"),
    }
}
