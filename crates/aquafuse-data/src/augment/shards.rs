//! One shard of a WebDataset, multiplied as a whole: a tar file is there or it is not.

use std::io::{BufReader, Write};
use std::path::Path;

use sha2::{Digest, Sha256};
use tar::Builder;

use super::journal::Journal;
use super::make::{Made, Maker, News};
use super::manifest::{Container, Entry, Line, Source, Variant, Written};
use super::plan::Planned;
use crate::dataset::shards::{Group, Member, groups};
use crate::dataset::{join, split};
use crate::digest::{hexadecimal, sha256};
use crate::picture::{
    FileError, Format, Opened, Picture, ReadOptions, one_line, open_file, write_atomically,
};
use crate::treatment::Space;

impl<E: Space> Maker<'_, E> {
    /// Makes a shard, unless it is there as it would be made now. A picture that fails leaves the others as they are.
    pub(super) fn make_shard(&self, sample: &Planned, known: Entry, journal: &Journal) -> Made {
        let made = self.make_shard_or_fail(sample, known, journal);
        made.unwrap_or_else(|error| Made { entry: Entry::default(), news: None, failures: vec![error] })
    }

    fn make_shard_or_fail(
        &self,
        sample: &Planned,
        known: Entry,
        journal: &Journal,
    ) -> Result<Made, FileError> {
        let input = self.job.dataset.root.join(&sample.key);
        let about = input.metadata().map_err(|error| FileError::Read { path: input.clone(), error })?;
        let is_current = |old: &Container| {
            old.failed.is_empty() && old.source.bytes == about.len() && self.stands(&old.written, &about)
        };
        if let Some(old) = known.container.filter(|old| is_current(old)) {
            return Ok(Made {
                entry: Entry { container: Some(old), ..Entry::default() },
                news: None,
                failures: Vec::new(),
            });
        }
        let (container, failures) = self.write_shard(&sample.key, &input)?;
        let line = Line::Container(Box::new(container.clone()));
        journal.add(std::slice::from_ref(&line))?;
        let news = News {
            variants: container.variants.len(),
            vanished: News::vanished(container.variants.iter()),
            verdict: None,
            lines: line.text(),
        };
        let entry = Entry { container: Some(Box::new(container)), ..Entry::default() };
        Ok(Made { entry, news: Some(news), failures })
    }

    /// Reads a shard sample by sample, and writes each with its variants.
    fn write_shard(&self, key: &str, input: &Path) -> Result<(Container, Vec<FileError>), FileError> {
        let path = self.job.output.join(key);
        let reading = &self.job.recipe.reading;
        let (file, bytes) = open_file(input)?;
        let mut seen = Sha256::new();
        let mut container = Container {
            key: key.to_owned(),
            source: Source { bytes, sha256: String::new(), depth_sha256: None },
            written: Written { output: key.to_owned(), bytes: 0, sha256: String::new() },
            variants: Vec::new(),
            skipped: Vec::new(),
            failed: Vec::new(),
        };
        let mut failures = Vec::new();
        // What the shard's own reading says is no fault of the writing.
        let mut unread = None;
        let written = write_atomically(&path, true, |out| {
            let mut builder = Builder::new(Hashed { out, digest: Sha256::new(), bytes: 0 });
            let read =
                groups(input, BufReader::new(file), reading, &mut |bytes| seen.update(bytes), &mut |group| {
                    let failed = |error: std::io::Error| FileError::Write {
                        path: path.clone(),
                        cause: error.to_string(),
                    };
                    if self.job.recipe.keep_originals {
                        group
                            .members
                            .iter()
                            .try_for_each(|member| member.append(&mut builder))
                            .map_err(failed)?;
                    }
                    match self.group(&group, input, &mut container) {
                        Ok(members) => {
                            members.iter().try_for_each(|member| member.append(&mut builder)).map_err(failed)
                        }
                        Err(error) => {
                            container.failed.push((join(key, &group.key), one_line(&error.to_string())));
                            failures.push(error);
                            Ok(())
                        }
                    }
                });
            if let Err(error) = read {
                unread = Some(error);
                return Err(std::io::Error::other("its input cannot be read"));
            }
            let Hashed { digest, bytes, .. } = builder.into_inner()?;
            (container.written.sha256, container.written.bytes) = (hexadecimal(&digest.finalize()), bytes);
            Ok(())
        });
        match unread {
            Some(error) => return Err(error),
            None => written?,
        }
        container.source.sha256 = hexadecimal(&seen.finalize());
        Ok((container, failures))
    }

    /// The variants of one sample, each with all that is about it.
    fn group(
        &self,
        group: &Group,
        input: &Path,
        container: &mut Container,
    ) -> Result<Vec<Member>, FileError> {
        let recipe = &self.job.recipe;
        let name = input.join(&group.key);
        let ambiguous = |cause| FileError::Damaged { path: name.clone(), cause };
        let Some(picture) = group.picture().map_err(ambiguous)? else { return Ok(Vec::new()) };
        let key = join(&container.key, &group.key);
        let member_name = input.join(&picture.path);
        let opened = Picture::open_bytes(&member_name, picture.bytes.clone(), &recipe.reading)?;
        let read = recipe.read(opened, &self.maps.source(&key)?, &self.budget)?;
        let quality = read.found.estimate.quality;
        if let Some(why) = recipe.skipped(quality) {
            container.skipped.push((key, why));
            return Ok(Vec::new());
        }
        let (folder, stem) = split(&group.key);
        let (mut members, mut variants) = (Vec::new(), Vec::<Variant>::new());
        for number in 0..recipe.per_image {
            let draw = recipe.draws.draw(&key, number, recipe.waters.len());
            let water = recipe.waters.get(draw.water).expect("a draw is one of the waters");
            // A name in a shard ends at its first dot.
            let slug = water.slug().replace('.', "-");
            let new_stem = format!("{stem}__{slug}__{number}");
            for member in &group.members {
                let is_picture = member.path == picture.path;
                let extension = if is_picture { written(member.extension()) } else { member.extension() };
                let path = join(folder, &format!("{new_stem}.{extension}"));
                if !is_picture {
                    members.push(member.with(path, member.bytes.clone()));
                    continue;
                }
                let (bytes, treated) = recipe.variant(&read, water, draw, path.as_ref())?;
                let about =
                    Written { output: path.clone(), bytes: bytes.len() as u64, sha256: sha256(&bytes) };
                variants.push(read.described(
                    &format!("{key}.{}", member.extension()),
                    number,
                    draw,
                    treated,
                    about,
                    Vec::new(),
                ));
                members.push(member.with(path, bytes));
            }
        }
        container.variants.extend(variants);
        Ok(members)
    }
}

/// The extension of a variant: that of its picture, if we write that format.
fn written(extension: &str) -> &str {
    if Format::written(format!("x.{extension}").as_ref()).is_some() { extension } else { "png" }
}

/// The picture of a key, SHARD/NAME.EXTENSION, in a shard.
pub(super) fn picture_of(shard: &Path, key: &str, options: &ReadOptions) -> Result<Opened, FileError> {
    let (file, _) = open_file(shard)?;
    let mut found = None;
    groups(shard, BufReader::new(file), options, &mut |_| {}, &mut |group| {
        let own = group.members.into_iter().find(|member| key.ends_with(&format!("/{}", member.path)));
        found = found.take().or(own);
        Ok(())
    })?;
    let none = || FileError::Damaged { path: shard.to_owned(), cause: format!("there is no {key} in it") };
    let member = found.ok_or_else(none)?;
    Picture::open_bytes(&shard.join(&member.path), member.bytes, options)
}

/// What is written, and its digest.
struct Hashed<W> {
    out: W,
    digest: Sha256,
    bytes: u64,
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.digest.update(bytes.get(..written).unwrap_or_default());
        self.bytes = self.bytes.saturating_add(written as u64);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}
