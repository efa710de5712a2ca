//! Random truth scenes, kept apart from those on which constants are chosen: harbours in Jerlov's waters.
//!
//! Constants of the estimators are chosen on reefs in synthetic waters; what is tried here shares neither.

mod exchange;
mod lit;

use std::sync::OnceLock;

use super::noise::Random;
use super::{Gaze, OPEN_WATER, Scene, Site, Size, View};
use crate::depth::{DepthKind, DepthMap};
use crate::formation::form;
use crate::image::{Encoding, Image};
use crate::waterbody::Waterbody;
use crate::waterbody::presets::{Conditions, Preset};

pub use exchange::Exchange;
pub(super) use lit::LitSite;
pub use lit::{LitCase, LitExchange, LitWaters};

const SIZE: Size = Size { width: 240, height: 160 };
/// Different places; each is seen in several waters.
const PLACES: usize = 100;
/// Seeds of places that nothing else uses.
const FIRST_SEED: u64 = 70_000;
/// Black pixels fewer than this share of the image are too few dark pixels: a cause to fail.
const ENOUGH_BLACK: f32 = 0.01;
/// A red veil fainter than this (encoded), with the direct red of a white thing gone at z95, is dead red.
const DEAD_VEIL: f32 = 0.02;

/// Numbered random scenes to try estimators and fusion on: the same numbers give the same pixels on every machine.
///
/// Harbours unless asked for other places, half of them with open water in view, in the ten waters of Jerlov, as a camera stores them.
///
/// # Examples
///
/// ```
/// use aquafuse::image::Encoded;
/// use aquafuse::truth::Trials;
///
/// let trials = Trials::default();
/// let exchange = trials.exchange::<Encoded>(0);
/// // The truth is another image than the content, of the same place.
/// assert_eq!(exchange.truths[0].size(), exchange.content.image.size());
/// assert_ne!(exchange.truths[0], exchange.content.image.to_unit());
/// ```
#[derive(Debug)]
pub struct Trials {
    site: Site,
    /// Places, each made once: even numbers look ahead, odd ones down.
    places: [OnceLock<Scene>; PLACES],
}

impl Default for Trials {
    fn default() -> Self {
        Self::at(Site::Harbour)
    }
}

/// One image of known truth.
#[derive(Clone, Debug)]
pub struct Case<E: Encoding> {
    /// I, the place as seen through air.
    pub clear: Image<f32, E>,
    /// z, in metres.
    pub depth: DepthMap,
    /// The water it is seen through, per metre.
    pub water: Waterbody<E>,
    /// As a camera stores it: encoded bytes, with its noise.
    pub image: Image<u8>,
    /// Whether open water is in view.
    pub open: bool,
    /// By construction: open water in view, enough that is black, red alive.
    pub clean: bool,
}

/// Which of the places the scene of this number shows.
fn place_of(number: usize) -> usize {
    number % PLACES
}

impl Trials {
    /// Scenes of one family of places.
    pub fn at(site: Site) -> Self {
        Self { site, places: [const { OnceLock::new() }; PLACES] }
    }

    /// Whether open water is in view of the scene of this number.
    fn is_open(&self, number: usize) -> bool {
        self.site == Site::OpenWater || place_of(number).is_multiple_of(2)
    }

    fn place(&self, number: usize) -> &Scene {
        let number = place_of(number);
        self.places[number].get_or_init(|| {
            let gaze = if number.is_multiple_of(2) { Gaze::Ahead } else { Gaze::Down };
            Scene::of(View { site: self.site, gaze }, FIRST_SEED + number as u64, SIZE)
        })
    }

    /// The scene of this number, formed in encoding `E`.
    pub fn case<E: Encoding>(&self, number: usize) -> Case<E> {
        Case::new(self.place(number), number, self.is_open(number))
    }

    /// The exchange of this number: a content, and a reference in a water that differs to the eye.
    pub fn exchange<E: Encoding>(&self, number: usize) -> Exchange<E> {
        Exchange::new(self, number)
    }
}

