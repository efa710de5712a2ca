//! Histogram matching: each channel is given the reference's distribution.

use aquafuse::image::Image;

/// Of each channel, the share of the pixels that do not exceed each value; values that occur only.
#[derive(Clone, Debug)]
pub(super) struct Ranks([Vec<(u8, f64)>; 3]);

impl Ranks {
    pub(super) fn of(image: &Image<u8>) -> Self {
        let mut counts = [[0_u64; 256]; 3];
        for pixel in image.pixels() {
            (0..3).for_each(|c| counts[c][usize::from(pixel[c])] += 1);
        }
        let all = image.pixels().len() as f64;
        Self(counts.map(|counts| {
            let mut seen = 0;
            let occurring = (0..=255_u8).zip(counts).filter(|(_, count)| *count > 0);
            let share = |(value, count): (u8, u64)| {
                seen += count;
                (value, seen as f64 / all)
            };
            occurring.map(share).collect()
        }))
    }
}

/// As `skimage.exposure.match_histograms`: between two shares of the reference its values are interpolated.
pub(super) fn transfer(content: &Image<u8>, own: &Ranks, other: &Ranks) -> Vec<[f32; 3]> {
    let mut tables = [[0.0; 256]; 3];
    for c in 0..3 {
        for &(value, share) in &own.0[c] {
            tables[c][usize::from(value)] = (value_at(&other.0[c], share) / 255.0) as f32;
        }
    }
    let of = |pixel: &[u8; 3]| std::array::from_fn(|c| tables[c][usize::from(pixel[c])]);
    content.pixels().iter().map(of).collect()
}

/// The value at a share of the pixels; shares below the least value's have that value.
fn value_at(ranks: &[(u8, f64)], share: f64) -> f64 {
    let above = ranks.partition_point(|(_, rank)| *rank < share);
    let (value, rank) = ranks.get(above).copied().unwrap_or(ranks[ranks.len() - 1]);
    let Some((below, rank_below)) = above.checked_sub(1).map(|below| ranks[below]) else {
        return f64::from(value);
    };
    if rank_below >= rank {
        return f64::from(value);
    }
    let part = ((share - rank_below) / (rank - rank_below)).min(1.0);
    f64::from(below) + part * (f64::from(value) - f64::from(below))
}
