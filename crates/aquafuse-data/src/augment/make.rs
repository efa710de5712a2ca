//! One image of a dataset, multiplied.

use std::borrow::Cow;
use std::fs::Metadata;
use std::io::{self, Read as _, Write};
use std::path::{Path, PathBuf};

use aquafuse::fusion::{Gain, Incidence};
use aquafuse::waterbody::{Quality, Reason, Verdict};

use super::depth::Maps;
use super::journal::{Journal, Slot};
use super::line::{Line, Listed, Original, Source, Variant, Written};
use super::plan::{Planned, PlannedVariant};
use super::{Augmentation, Draw, Multiplied, OnDoubtful, Recipe, Sea, Water};
use crate::dataset::Companion;
use crate::files::{FileError, Hashed, Patient, one_line, sha256, sha256_of, write_atomically, write_bytes};
use crate::image_file::{Format, ImageFile, Opened, open_file, read_beside};
use crate::pipeline::{Analysis, DepthSource, analyse_in};
use crate::pipeline::{Operation, Outcome, WaterEstimate};
use crate::run::{Budget, Reservation};

/// What became of one image.
#[derive(Default)]
pub(super) struct Made {
    /// What is new; `None` where all was there.
    pub(super) multiplied: Option<Multiplied>,
    /// What failed: the image, or some of a file that holds several, whose others are made.
    pub(super) failures: Vec<FileError>,
}

/// What is counted of variants.
#[derive(Default)]
pub(super) struct Counts {
    variants: usize,
    redrawn: usize,
    vanished: usize,
    unchanged: usize,
}

impl Counts {
    pub(super) fn of<'a>(variants: impl Iterator<Item = &'a Variant>) -> Self {
        let mut counts = Self::default();
        let add = |count: &mut usize, is_one: bool| *count = count.saturating_add(usize::from(is_one));
        for made in variants {
            add(&mut counts.variants, true);
            add(&mut counts.redrawn, made.redrawn > 0);
            add(&mut counts.vanished, made.contrast_left.is_some_and(|left| left < Outcome::VANISHED));
            add(&mut counts.unchanged, made.change.is_some_and(|change| change < Outcome::UNCHANGED));
        }
        counts
    }

    /// The outcome of an image, without its original.
    pub(super) fn multiplied(self, is_carried: bool, verdict: Option<Verdict>, lines: String) -> Multiplied {
        let Self { variants, redrawn, vanished, unchanged } = self;
        Multiplied { variants, is_carried, originals: 0, redrawn, vanished, unchanged, verdict, lines }
    }
}

/// How often a variant is drawn at most.
const MOST_DRAWS: u32 = 8;
/// A variant is drawn again where less of its image's contrast is left. Looked at: at .21 fish are lost, at .31 they are seen.
const LEAST_CONTRAST: f64 = 0.25;

/// How far a variant is from being hidden or unchanged: from 1 it is as it should be.
fn worth(outcome: &Outcome) -> f64 {
    (outcome.contrast_left / LEAST_CONTRAST).min(outcome.change / Outcome::UNCHANGED)
}

/// What multiplies images.
pub(super) struct Maker<'a> {
    pub(super) job: &'a Augmentation,
    pub(super) maps: Maps,
    pub(super) budget: Budget,
}

/// An image that was read, with all that its variants need.
pub(super) struct Read<'a> {
    pub(super) image: ImageFile,
    pub(super) found: Analysis<WaterEstimate>,
    pub(super) source: Source,
    /// Whether its own water was exchanged.
    pub(super) instead: bool,
    /// Memory for it and for one variant at a time.
    _room: Reservation<'a>,
}

