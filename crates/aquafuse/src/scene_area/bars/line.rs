//! A line of an image in planes, and what is counted in it: plain code that becomes vectors.

use std::ops::Range;

use crate::simd::{self, Work};

/// Red, green and blue of the places of a line.
#[derive(Clone, Copy)]
pub(super) struct Line<'a>([&'a [u8]; 3]);

impl<'a> Line<'a> {
    /// The line whose planes lie one behind the other.
    pub(super) fn new(planes: &'a [u8]) -> Self {
        let places = planes.len() / 3;
        Self([0, 1, 2].map(|c| &planes[c * places..(c + 1) * places]))
    }

    /// How many places it has.
    pub(super) fn len(self) -> usize {
        self.0[0].len()
    }

    /// Some of its places.
    pub(super) fn within(self, span: &Range<usize>) -> Self {
        Self(self.0.map(|plane| &plane[span.clone()]))
    }

    /// The median of each channel.
    pub(super) fn median(self) -> [u8; 3] {
        self.0.map(|plane| super::median(plane.iter().copied()))
    }

    /// In how many places it has a colour, within so many steps.
    pub(super) fn has(self, colour: [u8; 3], within: u16) -> usize {
        simd::widest(Has { line: self, colour, within })
    }

    /// The sum of its differences from another line of as many places.
    pub(super) fn off(self, other: Self) -> u64 {
        simd::widest(Off { lines: [self, other] }).into()
    }

    /// As many places of each plane.
    #[inline(always)]
    fn first(self, places: usize) -> [&'a [u8]; 3] {
        let [r, g, b] = self.0;
        [&r[..places], &g[..places], &b[..places]]
    }
}

/// In how many places colours leave the colour of the bar, by a number of steps, between the second and the third of four lines of as
/// many places; and in how many they have left it before. The lines are averaged by two.
pub(super) fn leaving(lines: [Line<'_>; 4], colour: [u8; 3], step: u16) -> (usize, usize) {
    simd::widest(Leaving { lines, colour, step })
}

/// The largest of three.
#[inline(always)]
fn most<T: Ord>(r: T, g: T, b: T) -> T {
    r.max(g).max(b)
}

struct Has<'a> {
    line: Line<'a>,
    colour: [u8; 3],
    within: u16,
}

impl Work for Has<'_> {
    type Output = usize;

    #[inline(always)]
    fn run(self) -> usize {
        let places = self.line.len();
        let ([r, g, b], [of_r, of_g, of_b]) = (self.line.first(places), self.colour);
        let mut found = 0_u32;
        for i in 0..places {
            let off = most(r[i].abs_diff(of_r), g[i].abs_diff(of_g), b[i].abs_diff(of_b));
            found += u32::from(u16::from(off) <= self.within);
        }
        found as usize
    }
}

struct Off<'a> {
    lines: [Line<'a>; 2],
}

impl Work for Off<'_> {
    type Output = u32;

    #[inline(always)]
    fn run(self) -> u32 {
        let places = self.lines[0].len();
        let [[r, g, b], [of_r, of_g, of_b]] = [self.lines[0].first(places), self.lines[1].first(places)];
        let mut sum = 0_u32;
        for i in 0..places {
            sum += u32::from(most(r[i].abs_diff(of_r[i]), g[i].abs_diff(of_g[i]), b[i].abs_diff(of_b[i])));
        }
        sum
    }
}

struct Leaving<'a> {
    lines: [Line<'a>; 4],
    colour: [u8; 3],
    step: u16,
}

impl Work for Leaving<'_> {
    type Output = (usize, usize);

    #[inline(always)]
    fn run(self) -> (usize, usize) {
        let Self { lines: [before, outer, inner, behind], colour, step } = self;
        let places = inner.len();
        let before = before.first(places);
        let outer = outer.first(places);
        let inner = inner.first(places);
        let behind = behind.first(places);
        let (mut leaving, mut gone) = (0_u32, 0_u32);
        for i in 0..places {
            // Twice the mean of two is their sum.
            let off = most(
                twice_off(before[0][i], outer[0][i], colour[0]),
                twice_off(before[1][i], outer[1][i], colour[1]),
                twice_off(before[2][i], outer[2][i], colour[2]),
            );
            let left = most(
                twice_off(inner[0][i], behind[0][i], colour[0]),
                twice_off(inner[1][i], behind[1][i], colour[1]),
                twice_off(inner[2][i], behind[2][i], colour[2]),
            );
            let own = most(
                inner[0][i].abs_diff(colour[0]),
                inner[1][i].abs_diff(colour[1]),
                inner[2][i].abs_diff(colour[2]),
            );
            let is_far = (left >= 2 * step) & (4 * u16::from(own) >= left);
            leaving += u32::from(is_far & (2 * off <= left));
            gone += u32::from((off >= 2 * step) & (2 * off > left));
        }
        (leaving as usize, gone as usize)
    }
}

/// Twice the difference of the mean of two values from another.
#[inline(always)]
fn twice_off(a: u8, b: u8, from: u8) -> u16 {
    (u16::from(a) + u16::from(b)).abs_diff(2 * u16::from(from))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values without a pattern.
    fn planes(seed: usize, places: usize) -> Vec<u8> {
        (0..3 * places).map(|i| ((i + seed) * (i + 7 * seed) * 40_503 / 512) as u8).collect()
    }

    #[test]
    fn a_line_has_the_colours_that_are_near() {
        let line = [10, 20, 30, 40, 50, 60, 70, 80, 90];
        let line = Line::new(&line);
        assert_eq!((line.len(), line.median()), (3, [20, 50, 80]));
        assert_eq!([9, 10, 255].map(|within| line.has([20, 50, 80], within)), [1, 3, 3]);
        assert_eq!(line.within(&(1..2)).has([20, 50, 80], 0), 1);
        assert_eq!(line.off(Line::new(&[10, 20, 31, 40, 52, 60, 73, 80, 90])), 3 + 2 + 1);
    }

    #[test]
    fn colours_leave_a_bar_where_they_were_its_own_before_and_are_another_behind() {
        let grey = |value: u8| [value; 6];
        let [bar, scene] = [grey(16), grey(200)];
        let of = |lines: [&[u8; 6]; 4]| leaving(lines.map(|line| Line::new(line)), [16; 3], 12);
        assert_eq!(of([&bar, &bar, &scene, &scene]), (2, 0));
        assert_eq!(of([&bar, &bar, &bar, &scene]), (0, 0));
        assert_eq!(of([&scene, &scene, &scene, &scene]), (0, 2));
        assert_eq!(of([&bar, &bar, &bar, &bar]), (0, 0));
    }

    #[test]
    fn vectors_count_what_plain_code_does() {
        for places in [1, 7, 64, 129, 256] {
            let seen = [1, 2, 3, 4].map(|seed| planes(seed, places));
            let lines = seen.each_ref().map(|planes| Line::new(planes));
            let colour = [90, 120, 60];
            let has = || Has { line: lines[0], colour, within: 60 };
            assert_eq!(simd::widest(has()), has().run());
            let off = || Off { lines: [lines[0], lines[1]] };
            assert_eq!(simd::widest(off()), off().run());
            let leaving = || Leaving { lines, colour, step: 20 };
            assert_eq!(simd::widest(leaving()), leaving().run());
        }
    }
}
