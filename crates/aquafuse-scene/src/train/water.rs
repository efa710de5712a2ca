//! The water, estimated again from the images once the splats know distances.
//!
//! Steps alone hardly move β: a splat's own colour is free and follows at once, and what is left for β in a step is far less
//! than the difference between views. But the same surface is seen from near and from far. So a few thousand places are
//! followed through the images. For each β, the best colour of each place is known in closed form. What remains is a search
//! over two numbers a channel, for the β that gives each place one colour.

use super::TrainView;
use super::transmittance::OPEN;
use crate::camera::Camera;
use crate::compare::distances;
use crate::medium::{Medium, Water};
use crate::render::render;
use crate::splats::Splats;

/// Views that are used, at most, spread evenly over all.
const ASKED: usize = 24;
/// Places that are followed, about.
const PLACES: usize = 4000;
/// A place is seen where the image's own distance is that of the place, but for this share.
const SAME: f64 = 0.03;
/// Views that must see a place for it to count.
const VIEWS: usize = 3;
/// Places that must be left for an estimate.
const LEAST_PLACES: usize = 100;
/// Differences of colour below this count by their square, others by their size: highlights, and what hides a place.
const TOLERATED: f64 = 0.003;
/// How far β may be from where it was: four times less or more, tried in so many steps each way.
const REACH: f64 = 4.0;
const STEPS: i32 = 4;
/// The least step of the search in ln β.
const FINEST: f64 = 0.01;
/// What a factor of e away from where β was must gain at least: a dead channel has no evidence.
const INERTIA: f64 = 1e-6;

/// A place as one view has it.
#[derive(Clone, Copy, Debug)]
struct Seen {
    distance: f32,
    colour: [f32; 3],
}

/// The water by the images and the distances of the splats; `None` where too little is seen from several cameras.
///
/// B∞ stays as learned: open water shows it in every view.
pub(super) fn estimate(views: &[TrainView], splats: &Splats<f32>, water: &Water<f32>) -> Option<Water<f32>> {
    let places = places(views, splats, &Medium::Learned(water.clone()));
    if places.len() < LEAST_PLACES {
        return None;
    }
    let (veil, growth, fading) = (water.veil(), water.backscatter(), water.attenuation());
    let found: [[f64; 2]; 3] = std::array::from_fn(|c| {
        let before = [growth[c], fading[c]].map(f64::from);
        searched(&Channel { places: &places, c, veil: veil[c] }, before)
    });
    Some(Water::new(veil.map(f64::from), found.map(|[growth, _]| growth), found.map(|[_, fading]| fading)))
}

/// Places on things, each with all views of it.
fn places(views: &[TrainView], splats: &Splats<f32>, medium: &Medium<f32>) -> Vec<Vec<Seen>> {
    let asked: Vec<&TrainView> = views.iter().step_by(views.len().div_ceil(ASKED)).collect();
    let maps: Vec<Vec<Option<f32>>> =
        asked.iter().map(|view| distances(&render(splats, 0, &view.camera, medium).rendering)).collect();
    let pixels: usize = maps.iter().map(Vec::len).sum();
    let every = pixels.div_ceil(PLACES);
    let mut places = Vec::new();
    for (number, (view, map)) in asked.iter().zip(&maps).enumerate() {
        // Another grid in each view.
        for i in ((number * 7919) % every..map.len()).step_by(every) {
            let Some(distance) = map[i] else { continue };
            let width = view.camera.width;
            let place = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
            let position = view.camera.point_at(place, f64::from(distance));
            let views = asked.iter().zip(&maps).filter_map(|(view, map)| seen(view, map, position));
            let views: Vec<Seen> = views.collect();
            if views.len() >= VIEWS {
                places.push(views);
            }
        }
    }
    places
}

