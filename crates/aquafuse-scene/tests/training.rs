//! Training on a truth scene: it learns, it repeats itself, and it goes on where it was.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::image::Image;
use aquafuse::metrics::psnr;
use aquafuse::truth::{OPEN_WATER, Size, waters};
use aquafuse_scene::compare::image;
use aquafuse_scene::files::ply_bytes;
use aquafuse_scene::medium::{Medium, Water};
use aquafuse_scene::render::render;
use aquafuse_scene::splats::Splats;
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{CheckpointError, Options, TrainView, Trainer};
use aquafuse_scene::truth::{TruthView, views};
use aquafuse_scene::{points, truth};

const SIZE: Size = Size { width: 72, height: 54 };
/// The view that is held out.
const HELD: usize = 4;

struct Place {
    views: Vec<TruthView>,
}

impl Place {
    fn new() -> Self {
        Self { views: views(1, SIZE, 10, 1) }
    }

    fn seen(&self, through: impl Fn(&TruthView) -> Image<f32>) -> Vec<Image<f32>> {
        self.views.iter().map(through).collect()
    }

    fn shots(&self, images: &[Image<f32>]) -> Vec<TrainView> {
        let kept = self.views.iter().zip(images).enumerate().filter(|(i, _)| *i != HELD);
        let shot = |(_, (view, image)): (usize, (&TruthView, &Image<f32>))| TrainView {
            camera: view.camera.clone(),
            target: Target::new(SIZE.width, SIZE.height, image.pixels()),
        };
        kept.map(shot).collect()
    }

    fn splats(&self, images: &[Image<f32>]) -> Splats<f32> {
        points::splats(&truth::points(&self.views, images, 12), 1)
    }

    /// How near the view that was held out comes, in dB.
    fn score(&self, trained: (&Splats<f32>, &Medium<f32>), image_there: &Image<f32>) -> f64 {
        let drawn = render(trained.0, 1, &self.views[HELD].camera, trained.1);
        psnr(&image(&drawn.rendering), image_there).unwrap()
    }
}

fn options(iterations: u32) -> Options {
    Options { iterations, max_splats: 5000, ..Options::default() }
}

#[test]
fn views_that_were_not_shown_come_nearer() {
    let place = Place::new();
    let images = place.seen(TruthView::clear);
    let begin = place.splats(&images);
    let mut trainer = Trainer::new(options(300), place.shots(&images), begin.clone(), None);
    while !trainer.is_done() {
        trainer.step();
    }
    let before = place.score((&begin, &Medium::Air), &images[HELD]);
    let after = place.score((trainer.splats(), &trainer.medium()), &images[HELD]);
    println!("{before:.2} dB before, {after:.2} dB after");
    assert!(after > 20.0 && after > before + 6.0, "{before} {after}");
    assert!(trainer.splats().len() > begin.len(), "splats were added");
}

#[test]
fn neither_threads_nor_a_stop_change_a_bit() {
    let place = Place::new();
    let images = place.seen(TruthView::clear);
    let water = Some(Water::new([0.1, 0.3, 0.4], [0.2; 3], [0.2; 3]));
    let new = || Trainer::new(options(240), place.shots(&images), place.splats(&images), water.clone());
    let run = |trainer: &mut Trainer, steps: u32| (0..steps).for_each(|_| _ = trainer.step());

    let mut whole = new();
    run(&mut whole, 130);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut stopped = new();
    alone.install(|| run(&mut stopped, 90));
    let kept = stopped.checkpoint();
    drop(stopped);
    // Over a change of density, at step 100.
    let mut resumed = Trainer::resume(options(240), place.shots(&images), &kept).unwrap();
    alone.install(|| run(&mut resumed, 40));
    assert_eq!(ply_bytes(resumed.splats()), ply_bytes(whole.splats()));
    assert_eq!(resumed.checkpoint(), whole.checkpoint());

    let refused = |options, bytes: &[u8]| Trainer::resume(options, place.shots(&images), bytes).unwrap_err();
    assert_eq!(refused(options(241), &kept), CheckpointError::OtherOptions);
    assert_eq!(refused(options(240), b"splats"), CheckpointError::Unknown);
    // The step stands behind mark, options and images; the first splat behind it, chance, the views to come, the degree.
    let length = |at: usize| u64::from_le_bytes(kept[at..at + 8].try_into().unwrap()) as usize;
    let step = 16 + 8 + length(16) + 8;
    let splat = step + 4 + 8 + 8 + 4 * length(step + 12) + 1 + 8;
    for (at, lie) in [(step, [0xff; 4]), (splat, f32::NAN.to_le_bytes())] {
        let mut changed = kept.clone();
        changed[at..at + 4].copy_from_slice(&lie);
        assert!(matches!(refused(options(240), &changed), CheckpointError::Damaged { .. }), "{at}");
    }
    for end in (16..kept.len()).step_by(kept.len() / 60) {
        assert!(matches!(refused(options(240), &kept[..end]), CheckpointError::Damaged { .. }), "{end}");
    }
}

