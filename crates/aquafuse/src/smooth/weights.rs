//! What neighbours count in the bilateral filter, and which they are.

/// Reach of the window, a circle of diameter d = 5.
pub(super) const RADIUS: usize = 2;
/// σ of the difference of two colours: the sum over the channels, in steps of a byte. OpenCV's examples have the same
/// number of pixels for σ of their distance, which over a window this small is no difference: 4 weights in 10,000.
const SIGMA: u64 = 75;
/// `e^(-x)` is taken as `(1 - y + y²/2)^(2^5)` with y = x / 2^5: off by 1 in 1,000 at most, and made of products alone,
/// which vectors have. Without the square, 1 in 400, values of noise came out two steps of a byte off.
const SQUARINGS: u32 = 5;
/// What a quarter of Δ² is multiplied by, in steps of 2^-16, to be y in such steps: `2^32 · 4 / (2^5 · 2 σ²)`, rounded.
const GROWTH: u16 =
    (((1 << 34) + ((SIGMA * SIGMA) << SQUARINGS)) / ((2 * SIGMA * SIGMA) << SQUARINGS)) as u16;
/// The weight of a pixel itself, and of any of its colour: somewhat less than 2^11, for each product is cut off.
///
/// Coarser weights would move results by a step of a byte; with finer ones, the sums of 13 pixels would outgrow the 24
/// bits that a division of floats has.
pub(super) const ONE: u16 = weight(0);

/// The half of the window that is read forwards; the other half is its mirror image, with the same weights.
pub(super) const AHEAD: [(isize, usize); 6] = [(1, 0), (2, 0), (-1, 1), (0, 1), (1, 1), (0, 2)];

/// What a neighbour counts whose colour differs so much.
///
/// In whole numbers, whose sums are the same in any order, on any machine.
#[inline(always)]
pub(super) const fn weight(difference: u16) -> u16 {
    // From 512 on nothing is left; a quarter of a square of nine bits is one of 16.
    let difference = if difference < 511 { difference } else { 511 };
    let quarter = high(difference << 7, difference << 7);
    let y = high(quarter, GROWTH);
    let mut power = u16::MAX - y + (high(y, y) >> 1);
    let mut squarings = 0;
    while squarings < SQUARINGS {
        power = high(power, power);
        squarings += 1;
    }
    power >> 5
}

/// The upper half of a product.
#[inline(always)]
const fn high(a: u16, b: u16) -> u16 {
    ((a as u32 * b as u32) >> 16) as u16
}

/// A place beyond the border, mirrored about the outermost pixels: -1 is 1, `length` is `length - 2`.
pub(super) fn mirrored(place: isize, length: usize) -> usize {
    let last = length as isize - 1;
    let mut place = place;
    // In a picture smaller than the window the mirror is met more than once.
    while !(0..=last).contains(&place) {
        place = if last == 0 {
            0
        } else if place < 0 {
            -place
        } else {
            2 * last - place
        };
    }
    place as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_border_is_a_mirror_whatever_the_size() {
        let places = |length: usize| (-2..length as isize + 2).map(move |place| mirrored(place, length));
        assert_eq!(places(4).collect::<Vec<_>>(), [2, 1, 0, 1, 2, 3, 2, 1]);
        assert_eq!(places(2).collect::<Vec<_>>(), [0, 1, 0, 1, 0, 1]);
        assert_eq!(places(1).collect::<Vec<_>>(), [0; 5]);
    }

    #[test]
    fn weights_are_the_bell_of_the_difference() {
        let (mut last, sigma) = (u16::MAX, SIGMA as f64);
        for difference in 0..=3 * 255 {
            let found = weight(difference);
            let bell = (-0.5 * (f64::from(difference) / sigma).powi(2)).exp();
            let off = f64::from(found) / f64::from(ONE) - bell;
            assert!(off.abs() < 0.001 && found <= last, "{difference}: {found}, off by {off}");
            last = found;
        }
        assert_eq!(last, 0);
    }

    #[test]
    fn the_places_ahead_and_their_mirror_image_are_a_circle() {
        let radius = RADIUS as isize;
        for (dx, dy) in (-radius..=radius).flat_map(|dy| (-radius..=radius).map(move |dx| (dx, dy))) {
            let inside = (dx, dy) != (0, 0) && dx * dx + dy * dy <= radius * radius;
            let ways = [(dx, dy), (-dx, -dy)];
            let found = AHEAD.iter().filter(|&&(x, y)| ways.contains(&(x, y as isize))).count();
            assert_eq!(found, usize::from(inside), "{dx}, {dy}");
        }
    }
}
