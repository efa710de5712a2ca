//! The colour of near things: what a scene is lit by, as far as an image shows it.

use super::statistics::Statistics;
use crate::image::Encoding;

/// Share of the pixels that count as near: there the water hides least.
const NEAR: f64 = 0.3;
/// The darkest colour (encoded): a darker one is noise.
const DARKEST: f32 = 0.01;

/// The mean colour of the nearest pixels; none where nothing was counted.
pub(super) fn of<E: Encoding>(statistics: &Statistics<E>) -> Option<[f32; 3]> {
    let all: u64 = statistics.bins.iter().map(|bin| bin.count).sum();
    let enough = (NEAR * all as f64).ceil() as u64;
    let (mut count, mut sum) = (0, [0.0_f64; 3]);
    for bin in &statistics.bins {
        if count >= enough {
            break;
        }
        for (c, sum) in sum.iter_mut().enumerate() {
            *sum += f64::from(bin.mean(c)) * bin.count as f64;
        }
        count += bin.count;
    }
    let darkest = E::from_encoded(DARKEST);
    (count > 0).then(|| sum.map(|sum| ((sum / count as f64) as f32).max(darkest)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::Quantised;
    use crate::image::{Encoded, Image, Linear};

    /// The near half of one colour and the far half of another.
    fn statistics<E: Encoding>(near: [u8; 3], far: [u8; 3]) -> Statistics<E> {
        let samples = [near, far].into_iter().flat_map(|colour| [colour; 100]).flatten().collect();
        let levels: Vec<u8> = (0..200).map(|i| if i < 100 { 10 } else { 200 }).collect();
        let image = Image::<u8>::from_raw(200, 1, samples).unwrap();
        let depth = Quantised { levels: levels.into(), step: 1.0, beyond: None };
        Statistics::of_all(image.view(), &depth)
    }

    #[test]
    fn only_what_is_near_counts() {
        let near = of(&statistics::<Encoded>([51, 102, 0], [255, 0, 7])).unwrap();
        for (found, expected) in near.into_iter().zip([0.2, 0.4, 0.01]) {
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
        let linear = of(&statistics::<Linear>([51, 102, 0], [255, 0, 7])).unwrap();
        assert!((linear[1] - Linear::from_encoded(0.4)).abs() < 1e-5);
    }
}
