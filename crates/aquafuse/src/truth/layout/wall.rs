//! A steep wall that falls off out of sight: bulging rock, an overhang, sea fans, small fish.

use super::super::Gaze;
use super::super::geometry::{Bunch, Rod, Vec3, vec3};
use super::super::noise::Random;
use super::super::thing::{Pattern, Shape};
use super::Place;

const BASALT: [[Vec3; 2]; 3] = [
    [vec3(0.13, 0.12, 0.13), vec3(0.30, 0.10, 0.22)],
    [vec3(0.20, 0.17, 0.14), vec3(0.46, 0.30, 0.06)],
    [vec3(0.16, 0.18, 0.17), vec3(0.14, 0.24, 0.30)],
];
const FANS: [[Vec3; 2]; 3] = [
    [vec3(0.50, 0.05, 0.06), vec3(0.72, 0.14, 0.10)],
    [vec3(0.66, 0.40, 0.05), vec3(0.80, 0.62, 0.18)],
    [vec3(0.36, 0.12, 0.42), vec3(0.60, 0.40, 0.66)],
];
const ANTHIAS: [Vec3; 2] = [vec3(0.90, 0.34, 0.10), vec3(0.70, 0.20, 0.50)];
/// Spacing of its bulges, and how far they reach down, up and along, metres.
const APART: f32 = 2.6;
const ROWS: usize = 6;
const COLUMNS: usize = 9;

impl Place {
    /// The wall rises on one side of the camera, or in front of it.
    pub(super) fn wall(&mut self, random: &mut Random, side: f32, gaze: Gaze) {
        self.sun = vec3(-side * random.between(0.1, 0.4), 1.0, random.between(-0.2, 0.2)).normalised();
        self.pitch = random.between(-0.15, 0.15);
        let eye = self.ground(0.0, 0.0) + vec3(0.0, self.eye, 0.0);
        // Its foot leans towards the camera, its top overhangs.
        let away = match gaze {
            Gaze::Ahead => random.between(2.2, 3.4),
            Gaze::Down => random.between(3.0, 5.0),
        };
        if gaze == Gaze::Down {
            self.yaw = side * random.between(1.2, 1.5);
        }
        let lean = random.between(-0.12, 0.2);
        let mut surface = Vec::new();
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                let up = (row as f32 - 2.5) * APART + random.between(-0.5, 0.5);
                let along = (column as f32 - 1.5) * APART + random.between(-0.5, 0.5);
                let radii =
                    vec3(random.between(1.6, 2.3), random.between(1.7, 2.3), random.between(1.7, 2.4));
                let out = away + radii.x - lean * up + random.between(-0.5, 0.5);
                let centre = eye + vec3(side * out, up, along);
                self.bulge(random, centre, radii);
                surface.push(centre - vec3(0.85 * side * radii.x, 0.0, 0.0));
            }
        }
        for column in 0..4 {
            let along = 1.0 + 3.5 * column as f32 + random.between(-0.8, 0.8);
            let centre =
                eye + vec3(side * (away + random.between(0.2, 1.0)), random.between(2.6, 4.2), along);
            let radii = vec3(random.between(1.4, 2.2), random.between(0.6, 1.0), 2.2);
            self.bulge(random, centre, radii);
        }
        for _ in 0..9 {
            let foot = random.pick(&surface);
            self.fan(random, foot, side);
        }
        for _ in 0..14 + random.below(12) {
            let out = random.between(0.5, 2.4).min(away - 0.5);
            let centre = eye
                + vec3(
                    side * out,
                    random.between(-1.6, 1.8),
                    random.between(if self.yaw == 0.0 { 2.2 } else { -2.0 }, 9.0),
                );
            let ahead = vec3(random.between(-0.4, 0.4), 0.0, random.pick(&[-1.0, 1.0])).normalised();
            let length = random.between(0.08, 0.16);
            self.add(Shape::Fish { centre, ahead, length, pattern: Pattern::TwoTone }, ANTHIAS);
        }
    }

    fn bulge(&mut self, random: &mut Random, centre: Vec3, radii: Vec3) {
        let offset = random.between(0.0, 300.0);
        self.add(Shape::Rock { centre, radii, offset }, random.pick(&BASALT));
    }

    /// A sea fan: it forks in one plane, away from the wall and upwards.
    fn fan(&mut self, random: &mut Random, foot: Vec3, side: f32) {
        let (mut rods, height) = (Vec::new(), random.between(0.5, 1.1));
        for stem in 0..7 {
            let turn = (stem as f32 - 3.0) * 0.33;
            let up = vec3(-0.75 * side, turn.cos(), turn.sin()).normalised();
            let middle = foot + up * (0.5 * height);
            rods.push(Rod::new(foot, middle, [0.03, 0.022]));
            for fork in [-0.3_f32, 0.0, 0.3] {
                let tip = vec3(-0.6 * side, (turn + fork).cos(), (turn + fork).sin()).normalised();
                rods.push(Rod::new(middle, middle + tip * (0.5 * height), [0.02, 0.012]));
            }
        }
        self.add(Shape::Branches(Bunch::new(&rods, 4)), random.pick(&FANS));
    }
}