/// The place in this view; none where it is out of it or hidden.
fn seen(view: &TrainView, map: &[Option<f32>], position: [f64; 3]) -> Option<Seen> {
    let Camera { width, height, focal, centre, .. } = &view.camera;
    let seen = view.camera.to_camera(position);
    let [x, y] = [0, 1].map(|a| focal[a] * seen[a] / seen[2] + centre[a]);
    let inside = seen[2] > 0.0 && x > 0.5 && y > 0.5 && x < *width as f64 - 0.5 && y < *height as f64 - 0.5;
    let there = inside.then(|| map[y as usize * width + x as usize]).flatten().map(f64::from)?;
    let distance = seen.iter().map(|v| v * v).sum::<f64>().sqrt();
    ((there / distance - 1.0).abs() < SAME)
        .then(|| Seen { distance: distance as f32, colour: view.target.between(x - 0.5, y - 0.5) })
}

/// One channel of all places.
struct Channel<'a> {
    places: &'a [Vec<Seen>],
    c: usize,
    veil: f32,
}

impl Channel<'_> {
    /// How much colours differ that should be one, under these β.
    fn disagreement(&self, [growth, fading]: [f64; 2]) -> f64 {
        let (growth, fading) = (growth as f32, fading as f32);
        let (mut sum, mut count) = (0.0, 0_usize);
        let mut direct = Vec::new();
        for place in self.places {
            direct.clear();
            direct.extend(place.iter().map(|seen| {
                let veiled = self.veil * (1.0 - (-growth * seen.distance).exp());
                ((-fading * seen.distance).exp(), seen.colour[self.c] - veiled)
            }));
            let (top, bottom) = direct.iter().fold((0.0, 1e-12), |(top, bottom), (left, light)| {
                (top + left * light, bottom + left * left)
            });
            let colour = (top / bottom).max(0.0);
            for (left, light) in &direct {
                let off = f64::from(light - colour * left);
                sum += off.hypot(TOLERATED) - TOLERATED;
            }
            count += direct.len();
        }
        sum / count.max(1) as f64
    }
}

/// The β by which things agree best: on a grid about those `before`, then ever finer steps downhill.
fn searched(channel: &Channel<'_>, before: [f64; 2]) -> [f64; 2] {
    let at = |[a, b]: [f64; 2]| [before[0] * a.exp(), before[1] * b.exp()];
    let cost = |moved: [f64; 2]| {
        channel.disagreement(at(moved)) + INERTIA * (moved[0] * moved[0] + moved[1] * moved[1])
    };
    let mut step = REACH.ln() / f64::from(STEPS);
    let mut best = ([0.0; 2], cost([0.0; 2]));
    for a in -STEPS..=STEPS {
        for b in -STEPS..=STEPS {
            let tried = [a, b].map(|steps| f64::from(steps) * step);
            let cost = cost(tried);
            if cost < best.1 {
                best = (tried, cost);
            }
        }
    }
    while step > FINEST {
        step *= 0.5;
        // The valley lies aslant: more of the one is less of the other.
        while let Some(better) = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1], [1, -1], [-1, 1]]
            .into_iter()
            .map(|way| {
                let tried = std::array::from_fn(|i| best.0[i] + step * f64::from(way[i]));
                (tried, cost(tried))
            })
            .find(|(tried, cost)| *cost < best.1 && tried.iter().all(|v| v.abs() <= REACH.ln()))
        {
            best = better;
        }
    }
    at(best.0)
}

/// Gives the splats the colours that look through `new` as theirs did through `old`, from half way between the nearest and
/// the farthest camera.
pub(super) fn repaint(splats: &mut Splats<f32>, views: &[TrainView], old: &Medium<f32>, new: &Water<f32>) {
    let cameras: Vec<[f64; 3]> = views.iter().map(|view| view.camera.position()).collect();
    let between = old.between();
    for i in 0..splats.len() {
        let distance = half_way(&cameras, splats.mean(i).map(f64::from));
        let seen = between.through(splats.colour(i), distance);
        splats.paint(i, new.taken_out(seen, distance));
    }
}

/// B∞ is shown where this share of the pixels has its colour.
const SHOWN: f64 = 0.02;
/// One pixel in so many is looked at.
const LOOKED_AT: usize = 31;

