//! WebDataset: tar files in which the members of a sample are adjacent and share their name up to its first dot.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, Read};
use std::path::Path;

use tar::{Archive, Builder, EntryType, Header};

use super::tree::Tree;
use super::{Dataset, Fault, Sample, inside, join, split};
use crate::files::{FileError, one_line};
use crate::image_file::ReadOptions;

/// What the image of a sample is called, behind the first dot.
const PICTURES: [&str; 7] = ["jpg", "jpeg", "png", "webp", "tif", "tiff", "bmp"];
/// Members of one sample; more are a mistake.
const MOST_MEMBERS: usize = 1 << 12;

/// What the names of compressed shards end in.
const COMPRESSED: [&str; 5] = [".tar.gz", ".tgz", ".tar.zst", ".tar.bz2", ".tar.xz"];

pub(super) fn evidence(tree: &Tree) -> Option<String> {
    let path = tree.ending(".tar").next()?;
    Some(format!("{path} is a shard"))
}

/// Each shard is a sample of the dataset: it is made as a whole.
pub(super) fn read(tree: &Tree, dataset: &mut Dataset) {
    for path in COMPRESSED.iter().flat_map(|end| tree.ending(end)) {
        dataset
            .faults
            .add(Fault::new(path, "it is a compressed shard; decompress it first, for example with gunzip"));
    }
    dataset.samples = tree.ending(".tar").map(|path| Sample::new(path, Vec::new())).collect();
}

/// A file in a shard.
#[derive(Clone, Debug)]
pub(crate) struct Member {
    header: Header,
    /// Its path.
    pub(crate) path: String,
    pub(crate) bytes: Vec<u8>,
}

/// The members that share a name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    /// The name, with the folder before it.
    pub(crate) key: String,
    pub(crate) members: Vec<Member>,
}

impl Member {
    /// A file of the same kind and time, with another name and other bytes.
    pub(crate) fn with(&self, path: String, bytes: Vec<u8>) -> Self {
        Self { header: self.header.clone(), path, bytes }
    }

    /// The part of its name after the first dot.
    pub(crate) fn extension(&self) -> &str {
        split(&self.path).1.split_once('.').map_or("", |(_, extension)| extension)
    }

    /// Adds it to a tar file.
    pub(crate) fn append(&self, builder: &mut Builder<impl io::Write>) -> io::Result<()> {
        let mut header = self.header.clone();
        header.set_size(self.bytes.len() as u64);
        builder.append_data(&mut header, &self.path, self.bytes.as_slice())
    }
}

impl Group {
    /// Its image, if it has exactly one: `NAME.jpg`, or where there is none, the one of `NAME.WORD.jpg` whose word names
    /// no mask.
    pub(crate) fn image(&self) -> Result<Option<&Member>, String> {
        let of_kind = |kind: Kind| {
            let mut images = self.members.iter().filter(|member| Kind::of(member.extension()) == Some(kind));
            (images.next(), images.next())
        };
        let one = |(one, other): (Option<&'_ Member>, Option<&'_ Member>)| match (one, other) {
            (Some(one), Some(other)) => Err(format!(
                "{} and {} may both be the image; rename masks, for example to .mask.png",
                one.path, other.path
            )),
            _ => Ok(()),
        };
        for kind in [Kind::Plain, Kind::Worded] {
            let found = of_kind(kind);
            one(found)?;
            if found.0.is_some() {
                return Ok(found.0);
            }
        }
        Ok(None)
    }

    /// The first name that two members have.
    fn twice(&self) -> Option<&str> {
        let mut names = HashSet::new();
        self.members.iter().map(|member| member.path.as_str()).find(|path| !names.insert(*path))
    }
}

/// How a member is called that may be the image.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// `jpg`.
    Plain,
    /// `input.jpg`.
    Worded,
}

/// Words that say that an image is about another one.
const ABOUT_OTHERS: [&str; 13] = [
    "mask",
    "masks",
    "seg",
    "label",
    "labels",
    "depth",
    "normal",
    "gt",
    "target",
    "output",
    "outputs",
    "segmentation",
    "instance",
];

impl Kind {
    fn of(extension: &str) -> Option<Self> {
        let small = extension.to_ascii_lowercase();
        let (word, last) = match small.rsplit_once('.') {
            Some((word, last)) => (Some(word), last),
            None => (None, small.as_str()),
        };
        match word {
            _ if !PICTURES.contains(&last) => None,
            None => Some(Self::Plain),
            Some(word) if word.split(['.', '_', '-']).any(|word| ABOUT_OTHERS.contains(&word)) => None,
            Some(_) => Some(Self::Worded),
        }
    }
}

