//! The circle of a fish-eye, around which an image has one colour.
//!
//! The four corners must have one colour. From each side of each row and column inwards, the first place of another
//! colour is a point of the outline. The circle through most of these points counts if the image has the corners' colour
//! around it and another one within it.

use super::bars::{distance, median, to_bytes};
use super::{Margins, places};
use crate::image::{Encoding, ImageRef, Sample};

/// Colours within so many steps are that of the corners.
const WITHIN: u16 = 16;
/// Just within the circle, colours differ from it by so many steps.
const STEP: u16 = 32;
/// Points of the outline that lie on the circle, pixels around it of the corners' colour, and places of its rim that
/// differ, in percent at least.
const ON_CIRCLE: usize = 60;
const AROUND: usize = 90;
const LIT: usize = 50;
/// Around the circle there is at least this part of the image. The corners that a lens darkens are less.
const LEAST_AROUND: usize = 200;
/// Sides of images in which a circle is sought: sums of fourth powers of larger ones would not fit.
const SIDES: std::ops::RangeInclusive<usize> = 48..=16_384;

/// A circle, in half pixels from the middle of a rectangle: the mirror image of a picture then has the circle with the
/// signs changed, to the bit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    margins: Margins,
    size: (usize, usize),
    middle: [f64; 2],
    radius: f64,
}

impl Circle {
    /// Whether it holds the pixel at a column and row of the image. The pixels on its rim are mixed with the border, and
    /// are left to it.
    pub(super) fn contains(&self, x: usize, y: usize) -> bool {
        let at = from_middle(self.size, x - self.margins.left, y - self.margins.top);
        self.squared_distance(at) <= (self.radius - 2.0).max(0.0).powi(2)
    }

    fn squared_distance(&self, [u, v]: [i64; 2]) -> f64 {
        let ([u, v], [at_u, at_v]) = ([u as f64, v as f64], self.middle);
        (u - at_u).powi(2) + (v - at_v).powi(2)
    }
}

/// The middle of a pixel in half pixels from the middle of a rectangle.
fn from_middle((width, height): (usize, usize), x: usize, y: usize) -> [i64; 2] {
    [2 * x as i64 + 1 - width as i64, 2 * y as i64 + 1 - height as i64]
}

/// The circle within what `margins` leave of an image.
pub(super) fn find<T: Sample, E: Encoding>(image: ImageRef<'_, T, E>, margins: Margins) -> Option<Circle> {
    let size = margins.leave(image.size())?;
    if !SIDES.contains(&size.0) || !SIDES.contains(&size.1) {
        return None;
    }
    let pixel = |x: usize, y: usize| to_bytes(image.row(margins.top + y)[margins.left + x]);
    let colour = corners(size, pixel)?;
    let is_other = |x: usize, y: usize| distance(pixel(x, y), colour) > WITHIN;
    let rows = outline(size, is_other);
    let columns = outline((size.1, size.0), |y, x| is_other(x, y));
    let few = |ends: &[_], all: usize| ends.len() * 16 < places(all).len();
    if few(&rows, size.1) || few(&columns, size.0) {
        return None;
    }
    // The middle of each row is that of the circle, whatever its length.
    let middle_of = |ends: &[([i64; 2], i64)]| {
        let mut sums: Vec<i64> = ends.iter().map(|(ends, _)| ends[0] + ends[1]).collect();
        sums.sort_unstable();
        (sums[sums.len() / 2] + sums[(sums.len() - 1) / 2]) as f64 / 4.0
    };
    let middle = [middle_of(&rows), middle_of(&columns)];
    let across = rows.iter().flat_map(|&([left, right], v)| [[left, v], [right, v]]);
    let down = columns.iter().flat_map(|&([above, below], u)| [[u, above], [u, below]]);
    let points: Vec<[i64; 2]> = across.chain(down).collect();
    let mut circle = Circle { margins, size, middle, radius: 0.0 };
    let mut distances: Vec<f64> = points.iter().map(|&point| circle.squared_distance(point)).collect();
    let half = distances.len() / 2;
    circle.radius = distances.select_nth_unstable_by(half, f64::total_cmp).1.sqrt();
    for _ in 0..2 {
        let near: Vec<_> = circle.near(&points, 6.0, 0.03);
        circle = circle.through(&near).unwrap_or(circle);
    }
    let on_it = circle.near(&points, 3.0, 0.01).len() * 100 >= ON_CIRCLE * points.len();
    (on_it && circle.divides(is_other, |x, y| distance(pixel(x, y), colour) >= STEP)).then_some(circle)
}

