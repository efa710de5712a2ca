//! A sheet of a few images with their variants, and what their annotations say drawn into both: whether the waters are right
//! and the boxes fit is seen at a glance.

use std::collections::BTreeMap;
use std::path::Path;

use aquafuse::image::Image;

use super::journal::{Journal, Slot};
use super::line::Written;
use super::plan::Planned;
use super::{Augmentation, Plan};
use crate::dataset::{
    Companion, Index, MOST_MARKS, Outline, PREVIEW, Sample, marks_of_coco, marks_of_companion, split,
};
use crate::drawing::{Cell, contact_sheet, outlined};
use crate::files::{FileError, sha256, text_of, write_bytes};
use crate::image_file::{Format, ImageFile, ReadOptions, read_beside};
use crate::run::Budget;

/// Variants of an image that are shown.
const VARIANTS: usize = 3;
/// Columns and rows of a cell, in pixels.
const ROOM: [u32; 2] = [320, 240];
/// Bytes a pixel that drawing into an image takes beside it: in bytes, with a mask, and with what it is made of.
const DRAWN: u64 = 12;
/// What masks are tinted with.
const TINT: [u8; 3] = [255, 40, 160];
const QUALITY: u8 = 90;

/// The boxes of some images, by their keys.
type Boxes = BTreeMap<String, Vec<Outline>>;

