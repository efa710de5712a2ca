//! The layout of a place.

mod harbour;
mod open_water;
mod wall;

use super::floor::{Floor, MUD, SAND};
use super::geometry::{Bunch, Rod, Vec3, vec3};
use super::noise::Random;
use super::thing::{Pattern, Shape, Thing};
use super::{Gaze, Kind, Site, View};

/// A place: the floor, what is on it, and how the camera and the sun stand.
pub(super) struct Place {
    site: Site,
    pub(super) floor: Floor,
    pub(super) things: Vec<Thing>,
    /// Height of the camera above the ground below it, metres.
    pub(super) eye: f32,
    /// How far the camera looks down, and to the right, radians.
    pub(super) pitch: f32,
    pub(super) yaw: f32,
    /// Unit direction towards the sun.
    pub(super) sun: Vec3,
}

/// How far below the floor lies where none is seen, metres.
const OUT_OF_SIGHT: f32 = 60.0;

const ROCKS: [Vec3; 4] =
    [vec3(0.30, 0.27, 0.24), vec3(0.24, 0.22, 0.22), vec3(0.36, 0.29, 0.22), vec3(0.22, 0.24, 0.22)];
const CRUSTS: [Vec3; 5] = [
    vec3(0.48, 0.20, 0.34),
    vec3(0.62, 0.26, 0.08),
    vec3(0.38, 0.36, 0.13),
    vec3(0.55, 0.12, 0.10),
    vec3(0.58, 0.44, 0.20),
];
const CORALS: [[Vec3; 2]; 5] = [
    [vec3(0.72, 0.30, 0.06), vec3(0.95, 0.72, 0.45)],
    [vec3(0.52, 0.16, 0.40), vec3(0.85, 0.60, 0.80)],
    [vec3(0.70, 0.14, 0.14), vec3(0.95, 0.55, 0.45)],
    [vec3(0.58, 0.48, 0.14), vec3(0.90, 0.85, 0.55)],
    [vec3(0.62, 0.42, 0.30), vec3(0.92, 0.82, 0.72)],
];
const SPONGES: [[Vec3; 2]; 3] = [
    [vec3(0.70, 0.20, 0.08), vec3(0.52, 0.10, 0.06)],
    [vec3(0.62, 0.50, 0.08), vec3(0.44, 0.32, 0.05)],
    [vec3(0.40, 0.18, 0.48), vec3(0.26, 0.10, 0.36)],
];
const LEAVES: [[Vec3; 2]; 3] = [
    [vec3(0.06, 0.12, 0.02), vec3(0.26, 0.38, 0.07)],
    [vec3(0.14, 0.11, 0.02), vec3(0.44, 0.34, 0.08)],
    [vec3(0.05, 0.10, 0.04), vec3(0.16, 0.36, 0.14)],
];
const FISHES: [([Vec3; 2], Pattern); 5] = [
    ([vec3(0.88, 0.66, 0.05), vec3(0.05, 0.05, 0.07)], Pattern::Bars),
    ([vec3(0.86, 0.30, 0.04), vec3(0.92, 0.90, 0.85)], Pattern::Bars),
    ([vec3(0.10, 0.22, 0.66), vec3(0.90, 0.78, 0.08)], Pattern::Band),
    ([vec3(0.62, 0.66, 0.68), vec3(0.30, 0.36, 0.40)], Pattern::Band),
    ([vec3(0.60, 0.12, 0.42), vec3(0.94, 0.74, 0.10)], Pattern::TwoTone),
];

impl Place {
    pub(super) fn new(view: View, seed: u64) -> Self {
        let mut random = Random::new(seed);
        // The reef rises on one side; the other is sand and grass.
        let side = random.pick(&[-1.0_f32, 1.0]);
        let floor = Floor {
            offset: random.between(0.0, 400.0),
            slope: side * random.between(0.04, 0.11),
            ground: match view.site {
                Site::Harbour => MUD,
                Site::Reef | Site::Wall | Site::OpenWater => SAND,
            },
            below: match view.site {
                Site::Reef | Site::Harbour => 0.0,
                Site::Wall | Site::OpenWater => OUT_OF_SIGHT,
            },
        };
        let mut place = Self {
            site: view.site,
            floor,
            things: Vec::new(),
            eye: floor.below + random.between(1.0, 1.5),
            pitch: random.between(0.10, 0.20),
            yaw: 0.0,
            sun: vec3(random.between(-0.5, 0.5), 1.0, random.between(-0.6, 0.1)).normalised(),
        };
        match view.site {
            Site::Reef => {
                place.reef(&mut random, side);
                place.foreground(&mut random, side);
                place.meadow(&mut random, side);
                place.fish(&mut random, side);
            }
            Site::Harbour => place.harbour(&mut random, side),
            Site::Wall => place.wall(&mut random, side, view.gaze),
            Site::OpenWater => place.open_water(&mut random, view.gaze),
        }
        if view.gaze == Gaze::Down && place.floor.below == 0.0 {
            // The upper edge of the image then meets the floor some metres away.
            place.pitch += random.between(0.42, 0.60);
            place.eye *= random.between(1.0, 2.2);
        }
        place
    }

