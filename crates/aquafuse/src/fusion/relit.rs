//! [`Model::Relight`](super::Model::Relight) on bytes: one look at a table of F a pixel, and arithmetic on many values at once.

use super::LawInUse;
use super::shared::{ToLeft, WHOLE};
use super::shift::BLOCK;
use crate::bands;
use crate::depth::{DepthMap, InSteps, Stepped, TABLE};
use crate::image::{Encoding, ImageMut, ImageRef, Sample};
use crate::simd::{self, Whole as _, Work};
use crate::waterbody::WaterShare;

/// 1 in F of the table.
const FACTOR: f32 = 65535.0;
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
        let mut left = vec![WHOLE as u16; width];
        let mut clipped = [0; 3];
        for (y, row) in (first..).zip(band.chunks_mut(stride)) {
            let row = &mut row[..3 * width];
            if let Some(rows) = &mut rows {
                let shares = rows.row::<u8, E>(y, row.as_chunks().0);
                simd::widest(ToLeft { shares, left: &mut left });
            }
            let depths = &depths[y * width..][..width];
            let clips = simd::widest(Row { relit: &relit, row, depths, left: &left });
            clipped = std::array::from_fn(|c| clipped[c] + clips[c]);
        }
        clipped
    };
    let add = |a: [u64; 3], b: [u64; 3]| std::array::from_fn(|c| a[c] + b[c]);
    bands::sum(image.into_samples(), stride, band, add)
}

/// The law for bytes: `U + (1 - F) shift + lit F (U - own (1 - F))`, channels in turn.
struct Relit {
    /// F' of things at each step of depth. The fourth is nothing.
    factors: Box<[[u16; 4]; TABLE]>,
    /// cosθ (α B2∞ - B1∞), cosθ (g - 1) and B1∞.
    shift: [f32; PERIOD],
    lit: [f32; PERIOD],
    own: [f32; PERIOD],
}

impl Relit {
    fn new<S: Stepped, E: Encoding>(law: LawInUse<'_, E>) -> Self {
        let mut factors = Box::new([[0; 4]; TABLE]);
        for (place, entry) in factors.iter_mut().enumerate().take(S::COUNT) {
            let factor = law.effect(S::z(place)).factor;
            for c in 0..3 {
                entry[c] = (FACTOR * factor[c]).round() as u16;
            }
        }
        let (cosine, [own, veil]) = law.veils();
        let gain = law.effect(0.0).gain;
        let turns = |of: &dyn Fn(usize) -> f32| std::array::from_fn(|i| of(i % 3));
        Self {
            factors,
            shift: turns(&|c| 255.0 * cosine * (veil[c] - own[c])),
            lit: turns(&|c| cosine * (gain[c] - 1.0)),
            own: turns(&|c| 255.0 * own[c]),
        }
    }

    /// Changes a block of values, of pixels with these F; counts what was clipped.
    #[inline(always)]
    fn change(&self, values: &mut [u8; PERIOD], factors: &[u16; PERIOD], clipped: &mut [u32; PERIOD]) {
        for i in 0..PERIOD {
            let (value, factor) = (f32::from(values[i]), f32::from(factors[i]) * FACTOR.recip());
            let direct = value - self.own[i] * (1.0 - factor);
            let changed = value + self.shift[i] * (1.0 - factor) + self.lit[i] * factor * direct;
            let kept = changed.max(0.0).min(255.0);
            values[i] = kept.whole_bits() as u8;
            clipped[i] += u32::from(!(-0.5..255.5).contains(&changed));
        }
    }
}

/// Changes one row.
struct Row<'a, S> {
    relit: &'a Relit,
    row: &'a mut [u8],
    depths: &'a [S],
    /// 1 - w of each pixel, in shares of [`WHOLE`].
    left: &'a [u16],
}

impl<S: Stepped> Work for Row<'_, S> {
    type Output = [u64; 3];

    #[inline(always)]
    fn run(self) -> [u64; 3] {
        let Self { relit, row, depths, left } = self;
        let mut factors = [0; 3 * BLOCK + 1];
        let mut clipped = [0; PERIOD];
        let blocks = row.chunks_mut(3 * BLOCK).zip(depths.chunks(BLOCK).zip(left.chunks(BLOCK)));
        for (values, (depths, left)) in blocks {
            for (i, (&depth, &left)) in depths.iter().zip(left).enumerate() {
                // The fourth is overwritten by the next pixel.
                let of_things = relit.factors[depth.place()];
                let factor = of_things.map(|factor| ((u32::from(factor) * u32::from(left)) >> 15) as u16);
                factors[3 * i..3 * i + 4].copy_from_slice(&factor);
            }
            let (turns, rest) = values.as_chunks_mut::<PERIOD>();
            let of_turns = factors.as_chunks::<PERIOD>().0;
            for (values, factors) in turns.iter_mut().zip(of_turns) {
                relit.change(values, factors, &mut clipped);
            }
            if !rest.is_empty() {
                let (mut last, mut of_last) = ([0; PERIOD], [FACTOR as u16; PERIOD]);
                last[..rest.len()].copy_from_slice(rest);
                of_last[..rest.len()].copy_from_slice(&factors[PERIOD * turns.len()..][..rest.len()]);
                relit.change(&mut last, &of_last, &mut clipped);
                rest.copy_from_slice(&last[..rest.len()]);
            }
        }
        let mut by_channel = [0; 3];
        for (i, &count) in clipped.iter().enumerate() {
            by_channel[i % 3] += u64::from(count);
        }
        by_channel
    }
}
