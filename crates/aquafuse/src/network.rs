//! A tiny network of our own: how much of each place is open water, and how far things are.
//!
//! 140,000 weights, trained by `cargo lab train-network` on synthetic places in drawn waters alone; it never saw a photograph.
//! It looks at about 128 x 96 pixels of an image and says only *where* water is and what is farther; what an image then becomes is
//! computed in closed form. The same weights give the same bits on every thread and by all vector instructions.
//!
//! [`WaterMap::Network`](crate::waterbody::WaterMap::Network) and [`WaterMap::Both`](crate::waterbody::WaterMap::Both) read the share of water,
//! [`DepthModel::Network`](crate::depth::DepthModel::Network) the distances.

mod convolution;
mod input;
mod layers;
mod weights;

use std::sync::OnceLock;

use crate::bands;
use crate::image::{ImageRef, TopEdge};
use crate::simd::Level;
use input::{Small, Turn};
use layers::{Maps, add_doubled, halved};
use weights::{INPUTS, OUTPUTS, Weights};

/// What is kept of ln z and of the logit of a share: from the one to the other.
const RANGE: [f32; 2] = [-12.0, 12.0];
/// Steps of either over its range: sums of whole numbers do not depend on their order.
const STEPS: f32 = 65535.0;
/// Two threads share work on as many values as these: the network is as much work, whatever the image.
const LARGE: usize = 1 << 20;

/// What the network sees in an image, in places of a coarse grid over it, row by row as stored.
///
/// # Examples
///
/// ```
/// use aquafuse::image::{Image, TopEdge};
/// use aquafuse::{network::Sight, truth};
///
/// let scene = truth::Scene::new(1, truth::Size { width: 128, height: 96 });
/// let image: Image<u8> = scene.seen_through(&truth::waters()[0].water).convert();
/// let sight = Sight::of(&image, TopEdge::First);
/// let (columns, rows) = sight.size();
/// let share = sight.water();
/// // Open water at the top, the floor at the bottom.
/// assert!(share[columns / 2] > 0.8 && share[(rows - 1) * columns + columns / 2] < 0.2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sight {
    size: (usize, usize),
    /// Logits of the share of water and ln z, in steps.
    water: Vec<u16>,
    ln_z: Vec<u16>,
}

impl Sight {
    /// Looks at an image whose edge `top` is up as seen.
    pub fn of<'a>(image: impl Into<ImageRef<'a, u8>>, top: TopEdge) -> Self {
        Self::by(Level::best(), image.into(), top)
    }

    fn by(level: Level, image: ImageRef<'_, u8>, top: TopEdge) -> Self {
        let small = Small::of(image, top);
        let mirrored = small.mirrored();
        // From both sides: what is seen in a mirror image is then the mirror image of what is seen.
        let (own, other) = bands::both(LARGE, || run(&small, level), || run(&mirrored, level));
        let columns = own.width;
        let mean = |row: usize, column: usize, channel: usize| {
            let at = |maps: &Maps, column: usize| maps.row(row)[column * OUTPUTS + channel];
            0.5 * (at(&own, column) + at(&other, columns - 1 - column))
        };
        let of = |channel: usize| -> Vec<u16> {
            let places = (0..own.height).flat_map(|row| (0..columns).map(move |column| (row, column)));
            places.map(|(row, column)| in_steps(mean(row, column, channel))).collect()
        };
        let (water, ln_z) = (of(0), of(1));
        let size = input::size(image.size());
        let size = (size.0 / 2, size.1 / 2);
        let turn = Turn { width: size.0, height: size.1, top };
        Self { size, water: turn.back(&water), ln_z: turn.back(&ln_z) }
    }

    /// Columns and rows of places.
    pub fn size(&self) -> (usize, usize) {
        self.size
    }

    /// How much of each place is open water, in `[0, 1]`.
    pub fn water(&self) -> Vec<f32> {
        self.water.iter().map(|&steps| share(value(f32::from(steps)))).collect()
    }

    /// How far each place is that is no water, in a unit of the image's own, > 0.
    pub fn distances(&self) -> Vec<f32> {
        self.ln_z.iter().map(|&steps| value(f32::from(steps)).exp()).collect()
    }

    /// The mean share of water of the twentieth part of places that are surest to be water.
    pub fn surest(&self) -> f32 {
        let mut shares = self.water.clone();
        shares.sort_unstable_by(|a, b| b.cmp(a));
        let surest = &shares[..shares.len().div_ceil(20)];
        surest.iter().map(|&steps| share(value(f32::from(steps)))).sum::<f32>() / surest.len() as f32
    }

    /// The mean logit of the share of water between borders of columns and rows, which begin and end with the image, row by row.
    pub(crate) fn logits_between(&self, columns: &[usize], rows: &[usize]) -> Vec<f32> {
        let (across, down) = (Parts::new(columns, self.size.0), Parts::new(rows, self.size.1));
        let mut logits = Vec::with_capacity(across.0.len() * down.0.len());
        for rows in &down.0 {
            for columns in &across.0 {
                let (mut sum, mut whole) = (0, 0);
                for &(row, height) in rows {
                    for &(column, width) in columns {
                        whole += width * height;
                        sum += width * height * u64::from(self.water[row * self.size.0 + column]);
                    }
                }
                logits.push(value((sum as f64 / whole as f64) as f32));
            }
        }
        logits
    }
}

