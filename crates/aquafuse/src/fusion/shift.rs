//! Shifts of bytes: looked up once a pixel, added many values at once.

use crate::depth::{Stepped, TABLE};
use crate::simd::{self, Level, Work};

/// Pixels shifted together: enough that what is looked up has left the processor's store queue before it is read.
pub(super) const BLOCK: usize = 512;
/// Values after which the channels have the same order again, in whole vectors.
pub(super) const PERIOD: usize = 96;

/// What is added to the three channels at each step of depth.
pub(super) struct Shifts {
    /// How much, up or down. The fourth byte is nothing: four bytes are moved at once.
    table: Box<[[u8; 4]; TABLE]>,
    /// All ones where a channel goes up, and where it goes down, value by value.
    up: [u8; PERIOD],
    down: [u8; PERIOD],
}

impl Shifts {
    /// Shifts of bytes, in `[-255, 255]`; none if one channel goes up at one step and down at another, which no
    /// law does.
    pub(super) fn new(of_step: impl Iterator<Item = [i16; 3]>) -> Option<Self> {
        let mut table = Box::new([[0; 4]; TABLE]);
        let (mut rises, mut falls) = ([false; 3], [false; 3]);
        for (entry, shift) in table.iter_mut().zip(of_step) {
            for c in 0..3 {
                entry[c] = shift[c].unsigned_abs().min(255) as u8;
                rises[c] |= shift[c] > 0;
                falls[c] |= shift[c] < 0;
            }
        }
        if (0..3).any(|c| rises[c] && falls[c]) {
            return None;
        }
        let mask = |up: bool| std::array::from_fn(|i| if rises[i % 3] == up { u8::MAX } else { 0 });
        Some(Self { table, up: mask(true), down: mask(false) })
    }

    /// Adds the shift of each pixel's depth to its three values and clips; returns how many values of each channel
    /// that changed.
    pub(super) fn add<S: Stepped>(&self, values: &mut [u8], depths: &[S]) -> [u64; 3] {
        self.add_by(Level::best(), values, depths)
    }

    fn add_by<S: Stepped>(&self, level: Level, values: &mut [u8], depths: &[S]) -> [u64; 3] {
        simd::widest_by(level, Add { shifts: self, values, depths })
    }

    #[inline(always)]
    fn add_block(&self, values: &mut [u8; 3 * BLOCK], shifts: &[u8; 3 * BLOCK + 1], clipped: &mut [u64; 3]) {
        // Each place of the period counts at most once a round: 16 rounds fit into a byte.
        let mut counts = [0_u8; PERIOD];
        let (rounds, _) = values.as_chunks_mut::<PERIOD>();
        let (shifts, _) = shifts.as_chunks::<PERIOD>();
        for (values, shifts) in rounds.iter_mut().zip(shifts) {
            for i in 0..PERIOD {
                let (up, down) = (shifts[i] & self.up[i], shifts[i] & self.down[i]);
                let whole = values[i].wrapping_add(up).wrapping_sub(down);
                let kept = values[i].saturating_add(up).saturating_sub(down);
                values[i] = kept;
                counts[i] += u8::from(whole != kept);
            }
        }
        if counts != [0; PERIOD] {
            for (i, &count) in counts.iter().enumerate() {
                clipped[i % 3] += u64::from(count);
            }
        }
    }
}

/// Pixels looked up without a question in between: the compiler would make gathers and scatters of one loop, which take twice as long.
const GROUP: usize = 8;

/// What a table has at the depths of a block or less, channels in turn. Of the four entries of a depth the last is nothing: it is
/// overwritten by the next pixel.
#[inline(always)]
pub(super) fn look_up<T: Copy, S: Stepped>(
    table: &[[T; 4]; TABLE],
    depths: &[S],
    of_pixels: &mut [T; 3 * BLOCK + 1],
) {
    let (groups, rest) = depths.as_chunks::<GROUP>();
    for (k, depths) in groups.iter().enumerate() {
        let of_group = &mut of_pixels[3 * GROUP * k..][..3 * GROUP + 1];
        for i in 0..GROUP {
            of_group[3 * i..3 * i + 4].copy_from_slice(&table[depths[i].place()]);
        }
    }
    for (i, depth) in (depths.len() - rest.len()..).zip(rest) {
        of_pixels[3 * i..3 * i + 4].copy_from_slice(&table[depth.place()]);
    }
}

impl Shifts {
    /// Adds the first of these shifts to a block of values or fewer, filled up with black pixels that are not shifted.
    #[inline(always)]
    pub(super) fn add_run(
        &self,
        values: &mut [u8],
        shifts: &mut [u8; 3 * BLOCK + 1],
        clipped: &mut [u64; 3],
    ) {
        if let Ok(block) = (&mut *values).try_into() {
            return self.add_block(block, shifts, clipped);
        }
        let mut last = [0; 3 * BLOCK];
        last[..values.len()].copy_from_slice(values);
        shifts[values.len()..].fill(0);
        self.add_block(&mut last, shifts, clipped);
        values.copy_from_slice(&last[..values.len()]);
    }
}

struct Add<'a, S> {
    shifts: &'a Shifts,
    values: &'a mut [u8],
    depths: &'a [S],
}

impl<S: Stepped> Work for Add<'_, S> {
    type Output = [u64; 3];

    #[inline(always)]
    fn run(self) -> [u64; 3] {
        let Self { shifts: of, values, depths } = self;
        let mut clipped = [0; 3];
        let mut shifts = [0; 3 * BLOCK + 1];
        let (blocks, rest) = values.as_chunks_mut::<{ 3 * BLOCK }>();
        let (blocks_of_depths, rest_of_depths) = depths.as_chunks::<BLOCK>();
        for (values, depths) in blocks.iter_mut().zip(blocks_of_depths) {
            look_up(&of.table, depths, &mut shifts);
            of.add_block(values, &shifts, &mut clipped);
        }
        for (shift, &depth) in shifts.chunks_exact_mut(3).zip(rest_of_depths) {
            shift.copy_from_slice(&of.table[depth.place()][..3]);
        }
        of.add_run(rest, &mut shifts, &mut clipped);
        clipped
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Kernels;

    fn scattered(count: usize, seed: usize) -> Vec<u8> {
        (0..count).map(|i| ((i + seed).wrapping_mul(2_654_435_761) >> 13) as u8).collect()
    }

    #[test]
    fn many_values_are_shifted_and_counted_as_one_is() {
        let of_level: [[i16; 3]; 256] =
            std::array::from_fn(|level| [level as i16, -(level as i16) / 3, 255 - level as i16]);
        let shifts = Shifts::new(of_level.into_iter()).unwrap();
        for pixels in [1, 7, 33, 511, 512, 513, 1024, 2049] {
            let (before, levels) = (scattered(3 * pixels, 5), scattered(pixels, 77));
            let mut expected = [0; 3];
            let mut one_by_one = before.clone();
            for (i, value) in one_by_one.iter_mut().enumerate() {
                let (kept, clips) = value.shifted(of_level[usize::from(levels[i / 3])][i % 3]);
                *value = kept;
                expected[i % 3] += u64::from(clips);
            }
            for level in Level::all() {
                let mut values = before.clone();
                assert_eq!(
                    shifts.add_by(level, &mut values, &levels),
                    expected,
                    "{level:?}, {pixels} pixels"
                );
                assert_eq!(values, one_by_one, "{level:?}, {pixels} pixels");
            }
        }
    }

    #[test]
    fn a_channel_that_goes_both_ways_is_left_to_others() {
        assert!(Shifts::new([[0, 4, 0], [0, -4, 0]].into_iter()).is_none());
    }
}
