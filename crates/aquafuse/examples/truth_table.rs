//! How much of the true change each way of estimating makes, on scenes whose truth is known.
//!
//! cargo run --release -p aquafuse --example truth_table
//!
//! Truth A is the content's place with nothing exchanged but B∞, formed anew. The share of the true change is
//! 1 - RMSE(fused, truth) / RMSE(content, truth) over all pixels and channels, before clipping: 1 is the
//! truth, 0 the content, less than 0 farther from the truth than the content was.

use aquafuse::depth::{DepthMap, DepthModel, Eq3};
use aquafuse::fusion::{Law, Model, Options, Waters};
use aquafuse::image::{Image, SizeError};
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::waterbody::{EstimateOptions, VeilingLight, VeilingLightMethod, Waterbody, estimate};

const SIZE: Size = Size { width: 240, height: 160 };
/// Seeds of contents and of references; neither was looked at when a constant was chosen.
const CONTENTS: std::ops::Range<u64> = 1000..1040;
const REFERENCES: u64 = 5000;
/// Every other picture is this noisy (standard deviation, in steps of a byte).
const NOISE: f32 = 1.5;

/// Which of the inputs of fusion are given, and how the others are estimated.
struct Way {
    name: &'static str,
    /// None is the true depth; pictures of the reference are then read by the default.
    depth: Option<DepthModel>,
    veils: Option<VeilingLightMethod>,
    coefficient_given: bool,
}

const WAYS: [Way; 9] = [
    Way { name: "everything given", depth: None, veils: None, coefficient_given: true },
    Way { name: "z and B∞ given", depth: None, veils: None, coefficient_given: false },
    Way {
        name: "z given, B∞ of open water",
        depth: None,
        veils: Some(VeilingLightMethod::OpenWater),
        coefficient_given: false,
    },
    Way {
        name: "z given, B∞ of the farthest 5 %",
        depth: None,
        veils: Some(VeilingLightMethod::Published),
        coefficient_given: false,
    },
    Way {
        name: "z by `eq3`, B∞ of open water",
        depth: Some(DepthModel::Eq3(Eq3::OURS)),
        veils: Some(VeilingLightMethod::OpenWater),
        coefficient_given: false,
    },
    Way {
        name: "z by `eq3`, B∞ of the farthest 5 %",
        depth: Some(DepthModel::Eq3(Eq3::OURS)),
        veils: Some(VeilingLightMethod::Published),
        coefficient_given: false,
    },
    Way {
        name: "z by `ratio`, B∞ of open water",
        depth: Some(DepthModel::Ratio),
        veils: Some(VeilingLightMethod::OpenWater),
        coefficient_given: false,
    },
    Way {
        name: "z by `ratio`, B∞ of the farthest 5 %",
        depth: Some(DepthModel::Ratio),
        veils: Some(VeilingLightMethod::Published),
        coefficient_given: false,
    },
    Way {
        name: "z by `ulap`, B∞ of open water",
        depth: Some(DepthModel::Ulap),
        veils: Some(VeilingLightMethod::OpenWater),
        coefficient_given: false,
    },
];

fn main() -> Result<(), SizeError> {
    let cases: Vec<Case> = CONTENTS.map(Case::new).collect();
    println!(
        "| what is given | `physical`, mean | median | worse than the content | `aquafuse` | median \\|ΔB∞\\| |"
    );
    println!("|---|---|---|---|---|---|");
    for way in &WAYS {
        let results = cases.iter().map(|case| case.judge(way)).collect::<Result<Vec<_>, _>>()?;
        let physical: Vec<f32> = results.iter().map(|result| result.physical).collect();
        let aquafuse: Vec<f32> = results.iter().map(|result| result.aquafuse).collect();
        let worse = physical.iter().filter(|share| **share < 0.0).count();
        println!(
            "| {} | {:.2} | {:.2} | {worse} of {} | {:.2} | {:.3} |",
            way.name,
            mean(&physical),
            median(physical.clone()),
            physical.len(),
            mean(&aquafuse),
            median(results.iter().map(|result| result.veil_error).collect())
        );
    }
    Ok(())
}

