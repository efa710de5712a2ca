//! Outputs of another tool, matched by file name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use aquafuse::image::Image;
use aquafuse::scene_area::Border;

use super::error::EvaluateError;
use super::members::Member;
use crate::files::display;
use crate::image_file;
use crate::image_file::{ImageFile, ReadOptions};

/// Bytes a pixel that an output takes while it is read, in 16 bits with opacity and its file.
pub(crate) const BYTES_A_PIXEL: u64 = 24;

/// The outputs of a tool: one image for each stem.
#[derive(Clone, Debug)]
pub struct Outputs {
    name: String,
    folder: PathBuf,
    by_stem: BTreeMap<String, Vec<PathBuf>>,
}

impl Outputs {
    /// Lists what the tool called `name` has written into `folder`.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when the folder cannot be listed, or holds no image.
    pub fn list(name: &str, folder: &Path) -> Result<Self, EvaluateError> {
        let mut by_stem: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
        for path in image_file::list(folder)?.images {
            let stem = display(path.file_stem().unwrap_or_default().as_ref()).to_string();
            by_stem.entry(stem).or_default().push(path);
        }
        match by_stem.is_empty() {
            true => Err(EvaluateError::NoImages { folder: folder.to_owned() }),
            false => Ok(Self { name: name.to_owned(), folder: folder.to_owned(), by_stem }),
        }
    }

    /// What the tool is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The scene in the output of this stem, which has the size of the image it was made from.
    pub(crate) fn read(
        &self,
        stem: &str,
        content: &Member,
        image: &ImageFile,
        options: &ReadOptions,
    ) -> Result<Image<u8>, EvaluateError> {
        let found = self.by_stem.get(stem);
        let Some([path]) = found.map(Vec::as_slice) else {
            let found = found.map_or(0, Vec::len);
            return Err(EvaluateError::NoOutput {
                folder: self.folder.clone(),
                stem: stem.to_owned(),
                found,
            });
        };
        let opened = ImageFile::open(path, &ReadOptions { border: Border::None, ..*options })?;
        let size = image.whole_size();
        // Before it is decoded: memory is reserved for one of the content's size.
        let (found, expected) = (opened.size(), (size.0 as u64, size.1 as u64));
        if found != expected {
            let (output, content) = (path.clone(), content.path.clone());
            return Err(EvaluateError::Size { output, found, content, expected });
        }
        let output = opened.decode()?.pixels.into_bytes();
        Ok(match image.area() {
            Some(area) => area.cut(&output),
            None => output,
        })
    }
}

/// Refuses images that share a stem: outputs could not be matched to them.
pub(crate) fn refuse_ambiguous(members: &[Member]) -> Result<(), EvaluateError> {
    let mut taken: BTreeMap<String, &Path> = BTreeMap::new();
    for member in members {
        if let Some(one) = taken.insert(member.stem(), &member.path) {
            return Err(EvaluateError::Ambiguous { one: one.to_owned(), other: member.path.clone() });
        }
    }
    Ok(())
}
