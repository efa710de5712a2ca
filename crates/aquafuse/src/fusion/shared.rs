//! Fusion where a share of each pixel is open water.
//!
//! The shift of a pixel is `D - (1 - w) G(z)`, with D the shift of open water and `G = D - shift(z)`, so that it is still one
//! look at a table of 256 depths a pixel, and one product. Both are kept in 1/256 of a byte, w in 1/32768: the shift of a byte
//! is off by less than 1/64 before it is rounded, and a w that changes slowly shows no steps but those of the bytes.

use super::shift::{BLOCK, Shifts};
use super::{Model, PixelTransform, TransferLaw};
use crate::bands;
use crate::depth::{DepthMap, LEVELS, level_to_z};
use crate::image::{Encoding, ImageError, ImageMut, ImageRef, Sample};
use crate::simd::{self, Work};
use crate::waterbody::WaterShare;

/// 1 in shares of a table's shifts, and a byte in steps of them.
const WHOLE: f32 = 32768.0;
const STEPS: f32 = 256.0;

/// Fuses the content, or `fused` itself if there is none, into `fused`; how many values were clipped.
pub(super) fn fuse<T: Sample, E: Encoding>(
    content: Option<ImageRef<'_, T, E>>,
    mut fused: ImageMut<'_, T, E>,
    depth: &DepthMap,
    law: &TransferLaw<E>,
    share: &WaterShare,
    model: Model,
) -> Result<[u64; 3], ImageError> {
    if let Some(content) = content {
        fused.copy_from(content)?;
    }
    if let Some(levels) = depth.levels().filter(|_| model.is_shift())
        && let Some(table) = Table::new(law)
        && let Some(bytes) = fused.reborrow().into_bytes()
    {
        return Ok(shift_bytes(bytes, levels, &table, share));
    }
    Ok(change_pixels(fused, depth, law, share))
}

fn shift_bytes<E: Encoding>(
    image: ImageMut<'_, u8, E>,
    levels: &[u8],
    table: &Table,
    share: &WaterShare,
) -> [u64; 3] {
    let (width, stride) = (image.width(), image.stride());
    let band = |first: usize, band: &mut [u8]| {
        let mut rows = share.rows();
        let mut left = vec![0; width];
        let mut clipped = [0; 3];
        for (y, row) in (first..).zip(band.chunks_mut(stride)) {
            let row = &mut row[..3 * width];
            let shares = rows.row::<u8, E>(y, row.as_chunks().0);
            left.iter_mut().zip(shares).for_each(|(left, w)| *left = (WHOLE * (1.0 - w) + 0.5) as u16);
            let levels = &levels[y * width..][..width];
            clipped = add(clipped, simd::widest(ShiftRow { table, row, levels, left: &left }));
        }
        clipped
    };
    bands::sum(image.into_samples(), stride, band, add)
}

/// The law at each pixel, whatever it is.
fn change_pixels<T: Sample, E: Encoding>(
    image: ImageMut<'_, T, E>,
    depth: &DepthMap,
    law: &TransferLaw<E>,
    share: &WaterShare,
) -> [u64; 3] {
    let (width, stride) = (image.width(), image.stride());
    let by_level: Option<[PixelTransform; LEVELS]> =
        depth.levels().map(|_| std::array::from_fn(|level| law.at(level_to_z(level as u8))));
    let band = |first: usize, band: &mut [T]| {
        let mut rows = share.rows();
        let mut clipped = [0; 3];
        for (y, row) in (first..).zip(band.chunks_mut(stride)) {
            let pixels = row[..3 * width].as_chunks_mut::<3>().0;
            let shares = rows.row::<T, E>(y, pixels);
            for (x, (pixel, &w)) in pixels.iter_mut().zip(shares).enumerate() {
                let things = match (&by_level, depth.levels()) {
                    (Some(table), Some(levels)) => table[usize::from(levels[y * width + x])],
                    _ => law.at(depth.at(x, y)),
                };
                let change = law.in_share(things, w);
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
    /// Of open water.
    water: [u16; 3],
    /// What things of each level of depth have less. The fourth is nothing.
    less: [[u16; 4]; LEVELS],
    /// Which channels go up, and the addition of blocks.
    shifts: Shifts,
}

impl Table {
    /// None for a law that takes a byte farther than from black to white, or one channel up and down, which no shift does.
    fn new<E: Encoding>(law: &TransferLaw<E>) -> Option<Self> {
        let steps = |offset: f32| (255.0 * STEPS * offset).round();
        let of_level: [[f32; 3]; LEVELS] =
            std::array::from_fn(|level| law.at(level_to_z(level as u8)).offset.map(steps));
        let water = law.in_share(PixelTransform::NONE, 1.0).offset.map(steps);
        let lies_within = |c: usize| {
            let within = |shift: f32| {
                if water[c] < 0.0 {
                    water[c] <= shift && shift <= 0.0
                } else {
                    0.0 <= shift && shift <= water[c]
                }
            };
            water[c].abs() <= 255.0 * STEPS && of_level.iter().all(|shift| within(shift[c]))
        };
        if !(0..3).all(lies_within) {
            return None;
        }
        let mut less = [[0; 4]; LEVELS];
        for (less, shift) in less.iter_mut().zip(&of_level) {
            (0..3).for_each(|c| less[c] = (water[c] - shift[c]).abs() as u16);
        }
        let whole = [water.map(|shift| if shift < 0.0 { -1 } else { 1 }); LEVELS];
        Some(Self { water: water.map(|shift| shift.abs() as u16), less, shifts: Shifts::new(&whole)? })
    }
}

/// Adds the shifts of one row.
struct ShiftRow<'a> {
    table: &'a Table,
    row: &'a mut [u8],
    levels: &'a [u8],
    /// 1 - w of each pixel.
    left: &'a [u16],
}

impl Work for ShiftRow<'_> {
    type Output = [u64; 3];

    #[inline(always)]
    fn run(self) -> [u64; 3] {
        let Self { table, row, levels, left } = self;
        let mut shifts = [0; 3 * BLOCK + 1];
        let mut clipped = [0; 3];
        let blocks = row.chunks_mut(3 * BLOCK).zip(levels.chunks(BLOCK).zip(left.chunks(BLOCK)));
        for (values, (levels, left)) in blocks {
            for (i, (&level, &left)) in levels.iter().zip(left).enumerate() {
                let less = table.less[usize::from(level)];
                for c in 0..3 {
                    let less = (u32::from(less[c]) * u32::from(left)) >> 15;
                    shifts[3 * i + c] = ((u32::from(table.water[c]) - less + 128) >> 8) as u8;
                }
            }
            table.shifts.add_run(values, &mut shifts, &mut clipped);
        }
        clipped
    }
}

#[cfg(test)]
mod tests;
