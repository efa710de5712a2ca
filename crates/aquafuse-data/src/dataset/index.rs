//! Files about all images of a dataset, written again for the images that were made.

use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;
use std::rc::Rc;

use super::{Sample, coco, join, split, stem};
use crate::files::FileError;
use crate::image_file::{ReadOptions, read_beside};

/// A file about all images of a dataset.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Index {
    /// It names no image, and is copied unchanged.
    Carried {
        /// Its path.
        path: String,
    },
    /// The YAML of a YOLO dataset: copied without `path`, so that paths are relative to its own folder.
    Config {
        /// Its path.
        path: String,
    },
    /// A path of an image a line.
    Paths {
        /// Its path.
        path: String,
    },
    /// The stem of an image a line, with something behind it or not.
    Stems {
        /// Its path.
        path: String,
        /// Where the images stand.
        folder: String,
    },
    /// JSON in the layout of COCO.
    Coco(coco::File),
}

/// What was made of a dataset.
#[derive(Clone, Copy)]
pub struct Made<'a> {
    /// The images of the dataset, sorted by key.
    pub samples: &'a [Sample],
    /// The variants of the image of this place: their numbers among those of the image, and their paths. None where
    /// nothing was made of it.
    pub variants: &'a dyn Fn(usize) -> Option<Vec<(u32, String)>>,
    /// Variants that an image may have at most.
    pub per_image: u32,
    /// Whether the images themselves are there too.
    pub originals: bool,
}

impl Made<'_> {
    /// An image and its variants; none where nothing was made of it.
    pub(super) fn of(&self, key: &str) -> Option<(&Sample, Vec<(u32, String)>)> {
        let place = self.samples.binary_search_by(|sample| sample.key.as_str().cmp(key)).ok()?;
        Some((self.samples.get(place)?, (self.variants)(place)?))
    }

    /// The paths of the variants of images whose path without its extension is this.
    fn of_stem(&self, path: &str) -> Rc<[String]> {
        let alike = format!("{path}.");
        let first = self.samples.partition_point(|sample| sample.key.as_str() < alike.as_str());
        let all = (first..).zip(self.samples.iter().skip(first));
        let own = all.take_while(|(_, sample)| sample.key.starts_with(&alike));
        let own = own.filter(|(_, sample)| stem(&sample.key) == path);
        own.filter_map(|(place, _)| (self.variants)(place)).flatten().map(|(_, path)| path).collect()
    }

    /// The paths of the variants of an image.
    fn of_key(&self, key: &str) -> Rc<[String]> {
        self.of(key).into_iter().flat_map(|(_, variants)| variants).map(|(_, path)| path).collect()
    }
}

impl Index {
    /// Its path within the dataset.
    pub fn path(&self) -> &str {
        match self {
            Self::Carried { path }
            | Self::Config { path }
            | Self::Paths { path }
            | Self::Stems { path, .. } => path,
            Self::Coco(file) => &file.path,
        }
    }

    /// Whether it is the same whichever images were made.
    pub(crate) fn is_shared(&self) -> bool {
        matches!(self, Self::Carried { .. } | Self::Config { .. })
    }

    /// Its content in the dataset in `root`.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the file cannot be read again.
    pub fn read(&self, root: &Path, reading: &ReadOptions) -> Result<Vec<u8>, FileError> {
        read_beside(&root.join(self.path()), reading)
    }

