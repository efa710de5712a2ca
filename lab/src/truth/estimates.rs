//! How right B∞ and β_B are, and whether intervals and verdicts keep their word.

use std::fmt::Write;

use anyhow::Result;
use aquafuse::depth::DepthModel;
use aquafuse::image::{Encoded, ImageError};
use aquafuse::truth::{Case, Trials};
use aquafuse::waterbody::{Estimate, Reason, Verdict, estimate};

const SCENES: usize = 500;
/// A channel whose veil is fainter hides its β_B: 25 % of it moves no pixel by 1.2 steps of a byte.
const VISIBLE: f32 = 0.05;
const WRONG: f32 = 0.25;

struct Found {
    open: bool,
    clean: bool,
    verdict: Verdict,
    reasons: Vec<Reason>,
    /// Per channel: error, whether the interval holds the truth, its width.
    veil: Vec<(f32, bool, f32)>,
    /// The same of β_B, relative, in channels whose veil can be seen.
    growth: Vec<(f32, bool, f32)>,
    wrong: bool,
}

/// The tables.
pub(super) fn table() -> Result<String> {
    let mut table = String::from(
        "| z | scenes | median \\|ΔB∞\\| | 95 % | interval holds B∞ | its width | median error of β_B | 95 % | \
         interval holds β_B | its width |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let trials = Trials::default();
    let given = found(&trials, None)?;
    table += &row("given", "open water seen", &given, |one| one.open);
    table += &row("given", "none in view", &given, |one| !one.open);
    table += &row("given", "all", &given, |_| true);
    for (name, model) in [("`eq3`", DepthModel::default()), ("`ratio`", DepthModel::Ratio)] {
        let by_colour = found(&trials, Some(model))?;
        table += &row(name, "open water seen", &by_colour, |one| one.open);
        table += &row(name, "none in view", &by_colour, |one| !one.open);
    }
    Ok(table + &verdicts(&given)?)
}

fn found(trials: &Trials, model: Option<DepthModel>) -> Result<Vec<Found>, ImageError> {
    (0..SCENES)
        .map(|number| {
            let case = trials.case::<Encoded>(number);
            let z = model.map_or_else(|| case.depth.clone(), |model| model.estimate(&case.image));
            Ok(judge(&case, &estimate(&case.image, &z, &Default::default())?, model.is_none()))
        })
        .collect()
}

fn judge(case: &Case<Encoded>, found: &Estimate, with_growth: bool) -> Found {
    let (truth, ours) = (case.water.veiling_light.rgb(), found.water.veiling_light.rgb());
    let within = |[low, high]: [f32; 2], truth: f32| (low..=high).contains(&truth);
    let veil: Vec<_> = (0..3)
        .map(|c| {
            let interval = found.intervals.veiling_light[c];
            ((ours[c] - truth[c]).abs(), within(interval, truth[c]), interval[1] - interval[0])
        })
        .collect();
    let growth: Vec<_> = (0..3)
        .filter(|&c| with_growth && truth[c] >= VISIBLE)
        .map(|c| {
            let (own, truth) =
                (found.water.backscatter_coefficient[c], case.water.backscatter_coefficient[c]);
            let interval = found.intervals.backscatter_coefficient[c];
            ((own / truth - 1.0).abs(), within(interval, truth), (interval[1] - interval[0]) / own)
        })
        .collect();
    let veil_wrong = (0..3).any(|c| veil[c].0 > WRONG * truth[c].max(VISIBLE));
    Found {
        open: case.open,
        clean: case.clean,
        verdict: found.quality.verdict,
        reasons: found.quality.reasons.iter().collect(),
        wrong: veil_wrong || growth.iter().any(|&(error, ..)| error > WRONG),
        veil,
        growth,
    }
}

fn row(z: &str, scenes: &str, found: &[Found], keep: impl Fn(&Found) -> bool) -> String {
    let kept: Vec<&Found> = found.iter().filter(|one| keep(one)).collect();
    let worst =
        kept.iter().map(|one| one.veil.iter().map(|&(error, ..)| error).fold(0.0, f32::max)).collect();
    let worst: Vec<f32> = worst;
    let veil: Vec<_> = kept.iter().flat_map(|one| &one.veil).copied().collect();
    let growth: Vec<_> = kept.iter().flat_map(|one| &one.growth).copied().collect();
    let widths = |of: &[(f32, bool, f32)]| median(&of.iter().map(|&(.., width)| width).collect::<Vec<_>>());
    let held = |of: &[(f32, bool, f32)]| percent(share(of, |&(_, holds, _)| holds));
    let errors: Vec<f32> = growth.iter().map(|&(error, ..)| error).collect();
    let of_growth = if growth.is_empty() {
        "| | | | |".to_owned()
    } else {
        format!(
            "| {:.3} | {:.3} | {} | {:.2} |",
            median(&errors),
            quantile(&errors, 0.95),
            held(&growth),
            widths(&growth)
        )
    };
    format!(
        "| {z} | {} {scenes} | {:.3} | {:.3} | {} | {:.3} {of_growth}\n",
        kept.len(),
        median(&worst),
        quantile(&worst, 0.95),
        held(&veil),
        widths(&veil),
    )
}

fn verdicts(given: &[Found]) -> Result<String> {
    let mut text = String::new();
    let count = |keep: &dyn Fn(&&Found) -> bool| given.iter().filter(|one| keep(one)).count();
    writeln!(text, "\n| verdict with z given | scenes | with anything more than 25 % wrong |")?;
    writeln!(text, "|---|---|---|")?;
    for verdict in [Verdict::Good, Verdict::Doubtful, Verdict::Failed] {
        writeln!(
            text,
            "| `{}` | {} | {} |",
            verdict.name(),
            count(&|one| one.verdict == verdict),
            count(&|one| one.verdict == verdict && one.wrong)
        )?;
    }
    let clean = count(&|one| one.clean);
    let good = count(&|one| one.clean && one.verdict == Verdict::Good);
    writeln!(
        text,
        "\nOf {clean} scenes with none of the named causes {good} are `good` ({}).",
        percent(good as f64 / clean as f64)
    )?;
    writeln!(text, "\n| reason | scenes | of them clean |")?;
    writeln!(text, "|---|---|---|")?;
    for reason in Reason::ALL {
        let holding = |one: &&Found| one.reasons.contains(reason);
        writeln!(
            text,
            "| {} | {} | {} |",
            reason.describe(),
            count(&holding),
            count(&|one| one.clean && holding(one))
        )?;
    }
    Ok(text)
}

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

fn median(values: &[f32]) -> f32 {
    quantile(values, 0.5)
}

fn quantile(values: &[f32], share: f64) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

fn share<T>(values: &[T], keep: impl Fn(&T) -> bool) -> f64 {
    values.iter().filter(|value| keep(value)).count() as f64 / values.len() as f64
}
