//! The verdict with its reasons, and the numbers.

use crate::pipeline::Analysis;
use aquafuse::waterbody::{Reason, Verdict};
use plotters::prelude::RGBColor;

use super::charts::CHANNELS;
use super::panels::Panel;
use crate::drawing::DrawError;
use crate::drawing::canvas::{INK, font, write as write_lines};

const LEFT: i32 = 14;
/// Where the numbers of each channel begin.
const COLUMNS: [i32; 3] = [176, 252, 328];
const WIDTH: i32 = 388;
const LINE: i32 = 22;

pub(super) fn write(panel: &Panel<'_>, found: &Analysis, unit: &str) -> Result<(), DrawError> {
    let estimate = &found.estimate;
    let quality = estimate.quality;
    let colour = match quality.verdict {
        Verdict::Good => RGBColor(24, 120, 60),
        Verdict::Doubtful => RGBColor(176, 100, 0),
        Verdict::Failed => RGBColor(180, 30, 30),
    };
    let mut y = 10;
    line(panel, &format!("verdict: {}", quality.verdict.name()), y, (24, colour))?;
    y += LINE + 8;
    if quality.reasons.is_empty() {
        line(panel, "no reason to doubt these numbers", y, (15, INK))?;
        y += LINE;
    }
    for reason in quality.reasons.iter().map(Reason::describe) {
        line(panel, &format!("– {reason}"), y, (15, INK))?;
        y += LINE;
    }
    y += LINE / 2;
    for ((name, x), colour) in ["red", "green", "blue"].into_iter().zip(COLUMNS).zip(CHANNELS) {
        panel.area.draw_text(name, &font(16, colour), (x, y))?;
    }
    let per = if unit == "m" { "per m" } else { "per unit of z" };
    let water = &estimate.water;
    let z95 = found.depth.percentile(0.95);
    let of_growth = water.backscatter_coefficient;
    let rows: [(String, [String; 3]); 6] = [
        ("B∞".into(), water.veiling_light.rgb().map(|value| format!("{value:.3}"))),
        ("   90 % interval".into(), estimate.intervals.veiling_light.map(|range| between(range, 2))),
        (format!("β_B, {per}"), of_growth.map(|value| format!("{value:.2}"))),
        (
            "   90 % interval".into(),
            estimate.intervals.backscatter_coefficient.map(|range| between(range, 1)),
        ),
        ("β_B z at 95 %".into(), of_growth.map(|value| format!("{:.2}", value * z95))),
        ("β_D z at 95 %".into(), water.attenuation.map(|curve| format!("{:.2}", curve.optical_depth(z95)))),
    ];
    for (name, values) in rows {
        y += LINE;
        panel.area.draw_text(&name, &font(15, INK), (LEFT, y))?;
        for (value, x) in values.iter().zip(COLUMNS) {
            panel.area.draw_text(value, &font(15, INK), (x, y))?;
        }
    }
    Ok(())
}

fn line(panel: &Panel<'_>, text: &str, y: i32, (size, colour): (u32, RGBColor)) -> Result<(), DrawError> {
    write_lines(&panel.area, text, (LEFT, y), &font(size, colour), WIDTH, 1)
}

fn between([low, high]: [f32; 2], decimals: usize) -> String {
    format!("{low:.decimals$}–{high:.decimals$}")
}