/// Reads a shard group by group, no group larger than `max_memory`; gives the first error that `each` gives. Errors of
/// the shard call it `path`.
pub(crate) fn groups(
    path: &Path,
    reader: impl Read,
    options: &ReadOptions,
    see: &mut dyn FnMut(&[u8]),
    each: &mut dyn FnMut(Group) -> Result<(), FileError>,
) -> Result<(), FileError> {
    let most_bytes = options.max_memory;
    let damaged = |cause: String| FileError::Damaged { path: path.to_owned(), cause };
    let failed = |error: io::Error| match error.kind() {
        io::ErrorKind::UnexpectedEof => {
            FileError::CutShort { path: path.to_owned(), cause: "it ends within a member".into() }
        }
        _ => damaged(one_line(&error.to_string())),
    };
    let mut archive = Archive::new(Seen { reader, see, zeros: 0 });
    let mut ended = HashSet::new();
    let mut each = |group: Group| {
        if let Some(path) = group.twice() {
            return Err(damaged(format!("it holds two members {path:?}")));
        }
        let again = |key: &str| {
            format!("the members of {key} in it are not adjacent; write the shard sorted by name")
        };
        match ended.insert(hash(&group.key)) {
            true => each(group),
            false => Err(damaged(again(&group.key))),
        }
    };
    // Bytes of the group, which is held as a whole.
    let (mut group, mut held) = (Group::default(), 0_u64);
    for entry in archive.entries().map_err(failed)? {
        let entry = entry.map_err(failed)?;
        match entry.header().entry_type() {
            EntryType::Regular | EntryType::Continuous => {}
            EntryType::Directory => continue,
            other => return Err(damaged(format!("it holds a {other:?}, but a shard holds only files"))),
        }
        let name = String::from_utf8(entry.path_bytes().into_owned())
            .map_err(|_| damaged("it holds a member whose name is not UTF-8".into()))?;
        let name = inside(&name).map_err(|cause| damaged(format!("{name:?} in it is {cause}")))?;
        let (folder, file_name) = split(&name);
        let key = join(folder, file_name.split('.').next().unwrap_or_default());
        if key != group.key && !group.members.is_empty() {
            each(std::mem::take(&mut group))?;
            held = 0;
        }
        let size = entry.size();
        held = held.saturating_add(size);
        if held > most_bytes {
            let cause =
                format!("{key} in it has {held} bytes or more, {most_bytes} are allowed (--max-memory)");
            return Err(FileError::TooLarge { path: path.to_owned(), cause });
        }
        let header = entry.header().clone();
        let mut bytes = Vec::new();
        entry.take(size).read_to_end(&mut bytes).map_err(failed)?;
        if bytes.len() as u64 != size {
            return Err(failed(io::ErrorKind::UnexpectedEof.into()));
        }
        if group.members.len() >= MOST_MEMBERS {
            return Err(damaged(format!("{key} in it has more than {MOST_MEMBERS} members")));
        }
        group.key = key;
        group.members.push(Member { header, path: name, bytes });
    }
    if !group.members.is_empty() {
        each(group)?;
    }
    // What follows the last member belongs to the file too.
    let mut rest = archive.into_inner();
    io::copy(&mut rest, &mut io::sink()).map_err(failed)?;
    match rest.zeros >= END || options.lenient {
        true => Ok(()),
        false => Err(FileError::CutShort { path: path.to_owned(), cause: "its end is missing".into() }),
    }
}

/// A digest of a name: a shard may have millions.
fn hash(name: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    hasher.finish()
}

/// Bytes of zero that a tar file ends with.
const END: usize = 1024;

/// What is read, and whoever sees it.
struct Seen<'a, R> {
    reader: R,
    see: &'a mut dyn FnMut(&[u8]),
    /// Zeros at its end so far.
    zeros: usize,
}

impl<R: Read> Read for Seen<'_, R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = self.reader.read(into)?;
        let bytes = into.get(..read).unwrap_or_default();
        let zeros = bytes.iter().rev().take_while(|byte| **byte == 0).count();
        self.zeros = if zeros == read { self.zeros.saturating_add(zeros) } else { zeros };
        (self.see)(bytes);
        Ok(read)
    }
}

/// Reads a shard for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(name: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let options = ReadOptions { max_memory: 1 << 16, ..ReadOptions::default() };
    groups(name, bytes, &options, &mut |_| {}, &mut |group| {
        let _ = group.image();
        assert!(group.members.iter().all(|member| inside(&member.path).is_ok()));
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(names: &[&str]) -> Result<Vec<Group>, String> {
        let mut builder = Builder::new(Vec::new());
        for name in names {
            let mut header = Header::new_gnu();
            header.set_size(1);
            builder.append_data(&mut header, name, &b"x"[..]).unwrap();
        }
        let (bytes, mut found) = (builder.into_inner().unwrap(), Vec::new());
        let read =
            groups("s.tar".as_ref(), bytes.as_slice(), &ReadOptions::default(), &mut |_| {}, &mut |group| {
                found.push(group);
                Ok(())
            });
        read.map(|()| found).map_err(|error| error.to_string())
    }

    #[test]
    fn the_image_of_a_sample_may_have_a_word_in_its_name() {
        for (names, image) in [
            (&["a.jpg", "a.cls"][..], Ok(Some("a.jpg"))),
            (&["a.input.jpg", "a.outputs.txt"], Ok(Some("a.input.jpg"))),
            (&["a.image.png", "a.mask.png", "a.json"], Ok(Some("a.image.png"))),
            (&["a.jpg", "a.seg.png", "a.left.png"], Ok(Some("a.jpg"))),
            (&["a.mask.png", "a.cls"], Ok(None)),
            (&["a.left.png", "a.right.png"], Err("may both be the image")),
            (&["a.jpg", "a.png"], Err("may both be the image")),
        ] {
            let groups = shard(names).unwrap();
            match (groups[0].image(), image) {
                (Ok(found), Ok(image)) => assert_eq!(found.map(|found| found.path.as_str()), image),
                (Err(said), Err(cause)) => assert!(said.contains(cause), "{said}"),
                (found, _) => panic!("{names:?}: {found:?}"),
            }
        }
    }

    #[test]
    fn members_are_adjacent_and_have_one_name_each() {
        let late = shard(&["a.jpg", "b.jpg", "a.txt"]).unwrap_err();
        assert!(late.contains("the members of a in it are not adjacent"), "{late}");
        let twice = shard(&["a.jpg", "a.txt", "a.txt"]).unwrap_err();
        assert!(twice.contains("two members \"a.txt\""), "{twice}");
    }
}
