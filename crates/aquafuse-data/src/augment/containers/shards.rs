//! One shard of a WebDataset, sample by sample.

use std::io::BufReader;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use tar::Builder;

use super::super::line::Container;
use super::super::make::Maker;
use super::{Held, written};
use crate::dataset::shards::{Group, Member, groups};
use crate::dataset::{join, split};
use crate::files::{FileError, Hashed, Patient, hexadecimal, one_line, write_atomically};
use crate::image_file::{ReadOptions, open_file};

impl Maker<'_> {
    /// Reads a shard sample by sample, and writes each with its variants.
    pub(super) fn write_shard(
        &self,
        input: &Path,
        container: &mut Container,
    ) -> Result<Vec<FileError>, FileError> {
        let path = self.job.output.join(&container.key);
        let reading = &self.job.run_options.reading;
        let (file, bytes) = open_file(input)?;
        container.source.bytes = bytes;
        let mut seen = Sha256::new();
        let mut failures = Vec::new();
        let mut has_image = false;
        // What the shard's own reading says is no fault of the writing.
        let mut unread = None;
        let result = write_atomically(&path, true, |out| {
            let mut builder = Builder::new(Hashed::new(out));
            let read = groups(
                input,
                BufReader::new(Patient(file)),
                reading,
                &mut |bytes| seen.update(bytes),
                &mut |group| {
                    let failed = |error: std::io::Error| FileError::Write {
                        path: path.clone(),
                        cause: error.to_string(),
                    };
                    let draws = join(&container.key, &group.key);
                    let has_one = group.image().is_ok_and(|image| image.is_some());
                    has_image |= has_one;
                    if self.job.recipe.keeps(&draws, has_one) {
                        container.originals.extend(has_one.then_some(draws));
                        group
                            .members
                            .iter()
                            .try_for_each(|member| member.append(&mut builder))
                            .map_err(failed)?;
                    }
                    match self.group(&group, input, container) {
                        Ok(members) => {
                            members.iter().try_for_each(|member| member.append(&mut builder)).map_err(failed)
                        }
                        Err(error @ FileError::Stopped { .. }) => Err(error),
                        Err(error) => {
                            let key = join(&container.key, &group.key);
                            container.failed.push((key, one_line(&error.to_string())));
                            failures.push(error);
                            Ok(())
                        }
                    }
                },
            );
            if let Err(error) = read {
                unread = Some(error);
                return Err(std::io::Error::other("its input cannot be read"));
            }
            (container.bytes, container.sha256) = builder.into_inner()?.result();
            Ok(())
        });
        match unread {
            Some(error) => return Err(error),
            None => result?,
        }
        container.source.sha256 = hexadecimal(&seen.finalize());
        if !has_image && failures.is_empty() {
            let found = "a shard in which no sample has an image".to_owned();
            let remedy = "Call the images KEY.jpg, KEY.png, KEY.webp or KEY.tif";
            let error = FileError::UnsupportedPixels { path: input.to_owned(), found, remedy };
            container.failed.push((container.key.clone(), one_line(&error.to_string())));
            failures.push(error);
        }
        Ok(failures)
    }

    /// The variants of one sample, each with all that is about it.
    fn group(
        &self,
        group: &Group,
        input: &Path,
        container: &mut Container,
    ) -> Result<Vec<Member>, FileError> {
        let ambiguous = |cause| FileError::Damaged { path: input.join(&group.key), cause };
        let Some(image) = group.image().map_err(ambiguous)? else { return Ok(Vec::new()) };
        let (folder, stem) = split(&group.key);
        let named = |suffix: &str, extension: &str| join(folder, &format!("{stem}{suffix}.{extension}"));
        let draws = join(&container.key, &group.key);
        let held = Held {
            key: format!("{draws}.{}", image.extension()),
            draws,
            name: input.join(&image.path),
            bytes: image.bytes.clone(),
        };
        let own = written(image.extension());
        let variants = self.vary(held, container, &|suffix| named(suffix, &own))?;
        let of_one = |variant: super::Varied| {
            let member = |member: &Member| match member.path == image.path {
                true => member.with(named(&variant.suffix, &own), variant.bytes.clone()),
                false => member.with(named(&variant.suffix, member.extension()), member.bytes.clone()),
            };
            group.members.iter().map(member).collect::<Vec<_>>()
        };
        Ok(variants.into_iter().flat_map(of_one).collect())
    }
}

/// The image of a key, SHARD/NAME.EXTENSION, in a shard: its name there, and its bytes.
pub(super) fn image_of(
    shard: &Path,
    key: &str,
    options: &ReadOptions,
) -> Result<Option<(PathBuf, Vec<u8>)>, FileError> {
    let (file, _) = open_file(shard)?;
    let mut found = None;
    groups(shard, BufReader::new(Patient(file)), options, &mut |_| {}, &mut |group| {
        let own = group.members.into_iter().find(|member| key.ends_with(&format!("/{}", member.path)));
        found = found.take().or(own);
        Ok(())
    })?;
    Ok(found.map(|member| (member.path.into(), member.bytes)))
}