#[test]
fn a_water_is_learned_and_taken_out() {
    let place = Place::new();
    let truth = waters()[0].water;
    let images = place.seen(|view| view.seen_through(&truth));
    // A first guess as far off as estimates are: B∞ by a tenth, the betas by a third.
    let guess = Water::new([0.08, 0.30, 0.58], [0.14, 0.12, 0.10], [0.24, 0.09, 0.07]);
    let mut trainer =
        Trainer::new(options(500), place.shots(&images), place.splats(&images), Some(guess.clone()));
    while !trainer.is_done() {
        trainer.step();
    }
    let Medium::Learned(water) = trainer.medium() else { panic!("a water was to be learned") };
    let off = |water: &Water<f32>| {
        let true_veil = truth.veiling_light.rgb();
        water
            .veil()
            .into_iter()
            .zip(true_veil)
            .map(|(found, truth)| (found - truth).abs())
            .fold(0.0, f32::max)
    };
    println!("{:?} {:?} {:?}", water.veil(), water.backscatter(), water.attenuation());
    println!("B∞ off by {:.3} before, {:.3} after", off(&guess), off(&water));
    assert!(off(&water) < 0.2 * off(&guess), "{} {}", off(&guess), off(&water));
    // How fast light fades is told by things that are seen from near and from far: what views differ by. Where the veil is
    // dark, β_B moves nothing.
    let astray = |water: &Water<f32>| {
        let fading = truth.attenuation.each_ref().map(|curve| curve.coefficient(0.0));
        let ratios = water.attenuation().into_iter().zip(fading);
        let growth = water.backscatter().into_iter().zip(truth.backscatter_coefficient).skip(1);
        ratios.chain(growth).map(|(found, truth)| (found / truth).ln().abs()).fold(0.0, f32::max)
    };
    println!("β astray by e^{:.2} before, e^{:.2} after", astray(&guess), astray(&water));
    assert!(astray(&water) < 0.6 * astray(&guess), "{} {}", astray(&guess), astray(&water));

    // Where things are, the place without its water is nearer to what it is than its image.
    let view = &place.views[HELD];
    let drawn = render(trainer.splats(), 1, &view.camera, &Medium::Air);
    let (dry, clear) = (image(&drawn.rendering), view.clear());
    let error = |image: &Image<f32>| -> f64 {
        let near = view.scene.depth.distances();
        let pixels = image.pixels().iter().zip(clear.pixels()).zip(near).filter(|(_, z)| *z < 8.0);
        let (sum, count) = pixels.fold((0.0, 0.0), |(sum, count), ((a, b), _)| {
            (sum + a.iter().zip(b).map(|(a, b)| f64::from((a - b) * (a - b))).sum::<f64>(), count + 3.0)
        });
        (sum / count).sqrt()
    };
    println!("RMSE to the clear place: {:.3} dewatered, {:.3} as seen", error(&dry), error(&images[HELD]));
    assert!(error(&dry) < 0.7 * error(&images[HELD]));
}

#[test]
fn the_veiling_light_does_not_make_up_for_a_beta_that_is_far_off() {
    let place = Place::new();
    let truth = waters()[0].water;
    let images = place.seen(|view| view.seen_through(&truth));
    // B∞ as open water shows it; β_B at a tenth of the true one and β_D at three times.
    let growth = truth.backscatter_coefficient.map(|beta| 0.1 * f64::from(beta));
    let fading = truth.attenuation.each_ref().map(|curve| 3.0 * f64::from(curve.coefficient(0.0)));
    let guess = Water::new(truth.veiling_light.rgb().map(f64::from), growth, fading);
    let mut trainer = Trainer::new(options(400), place.shots(&images), place.splats(&images), Some(guess));
    while !trainer.is_done() {
        trainer.step();
    }
    let Medium::Learned(water) = trainer.medium() else { panic!("a water was to be learned") };
    println!("{:?} {:?} {:?}", water.veil(), water.backscatter(), water.attenuation());
    let off = water.veil().into_iter().zip(truth.veiling_light.rgb()).map(|(a, b)| (a - b).abs());
    let off = off.fold(0.0, f32::max);
    assert!(off < 0.04, "B∞ is off by {off}: {:?}", water.veil());
    // Open water is empty: without the water it is black.
    let view = &place.views[HELD];
    let dry = render(trainer.splats(), 1, &view.camera, &Medium::Air).rendering;
    let open = view.scene.depth.distances().into_iter().zip(&dry.transmittance);
    let (sum, count) = open
        .filter(|(z, _)| *z >= OPEN_WATER)
        .fold((0.0, 0.0), |(sum, count), (_, through)| (sum + through, count + 1.0));
    assert!(sum / count > 0.85, "open water lets {} through", sum / count);
}

#[test]
fn surfaces_are_closed_and_open_water_stays_empty() {
    let place = Place::new();
    let truth = waters()[0].water;
    let images = place.seen(|view| view.seen_through(&truth));
    let water = || {
        let fading = truth.attenuation.each_ref().map(|curve| f64::from(curve.coefficient(0.0)));
        let growth = truth.backscatter_coefficient.map(f64::from);
        Some(Water::new(truth.veiling_light.rgb().map(f64::from), growth, fading))
    };
    // The mean transmittance of things in front, and of open water.
    let let_through = |transmittance_reg: f64| {
        let how = Options { transmittance_reg, ..options(300) };
        let mut trainer = Trainer::new(how, place.shots(&images), place.splats(&images), water());
        while !trainer.is_done() {
            trainer.step();
        }
        let view = &place.views[HELD];
        let drawn = render(trainer.splats(), 1, &view.camera, &trainer.medium()).rendering;
        let distances = view.scene.depth.distances();
        let mean = |is: &dyn Fn(f32) -> bool| {
            let those = drawn.transmittance.iter().zip(&distances).filter(|(_, z)| is(**z));
            let (sum, count) = those.fold((0.0, 0.0), |(sum, count), (t, _)| (sum + t, count + 1.0));
            sum / count
        };
        [mean(&|z| z < 5.0), mean(&|z| z >= OPEN_WATER)]
    };
    let [usual, without] = [Options::default().transmittance_reg, 0.0].map(let_through);
    println!("{usual:?}, {without:?} without");
    assert!(usual[0] < 0.75 * without[0], "{usual:?} {without:?}");
    assert!(usual[1] > 0.9 && usual[1] > without[1], "{usual:?} {without:?}");
}
