//! Images that are more likely masks or maps of other images. No water may be put into them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use tiff::ColorType;
use tiff::decoder::Decoder;

use super::masks::{is_mask, without_end};
use super::tree::Tree;
use super::{split, stem};
use crate::files::{Patient, catch_panic};
use crate::image_file::{Format, ImageFile, ReadOptions, open_file};

/// Images that stand where masks do; those of another one's name that have the name of a mask, have no colours, or stand
/// beside a JPEG; and, whatever they are called, those that are drawn where others are photographs.
pub(super) fn suspects(tree: &Tree) -> BTreeSet<String> {
    let mut by_name: BTreeMap<String, Vec<&String>> = BTreeMap::new();
    for path in tree.images() {
        let name = stem(split(path).1);
        by_name.entry(without_end(name).unwrap_or(name).to_lowercase()).or_default().push(path);
    }
    let alike = by_name.into_values().filter(|alike| alike.len() > 1);
    let alike = alike.flat_map(|alike| of_one_name(tree, &alike));
    // Where no image stands elsewhere, the folders say nothing.
    let are_others = tree.images().any(|path| !is_mask(path));
    let mut found: BTreeSet<String> =
        alike.chain(tree.images().filter(|path| are_others && is_mask(path)).cloned()).collect();
    let is_drawn = |path: &&String| is_drawn(&tree.root.join(path), &tree.reading);
    let drawn: BTreeSet<String> = tree.images().filter(is_drawn).cloned().collect();
    if tree.images().any(|path| !drawn.contains(path)) {
        found.extend(drawn);
    }
    found
}

/// Those among images that may be called alike because some are about others.
fn of_one_name(tree: &Tree, alike: &[&String]) -> Vec<String> {
    let by_place = |path: &&&String| is_mask(path) || without_end(stem(split(path).1)).is_some();
    let (mut found, images): (Vec<&String>, Vec<&String>) = alike.iter().partition(by_place);
    if images.is_empty() {
        return Vec::new();
    }
    let is_beside = |path: &&&String| {
        let mut others = images.iter().filter(|other| other != path && split(other).0 == split(path).0);
        !is_jpeg(path) && others.any(|other| is_jpeg(other))
    };
    let (beside, images): (Vec<&String>, Vec<&String>) = images.iter().partition(is_beside);
    found.extend(beside);
    let (flat, coloured): (Vec<&String>, Vec<&String>) =
        images.into_iter().partition(|path| is_flat(&tree.root.join(path)));
    if !coloured.is_empty() {
        found.extend(flat);
    }
    found.into_iter().cloned().collect()
}

fn is_jpeg(path: &str) -> bool {
    Format::of(Path::new(path)) == Some(Format::Jpeg)
}

/// Bytes for each pixel, at most, of a PNG whose pixels are looked at: photographs take ten times as many.
const BYTES: f64 = 0.125;
/// The share of pixels that equal the one before them, at least, in a mask; noise makes it small in photographs.
const EQUAL: f64 = 0.9;

/// Whether an image is drawn, as masks are, and was not taken: nearly every pixel equals the one before it. Only images
/// whose header or size leaves the question are decoded, and no JPEG.
fn is_drawn(path: &Path, reading: &ReadOptions) -> bool {
    let share = || equal_share(path, reading);
    match Format::of(path) {
        Some(Format::Png) => {
            (is_flat(path) || is_small(path, reading)) && share().is_some_and(|share| share >= EQUAL)
        }
        Some(Format::Bmp) => share().is_some_and(|share| share >= EQUAL),
        // Those with a palette are not decoded at all.
        Some(Format::Tiff) => is_flat(path) && share().is_none_or(|share| share >= EQUAL),
        _ => false,
    }
}

/// Whether a file has few bytes for its pixels.
fn is_small(path: &Path, reading: &ReadOptions) -> bool {
    let Ok(bytes) = path.metadata().map(|file| file.len()) else { return false };
    let Ok(image) = ImageFile::open(path, reading) else { return false };
    let (width, height) = image.size();
    (bytes as f64) < BYTES * width as f64 * height as f64
}

/// The share of the pixels of an image that equal the one before them in their row.
fn equal_share(path: &Path, reading: &ReadOptions) -> Option<f64> {
    let image = ImageFile::open(path, reading).ok()?.decode().ok()?;
    let bytes = image.bytes();
    let (width, _) = bytes.size();
    let (mut equal, mut all) = (0_u64, 0_u64);
    for row in bytes.as_raw().chunks(width.checked_mul(3)?) {
        let (pixels, _) = row.as_chunks::<3>();
        let pairs = pixels.iter().zip(pixels.get(1..)?);
        equal = equal.saturating_add(pairs.clone().filter(|(one, next)| one == next).count() as u64);
        all = all.saturating_add(pairs.count() as u64);
    }
    (all > 0).then(|| equal as f64 / all as f64)
}

/// Whether an image has a palette or a single channel, as masks and maps have, by its header. A JPEG is no mask.
fn is_flat(path: &Path) -> bool {
    let Ok((file, _)) = open_file(path) else { return false };
    let flat = |file: File| {
        let mut reader = BufReader::new(Patient(file));
        let mut head = [0; 30];
        match Format::of(path)? {
            Format::Png => {
                reader.read_exact(&mut head).ok()?;
                // Grey, a palette, grey with opacity.
                Some(matches!(head.get(25)?, 0 | 3 | 4))
            }
            Format::Bmp => {
                reader.read_exact(&mut head).ok()?;
                Some(*head.get(28)? <= 8)
            }
            Format::Tiff => {
                let kind = Decoder::new(reader).ok()?.colortype().ok()?;
                Some(matches!(kind, ColorType::Gray(_) | ColorType::GrayA(_) | ColorType::Palette(_)))
            }
            _ => None,
        }
    };
    catch_panic(|| flat(file)).flatten().unwrap_or(false)
}