/// The share whose logit this is.
fn share(logit: f32) -> f32 {
    1.0 / (1.0 + (-logit).exp())
}

/// What so many steps are.
fn value(steps: f32) -> f32 {
    RANGE[0] + (RANGE[1] - RANGE[0]) * steps / STEPS
}

/// The places that lie between each two borders, and how much of each does.
struct Parts(Vec<Vec<(usize, u64)>>);

impl Parts {
    fn new(borders: &[usize], places: usize) -> Self {
        let length = borders.last().copied().unwrap_or(0);
        let between = borders.windows(2).map(|pair| {
            let (from, to) = (pair[0] * places, pair[1] * places);
            let touched = from / length..to.div_ceil(length);
            touched
                .map(|place| {
                    let (start, end) = (place * length, (place + 1) * length);
                    (place, (end.min(to) - start.max(from)) as u64)
                })
                .collect()
        });
        Self(between.collect())
    }
}

fn in_steps(value: f32) -> u16 {
    (STEPS * ((value - RANGE[0]) / (RANGE[1] - RANGE[0])).clamp(0.0, 1.0) + 0.5) as u16
}

/// The maps of the network, at half the sides of the image.
fn run(small: &Small, level: Level) -> Maps {
    static WEIGHTS: OnceLock<Weights> = OnceLock::new();
    let weights = WEIGHTS.get_or_init(Weights::new);
    let layer = |layer: &weights::Layer, maps: &Maps| {
        let mut maps = layer.convolution.of(maps, level);
        layer.norm.apply(&mut maps, level);
        maps
    };
    let mut kept = vec![layer(&weights.stem, &unshuffled(small))];
    for [first, second] in &weights.down {
        let finer = &kept[kept.len() - 1];
        kept.push(layer(second, &layer(first, &halved(finer))));
    }
    let mut maps = kept.pop().expect("the stem's");
    for (narrow, up) in weights.narrow.iter().zip(&weights.up) {
        let mut finer = kept.pop().expect("one for each level");
        add_doubled(&mut finer, &narrow.of(&maps, level));
        maps = layer(up, &finer);
    }
    let mut found = weights.head.of(&maps, level);
    for y in 0..found.height {
        for pixel in found.row_mut(y).chunks_exact_mut(OUTPUTS) {
            pixel.iter_mut().zip(&weights.bias).for_each(|(value, bias)| *value += bias);
        }
    }
    found
}

/// Four pixels as the channels of one, from -1 to 1.
fn unshuffled(small: &Small) -> Maps {
    let mut maps = Maps::new(small.width / 2, small.height / 2, INPUTS);
    for y in 0..maps.height {
        for (x, channels) in maps.row_mut(y).chunks_exact_mut(INPUTS).enumerate() {
            for (i, channel) in channels.iter_mut().enumerate() {
                let (colour, dy, dx) = (i / 4, i / 2 % 2, i % 2);
                let pixel = &small.pixels[(2 * y + dy) * small.width + 2 * x + dx];
                *channel = 2.0 * pixel[colour] - 1.0;
            }
        }
    }
    maps
}

#[cfg(test)]
mod tests;
