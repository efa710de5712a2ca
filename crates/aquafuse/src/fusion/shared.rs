//! Fusion where a share of each pixel is open water.
//!
//! The shift of a pixel is `D - (1 - w) G(z)`, with D the shift of open water and `G = D - shift(z)`, so that it is still one
//! look at a table of 256 depths a pixel, and one product. Both are kept in 1/256 of a byte, w in 1/65535: the shift of a byte
//! is off by less than 1/64 before it is rounded, and a w that changes slowly shows no steps but those of the bytes.

use super::shift::{BLOCK, PERIOD, Shifts, look_up};
use super::{LawInUse, PixelTransform};
use crate::bands;
use crate::depth::{DepthMap, InSteps, Stepped, TABLE};
use crate::image::{Encoding, ImageError, ImageMut, ImageRef, Sample};
use crate::simd::{self, Whole as _, Work};
use crate::waterbody::WaterShare;

/// A share of 1, and a byte in steps of a table's shifts.
const WHOLE: f32 = 65535.0;
const STEPS: f32 = 256.0;

/// Fuses the content, or `fused` itself if there is none, into `fused`; how many values were clipped.
pub(super) fn fuse<T: Sample, E: Encoding>(
    content: Option<ImageRef<'_, T, E>>,
    mut fused: ImageMut<'_, T, E>,
    depth: &DepthMap,
    law: LawInUse<'_, E>,
    share: &WaterShare,
) -> Result<[u64; 3], ImageError> {
    if let Some(content) = content {
        fused.copy_from(content)?;
    }
    Ok(match depth.in_steps() {
        Some(InSteps::Levels(levels)) => by_steps(fused, levels, law, share),
        Some(InSteps::Steps(steps)) => by_steps(fused, steps, law, share),
        None => change_pixels(fused, law, share, |x, y| law.at(depth.at(x, y))),
    })
}

/// The same by depth in steps.
fn by_steps<T: Sample, E: Encoding, S: Stepped>(
    mut fused: ImageMut<'_, T, E>,
    depths: &[S],
    law: LawInUse<'_, E>,
    share: &WaterShare,
) -> [u64; 3] {
    if law.model().is_shift()
        && let Some(bytes) = fused.reborrow().into_bytes()
        && let Some(table) = Table::new::<S, E>(law)
    {
        return shift_bytes(bytes, depths, &table, share);
    }
    let table: Vec<PixelTransform> = law.at_each((0..S::COUNT).map(S::z)).collect();
    let width = fused.width();
    change_pixels(fused, law, share, |x, y| table[depths[y * width + x].place()])
}

fn shift_bytes<E: Encoding, S: Stepped>(
    image: ImageMut<'_, u8, E>,
    depths: &[S],
    table: &Table,
    share: &WaterShare,
) -> [u64; 3] {
    let (width, stride) = (image.width(), image.stride());
    let band = |first: usize, band: &mut [u8]| {
        let mut rows = share.rows();
        let mut of_values = vec![[0; 3]; width];
        let mut clipped = [0; 3];
        for (y, row) in (first..).zip(band.chunks_mut(stride)) {
            let row = &mut row[..3 * width];
            let shares = rows.row::<u8, E>(y, row.as_chunks().0);
            simd::widest(ToValues { shares, of_values: &mut of_values });
            let depths = &depths[y * width..][..width];
            clipped = add(clipped, simd::widest(ShiftRow { table, row, depths, shares: &of_values }));
        }
        clipped
    };
    bands::sum(image.into_samples(), stride, band, add)
}

/// The law at each pixel, whatever it is; `things` is the law where nothing is open water.
fn change_pixels<T: Sample, E: Encoding>(
    image: ImageMut<'_, T, E>,
    law: LawInUse<'_, E>,
    share: &WaterShare,
    things: impl Fn(usize, usize) -> PixelTransform + Sync,
) -> [u64; 3] {
    let (width, stride) = (image.width(), image.stride());
    let band = |first: usize, band: &mut [T]| {
        let mut rows = share.rows();
        let mut clipped = [0; 3];
        for (y, row) in (first..).zip(band.chunks_mut(stride)) {
            let pixels = row[..3 * width].as_chunks_mut::<3>().0;
            let shares = rows.row::<T, E>(y, pixels);
            for (x, (pixel, &w)) in pixels.iter_mut().zip(shares).enumerate() {
                let change = law.in_share(things(x, y), w);
                for c in 0..3 {
                    let (value, is_clipped) = pixel[c].changed(change.gain[c], change.offset[c]);
                    pixel[c] = value;
                    clipped[c] += u64::from(is_clipped);
                }
            }
        }
        clipped
    };
    bands::sum(image.into_samples(), stride, band, add)
}

