use super::*;
use crate::depth::{DepthMap, DepthModel};
use crate::image::Image;
use crate::metrics::spearman;
use crate::truth::{Scene, Size, waters};
use proptest::prelude::*;

/// Moves each stored pixel to where `place` says, given width and height.
fn moved(
    image: &Image<u8>,
    size: (usize, usize),
    place: impl Fn(usize, usize) -> (usize, usize),
) -> Image<u8> {
    let mut pixels = vec![[0; 3]; size.0 * size.1];
    for (i, &pixel) in image.pixels().iter().enumerate() {
        let (x, y) = place(i % image.width(), i / image.width());
        pixels[y * size.0 + x] = pixel;
    }
    Image::from_raw(size.0, size.1, pixels.concat()).unwrap()
}

fn picture() -> impl Strategy<Value = Image<u8>> {
    (1..70_usize, 1..24_usize).prop_flat_map(|(width, height)| {
        prop::collection::vec(any::<u8>(), 3 * width * height)
            .prop_map(move |samples| Image::from_raw(width, height, samples).unwrap())
    })
}

proptest! {
    #[test]
    fn the_mirror_image_has_the_mirrored_depth(image in picture()) {
        let (width, height) = image.size();
        let mirror = moved(&image, (width, height), |x, y| (width - 1 - x, y));
        let depth = DepthModel::Layout.estimate(&image);
        let of_mirror = DepthModel::Layout.estimate(&mirror);
        for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
            prop_assert_eq!(depth.at(x, y), of_mirror.at(width - 1 - x, y));
        }
    }

    #[test]
    fn an_image_stored_on_its_side_has_the_depth_of_the_upright_one(image in picture()) {
        let (width, height) = image.size();
        let depth = |image: &Image<u8>, top| {
            DepthMap::from_levels(image.width(), image.height(), levels(image.view(), top)).unwrap()
        };
        let upright = depth(&image, TopEdge::First);
        // Stored so that column 0 is the top, the last column is, the last row is.
        let left = moved(&image, (height, width), |x, y| (y, x));
        let right = moved(&image, (height, width), |x, y| (height - 1 - y, x));
        let last = moved(&image, (width, height), |x, y| (x, height - 1 - y));
        let refined = DepthModel::Layout.estimate(&image);
        let refined_on_its_side = DepthModel::Layout.estimate_oriented(&left, TopEdge::Left);
        let left = depth(&left, TopEdge::Left);
        let right = depth(&right, TopEdge::Right);
        let last = depth(&last, TopEdge::Last);
        for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
            prop_assert_eq!(upright.at(x, y), left.at(y, x));
            prop_assert_eq!(upright.at(x, y), right.at(height - 1 - y, x));
            prop_assert_eq!(upright.at(x, y), last.at(x, height - 1 - y));
            // Sums of floats in another order: at most a step.
            prop_assert!((refined.at(x, y) - refined_on_its_side.at(y, x)).abs() < 1.5 / 2040.0);
        }
    }
}

#[test]
fn an_image_of_one_colour_is_ordered_by_height_alone() {
    let image = Image::<u8>::from_raw(40, 101, vec![90; 40 * 101 * 3]).unwrap();
    let levels = levels(image.view(), TopEdge::First);
    let rows: Vec<u8> = levels.chunks(40).map(|row| row[0]).collect();
    assert!(levels.chunks(40).zip(&rows).all(|(row, first)| row.iter().all(|level| level == first)));
    assert!(rows.is_sorted_by(|upper, lower| upper >= lower));
    // Rows 1 and 99 are the ends of the scale.
    assert_eq!((rows[0], rows[1], rows[30], rows[99], rows[100]), (255, 255, 180, 0, 0));
}

#[test]
fn one_pixel_is_near() {
    let image = Image::<u8>::from_raw(1, 1, vec![9, 80, 70]).unwrap();
    assert_eq!(levels(image.view(), TopEdge::First), [0]);
}

#[test]
fn in_truth_scenes_it_orders_things_better_than_colour_alone() {
    let size = Size { width: 160, height: 106 };
    let mut sums = [0.0; 2];
    for (seed, named) in (20..).zip(waters()) {
        let scene = Scene::new(seed, size);
        let image = scene.seen_through(&named.water).convert::<u8>();
        let truth = scene.depth.distances();
        for (sum, model) in sums.iter_mut().zip([DepthModel::Layout, DepthModel::Ratio]) {
            *sum += spearman(&model.estimate(&image).distances(), &truth).unwrap() / 5.0;
        }
    }
    assert!(sums[0] > sums[1] && sums[0] > 0.85, "{sums:?}");
}
