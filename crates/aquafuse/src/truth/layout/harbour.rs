//! A harbour's floor: mud, concrete blocks, piles, pipes, and few fish.

use super::super::geometry::{Bunch, Rod, Vec3, vec3};
use super::super::noise::Random;
use super::super::thing::{Pattern, Shape};
use super::Place;

const CONCRETE: [[Vec3; 2]; 3] = [
    [vec3(0.46, 0.45, 0.42), vec3(0.20, 0.22, 0.13)],
    [vec3(0.34, 0.33, 0.32), vec3(0.26, 0.15, 0.10)],
    [vec3(0.55, 0.52, 0.45), vec3(0.14, 0.16, 0.10)],
];
const METAL: [[Vec3; 2]; 4] = [
    [vec3(0.36, 0.16, 0.07), vec3(0.14, 0.06, 0.04)],
    [vec3(0.10, 0.10, 0.11), vec3(0.04, 0.04, 0.04)],
    [vec3(0.60, 0.48, 0.06), vec3(0.30, 0.22, 0.06)],
    [vec3(0.62, 0.62, 0.60), vec3(0.30, 0.20, 0.14)],
];
const WRASSE: [Vec3; 2] = [vec3(0.20, 0.22, 0.16), vec3(0.42, 0.40, 0.32)];

impl Place {
    /// Fills the place: blocks and piles that recede, a pipe across, a chain's worth of small things near by.
    pub(super) fn harbour(&mut self, random: &mut Random, side: f32) {
        for i in 0..9 {
            let z = 2.6 + 1.7 * i as f32 + random.between(-0.6, 0.6);
            let x = random.between(-0.75, 0.75) * z;
            self.block(random, x, z);
        }
        for i in 0..6 {
            let z = 4.0 + 2.4 * i as f32 + random.between(-0.5, 0.5);
            let x = side * random.between(0.25, 0.8) * z;
            self.pile(random, x, z);
        }
        self.pipe(random, side);
        for _ in 0..5 {
            let z = random.between(1.8, 4.5);
            let size = random.between(0.12, 0.3);
            let centre = self.ground(random.between(-0.6, 0.6) * z, z) + vec3(0.0, 0.3 * size, 0.0);
            let offset = random.between(0.0, 300.0);
            self.add(
                Shape::Rock { centre, radii: vec3(size, 0.7 * size, size), offset },
                random.pick(&CONCRETE),
            );
        }
        for _ in 0..3 + random.below(4) {
            let z = random.between(2.2, 6.0);
            let centre = vec3(random.between(-0.5, 0.5) * z, random.between(0.5, 1.3), z);
            let ahead = vec3(random.pick(&[-1.0, 1.0]), 0.0, random.between(-0.5, 0.5)).normalised();
            let length = random.between(0.2, 0.4);
            self.add(Shape::Fish { centre, ahead, length, pattern: Pattern::TwoTone }, WRASSE);
        }
    }

    fn block(&mut self, random: &mut Random, x: f32, z: f32) {
        let half = vec3(random.between(0.25, 0.8), random.between(0.2, 0.7), random.between(0.25, 0.8));
        let turn = random.between(0.0, 1.5);
        let centre = self.ground(x, z) + vec3(0.0, 0.7 * half.y, 0.0);
        self.add(Shape::Block { centre, half, turn }, random.pick(&CONCRETE));
    }

    fn pile(&mut self, random: &mut Random, x: f32, z: f32) {
        let foot = self.ground(x, z) - vec3(0.0, 0.2, 0.0);
        let top = foot + vec3(random.between(-0.3, 0.3), random.between(1.2, 3.4), 0.0);
        let radius = random.between(0.10, 0.22);
        let rods = [Rod::new(foot, top, [radius, radius])];
        self.add(Shape::Branches(Bunch::new(&rods, 1)), random.pick(&METAL));
    }

    /// A pipe that lies across the view and sinks into the mud here and there.
    fn pipe(&mut self, random: &mut Random, side: f32) {
        let (near, far) = (random.between(2.4, 3.5), random.between(6.0, 10.0));
        let (a, b) = (self.ground(-side * 2.2, near), self.ground(side * 4.0, far));
        let radius = random.between(0.08, 0.2);
        let up = vec3(0.0, 0.6 * radius, 0.0);
        let rods = [Rod::new(a + up, b + up, [radius, radius])];
        self.add(Shape::Branches(Bunch::new(&rods, 1)), random.pick(&METAL));
    }
}
