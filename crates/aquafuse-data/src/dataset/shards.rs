//! WebDataset: tar files in which the members of a sample are adjacent and share their name up to its first dot.

use std::io::{self, Read};
use std::path::Path;

use tar::{Archive, Builder, EntryType, Header};

use super::tree::Tree;
use super::{Dataset, Sample, inside, join, split};
use crate::files::{FileError, one_line};
use crate::image_file::ReadOptions;

/// What the image of a sample is called, behind the first dot.
const PICTURES: [&str; 7] = ["jpg", "jpeg", "png", "webp", "tif", "tiff", "bmp"];
/// Members of one sample; more are a mistake.
const MOST_MEMBERS: usize = 1 << 12;

pub(super) fn evidence(tree: &Tree) -> Option<String> {
    let path = tree.ending(".tar").next()?;
    Some(format!("{path} is a shard"))
}

/// Each shard is a sample of the dataset: it is made as a whole.
pub(super) fn read(tree: &Tree, dataset: &mut Dataset) {
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
    /// Its image, if it has exactly one.
    pub(crate) fn image(&self) -> Result<Option<&Member>, String> {
        let is_image =
            |member: &&Member| PICTURES.contains(&member.extension().to_ascii_lowercase().as_str());
        let mut images = self.members.iter().filter(is_image);
        match (images.next(), images.next()) {
            (Some(one), Some(other)) => Err(format!(
                "{} and {} may both be the image; rename masks, for example to .mask.png",
                one.path, other.path
            )),
            (image, _) => Ok(image),
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
