//! Gray world: the mean colour is taken for that of the light.

use aquafuse::image::Image;

use super::monge_kantorovich::Moments;
use super::unit;

pub(super) fn transfer(content: &Image<u8>, own: &Moments, other: &Moments) -> Vec<[f32; 3]> {
    // A channel without light has no gain.
    let gain = |c: usize| if own.mean[c] > 0.0 { other.mean[c] / own.mean[c] } else { 1.0 };
    let gains: [f64; 3] = std::array::from_fn(gain);
    let changed = |pixel: &[u8; 3]| {
        let rgb = unit(pixel);
        std::array::from_fn(|c| (rgb[c] * gains[c]) as f32)
    };
    content.pixels().iter().map(changed).collect()
}
