//! The files about all images of a dataset, written again for the variants: lists, configurations, COCO.

mod coco;

use std::collections::HashMap;
use std::io::{self, Write};
use std::rc::Rc;

use crate::dataset::{Index, Sample, join, named, split, stem};
use crate::files::text_of;

#[cfg(feature = "fuzz-targets")]
pub(crate) use coco::try_parse as try_coco;

/// What was made of a dataset.
#[derive(Clone, Copy)]
pub(super) struct Made<'a> {
    /// The images of the dataset, sorted by key.
    pub(super) samples: &'a [Sample],
    /// The variants of the image of this place: their numbers among those of the image, and their paths. None where
    /// nothing was made of it.
    pub(super) variants: &'a dyn Fn(usize) -> Option<Vec<(u32, String)>>,
    /// Variants that an image may have at most.
    pub(super) per_image: u32,
    /// Whether all images themselves are there too.
    pub(super) originals: bool,
    /// Whether an image itself is there.
    pub(super) keeps: &'a dyn Fn(&Sample) -> bool,
}

/// What was made of the images that a line of a list names.
#[derive(Clone, Default)]
struct Listed {
    /// Whether an image itself is there, though the other originals are not.
    is_carried: bool,
    paths: Rc<[String]>,
}

impl Made<'_> {
    /// Whether the dataset has an image of this key.
    fn holds(&self, key: &str) -> bool {
        self.samples.binary_search_by(|sample| sample.key.as_str().cmp(key)).is_ok()
    }

    /// An image and its variants; none where nothing was made of it.
    fn of(&self, key: &str) -> Option<(&Sample, Vec<(u32, String)>)> {
        let place = self.samples.binary_search_by(|sample| sample.key.as_str().cmp(key)).ok()?;
        Some((self.samples.get(place)?, (self.variants)(place)?))
    }

    /// Whether an image itself is there.
    fn keeps(&self, sample: &Sample) -> bool {
        self.originals || (self.keeps)(sample)
    }

    /// What was made of the images whose path without its extension is this.
    fn of_stem(&self, path: &str) -> Listed {
        let alike = format!("{path}.");
        let first = self.samples.partition_point(|sample| sample.key.as_str() < alike.as_str());
        let all = (first..).zip(self.samples.iter().skip(first));
        let own = all.take_while(|(_, sample)| sample.key.starts_with(&alike));
        let own = own.filter(|(_, sample)| stem(&sample.key) == path);
        let made = own.filter_map(|(place, sample)| Some((sample, (self.variants)(place)?)));
        self.listed(made)
    }

    /// What was made of an image.
    fn of_key(&self, key: &str) -> Listed {
        self.listed(self.of(key).into_iter())
    }

    fn listed<'s>(&self, made: impl Iterator<Item = (&'s Sample, Vec<(u32, String)>)>) -> Listed {
        let (mut is_carried, mut paths) = (false, Vec::new());
        for (sample, variants) in made {
            is_carried |= self.keeps(sample);
            paths.extend(variants.into_iter().map(|(_, path)| path));
        }
        Listed { is_carried, paths: paths.into() }
    }
}

/// Writes a file about all images for what was made of the dataset; `bytes` is what [`Index::read`] gave.
///
/// # Errors
///
/// Those of `out`; and one when the file is no longer what it was when the dataset was opened.
pub(super) fn write(index: &Index, bytes: &[u8], made: &Made<'_>, out: &mut dyn Write) -> io::Result<()> {
    let text = text_of(bytes).unwrap_or_else(|| String::from_utf8_lossy(bytes));
    match index {
        Index::Carried { .. } => out.write_all(bytes),
        Index::Config { .. } => out.write_all(without_path(&text).as_bytes()),
        Index::Paths { .. } => {
            let mut paths =
                remembered(|line| made.of_key(&named(line, |key| made.holds(key)).unwrap_or_default()));
            lines(&text, made.originals, out, |line, add| {
                // A variant is written to the folder of its image.
                let line = line.trim_end();
                let folder = line.get(..line.rfind(['/', '\\']).map_or(0, |at| at.saturating_add(1)));
                let Listed { is_carried, paths } = paths(line);
                if is_carried {
                    add(&[line])?;
                }
                paths.iter().try_for_each(|path| add(&[folder.unwrap_or_default(), split(path).1]))
            })
        }
        Index::Stems { folder, .. } => {
            let mut paths = remembered(|name| made.of_stem(&join(folder, name)));
            lines(&text, made.originals, out, |line, add| {
                let (name, rest) = line.split_at(line.find(char::is_whitespace).unwrap_or(line.len()));
                let Listed { is_carried, paths } = paths(name);
                if is_carried {
                    add(&[line])?;
                }
                paths.iter().try_for_each(|path| add(&[stem(split(path).1), rest]))
            })
        }
        Index::Coco(file) => coco::write(file, &text, made, out),
    }
}

/// What is found by a name, found once: a list may name an image any number of times. What names none is not kept.
fn remembered<'t>(find: impl Fn(&str) -> Listed) -> impl FnMut(&'t str) -> Listed {
    let mut known: HashMap<&str, Listed> = HashMap::new();
    move |name| {
        if let Some(found) = known.get(name) {
            return found.clone();
        }
        let found = find(name);
        if found.is_carried || !found.paths.is_empty() {
            known.insert(name, found.clone());
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
        variants(line, &mut |parts| if originals && parts == [line] { Ok(()) } else { add(parts) })?;
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
    use crate::image_file::ReadOptions;

    #[test]
    fn lists_name_the_variants_behind_what_they_are_of() {
        let samples = ["JPEGImages/a.jpg", "JPEGImages/ab.jpg", "JPEGImages/c.jpg"]
            .map(|key| Sample::new(key, Vec::new()));
        let variants = |place: usize| {
            let paths = ["JPEGImages/a__w__0.jpg", "JPEGImages/ab__w__0.jpg"];
            Some(vec![(0, (*paths.get(place)?).to_owned())])
        };
        let made = |originals| Made {
            samples: &samples,
            variants: &variants,
            per_image: 1,
            originals,
            keeps: &|_| false,
        };
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("l.txt"), "a  1\nab -1\nc 0\n").unwrap();
        let list = Index::Stems { path: "l.txt".into(), folder: "JPEGImages".into() };
        let written = |list: &Index, originals: bool| {
            let (mut out, bytes) = (Vec::new(), list.read(folder.path(), &ReadOptions::default()).unwrap());
            write(list, &bytes, &made(originals), &mut out).unwrap();
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
