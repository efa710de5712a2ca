//! Whether supplied depth agrees with the image it is to belong to.

use crate::image::TopEdge;
use crate::rank::{ranks, spearman};

/// Places looked at, about: as many give a rank correlation to .01, and sorting them takes milliseconds.
const PLACES: usize = 20_000;
/// Weight of the row against colour: on real pairs it is the steadier of the two (colour fails where red is dead).
const ROW: f64 = 2.0;

/// Rank correlation of valid distances with rank of colour depth + 2 x rank of height in the image as seen.
pub(super) fn with_image(
    distances: &[f32],
    valid: &[bool],
    levels: &[u8],
    (width, height): (usize, usize),
    top: TopEdge,
) -> Option<f64> {
    let step = ((width * height) as f64 / PLACES as f64).sqrt().ceil().max(1.0) as usize;
    let (mut supplied, mut colour, mut up) = (Vec::new(), Vec::new(), Vec::new());
    for y in (0..height).step_by(step) {
        for x in (0..width).step_by(step) {
            let i = y * width + x;
            if valid[i] {
                supplied.push(distances[i]);
                colour.push(f32::from(levels[i]));
                up.push(match top {
                    TopEdge::First => (height - y) as f32,
                    TopEdge::Last => y as f32,
                    TopEdge::Left => (width - x) as f32,
                    TopEdge::Right => x as f32,
                });
            }
        }
    }
    let expected: Vec<f32> =
        ranks(&colour).iter().zip(ranks(&up)).map(|(colour, up)| (colour + ROW * up) as f32).collect();
    spearman(&supplied, &expected)
}
