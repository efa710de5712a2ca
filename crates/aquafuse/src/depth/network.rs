//! Depth as a network sees it, beside Eq. 3: the mean of their orders of what is farther.
//!
//! The network looks at shapes and at the whole, Eq. 3 at the colour of a pixel. Each is wrong where the other is not: the network where
//! a camera is turned, Eq. 3 where red is dead or a thing is blue.

use super::DepthModel;
use crate::fuser::on_bytes;
use crate::image::{ImageRef, Sample, TopEdge};
use crate::network::Sight;

/// z of the farthest things; open water is at 1.
const FARTHEST: f32 = 0.8;
/// A place with a larger share of water, in steps of 1/255, is no thing to be put in order.
const WATER: u8 = 127;
/// One in weights held as whole numbers.
const ONE: u32 = 256;

/// The level of each pixel of an image whose edge `top` is up: `z = w + .8 (1 - w) (r + c) / 2`, r and c the parts of all things that
/// are nearer by the network and by Eq. 3, w the share of open water by the network.
pub(super) fn levels<T: Sample>(image: ImageRef<'_, T>, top: TopEdge) -> Vec<u8> {
    let sight = on_bytes(image, |bytes| Sight::of(bytes, top));
    let by_colour = DepthModel::default().levels(image, top);
    let on_pixels = |values: &[u32]| doubled(values, sight.size(), image.size());
    let water =
        on_pixels(&sight.water().iter().map(|share| (65_535.0 * share + 0.5) as u32).collect::<Vec<_>>());
    let by_shape = on_pixels(&spread(&sight.distances()));
    let order = |levels: &[u8]| {
        let mut counts = [0_u64; 256];
        levels
            .iter()
            .zip(&water)
            .filter(|(_, water)| **water <= WATER)
            .for_each(|(level, _)| counts[usize::from(*level)] += 1);
        ranks(&counts)
    };
    let (shape, colour) = (order(&by_shape), order(&by_colour));
    let z = |((shape_level, colour_level), water): ((&u8, &u8), &u8)| {
        let thing = 0.5 * FARTHEST * (shape[usize::from(*shape_level)] + colour[usize::from(*colour_level)]);
        let share = f32::from(*water) / 255.0;
        (255.0 * (share + (1.0 - share) * thing) + 0.5) as u8
    };
    by_shape.iter().zip(&by_colour).zip(&water).map(z).collect()
}

/// The logarithms of distances, spread from 0 to 65535.
fn spread(distances: &[f32]) -> Vec<u32> {
    let ends =
        distances.iter().fold([f32::MAX, 0.0], |[low, high], z| [low.min(*z), high.max(*z)]).map(f32::ln);
    let scale = 65_535.0 / (ends[1] - ends[0]).max(1e-3);
    distances.iter().map(|z| (scale * (z.ln() - ends[0])) as u32).collect()
}

/// The part of all counts that lies below each level, half of its own with it.
fn ranks(counts: &[u64; 256]) -> [f32; 256] {
    let all = counts.iter().sum::<u64>().max(1) as f64;
    let mut below = 0.0;
    counts.map(|count| {
        below += count as f64;
        ((below - 0.5 * count as f64) / all) as f32
    })
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
