//! The summary of a run: one line of counts, what needs action, and details on request.

use std::collections::BTreeMap;
use std::fmt::Write;

use aquafuse::depth::{SuppliedKind, SuppliedReport};
use aquafuse::waterbody::Verdict;
use aquafuse_data::batch::{Item, Report};
use aquafuse_data::files::display;
use aquafuse_data::pipeline::Limited;
use aquafuse_data::pipeline::Scores;

use crate::args::depth::{inverted, inverted_by_network};
use crate::report::border;
use crate::report::water::{estimate_counts, reasons, verdict};

/// More clipping than this share of the values is listed.
const MUCH: f64 = 0.05;
/// More red made from green than this is listed.
const MUCH_RED: f32 = 0.05;
/// No water's backscatter grows faster than this in green, per metre: the thickest of Jerlov's has a third of it.
const THICKEST: f32 = 20.0;
/// Where the reasons of a verdict are explained.
const EXPLAINED: &str = "  `aquafuse inspect --help` says what these reasons mean and what helps";
/// Images that a warning names; with `--verbose` it names all.
const NAMED: usize = 5;

/// The detail that a list gives for an image; `None` if the image does not belong to the list.
type Detail = fn(&Report) -> Option<String>;

/// A sentence that calls for an action of the user, and its figure for this image; `None` if there is no need.
type Warning = fn(&Report) -> Option<(String, Option<String>)>;

/// Always printed.
const WARNINGS: [Warning; 5] = [
    |report| {
        let about = "the water is nearly black, as at night: less of it was exchanged, or none";
        report.outcome.limited.fusion.night.then(|| (about.into(), None))
    },
    |report| Some(("damaged file; the output is marked as such".into(), Some(report.damage.clone()?))),
    |report| {
        let supplied = report.supplied.filter(SuppliedReport::looks_inverted)?;
        let said = match report.network {
            true => inverted_by_network(supplied.kind),
            false => format!("the depth map {}", inverted(&supplied)),
        };
        Some((said, None))
    },
    |report| {
        let kind = report.supplied?.kind;
        let is_metric = matches!(kind, SuppliedKind::Metres | SuppliedKind::Millimetres);
        let is_too_thick =
            is_metric && report.water.is_some_and(|water| water.backscatter_coefficient[1] > THICKEST);
        let name = kind.name();
        is_too_thick.then(|| {
            (
                format!("by its depth map the water is thicker than any; check that the values are {name}"),
                None,
            )
        })
    },
    |report| {
        let left = format!("{:.0} % of the contrast left", 100.0 * report.outcome.contrast_left);
        let about = "WATER hides the scene; say how far one sees in it with --visibility METRES, or take --model physical";
        report.outcome.has_vanished().then(|| (about.into(), Some(left)))
    },
];

/// Lists that explain the counts: printed with `--verbose`.
const DETAILS: [(&str, Detail); 8] = [
    ("red made from green in part", |report| {
        let share = report.outcome.levels.map_or(0.0, |levels| levels.red_from_green);
        (share > MUCH_RED).then(|| format!("{:.0} % of green where there is no red", 100.0 * share))
    }),
    ("estimate failed", |report| of_verdict(report, Verdict::Failed)),
    ("estimate doubtful", |report| of_verdict(report, Verdict::Doubtful)),
    ("much clipped", |report| {
        let share = report.outcome.clipping.share();
        (share > MUCH).then(|| format!("{:.0} % of the values", 100.0 * share))
    }),
    ("pixels without a valid depth, filled from others and from colour", |report| {
        let supplied = report.supplied.filter(|supplied| supplied.invalid > 0)?;
        Some(format!("{:.1} %", 100.0 * supplied.invalid_share()))
    }),
    ("border left as it is", |report| report.area.as_ref().map(border::words)),
    ("not copied to the output", |report| (!report.left_out.is_empty()).then(|| report.left_out.join(", "))),
    ("limited by safety bounds", |report| {
        report.outcome.limited.any().then(|| bounds(report.outcome.limited))
    }),
];

/// The summary of the images of this run, and of the `skipped` images of an earlier one.
pub(super) fn of(reports: &[(Item, Report)], skipped: usize, verbose: bool) -> String {
    let mut text = String::new();
    if skipped > 0 {
        let _ = writeln!(text, "{} skipped: an earlier run wrote them", images(skipped));
    }
    written(&mut text, reports, verbose);
    for warning in WARNINGS {
        warn(&mut text, warning, reports, verbose);
    }
    scores(&mut text, reports);
    if verbose {
        for (about, detail) in DETAILS {
            // The line on a single image has its verdict.
            if reports.len() > 1 || !about.starts_with("estimate") {
                list(&mut text, about, &entries(reports, detail), reports.len());
            }
        }
    }
    text
}

