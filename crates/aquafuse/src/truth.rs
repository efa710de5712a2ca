//! A synthetic place on the sea floor of which everything is known: the ground truth of every estimator.
//!
//! From a seed, [`Scene::new`] lays out sand, rocks, corals, plants and fish, and ray-marches them as seen
//! through air. That gives the clear image I and the depth z exactly; [`Scene::seen_through`] puts any
//! water in between by the formation model. Nothing here is a photograph, so all of it may be shipped.

mod drawn;
mod floor;
mod geometry;
mod layout;
mod noise;
mod render;
mod thing;
mod trials;
mod waters;

pub use drawn::DrawnWater;
pub use trials::{Case, Exchange, LitCase, LitExchange, LitWaters, Trials};
pub use waters::{NamedWater, waters};

use crate::depth::{DepthKind, DepthMap};
use crate::formation::form;
use crate::image::Image;
use crate::waterbody::Waterbody;

/// Width and height of an image to make, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Columns, > 0.
    pub width: usize,
    /// Rows, > 0.
    pub height: usize,
}

/// The distance in metres at which open water is placed. Its clear image is black: it sends no light but
/// its backscatter, and the image there is the veiling light.
pub const OPEN_WATER: f32 = render::FAR;

/// The tangent of half the angle that an image is wide: its focal length is `width / (2 HALF_VIEW)` pixels.
pub const HALF_VIEW: f32 = render::HALF_VIEW;

/// The position and gaze of a camera, for more than one image of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Metres to the right of, above and ahead of where the place's own camera stands.
    pub moved: [f32; 3],
    /// How far it looks to the right of straight ahead, radians.
    pub yaw: f32,
    /// How far it looks down, radians.
    pub pitch: f32,
    /// How far it is rolled clockwise about its line of sight, radians.
    pub roll: f32,
    /// The tangent of half the angle that its image is wide, > 0; [`HALF_VIEW`] by default.
    pub half_view: f32,
}

impl Default for Pose {
    fn default() -> Self {
        Self { moved: [0.0; 3], yaw: 0.0, pitch: 0.0, roll: 0.0, half_view: HALF_VIEW }
    }
}

/// What kind of place it is, and where the camera looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct View {
    /// What kind of place.
    pub site: Site,
    /// Where the camera looks.
    pub gaze: Gaze,
}

/// Families of places that share neither layout nor colours: what was fitted on one is tried on another. Estimators' constants
/// were chosen on reefs, and the network learned from reefs and harbours; nothing was ever fitted to walls or to open water.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Site {
    /// Sand, rocks, corals, grass and fish.
    #[default]
    Reef,
    /// Mud, concrete, piles and pipes.
    Harbour,
    /// A steep wall with an overhang, lit from above, and no floor.
    Wall,
    /// A school of fish and divers in black, with nothing below and behind them.
    OpenWater,
}

impl Site {
    /// All of them.
    pub const ALL: &'static [Self] = &[Self::Reef, Self::Harbour, Self::Wall, Self::OpenWater];

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reef => "reef",
            Self::Harbour => "harbour",
            Self::Wall => "wall",
            Self::OpenWater => "open-water",
        }
    }
}

crate::names::named!(Site, "family of places");

/// Where the camera looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gaze {
    /// A little below the horizon: open water is in view.
    #[default]
    Ahead,
    /// So far down that the floor fills the image, but for what a thing's top may show; at the wall, where there is one; in open
    /// water, at a diver.
    Down,
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Kind {
    /// Nothing: the veiling light alone.
    OpenWater,
    /// Sand or mud.
    Floor,
    /// A boulder.
    Rock,
    /// Corals and sponges.
    Coral,
    /// Sea grass.
    Plant,
    /// A fish.
    Fish,
    /// Concrete, piles and pipes.
    Built,
    /// A diver with the gear.
    Diver,
}

/// A place with its clear image, its depth and what stands where.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// I, the place as seen through air, encoded.
    pub clear: Image<f32>,
    /// z, the distance along each line of sight in metres; [`OPEN_WATER`] where there is nothing to see.
    pub depth: DepthMap,
    /// What each pixel shows, row by row: the truth of a segmentation.
    pub kinds: Vec<Kind>,
}

