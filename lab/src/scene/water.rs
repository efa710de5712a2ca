//! What becomes of a scene once its learned water is removed or exchanged, against the truth.

use std::fmt::Write;

use anyhow::{Result, bail};
use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim};
use aquafuse::truth::{NamedWater, waters};
use aquafuse::waterbody::Waterbody;
use aquafuse_scene::compare::image;
use aquafuse_scene::medium::{Medium, Water};
use aquafuse_scene::points;
use aquafuse_scene::render::render;
use aquafuse_scene::splats::Splats;
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{Options, TrainView, Trainer};
use aquafuse_scene::truth::{self, TruthView};
use xtask::shell::say;

use super::training::SIZE;

/// Every so many views one is held out, as is usual.
const HELD: usize = 8;
/// How much finer the scenes are known than they are trained on, and a point in so many pixels.
const FINER: usize = 2;
const EVERY: usize = 24;
const STEPS: u32 = 700;
const SPLATS: usize = 24_000;
/// β of a channel whose B∞ is darker than this moves nothing that a camera sees.
const DARK: f32 = 0.1;

/// A scene by its seed, the number of views, and the numbers of the water it is in and of the one it is put into. Constants were
/// chosen on the first scene in its first two waters.
const CASES: [(u64, usize, usize, usize); 5] =
    [(1, 28, 0, 1), (1, 100, 0, 1), (2, 28, 0, 1), (1, 28, 1, 0), (1, 28, 2, 0)];

/// The table: with the loss of the transmittance and without it.
pub(super) fn table() -> Result<String> {
    let mut table = String::from(
        "| scene | views | water | transmittance_reg | seen: PSNR, dB | dewatered: PSNR, dB | SSIM | in another water: PSNR, dB | \
         SSIM | B∞ off by | β_B off by, % | β_D off by, % |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let usual = Options::default().transmittance_reg;
    for (seed, count, its, other) in CASES {
        say(&format!("Dewatering synthetic scene {seed}, {count} views"));
        let views = truth::views(seed, SIZE, count, FINER);
        let all = waters();
        let (its, other) = (&all[its], &all[other]);
        for weight in [0.0, usual] {
            let (splats, found) = trained(&views, its, weight)?;
            let seen = |water: &Waterbody| Medium::Known { water: *water, per_unit: 1.0 };
            let own =
                scores(&views, &splats, &Medium::Learned(found.clone()), |v| v.seen_through(&its.water))?;
            let dry = scores(&views, &splats, &Medium::Air, TruthView::clear)?;
            let there = scores(&views, &splats, &seen(&other.water), |v| v.seen_through(&other.water))?;
            let [veil, growth, fading] = off(&its.water, &found);
            writeln!(
                table,
                "| {seed} | {count} | {}, then {} | {weight} | {:.2} | {:.2} | {:.3} | {:.2} | {:.3} | {veil:.3} | {growth:.0} | \
                 {fading:.0} |",
                its.name, other.name, own[0], dry[0], dry[1], there[0], there[1],
            )?;
        }
    }
    Ok(table)
}

/// Splats trained on the views in a water, and the water as it was learned, from a first guess as far off as estimates are: B∞
/// by a tenth, β by a third.
fn trained(views: &[TruthView], water: &NamedWater, weight: f64) -> Result<(Splats<f32>, Water<f32>)> {
    let images: Vec<Image<f32>> = views.iter().map(|view| view.seen_through(&water.water)).collect();
    let begin = points::splats(&truth::points(views, &images, EVERY), 0);
    let kept = views.iter().zip(&images).enumerate().filter(|(i, _)| i % HELD != 0);
    let shots = kept.map(|(_, (view, image))| TrainView {
        camera: view.camera.clone(),
        target: Target::new(view.camera.width, view.camera.height, image.pixels()),
    });
    let [veil, growth, fading] = numbers(&water.water).map(|rgb| rgb.map(f64::from));
    let guess = Water::new(
        [veil[0] + 0.04, 0.83 * veil[1], 0.88 * veil[2]],
        growth.map(|beta| 0.7 * beta),
        fading.map(|beta| 0.68 * beta),
    );
    let options =
        Options { iterations: STEPS, max_splats: SPLATS, transmittance_reg: weight, ..Options::default() };
    let mut trainer = Trainer::new(options, shots.collect(), begin, Some(guess));
    while !trainer.is_done() {
        trainer.step();
    }
    let Medium::Learned(found) = trainer.medium() else { bail!("a water was to be learned") };
    Ok((trainer.splats().clone(), found))
}

/// B∞, β_B and β_D.
fn numbers(water: &Waterbody) -> [[f32; 3]; 3] {
    let fading = water.attenuation.each_ref().map(|curve| curve.coefficient(0.0));
    [water.veiling_light.rgb(), water.backscatter_coefficient, fading]
}

/// How far off the worst channel of each is: B∞ by itself, β in percent, β_B only where there is light to see it by.
fn off(truth: &Waterbody, found: &Water<f32>) -> [f32; 3] {
    let [veil, growth, fading] = numbers(truth);
    let ratio = |found: [f32; 3], truth: [f32; 3]| -> [f32; 3] {
        std::array::from_fn(|c| 100.0 * (found[c] / truth[c] - 1.0).abs())
    };
    let growths = ratio(found.backscatter(), growth).into_iter().zip(veil);
    [
        found.veil().into_iter().zip(veil).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max),
        growths.filter(|(_, veil)| *veil >= DARK).map(|(off, _)| off).fold(0.0, f32::max),
        ratio(found.attenuation(), fading).into_iter().fold(0.0, f32::max),
    ]
}

/// PSNR and SSIM of the views held out, through a medium, against what they are in truth.
fn scores(
    views: &[TruthView],
    splats: &Splats<f32>,
    medium: &Medium<f32>,
    truth: impl Fn(&TruthView) -> Image<f32>,
) -> Result<[f64; 2]> {
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for view in views.iter().step_by(HELD) {
        let (drawn, truth) = (image(&render(splats, 0, &view.camera, medium).rendering), truth(view));
        sum[0] += psnr(&drawn, &truth)?;
        sum[1] += ssim(&drawn, &truth)?.unwrap_or(f64::NAN);
        count += 1.0;
    }
    Ok(sum.map(|sum| sum / count))
}