impl Recipe {
    /// Reads an image, and estimates its depth and water.
    pub(super) fn read<'a>(
        &self,
        opened: Opened,
        depth: &DepthSource,
        budget: &'a Budget,
    ) -> Result<Read<'a>, FileError> {
        // A variant beside its image, what surrounds its scene, and as it is encoded.
        let beside = opened.memory_of_pixels().saturating_mul(3);
        let supplied = depth.memory(opened.pixels());
        let light = opened.pixels().saturating_mul(self.encoding.bytes_a_pixel());
        let beside = beside.saturating_add(supplied).saturating_add(light);
        let room = budget.reserve_for(&opened, Format::Png, beside)?;
        let mut source = Source { bytes: 0, sha256: String::new(), depth_sha256: None };
        let image = opened.decode_seeing(|bytes| {
            source.bytes = bytes.len() as u64;
            source.sha256 = sha256(bytes);
        })?;
        let mut found = analyse_in(self.encoding, &image, depth)?;
        // Now that it is known to be a file.
        if let DepthSource::Supplied { path, .. } = depth {
            source.depth_sha256 = Some(sha256_of(path)?);
        }
        let quality = found.estimate.quality();
        let doubtful = quality.verdict != Verdict::Good;
        let instead = match &self.on_doubtful {
            OnDoubtful::Instead(water) if doubtful => {
                found.estimate = water.file.estimate.with_quality(quality);
                true
            }
            _ => false,
        };
        Ok(Read { image, found, source, instead, _room: room })
    }

    /// Why an image of this quality has no variants, if it has none.
    pub(super) fn skipped(&self, quality: Quality) -> Option<String> {
        let skip = quality.verdict != Verdict::Good && matches!(self.on_doubtful, OnDoubtful::Skip);
        let reasons = || quality.reasons.iter().map(Reason::describe).collect::<Vec<_>>().join("; ");
        skip.then(|| format!("{}: {}", quality.verdict.name(), reasons()))
    }

    /// Whether an image is copied beside its variants; one without an image has none.
    pub(super) fn keeps(&self, key: &str, has_variants: bool) -> bool {
        let is_drawn = || self.draws.keeps(key, self.per_image, self.keep_share);
        self.keep_originals || (has_variants && is_drawn())
    }

    /// The water of a draw, if there is one.
    pub(super) fn water(&self, draw: Draw) -> Option<Cow<'_, Water>> {
        let own = self.waters.get(draw.water).map(Cow::Borrowed);
        own.or_else(|| Some(Cow::Owned(self.sea?.water(draw.sea, self.encoding).ok()?)))
    }

    /// What names of variants call the water of a draw.
    pub(super) fn slug(&self, draw: Draw) -> String {
        self.waters.get(draw.water).map_or_else(|| Sea::SLUG.to_owned(), Water::slug)
    }

    /// The variant of a number. If the scene is hidden or hardly changed, it is drawn again as far as draws differ; where no
    /// draw does, the best one is taken.
    pub(super) fn drawn(&self, read: &Read<'_>, key: &str, number: u32) -> (Draw, ImageFile, Outcome) {
        let draws = |redrawn| self.draws.redraw(key, number, self.choices(), redrawn);
        let made = |draw| {
            let water = self.water(draw).expect("the plan has seen that there is one");
            let (image, outcome) = self.fused(read, &water, draw);
            (draw, image, outcome)
        };
        let first = draws(0);
        let is_free = !self.draws.are_fixed() || first.water >= self.waters.len();
        let (mut best, mut most) = (first, f64::NEG_INFINITY);
        for redrawn in 0..if is_free { MOST_DRAWS } else { 0 } {
            let made = made(draws(redrawn));
            let value = worth(&made.2);
            if value >= 1.0 {
                return made;
            }
            if value > most {
                (best, most) = (made.0, value);
            }
        }
        // Made once more: memory is for one variant at a time.
        made(best)
    }

    /// A variant, and what was done.
    pub(super) fn fused(&self, read: &Read<'_>, water: &Water, draw: Draw) -> (ImageFile, Outcome) {
        let options = self
            .options
            .with_incidence(Incidence::from_degrees(draw.theta).unwrap_or(self.options.incidence))
            .with_gain(Gain::new(draw.alpha).unwrap_or(self.options.gain));
        let mut image = read.image.clone();
        let operation = Operation::Fuse { reference: water.file.estimate, options };
        let outcome =
            operation.apply(&mut image.pixels, Some(&read.found)).expect("the depth map is this image's");
        (image, outcome)
    }

    /// A variant as a file holds it.
    pub(super) fn encoded(&self, mut image: ImageFile, output: &Path) -> Result<Vec<u8>, FileError> {
        image.pixels = image.pixels.smoothed(self.smoothing);
        image.joined().encode(output, self.quality)
    }
}

impl Read<'_> {
    /// A variant of the image as the manifest has it.
    #[allow(clippy::too_many_arguments, reason = "each is another field of the line")]
    pub(super) fn described(
        &self,
        recipe: &Recipe,
        key: &str,
        number: u32,
        draw: Draw,
        outcome: Outcome,
        written: Written,
        companions: Vec<Written>,
    ) -> Variant {
        let quality = self.found.estimate.quality();
        let is_named = draw.water < recipe.waters.len();
        Variant {
            key: key.to_owned(),
            number,
            water: is_named.then_some(draw.water),
            sea: (!is_named).then_some(draw.sea),
            theta: draw.theta,
            alpha: draw.alpha,
            redrawn: draw.redrawn,
            source: self.source.clone(),
            verdict: quality.verdict.name().to_owned(),
            reasons: quality.reasons.iter().collect(),
            clipped: outcome.clipping.share(),
            contrast_left: Some(outcome.contrast_left),
            change: Some(outcome.change),
            instead: self.instead,
            output: written.output,
            bytes: written.bytes,
            sha256: written.sha256,
            companions,
        }
    }
}

