//! Waters by number for truth scenes, drawn as [`sea`](crate::waterbody::presets::sea) draws them, as thick as one sees things in.

use super::noise::Random;
use super::trials::{LitSite, stretched};
use super::{Scene, Size};
use crate::depth::DepthMap;
use crate::formation::form;
use crate::image::{Encoded, Image};
use crate::waterbody::Waterbody;
use crate::waterbody::presets::sea;

/// Green's optical depth at the far end of things, evenly in the logarithm.
const HAZES: [f32; 2] = [0.4, 4.0];
/// How many times as thick it is in one image as in another.
const PLACES: [f32; 2] = [0.8, 1.25];
/// From this optical depth a water is turbid: 14 % of the contrast of the farthest things are left.
const TURBID: f32 = 2.0;

/// A water by number, in which any scene can be seen: as it is, or lit by its own water.
///
/// # Examples
///
/// ```
/// use aquafuse::truth::{DrawnWater, Scene, Size};
///
/// let scene = Scene::new(7, Size { width: 48, height: 32 });
/// let water = DrawnWater::new(3);
/// assert_ne!(water.as_is(&scene, 0), water.lit(&scene, 0));
/// assert_eq!(water.lit(&scene, 0), DrawnWater::new(3).lit(&scene, 0));
/// ```
#[derive(Clone, Debug)]
pub struct DrawnWater {
    number: u32,
    water: Waterbody<Encoded>,
    site: LitSite,
    haze: f32,
}

impl DrawnWater {
    /// The water of this number.
    pub fn new(number: u32) -> Self {
        let (preset, conditions) = sea(number);
        let mut chance = Random::of_state(1 + u64::from(number));
        let [thin, thick] = HAZES.map(f32::ln);
        let haze = chance.between(thin, thick).exp();
        Self { number, water: preset.water(&conditions), site: LitSite::of_sea(number, &mut chance), haze }
    }

    /// Whether it is turbid: haze hides what is far.
    pub fn is_turbid(&self) -> bool {
        self.haze >= TURBID
    }

    /// A scene through it, lit by white light, formed in encoded values; `image` numbers the images taken.
    pub fn as_is(&self, scene: &Scene, image: u64) -> Image<u8> {
        let depth = self.depth(scene, self.water.backscatter_coefficient[1], &mut self.chance(image));
        form(&scene.clear, &depth, &self.water).expect("one size").convert()
    }

    /// A scene in its light and through it, formed in linear light, as a camera exposes, balances and encodes it, with its noise;
    /// `image` numbers the images taken.
    pub fn lit(&self, scene: &Scene, image: u64) -> Image<u8> {
        let mut chance = self.chance(image);
        let depth = self.depth(scene, self.site.backscatter(), &mut chance);
        let mut site = self.site.clone();
        site.expose_again(&mut chance);
        site.photographed(&scene.clear, &depth, &mut chance)
    }

    /// The quality at which a camera stores an image as JPEG, 60 to 95.
    pub fn jpeg_quality(&self, image: u64) -> u8 {
        60 + self.chance(!image).below(36) as u8
    }

    fn chance(&self, image: u64) -> Random {
        Random::new(image.wrapping_add(u64::from(self.number) << 32))
    }

    fn depth(&self, scene: &Scene, backscatter: f32, chance: &mut Random) -> DepthMap {
        let size = Size { width: scene.clear.width(), height: scene.clear.height() };
        let [less, more] = PLACES.map(f32::ln);
        stretched(&scene.depth, size, self.haze * chance.between(less, more).exp() / backscatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turbid_waters_leave_less_contrast() {
        let scene = Scene::new(3, Size { width: 60, height: 40 });
        let spread = |image: &Image<u8>| {
            let greens: Vec<f64> = image.pixels().iter().map(|pixel| f64::from(pixel[1])).collect();
            let mean = greens.iter().sum::<f64>() / greens.len() as f64;
            (greens.iter().map(|green| (green - mean).powi(2)).sum::<f64>() / greens.len() as f64).sqrt()
        };
        let mut sums = [[0.0; 2]; 2];
        for number in 0..60 {
            let water = DrawnWater::new(number);
            let sum = &mut sums[usize::from(water.is_turbid())];
            sum[0] += spread(&water.as_is(&scene, 0));
            sum[1] += 1.0;
        }
        assert!(sums[0][1] > 10.0 && sums[1][1] > 10.0, "{sums:?}");
        assert!(sums[1][0] / sums[1][1] < 0.8 * sums[0][0] / sums[0][1], "{sums:?}");
    }

    #[test]
    fn images_of_one_water_differ_and_their_quality_is_one() {
        let scene = Scene::new(3, Size { width: 60, height: 40 });
        let water = DrawnWater::new(9);
        assert_ne!(water.lit(&scene, 1), water.lit(&scene, 2));
        assert!((0..500).all(|image| (60..=95).contains(&water.jpeg_quality(image))));
    }
}