/// One line: what was written, the verdicts, the clipping.
fn written(text: &mut String, reports: &[(Item, Report)], verbose: bool) {
    let clipped = reports.iter().map(|(_, report)| report.outcome.clipping.share()).sum::<f64>();
    let clipped = format!("{:.2} % of the values clipped", 100.0 * clipped / reports.len() as f64);
    let _ = match reports {
        [] => Ok(()),
        [(item, report)] => {
            let output = display(&item.output);
            let estimate = report.quality.map(|quality| format!("estimate {}; ", verdict(quality)));
            writeln!(text, "{output}: written; {}{clipped}", estimate.unwrap_or_default())
        }
        _ => {
            let verdicts = reports.iter().filter_map(|(_, report)| Some(report.quality?.verdict));
            let all_good = verdicts.clone().all(|verdict| verdict == Verdict::Good);
            let more = if all_good || verbose { "" } else { "; -v names the images" };
            let count = images(reports.len());
            let estimates = match verdicts.clone().next() {
                Some(_) => format!("{}; ", estimate_counts(&verdicts)),
                None => String::new(),
            };
            writeln!(text, "{count} written; {estimates}{clipped}{more}")
        }
    };
    let has_reasons =
        |(_, report): &(Item, Report)| report.quality.is_some_and(|of| of.verdict != Verdict::Good);
    if (reports.len() == 1 || verbose) && reports.iter().any(has_reasons) {
        let _ = writeln!(text, "{EXPLAINED}");
    }
}

fn images(count: usize) -> String {
    if count == 1 { "1 image".into() } else { format!("{count} images") }
}

fn of_verdict(report: &Report, wanted: Verdict) -> Option<String> {
    report.quality.filter(|quality| quality.verdict == wanted).map(reasons)
}

/// The images of a list, as they can be given to another command, each with its detail.
fn entries(reports: &[(Item, Report)], detail: Detail) -> Vec<(String, String)> {
    let entry = |(item, report): &(Item, Report)| Some((display(&item.input).to_string(), detail(report)?));
    reports.iter().filter_map(entry).collect()
}

/// A line for each sentence, with the first few images that it holds for, or `all`.
fn warn(text: &mut String, warning: Warning, reports: &[(Item, Report)], verbose: bool) {
    let mut by_sentence: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (item, report) in reports {
        if let Some((sentence, figure)) = warning(report) {
            let figure = figure.map(|figure| format!(" ({figure})")).unwrap_or_default();
            by_sentence.entry(sentence).or_default().push(format!("{}{figure}", display(&item.input)));
        }
    }
    let most = if verbose { usize::MAX } else { NAMED };
    for (sentence, names) in by_sentence {
        let named = match names.len() {
            count if count == reports.len() && count > 1 => format!("all {count} images"),
            count if count > most => format!("{} and {} more", names[..most].join(", "), count - most),
            _ => names.join(", "),
        };
        let _ = writeln!(text, "  WARNING: {named}: {sentence}");
    }
}

/// A heading, and a line for each image; only one line if the heading holds for every image of a folder.
fn list(text: &mut String, about: &str, entries: &[(String, String)], all: usize) {
    let count = entries.len();
    if count == 0 {
        return;
    }
    if count == all && count > 1 {
        let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
        entries.iter().for_each(|(_, detail)| *kinds.entry(detail).or_default() += 1);
        let kinds: Vec<String> = match kinds.len() {
            1 => kinds.into_keys().map(str::to_owned).collect(),
            2..=NAMED => kinds.into_iter().map(|(detail, count)| format!("{count}x {detail}")).collect(),
            _ => Vec::new(),
        };
        let kinds = if kinds.is_empty() { String::new() } else { format!(" ({})", kinds.join("; ")) };
        let _ = writeln!(text, "  all {count} images: {about}{kinds}");
        return;
    }
    let _ = writeln!(text, "  {about}:");
    for (name, detail) in entries {
        let _ = writeln!(text, "    {name}: {detail}");
    }
}

/// A table of scores before and after: means over the images that have scores.
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
pub(crate) fn bounds(bounds: Limited) -> String {
    let Limited { fusion, restoration } = bounds;
    let all = [
        (fusion.glare, "glare of WATER darkened"),
        (fusion.red || restoration.red, "red limited"),
        (fusion.gain, "amplification limited"),
        (fusion.night, "water too dark to exchange"),
        (restoration.backscatter, "less backscatter subtracted"),
        (restoration.gain, "gain limited to avoid clipping"),
    ];
    all.into_iter().filter(|(acted, _)| *acted).map(|(_, words)| words).collect::<Vec<_>>().join(", ")
}
