//! `--max-pixels`, `--max-memory` and `--lenient`: which images are taken on.

use std::path::Path;

use anyhow::{Result, anyhow};
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use clap::Args;

use crate::failure::Failure;

#[derive(Args)]
pub(crate) struct Reading {
    /// Refuse images of more pixels than this.
    #[arg(long, global = true, help_heading = crate::args::common::HEADING, value_name = "N", default_value_t = ReadOptions::default().max_pixels)]
    max_pixels: u64,
    /// Memory for all images that are in work at once: 512MiB, 2GiB or a number of bytes. One that needs more
    /// by itself is refused, by every command; others wait their turn. Files that go along with images, as annotations
    /// and lists, may have a quarter of it each.
    #[arg(long, global = true, help_heading = crate::args::common::HEADING, value_name = "SIZE", default_value = "2GiB", value_parser = size)]
    max_memory: u64,
    /// Take images whose file was cut short, JPEG and PNG above all, for what is left of them. Their outputs say so in
    /// their EXIF description.
    #[arg(long, global = true, help_heading = crate::args::common::HEADING)]
    lenient: bool,
}

impl Reading {
    pub(crate) fn options(&self) -> ReadOptions {
        ReadOptions { max_pixels: self.max_pixels, max_memory: self.max_memory, lenient: self.lenient }
    }

    /// Reads one image.
    pub(crate) fn read(&self, path: &Path) -> Result<ImageFile, Failure> {
        Ok(ImageFile::open(path, &self.options())?.decode()?)
    }
}

/// A number of bytes, with a unit or without.
fn size(text: &str) -> Result<u64> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit: u64 = match &text[digits.len()..] {
        "" | "B" => 1,
        "KiB" => 1 << 10,
        "MiB" => 1 << 20,
        "GiB" => 1 << 30,
        _ => return Err(anyhow!("give a number of bytes, or one with KiB, MiB or GiB behind it")),
    };
    let number: u64 = digits.parse().map_err(|_| anyhow!("not a whole number"))?;
    number.checked_mul(unit).filter(|&bytes| bytes > 0).ok_or_else(|| anyhow!("no such amount of memory"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units_or_are_bytes() {
        assert_eq!(size("1GiB").unwrap(), 1 << 30);
        assert_eq!(size("512MiB").unwrap(), 512 << 20);
        assert_eq!(size("1000").unwrap(), 1000);
        for wrong in ["", "GiB", "1GB", "-1", "1.5GiB", "0", "99999999999GiB"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
