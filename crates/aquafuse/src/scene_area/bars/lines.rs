//! The lines of an image, counted from one of its sides.

use std::ops::Range;

use super::super::{Margins, places};
use super::{EVEN, MOST, TIERS, UNEVEN};
use crate::image::{Encoding, ImageRef, Sample};

/// A side of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Top,
    Right,
    Bottom,
    Left,
}

/// All sides, in the order of [`Margins`].
pub(super) const SIDES: [Side; 4] = [Side::Top, Side::Right, Side::Bottom, Side::Left];

impl Side {
    /// Whether its lines are rows.
    fn is_row(self) -> bool {
        matches!(self, Self::Top | Self::Bottom)
    }

    /// Of numbers for each side, those of the sides at which its lines begin and end.
    pub(super) fn neighbours(self, [top, right, bottom, left]: [usize; 4]) -> (usize, usize) {
        if self.is_row() { (left, right) } else { (top, bottom) }
    }

    /// Its number in some margins.
    pub(super) fn of(self, margins: &mut Margins) -> &mut usize {
        match self {
            Self::Top => &mut margins.top,
            Self::Right => &mut margins.right,
            Self::Bottom => &mut margins.bottom,
            Self::Left => &mut margins.left,
        }
    }
}

/// Rows from the top or the bottom, or columns from the left or the right, of what margins leave of an image. They are read
/// as they are needed.
pub(super) struct Lines<'a, T, E: Encoding> {
    image: ImageRef<'a, T, E>,
    columns: Range<usize>,
    rows: Range<usize>,
    side: Side,
    /// The places of a line that are read, rising.
    places: Vec<usize>,
    /// The lines that were read, from the outermost on.
    read: Vec<Vec<[u8; 3]>>,
    /// The median of the outermost line, in each channel.
    pub(super) colour: [u8; 3],
}

impl<'a, T: Sample, E: Encoding> Lines<'a, T, E> {
    /// The lines at a side of what `margins` leave, which is something.
    pub(super) fn new(image: ImageRef<'a, T, E>, margins: Margins, side: Side) -> Self {
        let columns = margins.left..image.width() - margins.right;
        let rows = margins.top..image.height() - margins.bottom;
        let length = if side.is_row() { columns.len() } else { rows.len() };
        let (places, read) = (places(length), Vec::new());
        let mut lines = Self { image, columns, rows, side, places, read, colour: [0; 3] };
        lines.colour = median(lines.get(0));
        lines
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        if self.side.is_row() { self.rows.len() } else { self.columns.len() }
    }

    /// The most of them that can be a bar.
    pub(super) fn most(&self) -> usize {
        self.count() * MOST / 100
    }

    /// The most of them that can be even, within so many steps.
    pub(super) fn most_even(&self, within: u16) -> usize {
        if within > TIERS[1].within { self.most().min(UNEVEN) } else { self.most() }
    }

    /// Which of the pixels that are read lie between the first `before` and the last `behind` of a line.
    pub(super) fn span(&self, before: usize, behind: usize) -> Range<usize> {
        let length = if self.side.is_row() { self.columns.len() } else { self.rows.len() };
        let from = self.places.partition_point(|&place| place < before);
        let to = self.places.partition_point(|&place| place + behind < length);
        from..to.max(from)
    }

    /// The pixels of line `k` that are read.
    pub(super) fn get(&mut self, k: usize) -> &[[u8; 3]] {
        while self.read.len() <= k {
            self.read.push(self.pixels(self.read.len()));
        }
        &self.read[k]
    }

    /// The pixels of a line with a few lines before and behind it, in a span.
    pub(super) fn around(&mut self, lines: [usize; 4], span: &Range<usize>) -> [&[[u8; 3]]; 4] {
        lines.into_iter().for_each(|k| _ = self.get(k));
        lines.map(|k| &self.read[k][span.clone()])
    }

    fn pixels(&self, k: usize) -> Vec<[u8; 3]> {
        let places = self.places.iter();
        let row = |y: usize| {
            let row = &self.image.row(y)[self.columns.clone()];
            places.clone().map(|&place| to_bytes(row[place])).collect()
        };
        let column = |x: usize| {
            places.clone().map(|&place| to_bytes(self.image.row(self.rows.start + place)[x])).collect()
        };
        match self.side {
            Side::Top => row(self.rows.start + k),
            Side::Bottom => row(self.rows.end - 1 - k),
            Side::Left => column(self.columns.start + k),
            Side::Right => column(self.columns.end - 1 - k),
        }
    }

    /// How many lines from the outermost on are even: they have its colour.
    pub(super) fn even(&mut self) -> usize {
        match self.even_within(TIERS[0].within) {
            0 => self.even_within(TIERS[2].within),
            even => even,
        }
    }

    /// [`Lines::even`] within so many steps.
    pub(super) fn even_within(&mut self, within: u16) -> usize {
        self.even_in(self.colour, within)
    }

    /// How many lines from the outermost on have a colour, within so many steps.
    pub(super) fn even_in(&mut self, colour: [u8; 3], within: u16) -> usize {
        let is_even = |line: &[[u8; 3]]| {
            line.iter().filter(|&&pixel| distance(pixel, colour) <= within).count() * 100 >= EVEN * line.len()
        };
        (0..self.most_even(within)).take_while(|&k| is_even(self.get(k))).count()
    }
}

/// The largest difference in a channel.
#[inline]
pub(in super::super) fn distance(a: [u8; 3], b: [u8; 3]) -> u16 {
    let [r, g, b] = [a[0].abs_diff(b[0]), a[1].abs_diff(b[1]), a[2].abs_diff(b[2])];
    u16::from(r.max(g).max(b))
}

/// A pixel in bytes.
#[inline]
pub(in super::super) fn to_bytes<T: Sample>([r, g, b]: [T; 3]) -> [u8; 3] {
    [r.to_byte(), g.to_byte(), b.to_byte()]
}

/// The lower median of each channel.
pub(in super::super) fn median(pixels: &[[u8; 3]]) -> [u8; 3] {
    [0, 1, 2].map(|c| {
        let mut counts = [0_usize; 256];
        pixels.iter().for_each(|pixel| counts[usize::from(pixel[c])] += 1);
        let half = pixels.len().div_ceil(2);
        let mut below = 0;
        (0..=255)
            .find(|&level: &u8| {
                below += counts[usize::from(level)];
                below >= half
            })
            .expect("all pixels are counted")
    })
}