/// The colour that all four corners have.
fn corners((width, height): (usize, usize), pixel: impl Fn(usize, usize) -> [u8; 3]) -> Option<[u8; 3]> {
    let side = (width.min(height) / 64).max(2);
    let corner = |x: usize, y: usize| (y..y + side).flat_map(move |y| (x..x + side).map(move |x| (x, y)));
    let (right, bottom) = (width - side, height - side);
    let mut pixels: Vec<[u8; 3]> = [(0, 0), (right, 0), (0, bottom), (right, bottom)]
        .into_iter()
        .flat_map(|(x, y)| corner(x, y))
        .map(|(x, y)| pixel(x, y))
        .collect();
    let colour = [0, 1, 2].map(|c| median(pixels.iter().map(|pixel| pixel[c])));
    pixels.retain(|&pixel| distance(pixel, colour) > WITHIN / 2);
    (pixels.len() * 10 <= 4 * side * side).then_some(colour)
}

/// Of each row that begins and ends with the corners' colour and holds another: the two ends of the other, and the row, in
/// half pixels from the middle. Two neighbours must be of another colour, because one may be noise.
fn outline((width, height): (usize, usize), is_other: impl Fn(usize, usize) -> bool) -> Vec<([i64; 2], i64)> {
    let row = |y: usize| {
        let left = (0..width - 1).find(|&x| is_other(x, y) && is_other(x + 1, y))?;
        let right = (1..width).rev().find(|&x| is_other(x, y) && is_other(x - 1, y))?;
        let [_, v] = from_middle((width, height), 0, y);
        let from_middle = |edge: usize| 2 * edge as i64 - width as i64;
        (left > 0 && right + 1 < width).then(|| ([from_middle(left), from_middle(right + 1)], v))
    };
    places(height).into_iter().filter_map(row).collect()
}

impl Circle {
    /// The points near its rim: within so many half pixels, or so much of the radius.
    fn near(&self, points: &[[i64; 2]], within: f64, of_radius: f64) -> Vec<[i64; 2]> {
        let within = within.max(of_radius * self.radius);
        let is_near =
            |&&point: &&[i64; 2]| (self.squared_distance(point).sqrt() - self.radius).abs() <= within;
        points.iter().filter(is_near).copied().collect()
    }

    /// The circle with the least squares of `u² + v² + d u + e v + f` over points. Sums are whole numbers, so that neither
    /// their order nor a mirrored image changes a bit.
    fn through(self, points: &[[i64; 2]]) -> Option<Self> {
        let sum = |of: fn(i128, i128) -> i128| -> i128 {
            points.iter().map(|&[u, v]| of(u.into(), v.into())).sum()
        };
        let n = points.len() as i128;
        let (u, v, uu, vv, uv) =
            (sum(|u, _| u), sum(|_, v| v), sum(|u, _| u * u), sum(|_, v| v * v), sum(|u, v| u * v));
        let (uz, vz) = (sum(|u, v| u * (u * u + v * v)), sum(|u, v| v * (u * u + v * v)));
        let z = uu + vv;
        let determinant = |[a, b, c]: [[i128; 3]; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        let all = determinant([[uu, uv, u], [uv, vv, v], [u, v, n]]);
        if all == 0 {
            return None;
        }
        let solved = |part: i128| -part as f64 / all as f64;
        let d = solved(determinant([[uz, uv, u], [vz, vv, v], [z, v, n]]));
        let e = solved(determinant([[uu, uz, u], [uv, vz, v], [u, z, n]]));
        let f = solved(determinant([[uu, uv, uz], [uv, vv, vz], [u, v, z]]));
        let squared = (d * d + e * e) / 4.0 - f;
        (squared > 0.0).then(|| Self { middle: [-d / 2.0, -e / 2.0], radius: squared.sqrt(), ..self })
    }

    /// Whether the image has the corners' colour around it, and is lit along its rim.
    fn divides(
        &self,
        is_other: impl Fn(usize, usize) -> bool,
        is_lit: impl Fn(usize, usize) -> bool,
    ) -> bool {
        let (width, height) = self.size;
        let squared = |off: f64| (self.radius + off).max(0.0).powi(2);
        let (outside, rim) = (squared(4.0), squared(-8.0)..squared(-4.0));
        let (mut around, mut other, mut on_rim, mut lit) = (0, 0, 0, 0);
        let (columns, mut seen) = (places(width), 0);
        for (y, &x) in places(height).into_iter().flat_map(|y| columns.iter().map(move |x| (y, x))) {
            seen += 1;
            let distance = self.squared_distance(from_middle(self.size, x, y));
            if distance > outside {
                around += 1;
                other += usize::from(is_other(x, y));
            } else if rim.contains(&distance) {
                on_rim += 1;
                lit += usize::from(is_lit(x, y));
            }
        }
        around * LEAST_AROUND >= seen
            && other * 100 <= (100 - AROUND) * around
            && on_rim > 0
            && lit * 100 >= LIT * on_rim
    }
}
