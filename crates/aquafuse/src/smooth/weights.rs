//! What neighbours count in the bilateral filter, and which they are.

/// Reach of the window, a circle of diameter d = 5.
pub(super) const RADIUS: usize = 2;
/// σ of the difference of two colours: the sum over the channels, in steps of a byte. OpenCV's examples have the same
/// number of pixels for σ of their distance, which over a window this small is no difference: 4 weights in 10,000.
const SIGMA: u64 = 75;
/// `e^(-x)` is taken as `(1 - y + y²/2)^(2^5)` with y = x / 2^5: off by 11 in 10,000 at most, rounding included, and made of
/// products alone, which vectors have. Without the square, 1 in 400, values of noise came out two steps of a byte off.
pub(super) const SQUARINGS: u32 = 5;
/// What Δ² / 8 is multiplied by, as a share of 2^15, to be such a y: `8 / (2^5 · 2 σ²)`, rounded.
pub(super) const GROWTH: i16 =
    (((1 << 33) + ((SIGMA * SIGMA) << SQUARINGS)) / ((2 * SIGMA * SIGMA) << SQUARINGS)) as i16;
/// The weight of a pixel itself, and of any of its colour: somewhat less than 2^15.
pub(super) const ONE: u16 = weight::<0>(0) as u16;

/// The half of the window that is read forwards; the other half is its mirror image, with the same weights.
pub(super) const AHEAD: [(isize, usize); 6] = [(1, 0), (2, 0), (-1, 1), (0, 1), (1, 1), (0, 2)];

/// From here on nothing is left; with the [bits](SHIFT) that come behind it, the largest number of 16 bits and a sign.
pub(super) const MOST: u16 = 511;
/// What a difference is shifted by so that its square is that of Δ / 8, over 2^15.
pub(super) const SHIFT: u32 = 6;

/// What a neighbour counts whose colour differs so much, in steps of a byte with `PART` bits behind the point; as a share
/// of 2^15.
///
/// In whole numbers, whose sums are the same in any order, on any machine.
#[inline(always)]
pub(super) const fn weight<const PART: u32>(difference: u16) -> i16 {
    let most = MOST << PART;
    let difference = if difference < most { difference } else { most };
    let difference = (difference << (SHIFT - PART)) as i16;
    let y = product(product(difference, difference), GROWTH);
    let mut power = i16::MAX - y + (product(y, y) >> 1);
    let mut squarings = 0;
    while squarings < SQUARINGS {
        power = product(power, power);
        squarings += 1;
    }
    power
}

/// The product over 2^15, rounded; halves go up. One instruction of most vectors.
#[inline(always)]
pub(super) const fn product(a: i16, b: i16) -> i16 {
    ((a as i32 * b as i32 + (1 << 14)) >> 15) as i16
}

/// A place beyond the border, mirrored about the outermost pixels: -1 is 1, `length` is `length - 2`.
pub(super) fn mirrored(place: isize, length: usize) -> usize {
    let last = length as isize - 1;
    let mut place = place;
    // In an image smaller than the window the mirror is met more than once.
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
        let (mut last, sigma) = (i16::MAX, SIGMA as f64);
        for difference in 0..=3 * 255 {
            let found = weight::<0>(difference);
            assert_eq!(weight::<5>(difference << 5), found);
            let bell = (-0.5 * (f64::from(difference) / sigma).powi(2)).exp();
            let off = f64::from(found) / f64::from(ONE) - bell;
            assert!(off.abs() < 0.0011 && found <= last, "{difference}: {found}, off by {off}");
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
