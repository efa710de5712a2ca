//! Which images a folder holds.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::files::{FileError, Step, count};
use crate::image_file::Format;

/// The content of a folder, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// Files whose extension names an image format (not GIF), sorted by name.
    pub images: Vec<PathBuf>,
    /// Pictures in formats that are not read, sorted by name.
    pub unread: Vec<PathBuf>,
    /// The names of the folders in it, without hidden ones and links.
    pub folders: Vec<OsString>,
    /// Files that were passed over because they are no pictures; hidden ones not counted.
    pub others: usize,
}

/// Lists the images that stand directly in `folder`; folders inside it are not entered.
///
/// # Errors
///
/// [`FileError::Read`] when the folder cannot be listed.
pub fn list(folder: &Path) -> Result<Listing, FileError> {
    let failed = |error| FileError::Read { path: folder.to_owned(), error };
    count(Step::FolderListed);
    let mut listing = Listing::default();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let path = entry.path();
        let hidden = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        // What the listing says already need not be asked, but a link may lead to a folder.
        let kind = entry.file_type().ok().filter(|kind| !kind.is_symlink());
        let is_dir = kind.map_or_else(|| path.is_dir(), |kind| kind.is_dir());
        if hidden || is_dir {
            if !hidden && kind.is_some() {
                listing.folders.push(entry.file_name());
            }
            continue;
        }
        if Format::listed(&path) {
            listing.images.push(path);
        } else if Format::is_other(&path) {
            listing.unread.push(path);
        } else {
            listing.others = listing.others.saturating_add(1);
        }
    }
    listing.images.sort();
    listing.unread.sort();
    Ok(listing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_listed_by_name_and_the_rest_is_counted() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.JPG", "a.png", "notes.txt", ".hidden.png", "c.jpeg", "d.jfif", "e.HEIC", "f.ARW"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join("inner.png")).unwrap();
        let found = list(folder.path()).unwrap();
        let names: Vec<_> = found.images.iter().map(|path| path.file_name().unwrap()).collect();
        assert_eq!(
            (names, found.others),
            (["a.png", "b.JPG", "c.jpeg", "d.jfif"].map(AsRef::as_ref).to_vec(), 1)
        );
        assert_eq!(found.unread.len(), 2);
    }
}
