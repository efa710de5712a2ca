//! The lines of an image, counted from one of its sides.

use std::ops::Range;

use super::super::{Margins, places};
use super::line::Line;
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
    /// The planes of the lines that were read, from the outermost on.
    read: Vec<u8>,
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
        lines.colour = lines.get(0).median();
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
    pub(super) fn get(&mut self, k: usize) -> Line<'_> {
        self.read_to(k);
        self.line(k)
    }

    /// The pixels of a line with a few lines before and behind it, in a span.
    pub(super) fn around(&mut self, lines: [usize; 4], span: &Range<usize>) -> [Line<'_>; 4] {
        lines.into_iter().for_each(|k| self.read_to(k));
        lines.map(|k| self.line(k).within(span))
    }

    fn line(&self, k: usize) -> Line<'_> {
        let length = 3 * self.places.len();
        Line::new(&self.read[k * length..(k + 1) * length])
    }

    fn read_to(&mut self, k: usize) {
        let length = 3 * self.places.len();
        while self.read.len() <= k * length {
            let next = self.read.len() / length;
            self.read.resize((next + 1) * length, 0);
            self.pixels(next);
        }
    }

    /// Reads line `k`, for which there is room.
    fn pixels(&mut self, k: usize) {
        let count = self.places.len();
        let (r, gb) = self.read[3 * k * count..].split_at_mut(count);
        let (g, b) = gb.split_at_mut(count);
        let planes = r.iter_mut().zip(g).zip(b).zip(&self.places);
        let place = |((r, g), b): ((&mut u8, &mut u8), &mut u8), pixel| [*r, *g, *b] = to_bytes(pixel);
        let row = |y: usize| &self.image.row(y)[self.columns.clone()];
        let (rows, columns) = (&self.rows, &self.columns);
        match self.side {
            Side::Top | Side::Bottom => {
                let row = row(if self.side == Side::Top { rows.start + k } else { rows.end - 1 - k });
                planes.for_each(|(to, &x)| place(to, row[x]));
            }
            Side::Left | Side::Right => {
                let x = if self.side == Side::Left { k } else { columns.len() - 1 - k };
                planes.for_each(|(to, &y)| place(to, row(rows.start + y)[x]));
            }
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
        let most = self.most_even(within);
        let mut is_even = |k: usize| {
            let line = self.get(k);
            line.has(colour, within) * 100 >= EVEN * line.len()
        };
        (0..most).take_while(|&k| is_even(k)).count()
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

/// The lower median.
pub(in super::super) fn median(values: impl ExactSizeIterator<Item = u8>) -> u8 {
    let half = values.len().div_ceil(2);
    let mut counts = [0_usize; 256];
    values.for_each(|value| counts[usize::from(value)] += 1);
    let mut below = 0;
    (0..=255)
        .find(|&level: &u8| {
            below += counts[usize::from(level)];
            below >= half
        })
        .expect("all values are counted")
}
