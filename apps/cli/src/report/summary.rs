//! What is said about images that were made: how many, and which deserve a look.

use std::fmt::Write;

use aquafuse::depth::{SuppliedKind, SuppliedReport};
use aquafuse::waterbody::Verdict;
use aquafuse_data::batch::{Item, Report};
use aquafuse_data::files::display;
use aquafuse_data::pipeline::Limited;
use aquafuse_data::pipeline::Scores;

use crate::args::depth::inverted;
use crate::report::water::reasons;

/// More clipping than this share of the values is worth a word.
const MUCH: f64 = 0.05;
/// No water's backscatter grows faster than this in green, per metre: the thickest of Jerlov's has a third of it.
const THICKEST: f32 = 20.0;
/// Images named for each thing that is worth a word.
const NAMED: usize = 5;

/// The summary of these images, and of `kept` that were there before; every image is named if it is `verbose`.
pub(super) fn of(reports: &[(Item, Report)], kept: usize, verbose: bool) -> String {
    let named = if verbose { usize::MAX } else { NAMED };
    let mut text = String::new();
    if kept > 0 {
        let _ = writeln!(text, "{kept} images were there already, made by a run before this one");
    }
    let mean =
        reports.iter().map(|(_, report)| report.outcome.clipping.share()).sum::<f64>() / reports.len() as f64;
    let _ = match reports {
        [] => Ok(()),
        [(item, _)] => {
            writeln!(text, "{}: written, {:.2} % of the values clipped", display(&item.output), 100.0 * mean)
        }
        _ => {
            writeln!(text, "{} images written, {:.2} % of the values clipped", reports.len(), 100.0 * mean)
        }
    };
    let mut clipped: Vec<_> =
        reports.iter().filter(|(_, report)| report.outcome.clipping.share() > MUCH).collect();
    clipped.sort_by(|(_, a), (_, b)| b.outcome.clipping.share().total_cmp(&a.outcome.clipping.share()));
    let with_share = |(item, report): &&(Item, Report)| {
        format!("{} {:.0} %", name(item), 100.0 * report.outcome.clipping.share())
    };
    list(&mut text, named, "much clipped", clipped.iter().map(with_share));
    let supplied = reports.iter().filter_map(|(item, report)| Some((item, report.supplied?)));
    for (item, supplied) in supplied.clone().filter(|(_, supplied)| supplied.looks_turned_round()).take(named)
    {
        let _ = writeln!(text, "  WARNING: the depth map of {} {}", name(item), inverted(&supplied));
    }
    let thick = reports.iter().filter_map(|(item, report)| {
        let supplied = report.supplied?;
        let is_metric = matches!(supplied.kind, SuppliedKind::Metres | SuppliedKind::Millimetres);
        (is_metric && report.water.backscatter_coefficient[1] > THICKEST).then_some((item, supplied))
    });
    for (item, supplied) in thick.take(named) {
        let _ = writeln!(
            text,
            "  WARNING: by its depth map {} has thicker water than there is; are its values really {}?",
            name(item),
            supplied.kind.name()
        );
    }
    let holes = supplied.filter(|(_, supplied)| supplied.invalid > 0);
    let with_share = |(item, supplied): (&Item, SuppliedReport)| {
        format!("{} {:.1} %", name(item), 100.0 * supplied.invalid_share())
    };
    list(&mut text, named, "pixels without a valid depth, told from colour", holes.map(with_share));
    let vanished = reports.iter().filter(|(_, report)| report.outcome.has_vanished());
    let with_share = |(item, report): &(Item, Report)| {
        format!("{} {:.0} %", name(item), 100.0 * report.outcome.contrast_left.unwrap_or(1.0))
    };
    let about = "hidden by WATER, share of the contrast left (a smaller --metres-at-one lets through more, --model physical all)";
    list(&mut text, named, about, vanished.map(with_share));
    for verdict in [Verdict::Failed, Verdict::Doubtful] {
        let of_verdict = reports.iter().filter(|(_, report)| report.quality.verdict == verdict);
        let with_reasons =
            |(item, report): &(Item, Report)| format!("{} ({})", name(item), reasons(report.quality));
        let about = format!("{}, see `aquafuse inspect`", verdict.name());
        list(&mut text, named, &about, of_verdict.map(with_reasons));
    }
    let damaged = reports.iter().filter_map(|(item, report)| Some((item, report.damage.as_ref()?)));
    list(
        &mut text,
        named,
        "from damaged files, and marked as such",
        damaged.map(|(item, damage)| format!("{} ({damage})", name(item))),
    );
    let left_out = reports.iter().filter(|(_, report)| !report.left_out.is_empty());
    list(
        &mut text,
        named,
        "not carried over",
        left_out.map(|(item, report)| format!("{} ({})", name(item), report.left_out.join(", "))),
    );
    scores(&mut text, reports);
    let held = reports.iter().filter(|(_, report)| report.outcome.limited.any());
    list(
        &mut text,
        named,
        "held back",
        held.map(|(item, report)| format!("{} ({})", name(item), bounds(report.outcome.limited))),
    );
    text
}

/// A table of scores before and after: means over the images that have them.
fn scores(text: &mut String, reports: &[(Item, Report)]) {
    type Score = fn(&Scores) -> Option<f64>;
    const ALL: [(&str, Score); 6] = [
        ("UCIQE", |scores| Some(scores.uciqe)),
        ("UIQM", |scores| scores.uiqm),
        ("colour", |scores| Some(scores.colour)),
        ("contrast", |scores| Some(scores.contrast)),
        ("sharpness", |scores| scores.sharpness),
        ("lightness", |scores| Some(scores.lightness)),
    ];
    let all: Vec<[Scores; 2]> = reports.iter().filter_map(|(_, report)| report.scores).collect();
    if all.is_empty() {
        return;
    }
    let _ =
        writeln!(text, "  {:<10} {:>8} {:>8}", if all.len() == 1 { "" } else { "means" }, "before", "after");
    for (name, score) in ALL {
        let both: Vec<_> = all.iter().filter_map(|[b, a]| Some([score(b)?, score(a)?])).collect();
        let mean = |i: usize| both.iter().map(|pair| pair[i]).sum::<f64>() / both.len() as f64;
        if !both.is_empty() {
            let _ = writeln!(text, "  {name:<10} {:>8.3} {:>8.3}", mean(0), mean(1));
        }
    }
}

/// Which bounds acted, in words.
fn bounds(bounds: Limited) -> String {
    let Limited { fusion, restoration } = bounds;
    let said = [
        (fusion.glare, "the glare of WATER darkened"),
        (fusion.red || restoration.red, "no red cast"),
        (fusion.gain, "nothing strengthened"),
        (restoration.backscatter, "less veil taken off"),
        (restoration.gain, "nothing burnt"),
    ];
    said.into_iter().filter(|(acted, _)| *acted).map(|(_, said)| said).collect::<Vec<_>>().join(", ")
}

/// A line that names the first few of what it is about, and counts the rest.
fn list(text: &mut String, named: usize, about: &str, names: impl Iterator<Item = String>) {
    let names: Vec<String> = names.collect();
    let shown = names.iter().take(named).cloned().collect::<Vec<_>>().join(", ");
    let _ = match names.len().saturating_sub(named) {
        _ if names.is_empty() => Ok(()),
        0 => writeln!(text, "  {about}: {shown}"),
        more => writeln!(text, "  {about}: {shown} and {more} more"),
    };
}

/// The image itself, as it can be given to another command.
fn name(item: &Item) -> String {
    display(&item.input).to_string()
}
