//! Which file a report is written to: its name says the format.

use std::path::{Path, PathBuf};

use super::{Report, csv, html, json, markdown};
use crate::files::{FileError, write_text};

/// What the name of a report ends in.
const NAMES: &str = ".md, .csv, .json or .html, or be that of a folder";

type Format = fn(&Report) -> String;

const FORMATS: [(&str, Format); 4] =
    [("md", markdown::document), ("csv", csv::tables), ("json", json::document), ("html", html::page)];

/// The files that a report of this name consists of: one, or, for the name of a folder, all of them.
fn files(path: &Path) -> Result<Vec<(PathBuf, Format)>, FileError> {
    let Some(extension) = path.extension().filter(|_| !path.is_dir()) else {
        let all = FORMATS.map(|(extension, format)| (path.join("report").with_extension(extension), format));
        let items: (PathBuf, Format) = (path.join("items.csv"), |report| csv::items(&report.items));
        return Ok(all.into_iter().chain([items]).collect());
    };
    let named = FORMATS.into_iter().find(|(name, _)| extension.eq_ignore_ascii_case(name));
    let (_, format) =
        named.ok_or_else(|| FileError::UnknownExtension { path: path.to_owned(), expected: NAMES })?;
    Ok(vec![(path.to_owned(), format)])
}

/// Refuses a name that no report can have, or whose files exist and may not be replaced.
///
/// # Errors
///
/// [`FileError`] that says which.
pub fn check_name(path: &Path, overwrite: bool) -> Result<(), FileError> {
    let files = files(path)?;
    let existing = files.into_iter().find(|(path, _)| !overwrite && path.symlink_metadata().is_ok());
    existing.map_or(Ok(()), |(path, _)| Err(FileError::Exists { path }))
}

/// Writes a report: Markdown, CSV (a line a figure), JSON or HTML by its extension, or all four into a folder, with
/// `items.csv`, a line a result.
///
/// # Errors
///
/// [`FileError`] when the name is of none of these, a file exists and may not be replaced, or the system refuses.
pub fn write(report: &Report, path: &Path, overwrite: bool) -> Result<(), FileError> {
    for (path, format) in files(path)? {
        write_text(&path, &format(report), overwrite)?;
    }
    Ok(())
}
