//! A file that holds several images, multiplied as a whole: it is there or it is not.

mod shards;
#[cfg(feature = "parquet")]
mod tables;

use std::path::{Path, PathBuf};

use super::Multiplied;
use super::journal::{Journal, Slot};
use super::line::{Container, Line, Source, Written};
use super::make::{Counts, Made, Maker};
use super::plan::Planned;
use crate::dataset::Layout;
use crate::files::FileError;
use crate::files::sha256;
use crate::image_file::{Format, ImageFile, Opened, ReadOptions};

/// An image in a container.
struct Held {
    /// What its draws depend on: CONTAINER/NAME.
    draws: String,
    /// What the manifest calls it.
    key: String,
    /// What errors call it.
    name: PathBuf,
    bytes: Vec<u8>,
}

/// A variant of such an image.
struct Varied {
    /// What follows the name of its image: `__WATER__NUMBER`.
    suffix: String,
    bytes: Vec<u8>,
}

impl Maker<'_> {
    /// Makes a container, unless it is there as it would be made now. An image that fails leaves the others as they are.
    pub(super) fn make_container(&self, sample: &Planned<'_>, journal: &Journal) -> Result<Made, FileError> {
        let input = self.job.dataset.root.join(sample.key);
        let about = input.metadata().map_err(|error| FileError::Read { path: input.clone(), error })?;
        let is_current = |old: &Container| {
            old.failed.is_empty() && old.source.bytes == about.len() && self.stands(old.listed(), &about)
        };
        if journal.entry(sample.index)?.container.is_some_and(|old| is_current(&old)) {
            return Ok(Made::default());
        }
        journal.forget(sample.index, Slot::Container);
        let mut container = Container {
            key: sample.key.to_owned(),
            source: Source { bytes: about.len(), sha256: String::new(), depth_sha256: None },
            output: sample.key.to_owned(),
            bytes: 0,
            sha256: String::new(),
            originals: Vec::new(),
            variants: Vec::new(),
            skipped: Vec::new(),
            failed: Vec::new(),
        };
        let failures = self.write_container(&input, &mut container)?;
        let originals = container.originals.len();
        let counts = Counts::of(container.variants.iter());
        let line = Line::Container(Box::new(container));
        journal.add(sample.index, std::slice::from_ref(&line))?;
        let lines = line.text();
        Ok(Made {
            multiplied: Some(Multiplied { originals, ..counts.multiplied(false, None, lines) }),
            failures,
        })
    }

    /// Writes it, and says in `container` what was made; the failures of single images come back.
    fn write_container(&self, input: &Path, container: &mut Container) -> Result<Vec<FileError>, FileError> {
        match self.job.dataset.layout {
            #[cfg(feature = "parquet")]
            Layout::Parquet => self.write_table(input, container),
            _ => self.write_shard(input, container),
        }
    }

    /// The variants of one image: none where it is skipped. `output` names one in the container, by what follows the
    /// image's own name.
    fn vary(
        &self,
        held: Held,
        container: &mut Container,
        output: &dyn Fn(&str) -> String,
    ) -> Result<Vec<Varied>, FileError> {
        let recipe = &self.job.recipe;
        self.job.run_options.stop.check(&self.job.output.join(&container.output))?;
        let opened = ImageFile::open_bytes(&held.name, held.bytes, &self.job.run_options.reading)?;
        let read = recipe.read(opened, &self.maps.source(&held.draws)?, &self.budget)?;
        if let Some(why) = recipe.skipped(read.found.estimate.quality()) {
            container.skipped.push((held.draws, why));
            return Ok(Vec::new());
        }
        let (mut all, mut variants) = (Vec::new(), Vec::new());
        for number in 0..recipe.per_image {
            let (draw, image, outcome) = recipe.drawn(&read, &held.draws, number);
            // A name in a shard ends at its first dot.
            let suffix = format!("__{}__{number}", recipe.slug(draw).replace('.', "-"));
            let path = output(&suffix);
            let bytes = recipe.encoded(image, path.as_ref())?;
            let about = Written { output: path, bytes: bytes.len() as u64, sha256: sha256(&bytes) };
            variants.push(read.described(recipe, &held.key, number, draw, outcome, about, Vec::new()));
            all.push(Varied { suffix, bytes });
        }
        container.variants.extend(variants);
        Ok(all)
    }
}

/// The image of a key in a container.
pub(super) fn image_of(
    layout: Layout,
    container: &Path,
    key: &str,
    options: &ReadOptions,
) -> Result<Opened, FileError> {
    let found = match layout {
        #[cfg(feature = "parquet")]
        Layout::Parquet => tables::image_of(container, key, options)?,
        _ => shards::image_of(container, key, options)?,
    };
    let none =
        || FileError::Damaged { path: container.to_owned(), cause: format!("there is no {key} in it") };
    let (name, bytes) = found.ok_or_else(none)?;
    ImageFile::open_bytes(&container.join(name), bytes, options)
}

/// The extension of a variant: its image's own, if we write that format. Words before the last dot stay.
fn written(extension: &str) -> String {
    let (words, last) = extension.rsplit_once('.').map_or(("", extension), |(words, last)| (words, last));
    let last = if Format::written(format!("x.{last}").as_ref()).is_some() { last } else { "png" };
    if words.is_empty() { last.to_owned() } else { format!("{words}.{last}") }
}
