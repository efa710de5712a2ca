//! `--max-pixels`, `--max-memory` and `--lenient`: which images are accepted.

use std::path::Path;

use anyhow::{Result, anyhow};
use aquafuse::scene_area::Border;
use aquafuse::waterbody::WaterMap;
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use clap::Args;

use crate::failure::Failure;

#[derive(Clone, Args)]
pub(crate) struct Reading {
    /// Refuse images with more pixels than this [default: 268435456, and of images above 33554432 pixels those with
    /// more than 64 pixels a byte, as no photograph has].
    #[arg(long, global = true, help_heading = crate::args::common::HEADING, value_name = "N")]
    max_pixels: Option<u64>,
    /// Memory for all images processed at once: 512MiB, 2GiB or a number of bytes. An image that needs more is
    /// refused; the others wait until memory is free. An annotation file or list may take a quarter of it.
    #[arg(long, global = true, help_heading = crate::args::common::HEADING, value_name = "SIZE", default_value = "2GiB", value_parser = size)]
    max_memory: u64,
    /// Decode what is left of truncated files (mainly JPEG and PNG). The EXIF description of the output says so.
    #[arg(long, global = true, help_heading = crate::args::common::HEADING)]
    lenient: bool,
    /// What is cut off around a scene: nothing, unless a command has `--border`.
    #[arg(skip = Border::None)]
    pub(crate) border: Border,
    /// What says where open water is: rules, unless a command has `--water-map`.
    #[arg(skip)]
    pub(crate) water_map: WaterMap,
}

impl Reading {
    pub(crate) fn options(&self) -> ReadOptions {
        let Self { max_pixels, max_memory, lenient, border, water_map } = *self;
        let default = ReadOptions { max_memory, lenient, border, water_map, ..ReadOptions::default() };
        match max_pixels {
            Some(max_pixels) => ReadOptions { max_pixels, max_pixels_per_byte: u64::MAX, ..default },
            None => default,
        }
    }

    /// The same for an image that gives its water: a border given in numbers belongs to the contents.
    pub(crate) fn of_reference(&self) -> Self {
        Self { border: self.border.of_reference(), ..*self }
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
        _ => return Err(anyhow!("give a number of bytes, or a number followed by KiB, MiB or GiB")),
    };
    let number: u64 = digits.parse().map_err(|_| anyhow!("not a whole number"))?;
    number
        .checked_mul(unit)
        .filter(|&bytes| bytes > 0)
        .ok_or_else(|| anyhow!("the amount must be above 0 and fit into 64 bits"))
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
