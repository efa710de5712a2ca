//! Files about all pictures of a data set, written anew for the pictures that were made.

use std::collections::BTreeMap;
use std::path::Path;

use super::{coco, join, stem};
use crate::picture::FileError;

/// A file about all pictures of a data set.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Index {
    /// It names no picture, and is carried over as it is.
    Carried {
        /// Its path.
        path: String,
    },
    /// The YAML of a YOLO data set: carried over without the `path` of its pictures, which then is its own folder.
    Config {
        /// Its path.
        path: String,
    },
    /// A path of a picture a line.
    Paths {
        /// Its path.
        path: String,
    },
    /// The stem of a picture a line, with something behind it or not.
    Stems {
        /// Its path.
        path: String,
        /// Where the pictures stand.
        folder: String,
    },
    /// JSON in the layout of COCO.
    Coco(coco::File),
}

/// What was made of a data set.
#[derive(Clone, Debug, Default)]
pub struct Made {
    /// The variants of each picture, by its key: their number among those of the picture, and their paths.
    pub variants: BTreeMap<String, Vec<(u32, String)>>,
    /// The place of each picture in the data set.
    pub ranks: BTreeMap<String, u64>,
    /// Variants that a picture may have at most.
    pub per_image: u32,
    /// Whether the pictures themselves are there too.
    pub originals: bool,
}

impl Made {
    pub(super) fn of(&self, key: &str) -> &[(u32, String)] {
        self.variants.get(key).map_or(&[], Vec::as_slice)
    }
}

impl Index {
    /// Its path within the data set.
    pub fn path(&self) -> &str {
        match self {
            Self::Carried { path }
            | Self::Config { path }
            | Self::Paths { path }
            | Self::Stems { path, .. } => path,
            Self::Coco(file) => &file.path,
        }
    }

    /// Whether it is the same whichever pictures were made.
    pub(crate) fn is_shared(&self) -> bool {
        matches!(self, Self::Carried { .. } | Self::Config { .. })
    }

    /// What stands in it, for what was made of the data set in `root`.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the file cannot be read again.
    pub fn for_made(&self, root: &Path, made: &Made) -> Result<Vec<u8>, FileError> {
        let path = root.join(self.path());
        let bytes = std::fs::read(&path).map_err(|error| FileError::Read { path: path.clone(), error })?;
        let text = String::from_utf8_lossy(&bytes);
        match self {
            Self::Carried { .. } => Ok(bytes),
            Self::Config { .. } => Ok(without_path(&text).into_bytes()),
            Self::Paths { .. } => Ok(lines(&text, made.originals, |line| {
                let key = super::inside(line).unwrap_or_default();
                let folder = line.strip_suffix(&key).unwrap_or_default().to_owned();
                made.of(&key).iter().map(|(_, path)| format!("{folder}{path}")).collect()
            })),
            Self::Stems { folder, .. } => Ok(lines(&text, made.originals, |line| {
                let (name, rest) = line.split_at(line.find(char::is_whitespace).unwrap_or(line.len()));
                let from = join(folder, name);
                let all = made.variants.range(from.clone()..).take_while(|(key, _)| key.starts_with(&from));
                let variants = all.filter(|(key, _)| stem(key) == from).flat_map(|(_, variants)| variants);
                variants.map(|(_, path)| format!("{}{rest}", stem(super::split(path).1))).collect()
            })),
            Self::Coco(file) => {
                file.for_made(&text, made).map_err(|cause| FileError::Damaged { path, cause })
            }
        }
    }
}

/// Each line, where it stays, and those that stand for its variants.
fn lines(text: &str, originals: bool, variants: impl Fn(&str) -> Vec<String>) -> Vec<u8> {
    let mut out = String::new();
    for line in text.lines() {
        let own = originals.then(|| line.to_owned());
        for line in own.into_iter().chain(variants(line)) {
            out.push_str(&line);
            out.push('\n');
        }
    }
    out.into_bytes()
}

/// YAML without the line that says where the data set is: it is where the file is.
fn without_path(text: &str) -> String {
    text.split_inclusive('\n').filter(|line| !line.starts_with("path:")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_name_the_variants_behind_what_they_are_of() {
        let variants = BTreeMap::from([
            ("JPEGImages/a.jpg".to_owned(), vec![(0, "JPEGImages/a__w__0.jpg".to_owned())]),
            ("JPEGImages/ab.jpg".to_owned(), vec![(0, "JPEGImages/ab__w__0.jpg".to_owned())]),
        ]);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("l.txt"), "a  1\nab -1\nc 0\n").unwrap();
        let list = Index::Stems { path: "l.txt".into(), folder: "JPEGImages".into() };
        let text = |originals: bool| {
            let made = Made { variants: variants.clone(), originals, ..Made::default() };
            String::from_utf8(list.for_made(folder.path(), &made).unwrap()).unwrap()
        };
        assert_eq!(text(true), "a  1\na__w__0  1\nab -1\nab__w__0 -1\nc 0\n");
        assert_eq!(text(false), "a__w__0  1\nab__w__0 -1\n");
        std::fs::write(folder.path().join("l.txt"), "./JPEGImages/a.jpg\n").unwrap();
        let paths = Index::Paths { path: "l.txt".into() };
        let made = Made { variants, originals: true, ..Made::default() };
        let text = String::from_utf8(paths.for_made(folder.path(), &made).unwrap()).unwrap();
        assert_eq!(text, "./JPEGImages/a.jpg\n./JPEGImages/a__w__0.jpg\n");
    }

    #[test]
    fn a_config_is_carried_but_for_its_place() {
        assert_eq!(
            without_path("path: ../a\ntrain: images # path: b\r\nnames: [x]"),
            "train: images # path: b\r\nnames: [x]"
        );
    }
}
