//! Means and intervals as a drawing (SVG): a line a row.

use std::fmt::Write;

use super::escaped;
use crate::evaluate::Summary;
use crate::evaluate::report::{Cell, Score, Table};

const WIDTH: f64 = 560.0;
/// Where the scale begins; labels stand to the left of it.
const LEFT: f64 = 276.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 30.0;
const ROW: f64 = 20.0;
const FOOT: f64 = 26.0;
/// Letters of a label that fit beside the scale.
const LETTERS: usize = 44;
/// Colours that are told apart on light and dark paper, and by those who see no red or green (Okabe and Ito).
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9"];

/// Draws one score of a table; none where fewer than two rows have it, or none an interval.
pub(super) fn means(table: &Table, place: usize, score: &Score) -> Option<String> {
    let mut methods: Vec<&str> = Vec::new();
    let (mut points, mut any_interval) = (Vec::new(), false);
    for row in &table.rows {
        let Cell::Summary(Summary { mean, interval, .. }) = row.cells.get(place)? else { continue };
        any_interval |= interval.is_some();
        let [low, high] = interval.unwrap_or([*mean; 2]);
        let method = row.labels.first().map(String::as_str).unwrap_or_default();
        if !methods.contains(&method) {
            methods.push(method);
        }
        let colour = methods.iter().position(|other| *other == method).unwrap_or(0);
        points.push((row.labels.join(", ").replace('`', ""), colour, *mean, low, high));
    }
    if points.len() < 2 || !any_interval {
        return None;
    }
    let least = points.iter().map(|(.., low, _)| *low).fold(f64::INFINITY, f64::min);
    let most = points.iter().map(|(.., high)| *high).fold(f64::NEG_INFINITY, f64::max);
    let scale = Scale::over(least, most);
    let height = points.iter().fold(TOP + FOOT, |height, _| height + ROW);
    let mut svg = format!(
        "<figure><svg width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">\n\
         <text class=\"title\" x=\"{LEFT}\" y=\"16\">{}</text>\n",
        escaped(score.title)
    );
    let bottom = height - FOOT;
    for tick in scale.ticks() {
        let x = scale.x(tick);
        let digits = scale.digits();
        let _ = writeln!(
            svg,
            "<line x1=\"{x:.1}\" y1=\"{TOP}\" x2=\"{x:.1}\" y2=\"{bottom}\" stroke=\"var(--faint)\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{tick:.digits$}</text>",
            bottom + 16.0
        );
    }
    let mut y = TOP - 0.5 * ROW;
    for (label, colour, mean, low, high) in &points {
        y += ROW;
        let paint = COLOURS.iter().cycle().nth(*colour).copied().unwrap_or_default();
        let (x, from, to) = (scale.x(*mean), scale.x(*low), scale.x(*high));
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\
             <line x1=\"{from:.1}\" y1=\"{y:.1}\" x2=\"{to:.1}\" y2=\"{y:.1}\" stroke=\"{paint}\" stroke-width=\"3\"/>\
             <circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\" fill=\"{paint}\"/>",
            LEFT - 10.0,
            y + 4.0,
            escaped(&shortened(label))
        );
    }
    Some(svg + "</svg></figure>\n")
}

/// The label, without its middle where it is too long.
fn shortened(label: &str) -> String {
    let letters: Vec<char> = label.chars().collect();
    let kept = LETTERS / 2;
    match letters.get(..kept).zip(letters.get(letters.len().saturating_sub(kept)..)) {
        Some((start, end)) if letters.len() > LETTERS => {
            start.iter().chain(['…'].iter()).chain(end).collect()
        }
        _ => label.to_owned(),
    }
}

/// Numbers as places on a line, with round numbers to mark it by.
struct Scale {
    from: f64,
    to: f64,
    step: f64,
}

impl Scale {
    fn over(least: f64, most: f64) -> Self {
        // What hardly differs is drawn as one place, not as its rounding.
        let spread = (most - least).max(1e-5 * most.abs()).max(1e-5);
        let (from, to) = (least - 0.06 * spread, most + 0.06 * spread);
        // Three to six marks: 1, 2 or 5 times a power of ten.
        let rough = (to - from) / 6.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0].map(|times| times * power).into_iter().find(|step| *step >= rough);
        Self { from, to, step: step.unwrap_or(10.0 * power) }
    }

    fn x(&self, value: f64) -> f64 {
        LEFT + (WIDTH - LEFT - RIGHT) * (value - self.from) / (self.to - self.from)
    }

    fn ticks(&self) -> impl Iterator<Item = f64> + '_ {
        let first = (self.from / self.step).ceil();
        (0..20).map(move |i: i32| (first + f64::from(i)) * self.step).take_while(|tick| *tick <= self.to)
    }

    /// Digits that tell two marks apart.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 9")]
    fn digits(&self) -> usize {
        (-self.step.log10().floor()).clamp(0.0, 9.0) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_and_lie_on_the_scale() {
        for (least, most) in [(0.901, 0.958), (-3.0, 170.0), (27.0, 27.0), (0.0, 0.0), (1e-4, 3e-4)] {
            let scale = Scale::over(least, most);
            let ticks: Vec<f64> = scale.ticks().collect();
            assert!((2..=7).contains(&ticks.len()), "{least} to {most}: {ticks:?}");
            for tick in ticks {
                assert!((LEFT..=WIDTH - RIGHT).contains(&scale.x(tick)));
                let shown: f64 = format!("{tick:.*}", scale.digits()).parse().unwrap();
                assert!((shown - tick).abs() < 0.01 * scale.step, "{tick} is shown as {shown}");
            }
        }
    }

    #[test]
    fn long_labels_lose_their_middle() {
        assert_eq!(shortened("aquafuse, all"), "aquafuse, all");
        let long = "a very long name of a method, in short, and an even longer group";
        assert_eq!(shortened(long).chars().count(), LETTERS + 1);
        assert!(shortened(long).starts_with("a very") && shortened(long).ends_with("group"));
    }
}
