//! Training: splats that look like the images, one view a step.
//!
//! As published by Kerbl et al.: draw a view, compare (`loss.rs`), go back to the splats, step by Adam (`adam.rs`), now
//! and then add and take away splats (`density.rs`). What is done when stands in `options.rs`. A run is its [`Options`],
//! its views and its state, which a checkpoint keeps (`checkpoint.rs`); nothing else has a say, threads least of all.

mod adam;
mod checkpoint;
mod density;
pub mod loss;
mod options;
mod state;
mod water;

pub use checkpoint::CheckpointError;
#[cfg(feature = "fuzz-targets")]
pub(crate) use checkpoint::try_state;
pub use options::{DensityOptions, Options, Rates};

use crate::camera::Camera;
use crate::medium::{Medium, PARAMETERS, Water};
use crate::render::render;
use crate::splats::{HARMONICS, LOG_SCALE, OPACITY, ROTATION, Splats};
use adam::Moments;
use aquafuse::random::{FNV_BASIS, fnv};
use loss::{Loss, Target, loss};
use state::State;

/// An image to train on and the camera that took it.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The camera; of the image's size.
    pub camera: Camera,
    /// The image.
    pub target: Target<f32>,
}

/// A run of training.
///
/// # Examples
///
/// ```
/// use aquafuse::truth::Size;
/// use aquafuse_scene::train::{Options, Shot, Trainer, loss::Target};
/// use aquafuse_scene::{points, truth};
///
/// let views = truth::views(1, Size { width: 40, height: 30 }, 4, 1);
/// let images: Vec<_> = views.iter().map(|view| view.clear()).collect();
/// let splats = points::splats(&truth::points(&views, &images, 16), 0);
/// let shots = views.into_iter().zip(&images).map(|(view, image)| Shot {
///     target: Target::new(40, 30, image.pixels()),
///     camera: view.camera,
/// });
/// let mut trainer = Trainer::new(Options { iterations: 20, ..Options::default() }, shots.collect(), splats, None);
/// let first = trainer.step();
/// while !trainer.is_done() {
///     trainer.step();
/// }
/// assert!(trainer.step().total < first.total);
/// ```
#[derive(Clone, Debug)]
pub struct Trainer {
    options: Options,
    shots: Vec<Shot>,
    /// How far the cameras stand from their middle, units of the scene.
    extent: f32,
    /// What the images and cameras come to, as one number.
    subject: u64,
    state: State,
}

impl Trainer {
    /// Begins with these splats, whose colours are those of the images; `water` is where a water that is to be learned
    /// begins, none for air. It is taken out of the colours first: else fading would be unlearned to explain them. Once distances are known it is told again (`water.rs`).
    ///
    /// # Panics
    ///
    /// When there is no shot, or one whose camera has another size than its image.
    pub fn new(options: Options, shots: Vec<Shot>, splats: Splats<f32>, water: Option<Water<f32>>) -> Self {
        let mut splats = splats;
        if let Some(water) = &water {
            // They are seen as through air, for they have the colours of the images.
            water::repaint(&mut splats, &shots, &Medium::Air, water);
        }
        let state = State::new(splats, water, options.seed);
        Self::at(options, shots, state)
    }

    fn at(options: Options, shots: Vec<Shot>, state: State) -> Self {
        assert!(!shots.is_empty(), "there must be something to train on");
        for shot in &shots {
            assert_eq!(
                (shot.camera.width, shot.camera.height),
                shot.target.size(),
                "a camera of its image's size"
            );
        }
        let cameras: Vec<&Camera> = shots.iter().map(|shot| &shot.camera).collect();
        Self { options, extent: extent(&cameras) as f32, subject: subject(&shots), shots, state }
    }