impl Augmentation {
    /// Draws the sheet; none where files hold many images, or nothing was multiplied.
    pub(super) fn write_preview(
        &self,
        plan: &Plan<'_>,
        journal: &Journal,
    ) -> Result<Option<Written>, FileError> {
        if self.preview == 0 || self.shard.of > 1 || self.dataset.layout.holds_many() || self.is_taken() {
            return Ok(None);
        }
        let has_variants =
            |index: &&usize| journal.slots(**index).iter().any(|slot| matches!(slot, Slot::Variant(_)));
        let multiplied: Vec<usize> = plan.indices().iter().filter(has_variants).copied().collect();
        let count = self.preview.min(multiplied.len());
        // From the first to the last, at even steps.
        let at = |number: usize| number.saturating_mul(multiplied.len()).checked_div(count);
        let shown: Vec<Planned<'_>> = (0..count)
            .filter_map(|number| plan.planned(*multiplied.get(at(number)?)?))
            .map(|mut planned| {
                let made = journal.slots(planned.index);
                planned.variants.retain(|variant| made.contains(&Slot::Variant(variant.number)));
                planned.variants.truncate(VARIANTS);
                planned
            })
            .collect();
        if shown.is_empty() {
            return Ok(None);
        }
        let (before, after) = (self.boxes(&shown, false), self.boxes(&shown, true));
        let budget = self.run_options.budget();
        let root = &self.dataset.root;
        let row = |planned: &Planned<'_>| {
            let own = self.cell(root, planned.key, planned.companions.to_vec(), &before, &budget);
            let variants = planned.variants.iter().map(|variant| {
                let paths = planned.companions.iter().zip(&variant.companions);
                let companions =
                    paths.map(|(companion, path)| Companion { path: path.clone(), ..companion.clone() });
                self.cell(&self.output, &variant.output, companions.collect(), &after, &budget)
            });
            std::iter::once(own).chain(variants).collect()
        };
        let rows: Vec<Vec<Cell>> = shown.iter().map(row).collect();
        let path = self.output.join(PREVIEW);
        let [width, height] = ROOM;
        let sheet = contact_sheet(&rows, width, height)
            .map_err(|error| FileError::Write { path: path.clone(), cause: error.to_string() })?;
        let bytes = ImageFile::new(sheet).encode(&path, QUALITY)?;
        write_bytes(&path, &bytes, true)?;
        Ok(Some(Written { output: PREVIEW.to_owned(), bytes: bytes.len() as u64, sha256: sha256(&bytes) }))
    }

    /// Whether the dataset has a file of the sheet's name, which the output has too.
    fn is_taken(&self) -> bool {
        let of_sample = |sample: &Sample| {
            sample.key == PREVIEW || sample.companions.iter().any(|companion| companion.path == PREVIEW)
        };
        self.dataset.samples.iter().any(of_sample)
            || self.dataset.indices.iter().any(|index| index.path() == PREVIEW)
    }

    /// The boxes in files about all images, of the images that are shown or of their variants.
    fn boxes(&self, shown: &[Planned<'_>], is_after: bool) -> Boxes {
        let mut boxes = Boxes::new();
        let reading = &self.run_options.reading;
        for index in &self.dataset.indices {
            let Index::Coco(file) = index else { continue };
            let own = |planned: &&Planned<'_>| file.keys.iter().any(|key| key == planned.key);
            let keys: Vec<&str> = shown
                .iter()
                .filter(own)
                .flat_map(|planned| match is_after {
                    true => planned.variants.iter().map(|variant| variant.output.as_str()).collect(),
                    false => vec![planned.key],
                })
                .collect();
            let root = if is_after { &self.output } else { &self.dataset.root };
            let Ok(bytes) = read_beside(&root.join(index.path()), reading) else { continue };
            let Some(text) = text_of(&bytes).filter(|_| !keys.is_empty()) else { continue };
            for (key, found) in marks_of_coco(&text, &keys) {
                boxes.entry(key).or_default().extend(found);
            }
        }
        boxes
    }

    /// An image with its annotations; its name alone where it cannot be read.
    fn cell(
        &self,
        root: &Path,
        key: &str,
        companions: Vec<Companion>,
        boxes: &Boxes,
        budget: &Budget,
    ) -> Cell {
        let reading = ReadOptions { border: aquafuse::scene_area::Border::None, ..self.run_options.reading };
        let draw = || -> Option<(Image<u8>, usize)> {
            let opened = ImageFile::open(&root.join(key), &reading).ok()?;
            let beside = opened.pixels().saturating_mul(DRAWN);
            let _room = budget.reserve_for(&opened, Format::Png, beside).ok()?;
            let mut image = opened.decode().ok()?.bytes().into_owned();
            let mut outlines = boxes.get(key).cloned().unwrap_or_default();
            let mut masks: usize = 0;
            for companion in companions {
                let path = root.join(&companion.path);
                if Format::of(&path).is_some() {
                    masks = masks.saturating_add(usize::from(tinted(&mut image, &path, &reading)));
                } else if let Ok(bytes) = read_beside(&path, &reading) {
                    outlines.extend(marks_of_companion(
                        self.dataset.layout,
                        &companion,
                        &bytes,
                        image.size(),
                    ));
                }
            }
            let count = outlines.len().saturating_add(masks);
            Some((outlined(&image, ROOM, &outlines).ok()?, count))
        };
        let name = split(key).1;
        match draw() {
            Some((image, count)) if count >= MOST_MARKS => {
                Cell { caption: format!("{name} ({count} or more)"), image: Some(image) }
            }
            Some((image, count)) => Cell { caption: format!("{name} ({count})"), image: Some(image) },
            None => Cell { caption: format!("{name}: not shown"), image: None },
        }
    }
}

/// Tints the pixels of an image that its mask does not leave black; whether the mask could be read.
fn tinted(image: &mut Image<u8>, mask: &Path, reading: &ReadOptions) -> bool {
    let Ok(mask) = ImageFile::open(mask, reading).and_then(crate::image_file::Opened::decode) else {
        return false;
    };
    let mask = mask.bytes();
    if mask.size() != image.size() {
        return false;
    }
    for (pixel, of_mask) in image.pixels_mut().iter_mut().zip(mask.pixels()) {
        if *of_mask != [0; 3] {
            let mixed = |(own, tint): (u8, u8)| (own / 2).saturating_add(tint / 2);
            let [r, g, b] = *pixel;
            let [red, green, blue] = TINT;
            *pixel = [mixed((r, red)), mixed((g, green)), mixed((b, blue))];
        }
    }
    true
}
