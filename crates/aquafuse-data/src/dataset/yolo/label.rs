//! A line of a label, and what is wrong with it.

/// As far as this beyond the image's edge, in shares of its side, a box is rounded rather than wrong.
const ROUNDED: f64 = 2e-3;
/// As far as this beyond the edge too, in pixels, as in COCO and Pascal VOC.
const SLACK: f64 = 1.0;

/// Gives the width and height of the image in pixels, if they can be read.
pub(super) type SizeOf<'a> = &'a dyn Fn() -> Option<(u64, u64)>;

/// What is wrong with a line, if there are so many classes.
pub(super) fn check(line: &str, classes: Option<usize>, size: SizeOf<'_>) -> Result<(), String> {
    let mut numbers = line.split_ascii_whitespace();
    let Some(class) = numbers.next() else { return Ok(()) };
    match (class.parse::<f64>(), classes) {
        (Ok(number), _) if number.fract() != 0.0 || number < 0.0 => return Err(no_class(class)),
        (Ok(number), Some(classes)) if number >= classes as f64 => {
            return Err(format!(
                "the class is {class}, but the highest of {classes} is {}",
                classes.saturating_sub(1)
            ));
        }
        (Ok(_), _) => {}
        (Err(_), _) => return Err(no_class(class)),
    }
    let values: Vec<f64> = numbers
        .map(|text| text.parse().map_err(|_| format!("{:?} is not a number", short(text))))
        .collect::<Result<_, _>>()?;
    match values.as_slice() {
        // A box, with key points or a confidence behind it or not.
        [x, y, w, h, rest @ ..] if rest.len() != 2 && (rest.len() < 4 || is_pose(rest)) => {
            inside_image("across", [x - w / 2.0, x + w / 2.0], &|| size().map(|(width, _)| width))?;
            inside_image("down", [y - h / 2.0, y + h / 2.0], &|| size().map(|(_, height)| height))
        }
        outline if outline.len() >= 6 && outline.len().is_multiple_of(2) => {
            for corner in outline.chunks(2) {
                let sides = [|(width, _)| width, |(_, height): (u64, u64)| height];
                for (value, side) in corner.iter().zip(sides) {
                    if !is_within([*value; 2], &|| size().map(side)) {
                        return Err(format!("a corner is at {value}, outside the image"));
                    }
                }
            }
            Ok(())
        }
        other => Err(format!("it has {} numbers after the class instead of 4", other.len())),
    }
}

fn no_class(said: &str) -> String {
    format!("the class is {:?}, but must be a whole number, 0 or more", short(said))
}

/// Whether these are key points: in threes the last of which says whether the point is seen.
fn is_pose(rest: &[f64]) -> bool {
    let seen = |point: &[f64]| point.last().is_some_and(|seen| [0.0, 1.0, 2.0].contains(seen));
    rest.len().is_multiple_of(3) && rest.chunks(3).all(seen)
}

/// Refuses a side that reaches beyond the image.
fn inside_image(way: &str, ends: [f64; 2], pixels: &dyn Fn() -> Option<u64>) -> Result<(), String> {
    match is_within(ends, pixels) {
        true => Ok(()),
        false => {
            let [from, to] = ends;
            Err(format!("the box reaches from {from:.4} to {to:.4} {way}, outside the image"))
        }
    }
}

/// Whether a side lies within the image, but for rounding; its length in pixels is asked for where it matters.
fn is_within([from, to]: [f64; 2], pixels: &dyn Fn() -> Option<u64>) -> bool {
    // A number that is none compares with nothing.
    let within = |slack: f64| from <= to && from >= -slack && to <= 1.0 + slack;
    within(ROUNDED) || pixels().is_some_and(|pixels| pixels > 0 && within(SLACK / pixels as f64))
}

/// A foreign string, shortened for a message.
fn short(text: &str) -> String {
    text.chars().take(20).collect()
}

/// Reads a label for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(super) fn try_parse(text: &str) {
    for line in text.lines() {
        let _ = check(line, Some(3), &|| Some((64, 48)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_outlines_and_poses_are_lines() {
        for line in [
            "",
            "0 0.5 0.5 1 1",
            "3 0.1 0.1 0.2 0.2 0.87",
            "3.0 0.1 0.1 0.2 0.2",
            "0 0.1 0.1 0.9 0.1 0.5 0.9",
            "0 0.5 0.5 0.2 0.2 0.5 0.5 2 0.1 0.1 0",
        ] {
            assert_eq!(check(line, Some(4), &|| None), Ok(()), "{line}");
        }
        for (line, said) in [
            ("fish 0.5 0.5 1 1", "class"),
            ("1.5 0.5 0.5 1 1", "class"),
            ("-1 0.5 0.5 1 1", "class"),
            ("4 0.5 0.5 1 1", "the highest of 4 is 3"),
            ("0 0.5 0.5 1", "3 numbers"),
            ("0 0.5 x 1 1", "not a number"),
            ("0 0.9 0.5 0.4 0.2", "outside the image"),
            ("0 0.5 0.5 nan 0.2", "outside the image"),
            ("0 0.5 0.5 -0.1 0.2", "outside the image"),
            ("0 0.1 0.1 1.9 0.1 0.5 0.9", "corner"),
        ] {
            assert!(check(line, Some(4), &|| None).unwrap_err().contains(said), "{line}");
        }
    }

    #[test]
    fn a_pixel_of_overhang_is_rounding() {
        let size = || Some((100, 50));
        assert_eq!(check("0 0.9 0.5 0.2199 0.5", None, &size), Ok(()));
        assert_eq!(check("0 0.5 0.9 0.2 0.239", None, &size), Ok(()));
        assert!(check("0 0.9 0.5 0.223 0.5", None, &size).is_err());
        assert_eq!(check("0 0.1 0.1 1.005 0.1 0.5 1.015", None, &size), Ok(()));
        assert!(check("0 0.1 0.1 1.015 0.1 0.5 0.9", None, &size).is_err());
    }
}