/// Whether the images show this B∞ as open water does.
///
/// It is then right, and must stay until β is: while β_B is far too low, B∞ would rise to make up for it, and what is then too bright
/// in open water would be hidden by splats for good. A B∞ that no image shows is wrong, and must be found before splats hide
/// where it is.
pub(super) fn is_shown(views: &[TrainView], veil: [f32; 3]) -> bool {
    let (mut near, mut all) = (0_usize, 0_usize);
    for TrainView { target, .. } in views {
        let (width, height) = target.size();
        for i in (0..width * height).step_by(LOOKED_AT) {
            near += usize::from(target.is_near(i, veil, OPEN));
            all += 1;
        }
    }
    near as f64 >= SHOWN * all as f64
}

/// The least colour that a splat keeps while a water is learned.
const DARKEST: f32 = 1.0 / 512.0;

/// Keeps colours from falling below 0, where they have no gradient: the red of far things is so little that a step leads past
/// 0, and none would lead back.
pub(super) fn keep_colours(splats: &mut Splats<f32>) {
    for i in 0..splats.len() {
        let colour = splats.colour(i);
        if colour.iter().any(|value| *value < DARKEST) {
            splats.paint(i, colour.map(|value| value.max(DARKEST)));
        }
    }
}

fn half_way(cameras: &[[f64; 3]], position: [f64; 3]) -> f32 {
    let apart = |camera: &[f64; 3]| (0..3).map(|a| (camera[a] - position[a]).powi(2)).sum::<f64>().sqrt();
    let ends = cameras
        .iter()
        .map(apart)
        .fold((f64::MAX, 0.0_f64), |(near, far), distance| (near.min(distance), far.max(distance)));
    (0.5 * (ends.0 + ends.1)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Things of all colours at all distances, each seen from four places through one channel of a water.
    fn things(veil: f32, growth: f32, fading: f32, apart: f32) -> Vec<Vec<Seen>> {
        let thing = |i: u16| {
            let (own, near) = (f32::from(i * 7 % 10) / 9.0, 1.0 + f32::from(i % 13) * 0.5);
            let view = |far: f32| {
                let light = own * (-fading * far).exp() + veil * (1.0 - (-growth * far).exp());
                Seen { distance: far, colour: [light; 3] }
            };
            [1.0, 1.0 + apart, 1.0 + 2.0 * apart, 1.0 + 3.0 * apart].map(|by| view(near * by)).to_vec()
        };
        (0..200).map(thing).collect()
    }

    #[test]
    fn beta_is_what_makes_colours_of_things_agree() {
        let places = things(0.5, 0.2, 0.35, 0.1);
        let channel = Channel { places: &places, c: 1, veil: 0.5 };
        let [growth, fading] = searched(&channel, [0.12, 0.5]);
        assert!((growth / 0.2 - 1.0).abs() < 0.03 && (fading / 0.35 - 1.0).abs() < 0.03, "{growth} {fading}");
    }

    #[test]
    fn no_colour_falls_below_0() {
        let mut splats = Splats::<f32>::new(0);
        splats.push(&Splats::<f32>::ball(0, [0.0; 3], 0.1, 0.5, [-0.2, 0.5, 0.9]));
        keep_colours(&mut splats);
        let [red, green, blue] = splats.colour(0);
        assert!(red > 0.0 && red < 0.01 && (green - 0.5).abs() < 1e-6 && (blue - 0.9).abs() < 1e-6);
    }

    #[test]
    fn beta_stays_where_nothing_tells() {
        // Each thing from one distance only: any β will do.
        let places = things(0.5, 0.2, 0.35, 0.0);
        let found = searched(&Channel { places: &places, c: 0, veil: 0.5 }, [0.12, 0.5]);
        assert!((found[0] / 0.12 - 1.0).abs() < 0.02 && (found[1] / 0.5 - 1.0).abs() < 0.02, "{found:?}");
    }
}
