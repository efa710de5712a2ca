//! What is to be read and written: everything that can be refused before work begins is refused here.

use std::path::{Path, PathBuf};

use anyhow::{Error, Result, anyhow};
use aquafuse_data::analysis::DepthSource;
use aquafuse_data::folder;
use aquafuse_data::job::Item;
use aquafuse_data::picture::{FileError, Format};

use crate::depth_arguments::Supply;

/// The pictures to fuse: one, or those of a folder.
pub(super) fn items(content: &Path, water: &Path, output: &Path, supply: &Supply) -> Result<Vec<Item>> {
    let about = content.metadata().map_err(|error| FileError::Read { path: content.to_owned(), error })?;
    let files =
        if about.is_dir() { of_folder(content, output)? } else { vec![of_file(content, water, output)?] };
    let item = |(input, output): (PathBuf, PathBuf)| {
        let depth = supply.of(&input)?;
        if let DepthSource::Supplied { path, .. } = &depth
            && same(path, &output)
        {
            return Err(written_over(&output));
        }
        Ok(Item { input, output, depth })
    };
    files.into_iter().map(item).collect()
}

fn written_over(input: &Path) -> Error {
    anyhow!("{} is an input, not to be written over; give another output", input.display())
}

/// Refuses outputs that are there already.
pub(super) fn refuse_existing(items: &[Item]) -> Result<()> {
    let mut existing = items.iter().filter(|item| item.output.symlink_metadata().is_ok());
    let Some(first) = existing.next() else { return Ok(()) };
    let exists = FileError::Exists { path: first.output.clone() };
    match existing.count() {
        0 => Err(exists.into()),
        others => Err(anyhow!("{exists} ({others} more outputs exist)")),
    }
}

/// Input and output.
fn of_file(content: &Path, water: &Path, output: &Path) -> Result<(PathBuf, PathBuf)> {
    let is_folder = output.is_dir() || output.as_os_str().as_encoded_bytes().ends_with(b"/");
    let output = match content.file_name() {
        Some(name) if is_folder => output.join(name),
        _ => output.to_owned(),
    };
    if Format::of(&output).is_none() {
        return Err(FileError::UnknownExtension { path: output, expected: ".png, .jpg or .jpeg" }.into());
    }
    if [content, water].into_iter().any(|input| same(input, &output)) {
        return Err(written_over(&output));
    }
    Ok((content.to_owned(), output))
}

/// Input and output of each picture.
fn of_folder(content: &Path, output: &Path) -> Result<Vec<(PathBuf, PathBuf)>> {
    if same(content, output) {
        return Err(anyhow!("{} is both content and output; give another output folder", content.display()));
    }
    let named_as_a_file = Format::of(output).is_some() && !output.is_dir();
    if output.is_file() || named_as_a_file {
        return Err(anyhow!(
            "{} is a folder, so the output must be one; {} is a file's name",
            content.display(),
            output.display()
        ));
    }
    let listing = folder::list(content)?;
    if listing.pictures.is_empty() {
        let others = listing.others;
        return Err(anyhow!(
            "{} holds no .png, .jpg or .jpeg, but {others} other files; name the folder in which the pictures \
             themselves stand",
            content.display()
        ));
    }
    let output = |input: &Path| output.join(input.file_name().unwrap_or_default());
    Ok(listing.pictures.into_iter().map(|input| (input.clone(), output(&input))).collect())
}

fn same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
