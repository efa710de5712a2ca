//! Places lit by their own water: light fades and changes colour on its way down, before any of it is seen through the water.

use super::{SIZE, Trials, place_of, scaled};
use crate::depth::DepthMap;
use crate::formation::form;
use crate::image::{Encoded, Encoding, Image, Linear};
use crate::truth::noise::Random;
use crate::waterbody::Waterbody;
use crate::waterbody::presets::{Conditions, Preset, White};

/// Numbers of scenes that nothing else uses.
const CONTENTS: usize = 5000;
const REFERENCES: usize = 7000;
/// Veils that differ by less in every channel of the image are one water to the eye.
const ANOTHER_WATER: f32 = 0.2;
/// How far below the surface, metres.
const DEPTHS: [f32; 2] = [1.0, 20.0];
/// The encoded luma that the brightest fiftieth of an image exceeds.
const LEVELS: [f32; 2] = [0.6, 0.95];
const BRIGHTEST: f32 = 0.02;

/// A place lit by its own water, as a camera shows it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LitCase {
    /// z, in metres.
    pub depth: DepthMap,
    /// As a camera stores it: exposed, balanced, encoded, with its noise.
    pub image: Image<u8>,
    /// Whether open water is in view.
    pub open: bool,
}

/// A content, and a reference in another water with another light.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LitExchange {
    /// The place that is to be seen in another water.
    pub content: LitCase,
    /// Another place, in that water.
    pub reference: LitCase,
    /// Truth C: the content's place in the reference's water and its light, by the reference's camera.
    pub truth: Image<f32>,
}

impl LitExchange {
    /// Whether open water is in view in both.
    pub fn open(&self) -> bool {
        self.content.open && self.reference.open
    }
}

/// A water with its light, and the camera there.
struct Site {
    water: Waterbody<Linear>,
    /// What a white diffuser shows.
    white: [f32; 3],
    camera: Camera,
}

/// A camera that exposes and balances itself.
struct Camera {
    /// The encoded luma that the brightest pixels reach.
    level: f32,
    /// How far it balances: 0 not at all, 1 until the image is grey.
    balance: f32,
    /// Deviation of its noise, encoded.
    noise: f32,
}

impl Trials {
    /// The lit exchange of this number.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::truth::Trials;
    ///
    /// let exchange = Trials::default().lit_exchange(0);
    /// assert_eq!(exchange.truth.size(), exchange.content.image.size());
    /// ```
    pub fn lit_exchange(&self, number: usize) -> LitExchange {
        let (content, _, of_content) = self.lit(CONTENTS + number);
        let mut other = REFERENCES + number;
        loop {
            let elsewhere = place_of(other) != place_of(CONTENTS + number);
            let (reference, there, of_reference) = self.lit(other);
            let differ = |c: usize| (of_content[c] - of_reference[c]).abs();
            if elsewhere && (0..3).any(|c| differ(c) >= ANOTHER_WATER) {
                let seen = self.through(CONTENTS + number, &content.depth, &there);
                let truth = there.camera.shows(&seen).0;
                return LitExchange { content, reference, truth };
            }
            other += 2;
        }
    }

    /// A case, its site, and the veil as its camera shows it.
    fn lit(&self, number: usize) -> (LitCase, Site, [f32; 3]) {
        let mut chance = Random::of_state(1 + number as u64);
        let site = Site::draw(&mut chance);
        let depth = scaled(&self.place(number).depth, &site.water, &mut chance);
        let seen = self.through(number, &depth, &site);
        let (shown, gains) = site.camera.shows(&seen);
        let veil = site.water.veiling_light.rgb();
        let veil = std::array::from_fn(|c| Linear::to_encoded((gains[c] * veil[c]).min(1.0)));
        let noisy = shown.as_raw().iter().map(|&value| value + site.camera.noise * chance.normal());
        let image: Image<f32> =
            Image::from_raw(SIZE.width, SIZE.height, noisy.collect()).expect("one colour a pixel");
        let open = place_of(number).is_multiple_of(2);
        (LitCase { depth, image: image.convert(), open }, site, veil)
    }

    /// The place of this number in the light and the water of a site.
    fn through(&self, number: usize, depth: &DepthMap, site: &Site) -> Image<f32, Linear> {
        let lit = self.place(number).clear.pixels().iter().flat_map(|pixel| {
            let clear = pixel.map(Linear::from_encoded);
            std::array::from_fn::<f32, 3, _>(|c| site.white[c] * clear[c])
        });
        let lit = Image::from_raw(SIZE.width, SIZE.height, lit.collect()).expect("one colour a pixel");
        form(&lit, depth, &site.water).expect("one size")
    }
}

impl Site {
    fn draw(chance: &mut Random) -> Self {
        let preset = Preset::ALL[chance.below(Preset::ALL.len())];
        let [shallow, deep] = DEPTHS.map(f32::ln);
        let metres = f64::from(chance.between(shallow, deep).exp());
        let conditions = Conditions::default().with_white(White::AtSurface);
        let conditions = conditions.with_depth_below_surface(metres).expect("in range");
        let derived = preset.derive::<Linear>(&conditions);
        Self {
            water: derived.water,
            white: derived.white,
            camera: Camera {
                level: chance.between(LEVELS[0], LEVELS[1]),
                balance: chance.between(0.0, 1.0),
                noise: chance.between(0.0, 3.0) / 255.0,
            },
        }
    }
}

impl Camera {
    /// What it shows of a scene, without its noise, and the gains it takes.
    fn shows(&self, seen: &Image<f32, Linear>) -> (Image<f32>, [f32; 3]) {
        let pixels = seen.pixels();
        let mean = |c: usize| pixels.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() as f32;
        let means: [f32; 3] = std::array::from_fn(mean);
        let grey = means.iter().sum::<f32>() / 3.0;
        let balanced = means.map(|mean| (grey / mean.max(1e-3 * grey)).powf(self.balance));
        let luma = |pixel: &[f32; 3]| {
            0.2126 * balanced[0] * pixel[0]
                + 0.7152 * balanced[1] * pixel[1]
                + 0.0722 * balanced[2] * pixel[2]
        };
        let mut lumas: Vec<f32> = pixels.iter().map(luma).collect();
        lumas.sort_by(f32::total_cmp);
        let bright = lumas[((1.0 - BRIGHTEST) * (lumas.len() - 1) as f32) as usize];
        let exposure = Linear::from_encoded(self.level) / bright.max(1e-6);
        let gains = balanced.map(|gain| exposure * gain);
        let shown = pixels.iter().flat_map(|pixel| {
            std::array::from_fn::<f32, 3, _>(|c| Linear::to_encoded((gains[c] * pixel[c]).clamp(0.0, 1.0)))
        });
        let shown = Image::<f32, Encoded>::from_raw(seen.width(), seen.height(), shown.collect());
        (shown.expect("one colour a pixel"), gains)
    }
}
