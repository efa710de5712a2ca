//! Means with their intervals, a row each, as an SVG.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{Circle, Color, FontStyle, PathElement, RGBColor, ShapeStyle, TextStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::DrawError;
use super::canvas::{INK, font, svg};

const WIDTH: i32 = 560;
/// Where the scale begins; labels stand to the left of it.
const LEFT: i32 = 276;
const RIGHT: i32 = 16;
const TOP: i32 = 30;
const ROW: i32 = 20;
const FOOT: i32 = 26;
/// Letters of a label that fit beside the scale.
const LETTERS: usize = 44;
/// The most marks of a scale.
const MARKS: usize = 6;
/// Marks and their lines; the style of the page names this colour to change it on dark paper.
const FAINT: RGBColor = RGBColor(217, 220, 218);
/// Colours that are seen as different on light and dark paper, and by those who see no red or green (Okabe and Ito).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(184, 134, 11),
    RGBColor(86, 180, 233),
];

/// A mean with its interval.
pub(crate) struct Mean {
    /// What it is the mean of.
    pub(crate) label: String,
    /// Means of one group have one colour.
    pub(crate) group: usize,
    pub(crate) mean: f64,
    /// The ends of the interval; both the mean where there is none.
    pub(crate) interval: [f64; 2],
}

/// Draws means on one scale; all of them are finite.
pub(crate) fn means(title: &str, means: &[Mean]) -> Result<String, DrawError> {
    let least = means.iter().map(|of| of.interval[0]).fold(f64::INFINITY, f64::min);
    let most = means.iter().map(|of| of.interval[1]).fold(f64::NEG_INFINITY, f64::max);
    let scale = scale_over(least, most);
    let x = |value: f64| scale.map(&value, (LEFT, WIDTH - RIGHT));
    let marks = scale.key_points(MARKS);
    let digits = digits(&marks);
    let bottom = TOP + ROW * means.len() as i32;
    let anchored = |size: u32, h: HPos, v: VPos| font(size, INK).pos(Pos::new(h, v));
    svg((WIDTH as u32, (bottom + FOOT) as u32), |area| {
        let bold: TextStyle<'_> =
            TextStyle { font: font(15, INK).font.style(FontStyle::Bold), ..font(15, INK) };
        area.draw_text(title, &bold, (LEFT, 6))?;
        for mark in marks {
            area.draw(&PathElement::new([(x(mark), TOP), (x(mark), bottom)], FAINT))?;
            let number = format!("{mark:.digits$}");
            area.draw_text(&number, &anchored(15, HPos::Center, VPos::Top), (x(mark), bottom + 6))?;
        }
        for (of, y) in means.iter().zip((TOP + ROW / 2..).step_by(ROW as usize)) {
            let beside = anchored(15, HPos::Right, VPos::Center);
            area.draw_text(&shortened(&of.label), &beside, (LEFT - 10, y))?;
            let colour = COLOURS[of.group % COLOURS.len()];
            let ends = of.interval.map(|end| (x(end), y));
            area.draw(&PathElement::new(ends, ShapeStyle::from(&colour).stroke_width(3)))?;
            area.draw(&Circle::new((x(of.mean), y), 4, colour.filled()))?;
        }
        Ok(())
    })
}

/// A scale on which everything lies, a little from its ends.
fn scale_over(least: f64, most: f64) -> RangedCoordf64 {
    // What hardly differs is drawn as one place, not as its rounding.
    let spread = (most - least).max(1e-5 * most.abs()).max(1e-5);
    (least - 0.06 * spread..most + 0.06 * spread).into()
}

/// The fewest digits behind the point that show each mark as what it is.
fn digits(marks: &[f64]) -> usize {
    let step = marks.windows(2).map(|two| two[1] - two[0]).fold(f64::INFINITY, f64::min);
    let shown = |mark: f64, digits: usize| format!("{mark:.digits$}").parse().unwrap_or(mark);
    let exact = |digits: &usize| marks.iter().all(|mark| (shown(*mark, *digits) - mark).abs() < 0.01 * step);
    (0..9).find(exact).unwrap_or(9)
}

/// The label, without its middle where it is too long.
fn shortened(label: &str) -> String {
    let letters: Vec<char> = label.chars().collect();
    if letters.len() <= LETTERS {
        return label.to_owned();
    }
    let (start, end) = (&letters[..LETTERS / 2], &letters[letters.len() - LETTERS / 2..]);
    start.iter().chain(['…'].iter()).chain(end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_and_lie_on_the_scale() {
        for (least, most) in [(0.901, 0.958), (-3.0, 170.0), (27.0, 27.0), (0.0, 0.0), (1e-4, 3e-4)] {
            let scale = scale_over(least, most);
            let marks = scale.key_points(MARKS);
            assert!((2..=MARKS).contains(&marks.len()), "{least} to {most}: {marks:?}");
            let digits = digits(&marks);
            let step = marks[1] - marks[0];
            for mark in marks {
                assert!((LEFT..=WIDTH - RIGHT).contains(&scale.map(&mark, (LEFT, WIDTH - RIGHT))));
                let shown: f64 = format!("{mark:.digits$}").parse().unwrap();
                assert!((shown - mark).abs() < 0.01 * step, "{mark} is shown as {shown}");
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

    #[test]
    fn labels_and_numbers_stay_text() {
        let mean = |label: &str, mean: f64| Mean {
            label: label.into(),
            group: 0,
            mean,
            interval: [mean - 0.01, mean + 0.01],
        };
        let drawn = means("SSIM, β", &[mean("a < b", 0.92), mean("plain", 0.94)]).unwrap();
        for text in ["SSIM, β", "a &lt; b", "plain", "0.92"] {
            assert!(drawn.contains(&format!(">\n{text}\n</text>")), "{text} in {drawn}");
        }
        assert!(drawn.starts_with("<svg width") && !drawn.contains("http"), "{drawn}");
    }
}
