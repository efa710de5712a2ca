//! How far a score might have been another, had the image shown a little more of this and less of that.

use std::collections::BTreeMap;

use aquafuse::metrics::spearman;

use crate::pairs::Pair;

/// Images made of an image's tiles.
pub(crate) const RESAMPLES: usize = 200;
/// Tiles along the width and the height. Neighbouring pixels say the same thing, so whole tiles are drawn; a
/// image must keep enough of them to draw from.
const TILES: [usize; 2] = [8, 6];
/// One pixel of a square of this side stands for it: ranks of a sixteenth are as good, and sixteen times as fast.
const THINNED: usize = 4;

/// Scores of images made of this image's tiles, drawn with replacement; the same ones each time.
pub(crate) fn resampled(pair: &Pair, estimated: &[f32], metres: &[f32]) -> Vec<f64> {
    let (width, height) = pair.image.size();
    let mut tiles: BTreeMap<usize, Vec<(f32, f32)>> = BTreeMap::new();
    for (i, place) in pair.measured.iter().enumerate() {
        let (x, y) = (place % width, place / width);
        if x % THINNED == 0 && y % THINNED == 0 {
            let tile = y * TILES[1] / height * TILES[0] + x * TILES[0] / width;
            tiles.entry(tile).or_default().push((estimated[i], metres[i]));
        }
    }
    let tiles: Vec<_> = tiles.into_values().collect();
    let mut chance = SplitMix(7);
    let mut score = || {
        let drawn = (0..tiles.len()).flat_map(|_| &tiles[chance.below(tiles.len())]);
        let (estimated, metres): (Vec<f32>, Vec<f32>) = drawn.copied().unzip();
        spearman(&estimated, &metres).unwrap_or_default()
    };
    (0..RESAMPLES).map(|_| score()).collect()
}

/// The middle 90 % of scores.
pub(crate) fn interval(mut scores: Vec<f64>) -> [f64; 2] {
    scores.sort_by(f64::total_cmp);
    [0.05, 0.95].map(|share| scores[(share * (scores.len() - 1) as f64).round() as usize])
}

/// SplitMix64: enough chance for a bootstrap, and no dependency.
struct SplitMix(u64);

impl SplitMix {
    fn below(&mut self, end: usize) -> usize {
        (aquafuse::random::split_mix(&mut self.0) % end as u64) as usize
    }
}