impl<'a> Maker<'a> {
    pub(super) fn new(job: &'a Augmentation, maps: Maps) -> Self {
        Self { job, maps, budget: job.run_options.budget() }
    }

    /// Makes what is not there yet.
    pub(super) fn make(&self, sample: &Planned<'_>, journal: &Journal) -> Made {
        let made = match self.job.dataset.layout.holds_many() && !sample.is_carried {
            true => self.make_container(sample, journal),
            false => self
                .make_variants(sample, journal)
                .map(|multiplied| Made { multiplied, failures: Vec::new() }),
        };
        made.unwrap_or_else(|error| {
            if matches!(error, FileError::Stopped { .. }) {
                return Made { multiplied: None, failures: vec![error] };
            }
            let (key, said) = (sample.key.to_owned(), one_line(&error.to_string()));
            journal.add_or_owe(sample.index, Line::Failed { key, error: said });
            Made { multiplied: None, failures: vec![error] }
        })
    }

    fn make_variants(
        &self,
        sample: &Planned<'_>,
        journal: &Journal,
    ) -> Result<Option<Multiplied>, FileError> {
        let recipe = &self.job.recipe;
        let input = self.job.dataset.root.join(sample.key);
        let input_about = input.metadata().map_err(|error| FileError::Read { path: input.clone(), error })?;
        let known = journal.entry(sample.index)?;
        let (mut lines, mut skipped) = (Vec::new(), None);
        let mut missing: Vec<&PlannedVariant> = Vec::new();
        for planned in &sample.variants {
            let old = known.variants.get(&planned.number);
            if !old.is_some_and(|old| self.is_current(old, planned, sample, &input_about)) {
                journal.forget(sample.index, Slot::Variant(planned.number));
                missing.push(planned);
            }
        }
        let verdict = if missing.is_empty() {
            None
        } else {
            let opened = ImageFile::open(&input, &self.job.run_options.reading)?;
            let read = recipe.read(opened, &self.maps.source(sample.key)?, &self.budget)?;
            let quality = read.found.estimate.quality();
            if let Some(why) = recipe.skipped(quality) {
                skipped = Some(Line::Skipped { key: sample.key.to_owned(), why });
                missing.clear();
            }
            for planned in &missing {
                self.job.run_options.stop.check(&self.job.output.join(&planned.output))?;
                let line = Line::Variant(self.write_variant(&read, sample, planned)?);
                // Each by itself: what is on the disk is known, whenever the process ends.
                journal.add(sample.index, std::slice::from_ref(&line))?;
                lines.push(line);
            }
            Some(quality.verdict)
        };
        let mut originals = 0;
        if sample.is_carried || recipe.keeps(sample.key, true) {
            let old = known.original.as_ref();
            if !old.is_some_and(|old| self.is_original(old, sample, &input_about)) {
                journal.forget(sample.index, Slot::Original);
                let line = Line::Original(self.write_original(sample)?);
                journal.add(sample.index, std::slice::from_ref(&line))?;
                lines.push(line);
                originals = usize::from(!sample.is_carried);
            }
        }
        if let Some(line) = skipped {
            journal.add(sample.index, std::slice::from_ref(&line))?;
            lines.push(line);
        }
        let made = lines.iter().filter_map(|line| match line {
            Line::Variant(variant) => Some(variant),
            _ => None,
        });
        let text = lines.iter().map(Line::text).collect();
        let multiplied = Counts::of(made).multiplied(sample.is_carried, verdict, text);
        Ok((!lines.is_empty()).then_some(Multiplied { originals, ..multiplied }))
    }

    fn write_variant(
        &self,
        read: &Read<'_>,
        sample: &Planned<'_>,
        planned: &PlannedVariant,
    ) -> Result<Variant, FileError> {
        let recipe = &self.job.recipe;
        let path = self.job.output.join(&planned.output);
        let (draw, image, outcome) = recipe.drawn(read, sample.key, planned.number);
        let bytes = recipe.encoded(image, &path)?;
        let name = crate::dataset::split(&planned.output).1;
        let carry = |(companion, output): (&Companion, &String)| {
            self.write(
                output,
                &companion.for_variant(
                    &self.job.dataset.root,
                    crate::dataset::split(sample.key).1,
                    name,
                    &self.job.run_options.reading,
                )?,
            )
        };
        // The image comes last: where it is, all that belongs to it is.
        let companions =
            sample.companions.iter().zip(&planned.companions).map(carry).collect::<Result<_, _>>()?;
        let written = self.write(&planned.output, &bytes)?;
        Ok(read.described(recipe, sample.key, planned.number, draw, outcome, written, companions))
    }

