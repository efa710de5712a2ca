//! [`Model::Relight`](super::Model::Relight) on bytes: one look at a table of F a pixel, and arithmetic on many values at once.

use super::LawInUse;
use super::shared::{ToValues, left, nearest};
use super::shift::BLOCK;
use crate::bands;
use crate::depth::{DepthMap, InSteps, Stepped, TABLE};
use crate::image::{Encoding, ImageMut, ImageRef, Sample};
use crate::simd::{self, Work};
use crate::waterbody::WaterShare;

/// 1 in F and in factors of the direct signal.
const WHOLE_FACTOR: f32 = 32767.0;
/// A byte in steps of the sums: three of its range either way fit into 16 bits, or are clipped anyway.
const STEPS: f32 = 64.0;
const STEP_BITS: u32 = 6;
/// Values after which the channels have the same order again, in whole vectors.
const PERIOD: usize = 48;

/// Fuses the content, or `fused` itself if there is none, into `fused`; how many values were clipped. Both are bytes, and depth
/// has steps: anything else stays as it is.
pub(super) fn fuse<T: Sample, E: Encoding>(
    content: Option<ImageRef<'_, T, E>>,
    mut fused: ImageMut<'_, T, E>,
    depth: &DepthMap,
    law: LawInUse<'_, E>,
    share: Option<&WaterShare>,
) -> [u64; 3] {
    if let Some(content) = content {
        fused.copy_from(content).expect("of one size");
    }
    let Some(bytes) = fused.into_bytes() else { return [0; 3] };
    match depth.in_steps() {
        Some(InSteps::Levels(levels)) => by_steps(bytes, levels, law, share),
        Some(InSteps::Steps(steps)) => by_steps(bytes, steps, law, share),
        None => [0; 3],
    }
}

fn by_steps<E: Encoding, S: Stepped>(
    image: ImageMut<'_, u8, E>,
    depths: &[S],
    law: LawInUse<'_, E>,
    share: Option<&WaterShare>,
) -> [u64; 3] {
    let relit = Relit::new::<S, E>(law);
    let (width, stride) = (image.width(), image.stride());
    let band = |first: usize, band: &mut [u8]| {
        let mut rows = share.map(WaterShare::rows);
        let mut of_values = vec![[0; 3]; width];
        let mut clipped = [0; 3];
        for (y, row) in (first..).zip(band.chunks_mut(stride)) {
            let row = &mut row[..3 * width];
            if let Some(rows) = &mut rows {
                let shares = rows.row::<u8, E>(y, row.as_chunks().0);
                simd::widest(ToValues { shares, of_values: &mut of_values });
            }
            let depths = &depths[y * width..][..width];
            let clips = simd::widest(Row { relit: &relit, row, depths, shares: &of_values });
            clipped = std::array::from_fn(|c| clipped[c] + clips[c]);
        }
        clipped
    };
    let add = |a: [u64; 3], b: [u64; 3]| std::array::from_fn(|c| a[c] + b[c]);
    bands::sum(image.into_samples(), stride, band, add)
}

/// The law for bytes: `U + (1 - F) shift + lit F (U - own (1 - F))`, channels in turn.
///
/// F and lit are in shares of [`WHOLE_FACTOR`], bytes in [`STEPS`]: a value is off by less than 1/32 before it is rounded, and not at
/// all where nothing changes.
struct Relit {
    /// F' of things at each step of depth. The fourth is nothing.
    factors: Box<[[u16; 4]; TABLE]>,
    /// cosθ (α B2∞ - B1∞), cosθ (g - 1) and B1∞.
    shift: [i16; PERIOD],
    lit: [i16; PERIOD],
    own: [i16; PERIOD],
}

/// The product of a number and a share.
#[inline(always)]
fn part(number: i16, share: i16) -> i16 {
    ((i32::from(number) * i32::from(share) + (1 << 14)) >> 15) as i16
}

impl Relit {
    fn new<S: Stepped, E: Encoding>(law: LawInUse<'_, E>) -> Self {
        let mut factors = Box::new([[0; 4]; TABLE]);
        for (place, entry) in factors.iter_mut().enumerate().take(S::COUNT) {
            let factor = law.effect(S::z(place)).factor;
            for c in 0..3 {
                entry[c] = nearest(WHOLE_FACTOR * factor[c]) as u16;
            }
        }
        let (cosine, [own, veil]) = law.veils();
        let gain = law.effect(0.0).gain;
        let turns = |whole: f32, of: &dyn Fn(usize) -> f32| {
            // What is out of range clips every value.
            std::array::from_fn(|i| (whole * of(i % 3)).round() as i16)
        };
        Self {
            factors,
            shift: turns(255.0 * STEPS, &|c| cosine * (veil[c] - own[c])),
            lit: turns(WHOLE_FACTOR, &|c| cosine * (gain[c] - 1.0)),
            own: turns(255.0 * STEPS, &|c| own[c]),
        }
    }

    /// Changes values of pixels with these F, in whole turns of the channels, and counts what was clipped.
    #[inline(always)]
    fn change(&self, values: &mut [[u8; PERIOD]], factors: &[[u16; PERIOD]], clipped: &mut [u64; 3]) {
        // Of at most 32 turns.
        let mut counts = [0_u16; PERIOD];
        for (values, factors) in values.iter_mut().zip(factors) {
            for i in 0..PERIOD {
                let (value, factor) = (i16::from(values[i]) << STEP_BITS, factors[i] as i16);
                let hidden = i16::MAX - factor;
                let direct = value - part(self.own[i], hidden);
                let shifted = value.saturating_add(part(self.shift[i], hidden));
                let sum = shifted.saturating_add(part(direct, part(self.lit[i], factor)));
                let rounded = sum.saturating_add(1 << (STEP_BITS - 1)) >> STEP_BITS;
                let kept = rounded.clamp(0, 255);
                values[i] = kept as u8;
                counts[i] += u16::from(kept != rounded);
            }
        }
        for (i, &count) in counts.iter().enumerate() {
            clipped[i % 3] += u64::from(count);
        }
    }
}

/// Changes one row.
struct Row<'a, S> {
    relit: &'a Relit,
    row: &'a mut [u8],
    depths: &'a [S],
    /// w of each value.
    shares: &'a [[u16; 3]],
}

impl<S: Stepped> Work for Row<'_, S> {
    type Output = [u64; 3];

    #[inline(always)]
    fn run(self) -> [u64; 3] {
        let Self { relit, row, depths, shares } = self;
        let mut factors = [0; 3 * BLOCK + 1];
        let mut clipped = [0; 3];
        let blocks = row.chunks_mut(3 * BLOCK).zip(depths.chunks(BLOCK).zip(shares.chunks(BLOCK)));
        for (values, (depths, shares)) in blocks {
            left(&relit.factors, depths, shares, &mut factors);
            let (turns, rest) = values.as_chunks_mut::<PERIOD>();
            let of_turns = factors.as_chunks::<PERIOD>().0;
            relit.change(turns, of_turns, &mut clipped);
            if !rest.is_empty() {
                // Filled up with black pixels at the camera, which stay as they are.
                let (mut last, mut of_last) = ([[0; PERIOD]], [[WHOLE_FACTOR as u16; PERIOD]]);
                last[0][..rest.len()].copy_from_slice(rest);
                of_last[0][..rest.len()].copy_from_slice(&factors[PERIOD * turns.len()..][..rest.len()]);
                relit.change(&mut last, &of_last, &mut clipped);
                rest.copy_from_slice(&last[0][..rest.len()]);
            }
        }
        clipped
    }
}
