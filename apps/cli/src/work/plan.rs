//! What is to be read and written: everything that can be refused before work begins is refused here.

use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Error, Result, anyhow};
use aquafuse_data::analysis::DepthSource;
use aquafuse_data::files::{FileError, display};
use aquafuse_data::image_file;
use aquafuse_data::image_file::{Format, LISTED, WRITTEN};
use aquafuse_data::job::{Item, Plan, RECORD, Record};
use aquafuse_data::maps;

use crate::depth_arguments::Supply;

/// The images to treat: one, or those of a folder. `beside` are further inputs, not to be written over.
pub(super) fn items(content: &Path, beside: &[&Path], output: &Path, supply: &Supply) -> Result<Vec<Item>> {
    let about = content.metadata().map_err(|error| FileError::Read { path: content.to_owned(), error })?;
    let files = if about.is_dir() { of_folder(content, output)? } else { vec![of_file(content, output)?] };
    // Resolved once: there may be a hundred thousand outputs.
    let beside: Vec<PathBuf> = beside.iter().filter_map(|other| other.canonicalize().ok()).collect();
    let item = |(input, output): (PathBuf, PathBuf)| {
        let depth = supply.of(&input)?;
        let map = match &depth {
            DepthSource::Supplied { path, .. } => path.canonicalize().ok(),
            DepthSource::Estimated(_) => None,
        };
        if output.canonicalize().is_ok_and(|there| beside.contains(&there) || map.as_ref() == Some(&there)) {
            return Err(written_over(&output));
        }
        Ok(Item { input, output, depth })
    };
    files.into_iter().map(item).collect()
}

fn written_over(input: &Path) -> Error {
    anyhow!("{} is an input, not to be written over; give another output", display(input))
}

/// Refuses outputs that are there already, unless a record in their folder may say that they are ours.
pub(super) fn refuse_unrecorded(items: &[Item], is_job: bool) -> Result<()> {
    let recorded = items.first().is_some_and(|item| item.output.with_file_name(RECORD).exists());
    if is_job && recorded {
        return Ok(());
    }
    refuse(items.iter().filter(|item| item.output.symlink_metadata().is_ok()))
}

/// Refuses outputs that are there and not of our making.
pub(super) fn refuse_foreign(items: &[Item], record: &Record, overwrite: bool) -> Result<()> {
    refuse(items.iter().filter(|item| record.plan(item, overwrite) == Plan::Foreign))
}

/// Refuses maps that are there and would be replaced, and images whose maps would have one name.
pub(super) fn refuse_maps(
    items: &[Item],
    folder: &Path,
    record: Option<&Record>,
    overwrite: bool,
) -> Result<()> {
    let mut taken = HashMap::new();
    for item in items {
        let is_new = record.is_none_or(|record| record.plan(item, overwrite) == Plan::Make);
        for path in maps::paths(folder, &item.input) {
            if !overwrite && is_new && path.symlink_metadata().is_ok() {
                return Err(FileError::Exists { path }.into());
            }
            if let Some(other) = taken.insert(path, &item.input) {
                let (one, other) = (display(&item.input), display(other));
                return Err(anyhow!("{one} and {other} would have maps of one name; rename one of them"));
            }
        }
    }
    Ok(())
}

fn refuse<'a>(mut existing: impl Iterator<Item = &'a Item>) -> Result<()> {
    let Some(first) = existing.next() else { return Ok(()) };
    let exists = FileError::Exists { path: first.output.clone() };
    match existing.count() {
        0 => Err(exists.into()),
        others => Err(anyhow!("{exists} ({others} more outputs exist)")),
    }
}

/// Input and output.
fn of_file(content: &Path, output: &Path) -> Result<(PathBuf, PathBuf)> {
    let is_folder = output.is_dir() || output.as_os_str().as_encoded_bytes().ends_with(b"/");
    let output = match content.file_name() {
        Some(name) if is_folder => output.join(name),
        _ => output.to_owned(),
    };
    if Format::written(&output).is_none() {
        return Err(FileError::UnknownExtension { path: output, expected: WRITTEN }.into());
    }
    if same(content, &output) {
        return Err(written_over(&output));
    }
    Ok((content.to_owned(), output))
}

/// Input and output of each image.
fn of_folder(content: &Path, output: &Path) -> Result<Vec<(PathBuf, PathBuf)>> {
    if same(content, output) {
        return Err(anyhow!("{} is both content and output; give another output folder", display(content)));
    }
    let named_as_a_file = Format::of(output).is_some() && !output.is_dir();
    if output.is_file() || named_as_a_file {
        return Err(anyhow!(
            "{} is a folder, so the output must be one; {} is a file's name",
            display(content),
            display(output)
        ));
    }
    let listing = image_file::list(content)?;
    if listing.images.is_empty() {
        let others = listing.others;
        return Err(anyhow!(
            "{} holds no {LISTED}, but {others} other files; name the folder in which the images themselves stand",
            display(content)
        ));
    }
    let mut taken = HashMap::new();
    for input in listing.images {
        let output = output.join(output_name(&input));
        if let Some(other) = taken.insert(output, input.clone()) {
            let (one, other) = (display(&input), display(&other));
            return Err(anyhow!("{one} and {other} would have one output; rename one of them"));
        }
    }
    let mut files: Vec<_> = taken.into_iter().map(|(output, input)| (input, output)).collect();
    files.sort();
    Ok(files)
}

/// The name of the output of one of a folder's images: its own, with .png behind where we do not write its format.
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
