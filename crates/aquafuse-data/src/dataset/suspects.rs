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
use crate::image_file::{Format, open_file};

/// Images that stand where masks do; and those of another one's name that have the name of a mask, have no colours, or
/// stand beside a JPEG.
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
    alike.chain(tree.images().filter(|path| are_others && is_mask(path)).cloned()).collect()
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
