//! Places lit by their own water: light fades and changes colour on its way down, before any of it is seen through the water.

use super::{Trials, place_of, scaled};
use crate::depth::DepthMap;
use crate::formation::form;
use crate::image::{Encoded, Encoding, Image, Linear};
use crate::truth::noise::Random;
use crate::waterbody::Waterbody;
use crate::waterbody::presets::{Conditions, Preset, White, sea};

/// Numbers of scenes that nothing else uses.
const CONTENTS: usize = 5000;
const REFERENCES: usize = 7000;
/// The first number of the waters of [`LitWaters::Sea`].
const SEA: u32 = 1_000_000;
/// Veils that differ by less in every channel of the image are one water to the eye.
const ANOTHER_WATER: f32 = 0.2;
/// How far below the surface, metres.
const DEPTHS: [f32; 2] = [1.0, 20.0];
/// The encoded luma that the brightest fiftieth of an image exceeds.
const LEVELS: [f32; 2] = [0.6, 0.95];
const BRIGHTEST: f32 = 0.02;

/// Which waters places are lit by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum LitWaters {
    /// The ten types of Jerlov, 1 to 20 m below the surface.
    #[default]
    Jerlov,
    /// Waters as [`sea`] draws them, none of which is drawn by a number below 1,000,000; the camera stores JPEG.
    Sea,
}

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
    /// The quality at which the camera stores JPEG, 60 to 95; `None`: it stores every value.
    pub jpeg_quality: Option<u8>,
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
#[derive(Clone, Debug)]
pub(in crate::truth) struct LitSite {
    water: Waterbody<Linear>,
    /// What a white diffuser shows.
    white: [f32; 3],
    camera: Camera,
}

/// A camera that exposes and balances itself.
#[derive(Clone, Debug)]
struct Camera {
    /// The encoded luma that the brightest pixels reach.
    level: f32,
    /// How far it balances: 0 not at all, 1 until the image is grey.
    balance: f32,
    /// Deviation of its noise, encoded.
    noise: f32,
}

impl Trials {
    /// The lit exchange of this number, in Jerlov's waters.
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
        self.lit_exchange_in(LitWaters::Jerlov, number)
    }

    /// The lit exchange of this number in other waters. Its images are not compressed yet: `jpeg_quality` says how the camera
    /// stores them.
    pub fn lit_exchange_in(&self, waters: LitWaters, number: usize) -> LitExchange {
        let (content, _, of_content) = self.lit(waters, CONTENTS + number);
        let mut other = REFERENCES + number;
        loop {
            let elsewhere = place_of(other) != place_of(CONTENTS + number);
            let (reference, there, of_reference) = self.lit(waters, other);
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
    fn lit(&self, waters: LitWaters, number: usize) -> (LitCase, LitSite, [f32; 3]) {
        let mut chance = Random::of_state(1 + number as u64);
        let (site, jpeg_quality) = match waters {
            LitWaters::Jerlov => (LitSite::draw(&mut chance), None),
            LitWaters::Sea => {
                let quality = 60 + chance.below(36) as u8;
                (LitSite::of_sea(SEA + number as u32, &mut chance), Some(quality))
            }
        };
        let depth = scaled(&self.place(number).depth, &site.water, &mut chance);
        let seen = self.through(number, &depth, &site);
        let (shown, gains) = site.camera.shows(&seen);
        let veil = site.water.veiling_light.rgb();
        let veil = std::array::from_fn(|c| Linear::to_encoded((gains[c] * veil[c]).min(1.0)));
        let image = site.camera.noisy(&shown, &mut chance);
        let open = self.is_open(number);
        (LitCase { depth, image, open, jpeg_quality }, site, veil)
    }

    /// The place of this number in the light and the water of a site.
    fn through(&self, number: usize, depth: &DepthMap, site: &LitSite) -> Image<f32, Linear> {
        site.seen(&self.place(number).clear, depth)
    }
}

impl LitSite {
    /// What is seen of a clear place in this light and through this water.
    fn seen(&self, clear: &Image<f32>, depth: &DepthMap) -> Image<f32, Linear> {
        let lit = clear.pixels().iter().flat_map(|pixel| {
            let clear = pixel.map(Linear::from_encoded);
            std::array::from_fn::<f32, 3, _>(|c| self.white[c] * clear[c])
        });
        let lit = Image::from_raw(clear.width(), clear.height(), lit.collect()).expect("one colour a pixel");
        form(&lit, depth, &self.water).expect("one size")
    }

    /// The same as its camera stores it, with its noise.
    pub(in crate::truth) fn photographed(
        &self,
        clear: &Image<f32>,
        depth: &DepthMap,
        chance: &mut Random,
    ) -> Image<u8> {
        let (shown, _) = self.camera.shows(&self.seen(clear, depth));
        self.camera.noisy(&shown, chance)
    }

    /// β_B of green, per metre.
    pub(in crate::truth) fn backscatter(&self) -> f32 {
        self.water.backscatter_coefficient[1]
    }

    /// Another exposure by the same camera.
    pub(in crate::truth) fn expose_again(&mut self, chance: &mut Random) {
        self.camera.level = chance.between(LEVELS[0], LEVELS[1]);
    }

    /// The water of this number among those that [`sea`] draws; exposure and noise are drawn here.
    pub(in crate::truth) fn of_sea(number: u32, chance: &mut Random) -> Self {
        let (preset, conditions) = sea(number);
        let balance = conditions.balance() as f32;
        // The camera below exposes: what is formed is light.
        let conditions = conditions.with_white(White::AtSurface);
        let derived = preset.derive::<Linear>(&conditions);
        let camera = Camera {
            level: chance.between(LEVELS[0], LEVELS[1]),
            balance,
            noise: chance.between(0.0, 3.0) / 255.0,
        };
        Self { water: derived.water, white: derived.white, camera }
    }

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
    /// Bytes, with its noise.
    fn noisy(&self, shown: &Image<f32>, chance: &mut Random) -> Image<u8> {
        let noisy = shown.as_raw().iter().map(|&value| value + self.noise * chance.normal());
        let image: Image<f32> =
            Image::from_raw(shown.width(), shown.height(), noisy.collect()).expect("one colour a pixel");
        image.convert()
    }

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
