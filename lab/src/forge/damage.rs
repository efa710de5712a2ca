//! Valid files cut short at many places, and with single bits turned over.

use anyhow::{Context, Result};

use super::bytes::find;
use super::list::{Files, Right, Role};
use super::tiff_bytes::Tiff;
use super::{jpeg_bytes, png_bytes, seeds};
use crate::chance::Chance;

const PICTURES: [&str; 6] = ["png", "jpg", "webp", "tiff", "bmp", "gif"];
const DEPTHS: [&str; 5] = ["png", "tiff", "exr", "npy", "pfm"];
/// Flips a file: images come from anywhere, depth maps mostly from one's own tools.
const FLIPS: [(Role, usize); 2] = [(Role::Image, 40), (Role::Depth, 20)];

pub(crate) fn add(files: &mut Files) -> Result<()> {
    for (role, flips) in FLIPS {
        let extensions = if role == Role::Image { &PICTURES[..] } else { &DEPTHS };
        for extension in extensions {
            let whole = match role {
                Role::Image => seeds::image(extension)?,
                Role::Depth => seeds::depth(extension)?,
            };
            cut(files, role, "cut", extension, &whole)?;
            flip(files, role, extension, &whole, flips);
        }
    }
    let mut also = |name, extension, whole: &[u8]| cut(files, Role::Image, name, extension, whole);
    // The directory in front, as most writers but the crate's have it: then pixels are what is lost.
    also("cut-by-hand", "tif", &Tiff::grey().bytes())?;
    // Larger ones, of which nearly everything is scan: decoders that fill up what is missing take them.
    also("cut-photo", "jpg", &seeds::photo()?)?;
    also("cut-progressive", "jpg", &jpeg_bytes::progressive(64))?;
    also("cut-interlaced", "png", &png_bytes::interlaced())?;
    Ok(())
}

/// Leaves so many bytes of a file.
fn cut(files: &mut Files, role: Role, name: &str, extension: &str, whole: &[u8]) -> Result<()> {
    let all = whole.len();
    let needed = needed(extension, whole)?;
    let eighths = [1, 2, 4, 6, 7].map(|eighths| all * eighths / 8);
    let near_the_end = [64, 24, 8, 1].map(|lost| all - lost);
    for left in [1, 3, 20].into_iter().chain(eighths).chain(near_the_end) {
        let right = if left < needed { Right::Refuse } else { Right::Any };
        let name = format!("{name}-to-{left:05}.{extension}");
        files.add("cut short", role, right, &name, &whole[..left]);
    }
    Ok(())
}

/// How many bytes of a seed its pixels need; what follows is an end mark that a reader may do without.
fn needed(extension: &str, whole: &[u8]) -> Result<usize> {
    Ok(match extension {
        // The last chunk of data with its checksum; the 12 bytes of IEND follow.
        "png" => find(whole, b"IEND")? - 4,
        // The marker EOI.
        "jpg" => whole.len() - 2,
        // The end of the sub-blocks, which is a zero, and the trailer.
        "gif" => whole.len() - 2,
        // A chunk of odd length is padded by one byte.
        "webp" => {
            let at = find(whole, b"VP8L")? + 4;
            let length = whole.get(at..at + 4).context("no length")?.iter().rev();
            at + 4 + length.fold(0, |length, &byte| length << 8 | usize::from(byte))
        }
        // Where no further directory is; it is the last thing the crate writes.
        "tiff" => whole.len() - 4,
        // Pixels come last.
        _ => whole.len(),
    })
}

fn flip(files: &mut Files, role: Role, extension: &str, whole: &[u8], flips: usize) {
    let mut chance = Chance(0xf11b ^ u64::from(role == Role::Depth));
    for index in 0..flips {
        // Half of them among the first hundred bytes: that is where headers are.
        let reach = if index % 2 == 0 { whole.len().min(100) } else { whole.len() };
        let (at, bit) = (chance.below(reach), chance.below(8));
        let mut flipped = whole.to_vec();
        flipped[at] ^= 1 << bit;
        let name = format!("flip-{index:02}-byte-{at}-bit-{bit}.{extension}");
        files.add("bit flips", role, Right::Any, &name, flipped);
    }
}
