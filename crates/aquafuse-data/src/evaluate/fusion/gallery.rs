//! The best and the worst results, to look at. They are made once more: no image is kept while others are scored.

use super::{Fusion, Reference, Scored};
use crate::evaluate::report::{Strip, thumbnail};
use crate::image_file::{Format, ImageFile, Pixels};
use crate::run::Budget;

/// Results shown at either end.
const SHOWN: usize = 3;

impl Fusion {
    /// Strips of the pairs whose results by the first method have the highest and the lowest SSIM, one of a content.
    pub(super) fn gallery(
        &self,
        results: &[Scored],
        references: &[Option<Reference>],
        budget: &Budget,
    ) -> Vec<Strip> {
        let mut sorted: Vec<&Scored> = results.iter().filter(|one| one.method == 0).collect();
        sorted.sort_by(|a, b| b.likeness.ssim.total_cmp(&a.likeness.ssim));
        let best = first_of_each_content(sorted.iter().copied());
        // With few contents both ends would be the same images.
        let is_best = |one: &&Scored| best.iter().any(|other| other.content == one.content);
        let mut worst = first_of_each_content(sorted.iter().rev().copied().filter(|one| !is_best(one)));
        worst.reverse();
        let strip = |heading: &'static str, one: &Scored| self.strip(heading, one, references, budget);
        let best = best.into_iter().filter_map(|one| strip("most alike", one));
        best.chain(worst.into_iter().filter_map(|one| strip("least alike", one))).collect()
    }

    /// Content, reference and what each method makes of them; none where a file has gone meanwhile.
    fn strip(
        &self,
        heading: &'static str,
        one: &Scored,
        references: &[Option<Reference>],
        budget: &Budget,
    ) -> Option<Strip> {
        let (member, other) = (self.contents.get(one.content)?, self.references.get(one.reference)?);
        let reference = references.get(one.reference)?.as_ref()?;
        let shown = ImageFile::open(&other.path, &self.run_options.reading).ok()?;
        let room = budget.reserve(shown.memory());
        let seen = thumbnail(&shown.decode().ok()?.upright().pixels.into_bytes());
        drop(room);
        let opened = ImageFile::open(&member.path, &self.run_options.reading).ok()?;
        let beside = opened.pixels().saturating_mul(self.bytes_a_pixel());
        let _room = budget.reserve(opened.memory_until_written(Format::Png, beside).ok()?);
        let content = self.read_content(member, opened.decode().ok()?).ok()?;
        let turn = content.image.metadata.orientation();
        let upright = |pixels: Pixels| thumbnail(&pixels.turned(turn).into_bytes());
        let mut images = vec![
            (member.name.clone(), upright(content.image.pixels.clone())),
            (format!("water of {}", other.name), seen),
        ];
        for way in &self.methods {
            let Ok(made) = self.make(way, member, other, &content, reference) else { continue };
            images.push((way.name().to_owned(), upright(made.into())));
        }
        let scores = one.likeness;
        let caption =
            format!("{heading}: SSIM {:.3}, depth RMSE {:.1} %", scores.ssim, scores.depth.percent());
        Some(Strip { caption, images })
    }
}

fn first_of_each_content<'a>(sorted: impl Iterator<Item = &'a Scored>) -> Vec<&'a Scored> {
    let mut found: Vec<&Scored> = Vec::new();
    for one in sorted {
        if found.len() == SHOWN {
            break;
        }
        if found.iter().all(|other| other.content != one.content) {
            found.push(one);
        }
    }
    found
}
