//! Training: splats are fitted to the images, one view a step.
//!
//! As published by Kerbl et al.: render a view, compare (`loss.rs`), propagate the gradient back to the splats, step by Adam
//! (`adam.rs`), and at intervals add and remove splats (`density.rs`). `options.rs` says what happens at which step. A run is
//! determined by its [`Options`], its views and its state, which a checkpoint keeps (`checkpoint.rs`); the number of threads
//! changes nothing. [`training`](crate::training) runs a whole scene from its folder.

mod adam;
mod checkpoint;
mod density;
pub mod loss;
mod options;
mod state;
mod transmittance;
mod water;

pub use checkpoint::CheckpointError;
#[cfg(feature = "fuzz-targets")]
pub(crate) use checkpoint::try_state;
pub(crate) use checkpoint::{is_checkpoint, is_ended};
pub use options::{DensityOptions, Options, Rates};

use crate::camera::Camera;
use crate::medium::{Medium, PARAMETERS, Water};
use crate::render::render;
use crate::splats::{HARMONICS, LOG_SCALE, OPACITY, ROTATION, Splats};
use adam::Moments;
use aquafuse::random::{FNV_BASIS, fnv};
use loss::{Loss, Target, loss};
use state::State;
use transmittance::Push;

/// An image to train on and the camera that took it.
#[derive(Clone, Debug)]
pub struct TrainView {
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
/// use aquafuse_scene::train::{Options, TrainView, Trainer, loss::Target};
/// use aquafuse_scene::{points, truth};
///
/// let views = truth::views(1, Size { width: 40, height: 30 }, 4, 1);
/// let images: Vec<_> = views.iter().map(|view| view.clear()).collect();
/// let splats = points::splats(&truth::points(&views, &images, 16), 0);
/// let views = views.into_iter().zip(&images).map(|(view, image)| TrainView {
///     target: Target::new(40, 30, image.pixels()),
///     camera: view.camera,
/// });
/// let mut trainer = Trainer::new(Options { iterations: 20, ..Options::default() }, views.collect(), splats, None);
/// let first = trainer.step();
/// while !trainer.is_done() {
///     trainer.step();
/// }
/// assert!(trainer.step().total < first.total);
/// ```
#[derive(Clone, Debug)]
pub struct Trainer {
    options: Options,
    views: Vec<TrainView>,
    /// How far the cameras stand from their centre, in units of the scene.
    extent: f32,
    /// A digest of images and cameras.
    subject: u64,
    state: State,
}

impl Trainer {
    /// Begins with these splats, in the colours of the images. `water` is the first guess of a water to be learned; `None`:
    /// air. The water is removed from the colours first: otherwise training would lower β_D to explain them. Once distances
    /// are known the water is estimated again (`water.rs`).
    ///
    /// # Panics
    ///
    /// When there is no view, or a camera and its image differ in size.
    pub fn new(
        options: Options,
        views: Vec<TrainView>,
        splats: Splats<f32>,
        water: Option<Water<f32>>,
    ) -> Self {
        let mut splats = splats;
        if let Some(water) = &water {
            // They are seen as through air, for they have the colours of the images.
            water::repaint(&mut splats, &views, &Medium::Air, water);
        }
        let state = State::new(splats, water, options.seed);
        Self::at(options, views, state)
    }

    fn at(options: Options, views: Vec<TrainView>, state: State) -> Self {
        assert!(!views.is_empty(), "there must be something to train on");
        for view in &views {
            assert_eq!(
                (view.camera.width, view.camera.height),
                view.target.size(),
                "a camera of its image's size"
            );
        }
        let cameras: Vec<&Camera> = views.iter().map(|view| &view.camera).collect();
        Self { options, extent: extent(&cameras) as f32, subject: subject(&views), views, state }
    }