    /// What a thing of this place is.
    pub(super) fn kind(&self, thing: &Thing) -> Kind {
        match (&thing.shape, self.site) {
            (Shape::Fish { .. }, _) => Kind::Fish,
            (Shape::Leaves(_), _) => Kind::Plant,
            (Shape::Rock { .. }, _) => Kind::Rock,
            (Shape::Branches(_), Site::OpenWater) => Kind::Diver,
            // A harbour's rods are piles and pipes.
            (Shape::Block { .. }, _) | (Shape::Branches(_), Site::Harbour) => Kind::Built,
            (Shape::Brain { .. } | Shape::Tubes(_) | Shape::Branches(_), _) => Kind::Coral,
        }
    }

    /// A point on the floor.
    fn ground(&self, x: f32, z: f32) -> Vec3 {
        vec3(x, self.floor.height(x, z), z)
    }

    fn add(&mut self, shape: Shape, colours: [Vec3; 2]) {
        self.things.push(Thing::new(shape, colours));
    }

    /// Boulders that grow towards the reef's side, corals and sponges on and between them.
    fn reef(&mut self, random: &mut Random, side: f32) {
        for i in 0..13 {
            let z = 3.4 + 1.15 * i as f32 + random.between(-0.5, 0.5);
            let x = side * (random.between(0.2, 0.75) * z * 0.75 + 0.5);
            let size = random.between(0.35, 0.8) * (0.8 + 0.05 * z);
            self.rock(random, x, z, size);
            for _ in 0..random.below(4) {
                let around = 1.1 * size;
                let (x, z) = (x + random.between(-around, around), z + random.between(-around, 0.4 * around));
                self.growth(random, x, z, 0.5 + 0.5 * size);
            }
        }
        for _ in 0..3 {
            let z = random.between(7.0, 15.0);
            let (x, size) = (-side * random.between(0.1, 0.6) * z, random.between(0.25, 0.55));
            self.rock(random, x, z, size);
            self.growth(random, x + 0.5, z - 0.4, 0.6);
        }
    }

    /// A few things within two or three metres, where colours are still whole.
    fn foreground(&mut self, random: &mut Random, side: f32) {
        let (x, z) = (side * random.between(0.55, 1.0), random.between(1.9, 2.4));
        let size = random.between(0.28, 0.40);
        self.rock(random, x + 0.35 * side, z + 0.3, size);
        for _ in 0..4 {
            let (dx, dz) = (random.between(-0.55, 0.45), random.between(-0.3, 0.45));
            self.growth(random, x + dx * side, z + dz, 0.42);
        }
        let (x, z) = (-side * random.between(0.5, 1.2), random.between(2.2, 3.0));
        self.growth(random, x, z, 0.45);
    }

    fn rock(&mut self, random: &mut Random, x: f32, z: f32, size: f32) {
        let mut stretch = || size * random.between(0.75, 1.35);
        let radii = vec3(stretch(), 0.75 * stretch(), stretch());
        let centre = self.ground(x, z) + vec3(0.0, 0.35 * radii.y, 0.0);
        let offset = random.between(0.0, 300.0);
        let colours = [random.pick(&ROCKS), random.pick(&CRUSTS)];
        self.add(Shape::Rock { centre, radii, offset }, colours);
    }

    /// A coral or a sponge of about `size` metres.
    fn growth(&mut self, random: &mut Random, x: f32, z: f32, size: f32) {
        let foot = self.ground(x, z);
        match random.below(5) {
            0 => {
                let radius = 0.45 * size * random.between(0.7, 1.2);
                let colours = [vec3(0.60, 0.46, 0.18), vec3(0.26, 0.20, 0.06)];
                self.add(Shape::Brain { centre: foot + vec3(0.0, 0.3 * radius, 0.0), radius }, colours);
            }
            1 => {
                let tubes = (0..3 + random.below(4)).map(|_| {
                    let spread = 0.28 * size;
                    let a =
                        foot + vec3(random.between(-spread, spread), -0.05, random.between(-spread, spread));
                    let lean = vec3(a.x - foot.x, 0.0, a.z - foot.z) * 0.8;
                    let b = a + lean + vec3(0.0, size * random.between(0.55, 1.1), 0.0);
                    Rod::new(a, b, [0.07 * size, size * random.between(0.10, 0.15)])
                });
                let tubes = tubes.collect();
                self.add(Shape::Tubes(tubes), random.pick(&SPONGES));
            }
            _ => {
                let mut rods = Vec::new();
                for _ in 0..4 + random.below(3) {
                    let out =
                        vec3(random.between(-1.0, 1.0), random.between(0.7, 1.6), random.between(-1.0, 1.0));
                    branch(random, &mut rods, foot, out.normalised() * (0.42 * size), 0.055 * size, FORKS);
                }
                self.add(Shape::Branches(Bunch::new(&rods, FORKED)), random.pick(&CORALS));
            }
        }
    }

