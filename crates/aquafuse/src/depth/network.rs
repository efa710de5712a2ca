//! Depth as a network sees it: a coarse map of distances, brought to the pixels of the image.

use crate::fuser::on_bytes;
use crate::image::{ImageRef, Sample, TopEdge};
use crate::network::Sight;

/// z of the farthest things; open water is at 1.
const FARTHEST: f32 = 0.8;
/// This part of the things may be farther than the farthest, and is then as far: a few odd places must not set the scale.
const CUT: f32 = 0.02;
/// A place with a larger share of water is no thing to measure by.
const WATER: f32 = 0.5;
/// One in weights held as whole numbers.
const ONE: u32 = 256;

/// The level of each pixel of an image whose edge `top` is up.
pub(super) fn levels<T: Sample>(image: ImageRef<'_, T>, top: TopEdge) -> Vec<u8> {
    let sight = on_bytes(image, |bytes| Sight::of(bytes, top));
    doubled(&relative(&sight), sight.size(), image.size())
}

/// z of each place, in `[0, 1]`, in steps of 1/65535.
fn relative(sight: &Sight) -> Vec<u32> {
    let (water, distances) = (sight.water(), sight.distances());
    let is_thing = |&(share, _): &(&f32, &f32)| *share < WATER;
    let mut things: Vec<f32> = water.iter().zip(&distances).filter(is_thing).map(|(_, z)| *z).collect();
    things.sort_by(f32::total_cmp);
    let farthest = things.len().checked_sub(1).map(|last| things[((1.0 - CUT) * last as f32) as usize]);
    let z = |(share, distance): (&f32, &f32)| {
        let thing = farthest.map_or(1.0, |farthest| FARTHEST * (distance / farthest).min(1.0));
        (65_535.0 * (share + (1.0 - share) * thing).clamp(0.0, 1.0) + 0.5) as u32
    };
    water.iter().zip(&distances).map(z).collect()
}

/// Values of a coarse map at the pixels of an image, as levels, by straight lines between the middles of places. Weights are whole
/// numbers, the same from both sides.
fn doubled(values: &[u32], (columns, rows): (usize, usize), (width, height): (usize, usize)) -> Vec<u8> {
    let across: Vec<Beside> = (0..width).map(|x| Beside::new(x, width, columns)).collect();
    let mut levels = Vec::with_capacity(width * height);
    let mut line = vec![0; columns];
    for y in 0..height {
        let down = Beside::new(y, height, rows);
        let [above, below] = down.places.map(|row| &values[row * columns..][..columns]);
        for ((value, above), below) in line.iter_mut().zip(above).zip(below) {
            *value = (down.weights[0] * above + down.weights[1] * below) / ONE;
        }
        levels.extend(across.iter().map(|beside| {
            let [left, right] = beside.places.map(|place| line[place]);
            let value = (beside.weights[0] * left + beside.weights[1] * right) / ONE;
            ((value + 128) / 257) as u8
        }));
    }
    levels
}

/// The places on both sides of a pixel, and their weights.
struct Beside {
    places: [usize; 2],
    weights: [u32; 2],
}

impl Beside {
    fn new(pixel: usize, pixels: usize, places: usize) -> Self {
        // Twice the distance of the middles of the pixel and of the first place, in pixels times places.
        let from_first = ((2 * pixel + 1) * places).saturating_sub(pixels);
        let before = (from_first / (2 * pixels)).min(places - 1);
        let (past, step) = (from_first - 2 * pixels * before, 2 * pixels);
        let part = |of: usize| (ONE as usize * of / step) as u32;
        let after = if 2 * past <= step { part(past) } else { ONE - part(step - past) };
        Self { places: [before, (before + 1).min(places - 1)], weights: [ONE - after, after] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::DepthModel;
    use crate::image::Image;
    use crate::metrics::spearman;
    use crate::truth::{OPEN_WATER, Scene, Size, waters};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_mirrored_map_is_the_mirror_image(width in 1..200_usize, columns in 1..70_usize) {
            let values: Vec<u32> = (0..columns).map(|i| (i * 9973 % 65536) as u32).collect();
            let own = doubled(&values, (columns, 1), (width, 1));
            let mirrored: Vec<u32> = values.iter().rev().copied().collect();
            let mut other = doubled(&mirrored, (columns, 1), (width, 1));
            other.reverse();
            prop_assert_eq!(own, other);
        }

        #[test]
        fn no_level_leaves_the_range_of_its_map(width in 1..60_usize, height in 1..60_usize, value in 0..65536_u32) {
            let levels = doubled(&[value; 20], (5, 4), (width, height));
            prop_assert!(levels.iter().all(|level| (i64::from(*level) * 257 - i64::from(value)).abs() <= 130));
        }
    }

    #[test]
    fn things_of_truth_scenes_are_ordered_by_distance() {
        let mut mean = 0.0;
        for number in 400..410 {
            let scene = Scene::new(number, Size { width: 160, height: 120 });
            let image: Image<u8> = scene.seen_through(&waters()[number as usize % 5].water).convert();
            let found = DepthModel::Network.estimate(&image).distances();
            let true_z = scene.depth.distances();
            let things: Vec<usize> = (0..true_z.len()).filter(|&i| true_z[i] < OPEN_WATER).collect();
            let of = |z: &[f32]| things.iter().map(|&i| z[i]).collect::<Vec<f32>>();
            mean += spearman(&of(&found), &of(&true_z)).unwrap() / 10.0;
        }
        assert!(mean > 0.8, "{mean}");
    }
}
