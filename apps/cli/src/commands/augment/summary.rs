//! What is said about a dataset that was multiplied.

use std::fmt::Write;

use aquafuse::waterbody::Verdict;
use aquafuse_data::augment::{Augmentation, Multiplied, Plan};
use aquafuse_data::dataset::Layout;
use aquafuse_data::files::display;
use aquafuse_data::run::Summary;

use crate::report::water::reasons;

/// What is counted while a run goes on.
#[derive(Default)]
pub(super) struct Tally {
    variants: usize,
    vanished: usize,
    doubtful: usize,
    failed_estimates: usize,
}

impl Tally {
    pub(super) fn add(&mut self, made: &Multiplied) {
        self.variants += made.variants;
        self.vanished += made.vanished;
        match made.verdict {
            Some(Verdict::Doubtful) => self.doubtful += 1,
            Some(Verdict::Failed) => self.failed_estimates += 1,
            _ => {}
        }
    }
}

/// What a run would make.
pub(super) fn planned(job: &Augmentation, plan: &Plan, bad: usize) -> String {
    let mut text = heading(job);
    let (images, variants) = (plan.files(), plan.variants());
    let kept = if job.recipe.keep_originals { ", and carry them over" } else { "" };
    let _ = match job.dataset.layout {
        layout if layout.holds_many() => writeln!(
            text,
            "would make {} variants of each image in {images} {}{kept}",
            job.recipe.per_image,
            things(layout)
        ),
        _ => writeln!(text, "would make {variants} variants of {images} images{kept}"),
    };
    left_out(&mut text, bad);
    text
}

/// What a run has made.
pub(super) fn of(job: &Augmentation, tally: &Tally, ended: &Summary, bad: usize) -> String {
    let mut text = heading(job);
    let things = things(job.dataset.layout);
    if ended.skipped > 0 {
        let _ = writeln!(text, "{} {things} were done already, by a run before this one", ended.skipped);
    }
    if ended.done == 0 && ended.failed == 0 {
        let _ = writeln!(text, "nothing is left to do");
        return text;
    }
    let _ = writeln!(
        text,
        "{} variants of {} {things} written to {}",
        tally.variants,
        ended.done,
        display(&job.output)
    );
    left_out(&mut text, bad);
    if tally.vanished > 0 {
        let _ = writeln!(
            text,
            "  variants in which the water hides the scene: {}; a smaller --metres-at-one lets through more, --model \
             physical all; `contrast_left` in the manifest names them",
            tally.vanished
        );
    }
    for (count, verdict) in [(tally.failed_estimates, Verdict::Failed), (tally.doubtful, Verdict::Doubtful)] {
        if count > 0 {
            let _ = writeln!(
                text,
                "  images whose own water is {}: {count}; the manifest names them",
                verdict.name()
            );
        }
    }
    text
}

/// What a layout's files are.
fn things(layout: Layout) -> &'static str {
    match layout {
        Layout::Shards => "shards",
        Layout::Parquet => "tables",
        _ => "images",
    }
}

fn heading(job: &Augmentation) -> String {
    let (layout, waters) = (job.dataset.layout.name(), job.recipe.waters.len());
    let mut text = format!("{}: layout {layout}, {waters} waters\n", display(&job.dataset.root));
    for water in &job.recipe.waters {
        let quality = water.file.estimate.quality();
        if quality.verdict != Verdict::Good {
            let _ = writeln!(text, "  {}: {} ({})", quality.verdict.name(), water.name, reasons(quality));
        }
    }
    text
}

fn left_out(text: &mut String, bad: usize) {
    if bad > 0 {
        let _ = writeln!(text, "  images left out for bad annotations: {bad}");
    }
}