    /// Tufts of grass on the open side, all bent by one current.
    fn meadow(&mut self, random: &mut Random, side: f32) {
        let current = vec3(random.between(-0.5, 0.5), 0.0, random.between(-0.3, 0.3));
        let colours = random.pick(&LEAVES);
        let (middle, spread) = (random.between(3.5, 6.0), random.between(1.5, 3.5));
        for _ in 0..22 {
            let z = (middle + random.between(-spread, spread)).max(1.8);
            let x = -side * random.between(0.12, 0.75) * z;
            let foot = self.ground(x, z);
            let mut rods = Vec::new();
            for _ in 0..6 + random.below(5) {
                let root = foot + vec3(random.between(-0.13, 0.13), -0.03, random.between(-0.13, 0.13));
                leaf(random, &mut rods, root, current);
            }
            self.add(Shape::Leaves(Bunch::new(&rods, LEAF_PIECES)), colours);
        }
    }

    /// A school in the middle distance and one or two fish that came to look.
    fn fish(&mut self, random: &mut Random, side: f32) {
        let (colours, pattern) = random.pick(&FISHES);
        let heading = random.pick(&[-1.0_f32, 1.0]);
        let (x, y, z) =
            (-side * random.between(0.0, 1.0), random.between(1.1, 1.7), random.between(4.0, 7.0));
        for _ in 0..9 + random.below(8) {
            let spread =
                vec3(random.between(-1.5, 1.5), random.between(-0.5, 0.7), random.between(-1.2, 2.0));
            let ahead = vec3(heading, 0.0, random.between(-0.4, 0.4)).normalised();
            let centre = vec3(x, y, z) + spread;
            let length = random.between(0.24, 0.36);
            self.add(Shape::Fish { centre, ahead, length, pattern }, colours);
        }
        for _ in 0..1 + random.below(2) {
            let (colours, pattern) = random.pick(&FISHES);
            let z = random.between(1.7, 2.6);
            let centre = vec3(-side * random.between(-0.1, 0.45) * z, random.between(0.8, 1.35), z);
            let ahead = vec3(random.pick(&[-1.0, 1.0]), 0.0, random.between(-0.5, 0.5)).normalised();
            let length = random.between(0.28, 0.42);
            self.add(Shape::Fish { centre, ahead, length, pattern }, colours);
        }
    }
}

/// Times a coral's branch forks in two, and the rods that makes.
const FORKS: u32 = 2;
const FORKED: usize = (2 << FORKS) - 1;
/// Straight pieces of a bent leaf.
const LEAF_PIECES: usize = 3;

/// A coral's branch that forks `forks` times.
fn branch(random: &mut Random, rods: &mut Vec<Rod>, a: Vec3, along: Vec3, radius: f32, forks: u32) {
    let b = a + along;
    rods.push(Rod::new(a, b, [radius, 0.75 * radius]));
    if forks > 0 {
        for _ in 0..2 {
            let length = along.length();
            let mut turn = || random.between(-0.65, 0.65) * length;
            let next = along + vec3(turn(), turn().abs() * 0.6, turn());
            branch(random, rods, b, next.normalised() * (0.68 * length), 0.72 * radius, forks - 1);
        }
    }
}

/// A leaf that leans further the higher it gets.
fn leaf(random: &mut Random, rods: &mut Vec<Rod>, root: Vec3, current: Vec3) {
    let length = random.between(0.4, 0.95);
    let own = vec3(random.between(-0.25, 0.25), 0.0, random.between(-0.25, 0.25));
    let mut a = root;
    for piece in 0..LEAF_PIECES {
        let height = (piece + 1) as f32 / LEAF_PIECES as f32;
        let direction = (vec3(0.0, 1.0, 0.0) + (current + own) * (1.2 * height)).normalised();
        let b = a + direction * (length / LEAF_PIECES as f32);
        let width = |height: f32| 0.012 * (1.0 - 0.75 * height * height);
        rods.push(Rod::new(a, b, [width(height - 1.0 / LEAF_PIECES as f32), width(height)]));
        a = b;
    }
}