impl Scene {
    /// The place of this seed: a reef, open water in view. The same seed gives the same pixels at any number of threads.
    ///
    /// # Panics
    ///
    /// When `size` has no pixels.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::truth::{Scene, Size};
    ///
    /// let scene = Scene::new(7, Size { width: 48, height: 32 });
    /// // The floor at the bottom is near, the top is open water.
    /// assert!(scene.depth.at(24, 31) < 5.0);
    /// assert!(scene.depth.at(24, 0) > 20.0);
    /// ```
    pub fn new(seed: u64, size: Size) -> Self {
        Self::of(View::default(), seed, size)
    }

    /// The place of this seed among those of another kind, or looked at another way.
    ///
    /// # Panics
    ///
    /// When `size` has no pixels.
    pub fn of(view: View, seed: u64, size: Size) -> Self {
        let place = layout::Place::new(view, seed);
        let own = Pose { pitch: place.pitch, yaw: place.yaw, ..Pose::default() };
        Self::seen(&place, &own, size)
    }

    /// The place of this seed as another camera sees it.
    ///
    /// # Panics
    ///
    /// When `size` has no pixels.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::truth::{Pose, Scene, Size, View};
    ///
    /// let size = Size { width: 48, height: 32 };
    /// let turned = Pose { yaw: 3.1, ..Pose::default() };
    /// let [ahead, behind] = [Pose::default(), turned].map(|pose| Scene::from(View::default(), 7, &pose, size));
    /// assert_ne!(ahead, behind);
    /// ```
    pub fn from(view: View, seed: u64, pose: &Pose, size: Size) -> Self {
        Self::seen(&layout::Place::new(view, seed), pose, size)
    }

    fn seen(place: &layout::Place, pose: &Pose, size: Size) -> Self {
        assert!(size.width > 0 && size.height > 0, "a scene needs pixels, not {size:?}");
        let seen: Vec<render::Seen> = render::render(place, pose, size);
        let samples = seen.iter().flat_map(|seen| seen.colour).collect();
        let distances = seen.iter().map(|seen| seen.distance).collect();
        let clear = Image::from_raw(size.width, size.height, samples).expect("one colour a pixel");
        let depth = DepthMap::from_distances(size.width, size.height, DepthKind::Metres, distances)
            .expect("one finite distance a pixel");
        let kinds = seen.iter().map(|seen| seen.kind).collect();
        Self { clear, depth, kinds }
    }

