//! Open water all around: a school of silver fish, and divers in black.

use super::super::Gaze;
use super::super::geometry::{Bunch, Rod, Vec3, vec3};
use super::super::noise::Random;
use super::super::thing::{Pattern, Shape};
use super::Place;

const SUIT: [Vec3; 2] = [vec3(0.012, 0.012, 0.014), vec3(0.02, 0.02, 0.022)];
const SKIN: [Vec3; 2] = [vec3(0.52, 0.34, 0.25), vec3(0.50, 0.32, 0.24)];
const TANKS: [[Vec3; 2]; 3] = [
    [vec3(0.62, 0.62, 0.60), vec3(0.55, 0.55, 0.54)],
    [vec3(0.70, 0.58, 0.06), vec3(0.60, 0.50, 0.08)],
    [vec3(0.05, 0.10, 0.36), vec3(0.05, 0.08, 0.30)],
];
const FINS: [[Vec3; 2]; 3] = [
    [vec3(0.02, 0.02, 0.02), vec3(0.02, 0.02, 0.02)],
    [vec3(0.74, 0.62, 0.05), vec3(0.80, 0.70, 0.10)],
    [vec3(0.55, 0.06, 0.05), vec3(0.60, 0.08, 0.06)],
];
const SILVER: [[Vec3; 2]; 3] = [
    [vec3(0.62, 0.66, 0.68), vec3(0.20, 0.26, 0.30)],
    [vec3(0.50, 0.54, 0.50), vec3(0.62, 0.56, 0.10)],
    [vec3(0.34, 0.38, 0.42), vec3(0.10, 0.12, 0.15)],
];

impl Place {
    /// A diver near the camera, another farther away, a school behind or in front of them.
    pub(super) fn open_water(&mut self, random: &mut Random, gaze: Gaze) {
        self.pitch = random.between(-0.15, 0.25);
        let eye = self.ground(0.0, 0.0) + vec3(0.0, self.eye, 0.0);
        let near = match gaze {
            Gaze::Ahead => random.between(2.2, 4.0),
            Gaze::Down => random.between(1.5, 2.0),
        };
        for away in [near, random.between(5.0, 12.0)] {
            let across = vec3(random.between(-0.35, 0.35) * away, random.between(-0.2, 0.15) * away, away);
            self.diver(random, eye + across);
        }
        let (colours, heading) = (random.pick(&SILVER), random.pick(&[-1.0_f32, 1.0]));
        let middle = vec3(random.between(-1.5, 1.5), random.between(-1.0, 0.8), random.between(4.0, 9.0));
        let pattern = random.pick(&[Pattern::Band, Pattern::TwoTone]);
        for _ in 0..24 + random.below(20) {
            let spread = vec3(2.2 * random.normal(), 0.7 * random.normal(), 1.5 * random.normal());
            let mut centre = eye + middle + spread;
            centre.z = centre.z.max(eye.z + 1.8);
            let ahead = vec3(heading, 0.0, random.between(-0.35, 0.35)).normalised();
            let length = random.between(0.22, 0.5);
            self.add(Shape::Fish { centre, ahead, length, pattern }, colours);
        }
    }

    /// A diver who swims level, turned any way.
    fn diver(&mut self, random: &mut Random, chest: Vec3) {
        let turn = random.between(-3.1, 3.1);
        let ahead = vec3(turn.cos(), random.between(-0.25, 0.25), turn.sin()).normalised();
        let side = vec3(-ahead.z, 0.0, ahead.x).normalised();
        let up = vec3(0.0, 1.0, 0.0);
        let at = |along: f32, across: f32, high: f32| chest + ahead * along + side * across + up * high;
        let hips = at(-0.55, 0.0, 0.0);
        let mut suit = vec![Rod::new(at(0.12, 0.0, 0.0), hips, [0.19, 0.15])];
        let mut fins = Vec::new();
        for across in [-1.0_f32, 1.0] {
            let knee = hips + ahead * -0.45 + side * (0.12 * across) - up * random.between(-0.1, 0.2);
            let foot = knee + ahead * -0.42 + up * random.between(-0.1, 0.25);
            suit.push(Rod::new(hips + side * (0.09 * across), knee, [0.10, 0.075]));
            suit.push(Rod::new(knee, foot, [0.07, 0.05]));
            let tip = foot + ahead * -0.5 - up * random.between(0.0, 0.25);
            for blade in [-0.06_f32, 0.0, 0.06] {
                fins.push(Rod::new(foot, tip + side * blade, [0.035, 0.02]));
            }
            let elbow = at(0.15, 0.28 * across, -0.18);
            suit.push(Rod::new(at(0.05, 0.17 * across, 0.02), elbow, [0.07, 0.055]));
            suit.push(Rod::new(elbow, at(0.40, 0.16 * across, -0.22), [0.05, 0.04]));
        }
        let head = [Rod::new(at(0.30, 0.0, 0.05), at(0.38, 0.0, 0.07), [0.11, 0.10])];
        let tank = [Rod::new(at(0.05, 0.0, 0.23), at(-0.42, 0.0, 0.21), [0.09, 0.09])];
        self.add(Shape::Branches(Bunch::new(&suit, suit.len())), SUIT);
        self.add(Shape::Branches(Bunch::new(&head, 1)), random.pick(&[SUIT, SKIN]));
        self.add(Shape::Branches(Bunch::new(&tank, 1)), random.pick(&TANKS));
        self.add(Shape::Branches(Bunch::new(&fins, fins.len())), random.pick(&FINS));
    }
}