    /// Renders one view and takes one step; returns the loss before it.
    pub fn step(&mut self) -> Loss {
        let view = self.state.next_view(self.views.len());
        let TrainView { camera, target } = &self.views[view];
        let degree = self.options.degree(self.state.step, self.state.splats.sh_degree());
        let medium = self.state.medium();
        let rendered = render(&self.state.splats, degree, camera, &medium);
        let (loss, mut of_rendering) = loss(&rendered.rendering, target, self.options.lambda);
        let push = Push {
            weight: self.options.transmittance_reg as f32,
            closes: self.options.closes_surfaces(self.state.step),
        };
        of_rendering.transmittance = push.gradient(target, &medium, &rendered.rendering.transmittance);
        let gradient = rendered.back(&self.state.splats, &medium, &of_rendering);

        self.state.density.note(&gradient, camera.width, camera.height);
        let rates = self.rates();
        let state = &mut self.state;
        state.step += 1;
        state.moments.step(state.splats.rows_mut(), gradient.splats.rows(), &rates, state.step);
        if let Some((water, moments)) = &mut state.water {
            let rate = self.options.rates.water as f32;
            let is_held = !self.options.knows_beta(state.step) && water::is_shown(&self.views, water.veil());
            let veil = if is_held { 0.0 } else { rate };
            let rates: [f32; PARAMETERS] = std::array::from_fn(|i| if i < 3 { veil } else { rate / 6.0 });
            moments.step(&mut water.raw, &gradient.water, &rates, state.step);
            water::keep_colours(&mut state.splats);
        }
        if self.options.estimates_water_after(state.step) {
            Self::estimate_water(&self.views, state);
        }
        if self.options.grows_after(state.step) {
            density::change(state, &self.options, self.extent);
        }
        if self.options.resets_after(state.step) {
            density::reset(state);
        }
        loss
    }

    /// Estimates the water again from the views and the present distances, and changes the splats' colours with it.
    fn estimate_water(views: &[TrainView], state: &mut State) {
        let old = state.medium();
        let Some((water, moments)) = &mut state.water else { return };
        if let Some(estimated) = water::estimate(views, &state.splats, water) {
            water::repaint(&mut state.splats, views, &old, &estimated);
            (*water, *moments) = (estimated, Moments::new(PARAMETERS));
        }
    }

    /// The rate of each number of a row at this step.
    fn rates(&self) -> Vec<f32> {
        let rates = &self.options.rates;
        let means = self.options.means_rate(self.state.step) * f64::from(self.extent);
        let share = self.options.share(self.state.step);
        let rate = |i: usize| match i {
            0..LOG_SCALE => means,
            LOG_SCALE..ROTATION => share * rates.scales,
            ROTATION..OPACITY => share * rates.quats,
            OPACITY => share * rates.opacities,
            _ if i < HARMONICS + 3 => share * rates.sh0,
            _ => share * rates.sh0 / 20.0,
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

    /// The splats so far.
    pub fn splats(&self) -> &Splats<f32> {
        &self.state.splats
    }

    /// The medium: air, or the water as learned so far.
    pub fn medium(&self) -> Medium<f32> {
        self.state.medium()
    }
}

/// A digest of all images and cameras (FNV-1a, a value at a time): a run does not go on with others.
fn subject(views: &[TrainView]) -> u64 {
    views.iter().fold(FNV_BASIS, |sum, TrainView { camera, target }| {
        let Camera { width, height, focal, centre, rotation, translation } = camera;
        let numbers = focal.iter().chain(centre).chain(rotation.as_flattened()).chain(translation);
        let sum = [*width, *height].iter().fold(sum, |sum, side| fnv(sum, *side as u64));
        let sum = numbers.fold(sum, |sum, number| fnv(sum, number.to_bits()));
        target.values().fold(sum, |sum, value| fnv(sum, value.to_bits()))
    })
}

/// The greatest distance of a camera from the centre of all, and a tenth more: the size of a scene, as published.
pub fn extent(cameras: &[&Camera]) -> f64 {
    let positions: Vec<[f64; 3]> = cameras.iter().map(|camera| camera.position()).collect();
    let centre: [f64; 3] =
        std::array::from_fn(|i| positions.iter().map(|p| p[i]).sum::<f64>() / positions.len() as f64);
    let apart = |p: &[f64; 3]| (0..3).map(|i| (p[i] - centre[i]).powi(2)).sum::<f64>().sqrt();
    // A single camera, or several at one place, have a scene too.
    (1.1 * positions.iter().map(apart).fold(0.0, f64::max)).max(1e-3)
}
