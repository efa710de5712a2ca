//! The summary of an augmentation: counts, what needs action, and details on request.

use std::fmt::Write;
use std::iter::repeat_n;

use aquafuse::waterbody::Verdict;
use aquafuse_data::augment::{Augmentation, Multiplied, Plan, Water};
use aquafuse_data::dataset::{Layout, Split};
use aquafuse_data::files::display;
use aquafuse_data::run::Summary;

use crate::report::water::{estimate_counts, reasons};

/// What is counted during a run.
#[derive(Default)]
pub(super) struct Tally {
    variants: usize,
    /// Originals that were copied beside their variants.
    originals: usize,
    redrawn: usize,
    unchanged: usize,
    /// Images that were copied unchanged, because their split is not multiplied.
    carried: usize,
    vanished: usize,
    /// Images that have no variants, because their estimate is not good.
    skipped: usize,
    /// Images whose own water is estimated well.
    good: usize,
    /// The keys of the other images.
    others: Vec<(String, Verdict)>,
}

impl Tally {
    pub(super) fn add(&mut self, key: &str, made: &Multiplied) {
        self.variants += made.variants;
        self.carried += usize::from(made.is_carried);
        let is_skipped = made.variants == 0 && made.verdict.is_some_and(|verdict| verdict != Verdict::Good);
        self.skipped += usize::from(is_skipped);
        self.vanished += made.vanished;
        self.originals += made.originals;
        self.redrawn += made.redrawn;
        self.unchanged += made.unchanged;
        match made.verdict {
            Some(Verdict::Good) => self.good += 1,
            Some(verdict) => self.others.push((key.to_owned(), verdict)),
            None => {}
        }
    }

    /// The verdicts in one clause; nothing if the layout gives none.
    fn verdicts(&self) -> String {
        let others = self.others.iter().map(|(_, verdict)| *verdict);
        match (self.good, self.others.len()) {
            (0, 0) => String::new(),
            (good, _) => format!("; {}", estimate_counts(&repeat_n(Verdict::Good, good).chain(others))),
        }
    }

    /// The images whose estimate is not good, by verdict; one line if a verdict holds for every image.
    fn details(&self) -> String {
        let mut text = String::new();
        for wanted in [Verdict::Failed, Verdict::Doubtful] {
            let of_verdict = self.others.iter().filter(|(_, verdict)| *verdict == wanted);
            let mut names: Vec<&str> = of_verdict.map(|(key, _)| key.as_str()).collect();
            names.sort_unstable();
            let (count, name) = (names.len(), wanted.name());
            let _ = match count {
                0 => Ok(()),
                _ if count == self.good + self.others.len() && count > 1 => {
                    writeln!(text, "  all {count} images: estimate {name}")
                }
                _ => writeln!(text, "  estimate {name}: {}", names.join(", ")),
            };
        }
        text
    }
}

/// What a run would write.
pub(super) fn planned(job: &Augmentation, plan: &Plan<'_>, bad: usize, verbose: bool) -> String {
    let mut text = heading(job, verbose);
    let (images, variants) = (plan.files(), plan.variants());
    let originals = match (&job.recipe, plan.originals()) {
        (recipe, _) if recipe.keep_originals => ", and copy the originals".to_owned(),
        (_, 0) => String::new(),
        (_, copied) => format!(", and copy {copied} originals"),
    };
    let _ = match job.dataset.layout {
        layout if layout.holds_many() => writeln!(
            text,
            "would make {} variants of each image in {images} {}{originals}",
            job.recipe.per_image,
            files(layout)
        ),
        _ => writeln!(
            text,
            "would make {variants} variants of {} images{originals}",
            images.saturating_sub(plan.carried())
        ),
    };
    unchanged(&mut text, "would copy unchanged", plan.carried(), job);
    left_out(&mut text, bad);
    text
}