impl<E: Encoding> Case<E> {
    fn new(place: &Scene, number: usize, open: bool) -> Self {
        let mut chance = Random::of_state(1 + number as u64);
        let preset = Preset::ALL[chance.below(Preset::ALL.len())];
        let conditions = Conditions::default();
        let conditions =
            conditions.with_depth_below_surface(f64::from(chance.between(1.0, 15.0))).expect("in range");
        let water: Waterbody<E> = preset.water(&conditions);
        let depth = scaled(&place.depth, &water, &mut chance);
        let black = [0.0, 0.01, 0.02, 0.03, 0.04, 0.05][chance.below(6)] * chance.between(0.7, 1.0);
        let (clear, black) = blackened(place, black, &mut chance);
        let clear = Image::from_raw(
            SIZE.width,
            SIZE.height,
            clear.into_iter().flatten().map(E::from_encoded).collect(),
        );
        let clear: Image<f32, E> = clear.expect("one colour a pixel");
        let image = photographed(&form(&clear, &depth, &water).expect("one size"), &mut chance);
        let z95 = depth_of_things(&depth);
        let [red, ..] = water.illumination(z95);
        let dead = E::to_encoded(water.veiling_light.rgb()[0]) < DEAD_VEIL && red < 0.05;
        Self { clear, depth, water, image, open, clean: open && black >= ENOUGH_BLACK && !dead }
    }
}

/// Distances stretched so that green's optical depth at the far end of things is .4 to 4: in the murkiest
/// waters one stands closer, or sees nothing.
fn scaled<E: Encoding>(depth: &DepthMap, water: &Waterbody<E>, chance: &mut Random) -> DepthMap {
    let wanted = chance.between(0.4_f32.ln(), 4.0_f32.ln()).exp();
    stretched(depth, SIZE, wanted / water.backscatter_coefficient[1])
}

/// Distances stretched so that the far end of things is this far away.
pub(super) fn stretched(depth: &DepthMap, size: Size, far: f32) -> DepthMap {
    let scale = far / depth_of_things(depth);
    let stretch = |z: f32| if z >= OPEN_WATER { OPEN_WATER.max(40.0 * scale) } else { z * scale };
    let distances = depth.distances().into_iter().map(stretch).collect();
    DepthMap::from_distances(size.width, size.height, DepthKind::Metres, distances).expect("finite distances")
}

/// z that 95 % of what is no open water does not exceed.
fn depth_of_things(depth: &DepthMap) -> f32 {
    let all = depth.distances();
    let farthest = all.iter().copied().fold(0.0, f32::max);
    let mut things: Vec<f32> = all.into_iter().filter(|&z| z < 0.98 * farthest.max(OPEN_WATER)).collect();
    things.sort_by(f32::total_cmp);
    things[things.len() * 95 / 100]
}

/// The clear colours with small black discs on things, and the share of the image they cover.
fn blackened(place: &Scene, share: f32, chance: &mut Random) -> (Vec<[f32; 3]>, f32) {
    let mut clear = place.clear.pixels().to_vec();
    let distances = place.depth.distances();
    let (width, height) = (SIZE.width as i32, SIZE.height as i32);
    let mut black = 0;
    while (black as f32) < share * clear.len() as f32 {
        let (x, y) = (chance.below(SIZE.width) as i32, chance.below(SIZE.height) as i32);
        let radius = chance.between(0.8, 3.2);
        for (dx, dy) in (-3..=3).flat_map(|dx| (-3..=3).map(move |dy| (dx, dy))) {
            let inside = (0..width).contains(&(x + dx)) && (0..height).contains(&(y + dy));
            if !inside || (dx * dx + dy * dy) as f32 > radius * radius {
                continue;
            }
            let place = ((y + dy) * width + x + dx) as usize;
            if distances[place] < OPEN_WATER && clear[place] != [0.0; 3] {
                clear[place] = [0.0; 3];
                black += 1;
            }
        }
    }
    let share = black as f32 / clear.len() as f32;
    (clear, share)
}

/// Bytes, with a camera's noise of up to 3 of them.
fn photographed<E: Encoding>(seen: &Image<f32, E>, chance: &mut Random) -> Image<u8> {
    let noise = chance.between(0.0, 3.0) / 255.0;
    let values = seen.as_raw().iter().map(|&value| E::to_encoded(value.max(0.0)) + noise * chance.normal());
    let image: Image<f32> =
        Image::from_raw(SIZE.width, SIZE.height, values.collect()).expect("one colour a pixel");
    image.convert()
}