    /// Shows one view and takes one step; gives the loss before it.
    pub fn step(&mut self) -> Loss {
        let shot = self.state.next_view(self.shots.len());
        let Shot { camera, target } = &self.shots[shot];
        let degree = self.options.degree(self.state.step, self.state.splats.degree());
        let medium = self.state.medium();
        let drawn = render(&self.state.splats, degree, camera, &medium);
        let (loss, of_drawing) = loss(&drawn.drawing, target, self.options.lambda);
        let gradient = drawn.back(&self.state.splats, &medium, &of_drawing);

        self.state.density.note(&gradient, camera.width, camera.height);
        let rates = self.rates();
        let state = &mut self.state;
        state.step += 1;
        state.moments.step(state.splats.rows_mut(), gradient.splats.rows(), &rates, state.step);
        if let Some((water, moments)) = &mut state.water {
            let veil = self.options.rates.water as f32;
            let rates: [f32; PARAMETERS] = std::array::from_fn(|i| if i < 3 { veil } else { veil / 6.0 });
            moments.step(&mut water.raw, &gradient.water, &rates, state.step);
        }
        if self.options.looks_at_water_after(state.step) {
            Self::look_at_water(&self.shots, state);
        }
        if self.options.grows_after(state.step) {
            density::change(state, &self.options, self.extent);
        }
        if self.options.resets_after(state.step) {
            density::reset(state);
        }
        loss
    }

    /// Takes the water that the views tell by the distances there are now, and the splats' colours with it.
    fn look_at_water(shots: &[Shot], state: &mut State) {
        let old = state.medium();
        let Some((water, moments)) = &mut state.water else { return };
        if let Some(told) = water::told(shots, &state.splats, water) {
            water::repaint(&mut state.splats, shots, &old, &told);
            (*water, *moments) = (told, Moments::new(PARAMETERS));
        }
    }

    /// The rate of each number of a row at this step.
    fn rates(&self) -> Vec<f32> {
        let rates = &self.options.rates;
        let position = self.options.position_rate(self.state.step) * f64::from(self.extent);
        let rate = |i: usize| match i {
            0..LOG_SCALE => position,
            LOG_SCALE..ROTATION => rates.scale,
            ROTATION..OPACITY => rates.rotation,
            OPACITY => rates.opacity,
            _ if i < HARMONICS + 3 => rates.colour,
            _ => rates.colour / 20.0,
        };
        (0..self.state.splats.width()).map(|i| rate(i) as f32).collect()
    }

    /// Steps done.
    pub fn steps(&self) -> u32 {
        self.state.step
    }

    /// Whether all steps are done.
    pub fn is_done(&self) -> bool {
        self.state.step >= self.options.iterations
    }

    /// The splats as they are.
    pub fn splats(&self) -> &Splats<f32> {
        &self.state.splats
    }

    /// What they are seen through: air, or the water as it is learned so far.
    pub fn medium(&self) -> Medium<f32> {
        self.state.medium()
    }
}

/// All images and cameras as one number (FNV-1a, a value at a time): a run is not gone on with on others.
fn subject(shots: &[Shot]) -> u64 {
    shots.iter().fold(FNV_BASIS, |sum, Shot { camera, target }| {
        let Camera { width, height, focal, centre, rotation, translation } = camera;
        let numbers = focal.iter().chain(centre).chain(rotation.as_flattened()).chain(translation);
        let sum = [*width, *height].iter().fold(sum, |sum, side| fnv(sum, *side as u64));
        let sum = numbers.fold(sum, |sum, number| fnv(sum, number.to_bits()));
        target.values().fold(sum, |sum, value| fnv(sum, value.to_bits()))
    })
}

/// The greatest distance of a camera from the middle of all, and a tenth more: the size of a scene, as published.
pub fn extent(cameras: &[&Camera]) -> f64 {
    let positions: Vec<[f64; 3]> = cameras.iter().map(|camera| camera.position()).collect();
    let middle: [f64; 3] =
        std::array::from_fn(|i| positions.iter().map(|p| p[i]).sum::<f64>() / positions.len() as f64);
    let apart = |p: &[f64; 3]| (0..3).map(|i| (p[i] - middle[i]).powi(2)).sum::<f64>().sqrt();
    // A single camera, or several at one place, have a scene too.
    (1.1 * positions.iter().map(apart).fold(0.0, f64::max)).max(1e-3)
}