    /// Carries the image and what is about it over as they are.
    fn write_original(&self, sample: &Planned<'_>) -> Result<Original, FileError> {
        let carry = |path: &str| {
            let input = self.job.dataset.root.join(path);
            self.write(path, &read_beside(&input, &self.job.run_options.reading)?)
        };
        let companions =
            sample.companions.iter().map(|companion| carry(&companion.path)).collect::<Result<_, _>>()?;
        let input = self.job.dataset.root.join(sample.key);
        let Written { output, bytes, sha256 } = self.copy(&input, sample.key)?;
        Ok(Original { key: sample.key.to_owned(), output, bytes, sha256, companions })
    }

    fn write(&self, output: &str, bytes: &[u8]) -> Result<Written, FileError> {
        write_bytes(&self.job.output.join(output), bytes, true)?;
        Ok(Written { output: output.to_owned(), bytes: bytes.len() as u64, sha256: sha256(bytes) })
    }

    /// Copies a file piece by piece: a shard may be larger than memory.
    fn copy(&self, input: &Path, output: &str) -> Result<Written, FileError> {
        let (mut file, _) = open_file(input)?;
        let (mut digest, mut unread) = ((0, String::new()), None);
        let result = write_atomically(&self.job.output.join(output), true, |out| -> io::Result<()> {
            let mut hashed = Hashed::new(out);
            let mut piece = vec![0; 1 << 16];
            loop {
                match Patient(&mut file).read(&mut piece) {
                    Ok(0) => break,
                    Ok(length) => hashed.write_all(piece.get(..length).unwrap_or_default())?,
                    Err(error) => {
                        unread = Some(error);
                        return Err(io::Error::other("its input cannot be read"));
                    }
                }
            }
            digest = hashed.result();
            Ok(())
        });
        if let Some(error) = unread {
            return Err(FileError::Read { path: input.to_owned(), error });
        }
        result?;
        let (bytes, sha256) = digest;
        Ok(Written { output: output.to_owned(), bytes, sha256 })
    }

    /// Whether a variant is there as it would be made now: all its files, no older than what they are made from.
    fn is_current(
        &self,
        old: &Variant,
        planned: &PlannedVariant,
        sample: &Planned<'_>,
        input: &Metadata,
    ) -> bool {
        let recipe = &self.job.recipe;
        let draw = recipe.draws.redraw(sample.key, planned.number, recipe.choices(), old.redrawn);
        let is_so = |old: Draw| {
            let is_of_sea = draw.water >= recipe.waters.len();
            let water = if is_of_sea { old.sea == draw.sea } else { old.water == draw.water };
            water && (old.theta, old.alpha) == (draw.theta, draw.alpha)
        };
        let companions = sample.companions.iter().zip(&planned.companions).zip(&old.companions);
        let about = |companion: &Companion| self.job.dataset.root.join(&companion.path).metadata();
        old.draw(recipe.waters.len()).is_some_and(is_so)
            && old.output == planned.output
            && old.source.bytes == input.len()
            && self.stands(old.listed(), input)
            && self.is_of_depth(old, sample.key)
            && old.companions.len() == sample.companions.len()
            && companions.into_iter().all(|((companion, output), old)| {
                old.output == *output && about(companion).is_ok_and(|about| self.stands(old.listed(), &about))
            })
    }

    /// Whether a variant is no older than the depth map that it was made with, if it has one.
    fn is_of_depth(&self, old: &Variant, key: &str) -> bool {
        match self.maps.source(key) {
            Ok(DepthSource::Supplied { path, .. }) => {
                path.metadata().is_ok_and(|about| self.stands(old.listed(), &about))
            }
            Ok(DepthSource::Estimated(_)) => true,
            // Making it again says what is wrong with its depth.
            Err(_) => false,
        }
    }

    fn is_original(&self, old: &Original, sample: &Planned<'_>, input: &Metadata) -> bool {
        let about = |companion: &Companion| self.job.dataset.root.join(&companion.path).metadata();
        let companions = sample.companions.iter().zip(&old.companions);
        old.output == sample.key
            && old.bytes == input.len()
            && self.stands(old.listed(), input)
            && old.companions.len() == sample.companions.len()
            && companions.into_iter().all(|(companion, old)| {
                old.output == companion.path
                    && about(companion).is_ok_and(|about| self.stands(old.listed(), &about))
            })
    }

    /// Whether a file that was written stands there, no older than what it was made from.
    pub(super) fn stands(&self, written: Listed<'_>, from: &Metadata) -> bool {
        let path: PathBuf = self.job.output.join(written.output);
        let newer = |about: &Metadata| match (about.modified(), from.modified()) {
            (Ok(made), Ok(from)) => made >= from,
            _ => true,
        };
        path.metadata().is_ok_and(|about| about.len() == written.bytes && newer(&about))
    }
}