/// What a run has written.
pub(super) fn of(job: &Augmentation, tally: &Tally, ended: &Summary, bad: usize, verbose: bool) -> String {
    let mut text = heading(job, verbose);
    let files = files(job.dataset.layout);
    if ended.skipped > 0 {
        let _ = writeln!(text, "{} {files} skipped: an earlier run wrote their variants", ended.skipped);
    }
    if ended.done == 0 && ended.failed == 0 {
        let _ = writeln!(text, "nothing is left to do");
        return text;
    }
    let _ = writeln!(
        text,
        "{} variants of {} {files} written to {}{}",
        tally.variants,
        ended.done.saturating_sub(tally.carried),
        display(&job.output),
        tally.verdicts()
    );
    unchanged(&mut text, "copied unchanged", tally.carried, job);
    if tally.originals > 0 {
        let _ = writeln!(text, "  and copied originals: {}", tally.originals);
    }
    if tally.redrawn > 0 {
        let _ = writeln!(
            text,
            "  drawn again, because the water hid the scene or hardly changed it: {}",
            tally.redrawn
        );
    }
    if tally.skipped > 0 {
        let _ = writeln!(text, "  without variants, because their estimate is not good: {}", tally.skipped);
    }
    if ended.failed > 0 {
        let _ = writeln!(text, "  failed: {}", ended.failed);
    }
    left_out(&mut text, bad);
    if tally.vanished > 0 {
        let _ = writeln!(
            text,
            "  WARNING: the water hides the scene in {} variants (`contrast_left` in the manifest); say how far \
             one sees with --visibility METRES, or take --model physical",
            tally.vanished
        );
    }
    if tally.unchanged > 0 {
        let _ = writeln!(
            text,
            "  WARNING: {} variants hardly differ from their images (`change` in the manifest); give other waters, \
             a smaller theta, or --model relight",
            tally.unchanged
        );
    }
    if verbose {
        text += &tally.details();
    }
    text
}

/// What a layout's files are.
fn files(layout: Layout) -> &'static str {
    match layout {
        Layout::Shards => "shards",
        Layout::Parquet => "tables",
        _ => "images",
    }
}

/// The dataset, the files that are not part of it, and the waters; with `verbose`, the waters that are not good.
fn heading(job: &Augmentation, verbose: bool) -> String {
    let waters = &job.recipe.waters;
    let quality = |water: &Water| water.file.estimate.quality();
    let bad: Vec<_> = waters.iter().filter(|water| quality(water).verdict != Verdict::Good).collect();
    let counted = if bad.is_empty() {
        String::new()
    } else {
        format!(" ({} not good{})", bad.len(), if verbose { "" } else { "; -v says why" })
    };
    let (root, layout) = (display(&job.dataset.root), job.dataset.layout.name());
    let waters = match (waters.len(), job.recipe.sea) {
        (0, Some(_)) => "waters of the sea".to_owned(),
        (named, Some(_)) => format!("{named} waters{counted} and waters of the sea"),
        (named, None) => format!("{named} waters{counted}"),
    };
    let mut text = format!("{root}: layout {layout}, {waters}\n");
    let counts = job.dataset.split_counts();
    if counts.keys().any(Option::is_some) {
        let count = |(split, count): (&Option<Split>, &usize)| {
            format!("{} {count}", split.map_or("none", Split::name))
        };
        let counts: Vec<String> = counts.iter().map(count).collect();
        let _ = writeln!(text, "  splits: {}", counts.join(", "));
    }
    if !job.dataset.left_out.is_empty() {
        let _ = writeln!(text, "  left out: {}", job.dataset.left_out);
    }
    for water in bad.into_iter().filter(|_| verbose) {
        let quality = quality(water);
        let _ = writeln!(text, "  {}: {} ({})", quality.verdict.name(), water.name, reasons(quality));
    }
    text
}

/// What was not multiplied because of its split.
fn unchanged(text: &mut String, what: &str, carried: usize, job: &Augmentation) {
    if carried > 0 {
        let files = files(job.dataset.layout);
        let _ = writeln!(
            text,
            "  {what}: {carried} {files} of other splits than {} (choose with --splits)",
            job.recipe.splits
        );
    }
}

fn left_out(text: &mut String, bad: usize) {
    if bad > 0 {
        let _ = writeln!(text, "  images left out for bad annotations: {bad}");
    }
}