    /// The image a camera takes of this place through `water` (coefficients per metre).
    pub fn seen_through(&self, water: &Waterbody) -> Image<f32> {
        form(&self.clear, &self.depth, water).expect("clear image and depth were made in one size")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: Size = Size { width: 60, height: 40 };

    #[test]
    fn a_seed_gives_the_same_place_again_and_another_seed_another() {
        let scene = Scene::new(3, SMALL);
        assert_eq!(scene, Scene::new(3, SMALL));
        assert_ne!(scene, Scene::new(4, SMALL));
    }

    #[test]
    fn what_two_cameras_see_of_a_place_is_at_one_distance_from_it() {
        // One camera hangs half a metre above the other, both look straight down: in the middle of the image the floor is
        // half a metre farther.
        let size = Size { width: 61, height: 41 };
        let depth = |above: f32| {
            let pose =
                Pose { moved: [0.0, above, 0.0], pitch: std::f32::consts::FRAC_PI_2, ..Pose::default() };
            Scene::from(View::default(), 5, &pose, size).depth.at(30, 20)
        };
        let (near, far) = (depth(0.5), depth(1.0));
        assert!(near < 20.0 && (far - near - 0.5).abs() < 0.02, "{near} {far}");
    }

    #[test]
    fn a_camera_rolled_by_half_a_turn_sees_the_place_upside_down() {
        let of = |roll: f32| Scene::from(View::default(), 5, &Pose { roll, ..Pose::default() }, SMALL).depth;
        let (level, rolled) = (of(0.0), of(std::f32::consts::PI));
        // The middle of a pixel and the middle of the opposite pixel have one ray.
        let alike = (0..40).flat_map(|y| (0..60).map(move |x| (x, y))).filter(|&(x, y)| {
            let (own, other) = (level.at(x, y), rolled.at(59 - x, 39 - y));
            (own - other).abs() < 0.02 * own
        });
        assert!(alike.count() > 60 * 40 * 97 / 100);
    }

    #[test]
    fn a_narrow_view_is_the_middle_of_a_wide_one() {
        let half = Pose { half_view: 0.5 * HALF_VIEW, ..Pose::default() };
        let wide = Scene::from(View::default(), 5, &Pose::default(), Size { width: 120, height: 80 }).depth;
        let narrow = Scene::from(View::default(), 5, &half, SMALL).depth;
        let alike = (0..40).flat_map(|y| (0..60).map(move |x| (x, y))).filter(|&(x, y)| {
            let (own, other) = (narrow.at(x, y), wide.at(30 + x, 20 + y));
            (own - other).abs() < 0.02 * own
        });
        assert!(alike.count() > 60 * 40 * 97 / 100);
    }

    #[test]
    fn open_water_is_the_veiling_light_in_every_water() {
        let scene = Scene::new(1, SMALL);
        for named in waters() {
            let seen = scene.seen_through(&named.water);
            let distances = scene.depth.distances();
            let open = seen.pixels().iter().zip(&distances).filter(|&(_, &z)| z == OPEN_WATER);
            for (pixel, _) in open {
                for (value, veil) in pixel.iter().zip(named.water.veiling_light.rgb()) {
                    // The other rays of a pixel at the edge of a fish may have hit it.
                    assert!(*value >= veil - 0.5 / 255.0);
                }
            }
            let [value, ..] = seen.pixels()[0];
            assert!((value - named.water.veiling_light.rgb()[0]).abs() < 0.5 / 255.0);
        }
    }

    #[test]
    fn what_a_pixel_shows_agrees_with_how_far_it_is_and_what_stands_in_the_place() {
        for (site, there, floor, nowhere) in [
            (Site::Reef, Kind::Coral, true, Kind::Built),
            (Site::Harbour, Kind::Built, true, Kind::Coral),
            (Site::Wall, Kind::Rock, false, Kind::Built),
            (Site::OpenWater, Kind::Diver, false, Kind::Rock),
        ] {
            let scene = Scene::of(View { site, gaze: Gaze::Ahead }, 2, SMALL);
            let distances = scene.depth.distances();
            for (kind, distance) in scene.kinds.iter().zip(distances) {
                assert_eq!(*kind == Kind::OpenWater, distance == OPEN_WATER);
            }
            assert!(scene.kinds.contains(&there) && scene.kinds.contains(&Kind::OpenWater));
            assert_eq!(scene.kinds.contains(&Kind::Floor), floor, "{site}");
            assert!(!scene.kinds.contains(&nowhere));
        }
    }

    #[test]
    fn a_wall_fills_the_image_of_a_camera_that_faces_it() {
        for seed in 0..6 {
            let scene = Scene::of(View { site: Site::Wall, gaze: Gaze::Down }, seed, SMALL);
            let open = scene.kinds.iter().filter(|kind| **kind == Kind::OpenWater).count();
            assert!(open < scene.kinds.len() / 20, "seed {seed}: {open}");
        }
    }

    #[cfg(feature = "threads")]
    #[test]
    fn the_number_of_threads_changes_no_bit() {
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(alone.install(|| Scene::new(3, SMALL)), Scene::new(3, SMALL));
    }

    #[test]
    fn every_place_has_near_things_open_water_and_colours_in_range() {
        for seed in 0..12 {
            let scene = Scene::new(seed, SMALL);
            assert!(scene.clear.as_raw().iter().all(|v| (0.0..=1.0).contains(v)));
            let distances = scene.depth.distances();
            let share = |keep: &dyn Fn(f32) -> bool| {
                distances.iter().filter(|&&z| keep(z)).count() as f32 / distances.len() as f32
            };
            assert!(share(&|z| z < 4.0) > 0.1, "seed {seed} has nothing near");
            assert!(share(&|z| z == OPEN_WATER) > 0.05, "seed {seed} has no open water");
        }
    }
}
