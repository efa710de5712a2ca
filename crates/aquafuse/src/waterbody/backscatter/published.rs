//! The paper's way: the darkest pixels stand for black.

use crate::image::Encoding;
use crate::waterbody::Seen;

/// Share of the image that is taken for black. The paper says 1-5 %; fewest are blackest.
const DARKEST: f64 = 0.01;
/// Residuals beyond this (encoded) count linearly.
const NOISE: f32 = 0.03;

/// ln(β_B z95) per channel: of `taus`, the one whose curve `B∞ (1 - e^(-τ z))` is nearest to the darkest 1 % of
/// the whole image, robustly.
///
/// `z` is what each level of depth is in units of z95; levels without one are left out.
pub(super) fn optical_depth<E: Encoding>(
    seen: Seen<'_>,
    z: &[Option<f32>; 256],
    veil: [f32; 3],
    taus: &[f32],
) -> [f32; 3] {
    let brightness = |pixel: &[u8; 3]| pixel.iter().map(|&value| usize::from(value)).sum::<usize>();
    let mut counts = [0_u64; 3 * 255 + 1];
    for (pixel, level) in seen.pixels() {
        if z[usize::from(level)].is_some() {
            counts[brightness(pixel)] += 1;
        }
    }
    let wanted = DARKEST * counts.iter().sum::<u64>() as f64;
    let mut passed = 0;
    let darkest = counts.iter().position(|count| {
        passed += count;
        passed as f64 >= wanted
    });
    let darkest = darkest.unwrap_or(0);
    // Sums a level: pixels of one depth share one point of the curve.
    let mut sums = [(0_u64, [0_u64; 3]); 256];
    for (pixel, level) in seen.pixels() {
        if z[usize::from(level)].is_some() && brightness(pixel) <= darkest {
            let (count, values) = &mut sums[usize::from(level)];
            *count += 1;
            (0..3).for_each(|c| values[c] += u64::from(pixel[c]));
        }
    }
    let noise = E::from_encoded(NOISE);
    std::array::from_fn(|c| {
        let cost = |ln_tau: f32| -> f32 {
            let of_level = |(z, (count, values)): (&Option<f32>, &(u64, [u64; 3]))| {
                let (Some(z), true) = (z, *count > 0) else { return 0.0 };
                let mean = E::from_encoded(values[c] as f32 / *count as f32 / 255.0);
                let off = ((veil[c] * (1.0 - (-ln_tau.exp() * z).exp()) - mean) / noise).abs();
                *count as f32 * if off <= 1.0 { 0.5 * off * off } else { off - 0.5 }
            };
            z.iter().zip(&sums).map(of_level).sum()
        };
        let costs = taus.iter().map(|&ln_tau| (ln_tau, cost(ln_tau)));
        costs.min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0.0, |(ln_tau, _)| ln_tau)
    })
}
