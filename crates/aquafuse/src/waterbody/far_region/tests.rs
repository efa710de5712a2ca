use super::*;
use crate::depth;
use crate::image::Image;

const WIDTH: usize = 192;
const HEIGHT: usize = 144;

/// Grain of things: from -1 to 1, the same for a place and another for its neighbours.
fn grain(x: usize, y: usize) -> f32 {
    ((x * 7919 + y * 104_729).wrapping_mul(2_654_435_761) >> 8) as f32 % 2001.0 / 1000.0 - 1.0
}

fn paint(colour: impl Fn(usize, usize) -> [f32; 3]) -> Image<u8> {
    let places = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    let samples = places.flat_map(|(x, y)| colour(x, y).map(|value| (value + 0.5).clamp(0.0, 255.0) as u8));
    Image::from_raw(WIDTH, HEIGHT, samples.collect()).unwrap()
}

/// Water of this colour above a reef; `over` may paint something over both.
fn above_a_reef(water: [f32; 3], over: impl Fn(usize, usize) -> Option<[f32; 3]>) -> Image<u8> {
    paint(|x, y| {
        over(x, y).unwrap_or(if y < 60 {
            water.map(|value| value + 0.6 * grain(x, y))
        } else {
            [110.0, 95.0, 80.0].map(|value| value * (1.0 + 0.5 * grain(x / 2, y / 2)))
        })
    })
}

fn region(image: &Image<u8>, top: TopEdge) -> Region {
    let z = depth::estimate(image);
    Region::of(Cells::new(image.view(), &z.quantised().levels), false, top)
}

fn is_near(colour: [f32; 3], water: [f32; 3]) -> bool {
    (0..3).all(|c| (255.0 * colour[c] - water[c]).abs() < 4.0)
}

const BLUE: [f32; 3] = [20.0, 120.0, 170.0];

#[test]
fn a_black_suit_and_the_suns_glare_are_not_far() {
    for over in [[6.0; 3], [252.0; 3]] {
        let image = above_a_reef(BLUE, |x, y| ((40..90).contains(&x) && y < 50).then_some(over));
        let found = region(&image, TopEdge::First);
        assert!(is_near(found.colour, BLUE) && found.seen > 0.65, "{:?} {}", found.colour, found.seen);
    }
}

#[test]
fn bluish_green_is_presumed_and_not_demanded() {
    for water in
        [BLUE, [150.0, 130.0, 40.0], [120.0, 80.0, 50.0], [150.0, 170.0, 175.0], [130.0, 100.0, 160.0]]
    {
        let found = region(&above_a_reef(water, |_, _| None), TopEdge::First);
        assert!(is_near(found.colour, water), "{:?} for {water:?}", found.colour);
    }
}

#[test]
fn water_that_fills_the_image_around_a_thing_is_compared_with_the_thing() {
    for across in [10, 24, 60] {
        let thing = |x: usize, y: usize| x.abs_diff(96) < across && y.abs_diff(72) < across;
        let image = paint(|x, y| match thing(x, y) {
            true => [60.0, 55.0, 50.0].map(|value| value * (1.0 + 0.5 * grain(x / 2, y / 2))),
            false => BLUE.map(|value| value + 2.0 * grain(x, y)),
        });
        let found = region(&image, TopEdge::First);
        assert!(is_near(found.colour, BLUE) && found.seen > 0.68, "{across}: {}", found.seen);
    }
}

#[test]
fn where_all_is_rough_nothing_is_water() {
    let image = paint(|x, y| [90.0, 110.0, 100.0].map(|value| value * (1.0 + 0.5 * grain(x / 2, y / 2))));
    let found = region(&image, TopEdge::First);
    assert!(found.seen < 0.15, "{}", found.seen);
}

#[test]
fn an_image_on_its_side_or_upside_down_has_the_same_water() {
    let image = above_a_reef(BLUE, |_, _| None);
    let found = region(&image, TopEdge::First);
    let turned = image.as_raw().chunks(3).rev().flatten().copied().collect();
    let upside_down = region(&Image::from_raw(WIDTH, HEIGHT, turned).unwrap(), TopEdge::Last);
    assert!((found.seen - upside_down.seen).abs() < 1e-3);
    assert!((0..3).all(|c| (found.colour[c] - upside_down.colour[c]).abs() < 1.0 / 255.0));
    let on_its_side = (0..WIDTH).flat_map(|x| (0..HEIGHT).flat_map(move |y| [x, y])).collect::<Vec<_>>();
    let samples = on_its_side.chunks(2).flat_map(|place| image.row(place[1])[place[0]]).collect();
    let on_its_side = region(&Image::from_raw(HEIGHT, WIDTH, samples).unwrap(), TopEdge::Left);
    assert!((found.seen - on_its_side.seen).abs() < 0.02);
}

#[test]
fn things_that_are_as_far_as_each_other_are_read_together() {
    // Two walls, of which now one and then the other is a little smoother; as bright and by colour as far as each other.
    let (left, right) = ([60.0, 80.0, 140.0], [60.0, 140.0, 80.0]);
    let of_things = |smoother_left: bool| {
        let image = paint(|x, y| {
            let is_left = x < WIDTH / 2;
            let texture = if is_left == smoother_left { 0.30 } else { 0.31 };
            let wall = if is_left { left } else { right };
            wall.map(|value| value * (1.0 + texture * grain(x, y)))
        });
        region(&image, TopEdge::First).of_things
    };
    let (one, other) = (of_things(true), of_things(false));
    for c in [1, 2] {
        assert!((one[c] - other[c]).abs() < 20.0 / 255.0, "{one:?} {other:?}");
    }
}