fn add(a: [u64; 3], b: [u64; 3]) -> [u64; 3] {
    std::array::from_fn(|c| a[c] + b[c])
}

/// Shifts of bytes in steps of 1/256.
struct Table {
    /// Of open water, channels in turn.
    water: [u16; PERIOD],
    /// What things at each step of depth have less. The fourth is nothing.
    less: Box<[[u16; 4]; TABLE]>,
    /// Which channels go up, and the addition of blocks.
    shifts: Shifts,
}

impl Table {
    /// None for a law that takes a byte farther than from black to white, or one channel up and down, which no shift does.
    fn new<S: Stepped, E: Encoding>(law: LawInUse<'_, E>) -> Option<Self> {
        let steps = |offset: f32| nearest(255.0 * STEPS * offset);
        let water = law.in_share(PixelTransform::NONE, 1.0).offset.map(steps);
        // A NaN is no such shift either.
        if !water.iter().all(|shift| shift.abs() <= 255.0 * STEPS) {
            return None;
        }
        let mut less = Box::new([[0; 4]; TABLE]);
        for (less, things) in less.iter_mut().zip(law.at_each((0..S::COUNT).map(S::z))) {
            let things = things.offset.map(steps);
            for c in 0..3 {
                let (least, most) = (water[c].min(0.0), water[c].max(0.0));
                if !(least..=most).contains(&things[c]) {
                    return None;
                }
                less[c] = (water[c] - things[c]).abs() as u16;
            }
        }
        let up_or_down = water.map(|shift| if shift < 0.0 { -1 } else { 1 });
        let shifts = Shifts::new(std::iter::once(up_or_down))?;
        let water = std::array::from_fn(|i| water[i % 3].abs() as u16);
        Some(Self { water, less, shifts })
    }
}

/// The nearest whole number, of numbers that 32 bits hold; a NaN stays one. The library's takes as long as the law.
#[inline(always)]
pub(super) fn nearest(value: f32) -> f32 {
    if value.is_nan() { value } else { ((value.abs() + 0.5) as i32 as f32).copysign(value) }
}

/// w of a row for each value, in shares of [`WHOLE`].
pub(super) struct ToValues<'a> {
    pub(super) shares: &'a [f32],
    pub(super) of_values: &'a mut [[u16; 3]],
}

impl Work for ToValues<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (of_values, w) in self.of_values.iter_mut().zip(self.shares) {
            *of_values = [(WHOLE * w).whole_bits() as u16; 3];
        }
    }
}

/// What a table has at the depths of a block or less, times 1 - w.
#[inline(always)]
pub(super) fn left<S: Stepped>(
    table: &[[u16; 4]; TABLE],
    depths: &[S],
    shares: &[[u16; 3]],
    values: &mut [u16; 3 * BLOCK + 1],
) {
    look_up(table, depths, values);
    for (value, &w) in values.iter_mut().zip(shares.as_flattened()) {
        *value -= ((u32::from(*value) * u32::from(w)) >> 16) as u16;
    }
}

/// Adds the shifts of one row.
struct ShiftRow<'a, S> {
    table: &'a Table,
    row: &'a mut [u8],
    depths: &'a [S],
    /// w of each value.
    shares: &'a [[u16; 3]],
}

impl<S: Stepped> Work for ShiftRow<'_, S> {
    type Output = [u64; 3];

    #[inline(always)]
    fn run(self) -> [u64; 3] {
        let Self { table, row, depths, shares } = self;
        let (mut less, mut shifts) = ([0; 3 * BLOCK + 1], [0; 3 * BLOCK + 1]);
        let mut clipped = [0; 3];
        let blocks = row.chunks_mut(3 * BLOCK).zip(depths.chunks(BLOCK).zip(shares.chunks(BLOCK)));
        for (values, (depths, shares)) in blocks {
            left(&table.less, depths, shares, &mut less);
            let (turns, _) = shifts.as_chunks_mut::<PERIOD>();
            for (shifts, less) in turns.iter_mut().zip(less.as_chunks::<PERIOD>().0) {
                for i in 0..PERIOD {
                    shifts[i] = (table.water[i].wrapping_sub(less[i]).wrapping_add(128) >> 8) as u8;
                }
            }
            table.shifts.add_run(values, &mut shifts, &mut clipped);
        }
        clipped
    }
}

#[cfg(test)]
mod tests;