/// A place in one water, to be seen in another's.
struct Case {
    scene: Scene,
    content: Image<u8>,
    reference: Image<u8>,
    own: Waterbody,
    other: Waterbody,
}

struct Shares {
    physical: f32,
    aquafuse: f32,
    veil_error: f32,
}

impl Case {
    fn new(seed: u64) -> Self {
        let waters = waters().map(|named| named.water);
        let count = waters.len();
        // Every ordered pair of different waters in turn.
        let pair = seed as usize % (count * (count - 1));
        let (from, step) = (pair / (count - 1), 1 + pair % (count - 1));
        let (own, other) = (waters[from], waters[(from + step) % count]);
        let scene = Scene::new(seed, SIZE);
        let noise = if seed.is_multiple_of(2) { 0.0 } else { NOISE };
        let content = noisy(&scene.seen_through(&own), noise, seed);
        let reference = noisy(&Scene::new(REFERENCES + seed, SIZE).seen_through(&other), noise, seed + 1);
        Self { scene, content, reference, own, other }
    }

    fn judge(&self, way: &Way) -> Result<Shares, SizeError> {
        let z = way.depth.map_or_else(|| self.scene.depth.clone(), |model| model.estimate(&self.content));
        let options = EstimateOptions { veiling_light: way.veils.unwrap_or_default(), ..Default::default() };
        let found = estimate(&self.content, &z, &options)?.water;
        let reference_depth = way.depth.unwrap_or_default().estimate(&self.reference);
        let reference = estimate(&self.reference, &reference_depth, &options)?.water;
        let (own, other) = match way.veils {
            Some(_) => (found.veiling_light, reference.veiling_light),
            None => (self.own.veiling_light, self.other.veiling_light),
        };
        let coefficient = if way.coefficient_given {
            self.own.backscatter_coefficient
        } else {
            found.backscatter_coefficient
        };
        let own = Waterbody { veiling_light: own, backscatter_coefficient: coefficient, ..self.own };
        let other = Waterbody { veiling_light: other, ..self.other };
        let waters = Waters { content: &own, reference: &other };
        let share = |model| self.share(&z, &Law::new(waters, &Options::for_model(model)));
        Ok(Shares {
            physical: share(Model::Physical),
            aquafuse: share(Model::Aquafuse),
            veil_error: distance(own.veiling_light, self.own.veiling_light),
        })
    }

    fn share(&self, z: &DepthMap, law: &Law) -> f32 {
        let exchanged = Waterbody { veiling_light: self.other.veiling_light, ..self.own };
        let truth = self.scene.seen_through(&exchanged);
        let (mut fused, mut content) = (0.0_f64, 0.0_f64);
        for ((pixel, truth), z) in self.content.pixels().iter().zip(truth.pixels()).zip(z.distances()) {
            let before = pixel.map(|value| f32::from(value) / 255.0);
            let after = law.at(z).of(before);
            for c in 0..3 {
                fused += f64::from(after[c] - truth[c]).powi(2);
                content += f64::from(before[c] - truth[c]).powi(2);
            }
        }
        1.0 - (fused / content).sqrt() as f32
    }
}

/// The picture in bytes, with noise that is the same for the same seed.
fn noisy(image: &Image<f32>, deviation: f32, seed: u64) -> Image<u8> {
    let mut state = seed;
    let mut even = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1_u32 << 24) as f32
    };
    // Twelve even numbers add up to a nearly normal one of deviation 1.
    let mut normal = || (0..12).map(|_| even()).sum::<f32>() - 6.0;
    let mut noisy = image.clone();
    for pixel in noisy.pixels_mut() {
        *pixel = pixel.map(|value| value + normal() * deviation / 255.0);
    }
    noisy.to_samples()
}

fn distance(a: VeilingLight, b: VeilingLight) -> f32 {
    (0..3).map(|c| (a.rgb()[c] - b.rgb()[c]).abs()).fold(0.0, f32::max)
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

fn median(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    values[values.len() / 2]
}