    /// Writes its content for the variants that were made; `bytes` is the result of [`Index::read`].
    ///
    /// # Errors
    ///
    /// Those of `out`; and one when the file is no longer what it was when the dataset was opened.
    pub fn write_made(&self, bytes: &[u8], made: &Made<'_>, out: &mut dyn Write) -> io::Result<()> {
        let text = String::from_utf8_lossy(bytes);
        match self {
            Self::Carried { .. } => out.write_all(bytes),
            Self::Config { .. } => out.write_all(without_path(&text).as_bytes()),
            Self::Paths { .. } => {
                let mut paths = remembered(|line| made.of_key(&super::inside(line).unwrap_or_default()));
                lines(&text, made.originals, out, |line, add| {
                    let key = super::inside(line).unwrap_or_default();
                    let folder = line.strip_suffix(&key).unwrap_or_default();
                    paths(line).iter().try_for_each(|path| add(&[folder, path]))
                })
            }
            Self::Stems { folder, .. } => {
                let mut paths = remembered(|name| made.of_stem(&join(folder, name)));
                lines(&text, made.originals, out, |line, add| {
                    let (name, rest) = line.split_at(line.find(char::is_whitespace).unwrap_or(line.len()));
                    paths(name).iter().try_for_each(|path| add(&[stem(split(path).1), rest]))
                })
            }
            Self::Coco(file) => file.write_made(&text, made, out),
        }
    }
}

/// What is found by a name, found once: a list may name an image any number of times. What names none is not kept.
fn remembered<'t>(find: impl Fn(&str) -> Rc<[String]>) -> impl FnMut(&'t str) -> Rc<[String]> {
    let mut known: HashMap<&str, Rc<[String]>> = HashMap::new();
    move |name| {
        if let Some(found) = known.get(name) {
            return Rc::clone(found);
        }
        let found = find(name);
        if !found.is_empty() {
            known.insert(name, Rc::clone(&found));
        }
        found
    }
}

/// Each line, where it stays, and those that stand for its variants, which are given in parts.
fn lines<'t>(
    text: &'t str,
    originals: bool,
    out: &mut dyn Write,
    mut variants: impl FnMut(&'t str, &mut dyn FnMut(&[&str]) -> io::Result<()>) -> io::Result<()>,
) -> io::Result<()> {
    let mut add = |parts: &[&str]| {
        parts.iter().try_for_each(|part| out.write_all(part.as_bytes()))?;
        out.write_all(b"\n")
    };
    for line in text.lines() {
        if originals {
            add(&[line])?;
        }
        variants(line, &mut add)?;
    }
    Ok(())
}

/// YAML without the line that says where the dataset is: it is where the file is.
fn without_path(text: &str) -> String {
    text.split_inclusive('\n').filter(|line| !line.starts_with("path:")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_name_the_variants_behind_what_they_are_of() {
        let samples = ["JPEGImages/a.jpg", "JPEGImages/ab.jpg", "JPEGImages/c.jpg"]
            .map(|key| Sample::new(key, Vec::new()));
        let variants = |place: usize| {
            let paths = ["JPEGImages/a__w__0.jpg", "JPEGImages/ab__w__0.jpg"];
            Some(vec![(0, (*paths.get(place)?).to_owned())])
        };
        let made = |originals| Made { samples: &samples, variants: &variants, per_image: 1, originals };
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("l.txt"), "a  1\nab -1\nc 0\n").unwrap();
        let list = Index::Stems { path: "l.txt".into(), folder: "JPEGImages".into() };
        let written = |list: &Index, originals: bool| {
            let (mut out, bytes) = (Vec::new(), list.read(folder.path(), &ReadOptions::default()).unwrap());
            list.write_made(&bytes, &made(originals), &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        assert_eq!(written(&list, true), "a  1\na__w__0  1\nab -1\nab__w__0 -1\nc 0\n");
        assert_eq!(written(&list, false), "a__w__0  1\nab__w__0 -1\n");
        std::fs::write(folder.path().join("l.txt"), "./JPEGImages/a.jpg\n").unwrap();
        let paths = Index::Paths { path: "l.txt".into() };
        assert_eq!(written(&paths, true), "./JPEGImages/a.jpg\n./JPEGImages/a__w__0.jpg\n");
    }

    #[test]
    fn a_config_is_carried_but_for_its_place() {
        assert_eq!(
            without_path("path: ../a\ntrain: images # path: b\r\nnames: [x]"),
            "train: images # path: b\r\nnames: [x]"
        );
    }
}
