//! Every gradient against finite differences, in `f64`.

use aquafuse_scene::camera::Camera;
use aquafuse_scene::medium::{Medium, PARAMETERS, Water};
use aquafuse_scene::render::{Rendering, render};
use aquafuse_scene::splats::Splats;
use aquafuse_scene::train::loss::{Target, loss};

const WIDTH: usize = 37;
const HEIGHT: usize = 29;

/// Numbers in [0, 1), the same ones every time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

fn camera() -> Camera {
    let q = [0.97, 0.1, -0.2, 0.05];
    let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    Camera {
        width: WIDTH,
        height: HEIGHT,
        focal: [33.0, 31.0],
        centre: [17.2, 15.1],
        rotation: Camera::rotation_of(q.map(|v| v / length)),
        translation: [0.2, -0.1, 0.3],
    }
}

/// Splats of every kind in view: long and round, faint and nearly opaque, half outside, one behind the camera.
fn splats(degree: u8) -> Splats<f64> {
    let camera = camera();
    let mut numbers = Numbers(5);
    let mut splats = Splats::new(degree);
    for i in 0..24 {
        let place = [numbers.between(-4.0, WIDTH as f64 + 4.0), numbers.between(-4.0, HEIGHT as f64 + 4.0)];
        let position = camera.point_at(place, numbers.between(1.5, 6.0));
        let opacity = if i % 5 == 0 { 0.96 } else { numbers.between(0.1, 0.9) };
        let colour = [numbers.next(), numbers.next(), numbers.next()];
        let mut row = Splats::<f64>::ball(degree, position, 0.25, opacity, colour);
        for value in &mut row[3..6] {
            *value += numbers.between(-1.2, 0.6);
        }
        for value in &mut row[6..10] {
            *value += numbers.between(-0.8, 0.8);
        }
        for value in &mut row[14..] {
            *value = numbers.between(-0.25, 0.25);
        }
        splats.push(&row);
    }
    let behind = camera.point_at([18.0, 14.0], -3.0);
    splats.push(&Splats::<f64>::ball(degree, behind, 0.3, 0.5, [0.5; 3]));
    splats
}

fn water() -> Water<f64> {
    Water::new([0.1, 0.4, 0.5], [0.3, 0.2, 0.15], [0.4, 0.15, 0.1])
}

/// A loss that asks for everything that is drawn: numbers times planes, and the loss of training.
struct Asked {
    weights: Rendering<f64>,
    target: Target<f64>,
}

impl Asked {
    fn new() -> Self {
        let mut numbers = Numbers(9);
        let mut weights = Rendering::zeros(WIDTH, HEIGHT);
        let [r, g, b] = &mut weights.colour;
        for plane in [r, g, b, &mut weights.distance, &mut weights.transmittance] {
            plane.iter_mut().for_each(|v| *v = numbers.between(-1.0, 1.0) / (WIDTH * HEIGHT) as f64);
        }
        let mut value = || numbers.next() as f32;
        let pixels: Vec<[f32; 3]> = (0..WIDTH * HEIGHT).map(|_| [value(), value(), value()]).collect();
        Self { weights, target: Target::new(WIDTH, HEIGHT, &pixels) }
    }

    fn of(&self, rendering: &Rendering<f64>) -> f64 {
        let planes = |d: &Rendering<f64>| -> Vec<f64> {
            let [r, g, b] = &d.colour;
            [r, g, b, &d.distance, &d.transmittance].into_iter().flatten().copied().collect()
        };
        let weighed: f64 = planes(rendering).iter().zip(planes(&self.weights)).map(|(a, b)| a * b).sum();
        weighed + loss(rendering, &self.target, 0.2).0.total
    }

    fn gradient(&self, rendering: &Rendering<f64>) -> Rendering<f64> {
        let (_, mut gradient) = loss(rendering, &self.target, 0.2);
        for c in 0..3 {
            for (sum, weight) in gradient.colour[c].iter_mut().zip(&self.weights.colour[c]) {
                *sum += weight;
            }
        }
        gradient.distance.clone_from(&self.weights.distance);
        gradient.transmittance.clone_from(&self.weights.transmittance);
        gradient
    }
}

const STEP: f64 = 1e-6;
/// Gradients smaller than this are compared as if they were as large: finite differences know no more digits.
const LEAST: f64 = 1e-6;

fn off(slope: f64, found: f64) -> f64 {
    (slope - found).abs() / slope.abs().max(found.abs()).max(LEAST)
}

/// The worst relative error over all parameters of splats and water, and how many gradients are not nothing.
fn worst(degree: u8, medium: &Medium<f64>) -> (f64, usize) {
    let (camera, asked, mut splats) = (camera(), Asked::new(), splats(degree));
    let value = |splats: &Splats<f64>, medium: &Medium<f64>| {
        asked.of(&render(splats, degree, &camera, medium).rendering)
    };
    let drawn = render(&splats, degree, &camera, medium);
    let gradient = drawn.back(&splats, medium, &asked.gradient(&drawn.rendering));
    let (mut worst, mut counted) = (0.0_f64, 0);
    for i in 0..splats.rows().len() {
        let at = splats.rows()[i];
        let mut moved = |by: f64| {
            splats.rows_mut()[i] = at + by;
            value(&splats, medium)
        };
        let slope = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
        splats.rows_mut()[i] = at;
        let found = gradient.splats.rows()[i];
        let error = off(slope, found);
        assert!(
            error < 1e-4,
            "degree {degree}, row {}, number {}: {slope} {found}",
            i / splats.width(),
            i % splats.width()
        );
        worst = worst.max(error);
        counted += usize::from(found.abs() > LEAST);
    }
    if let Medium::Learned(water) = medium {
        for i in 0..PARAMETERS {
            let moved = |by: f64| {
                let mut water = water.clone();
                water.raw[i] += by;
                value(&splats, &Medium::Learned(water))
            };
            let slope = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
            let error = off(slope, gradient.water[i]);
            assert!(error < 1e-4, "water {i}: {slope} {}", gradient.water[i]);
            assert!(gradient.water[i].abs() > LEAST, "water {i} tells nothing");
            worst = worst.max(error);
        }
    }
    (worst, counted)
}

#[test]
fn every_gradient_is_that_of_finite_differences_in_air() {
    for degree in 0..=3 {
        let (worst, counted) = worst(degree, &Medium::Air);
        println!("degree {degree}: worst relative error {worst:.1e}, {counted} gradients");
        assert!(counted > 150, "{counted} gradients are large enough to compare");
    }
}

#[test]
fn every_gradient_is_that_of_finite_differences_in_learned_water() {
    let (worst, counted) = worst(3, &Medium::Learned(water()));
    println!("worst relative error {worst:.1e}, {counted} gradients");
    assert!(counted > 700, "{counted} gradients are large enough to compare");
}
