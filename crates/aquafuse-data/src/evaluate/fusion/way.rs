//! Scores of the water apart from everything else: how far it became the reference's, which an unchanged image does not, how much
//! near objects changed meanwhile, and whether the image stayed sharp.

use aquafuse::depth::DepthMap;
use aquafuse::image::Image;
use aquafuse::metrics::lab;

/// A colour in CIELab (D65).
type Lab = [f64; 3];

/// Share of the pixels that are not far: the farthest fifth is.
const NOT_FAR: f32 = 0.8;
/// Share of the pixels that are near.
const NEAR: f32 = 0.3;
/// ΔE between two waters below which they are alike. The share of the way divides by this distance: over a shorter one, small
/// errors of either colour would decide it.
const ALIKE: f64 = 10.0;

/// Which pixels of an image are far, and which are near; row by row from the top.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    far: Vec<bool>,
    near: Vec<bool>,
}

impl Regions {
    /// The farthest fifth and the nearest 30 % of the pixels, with all that are as far as the last of them.
    pub(super) fn of_depth(depth: &DepthMap) -> Self {
        let least = depth.percentile(NOT_FAR);
        Self { far: depth.distances().iter().map(|&z| z >= least).collect(), near: near(depth) }
    }

    /// The pixels from which an estimate read the veiling light, and the nearest 30 % by its depth.
    pub(super) fn of_estimate(read_from: Vec<bool>, depth: &DepthMap) -> Self {
        Self { far: read_from, near: near(depth) }
    }

    /// The mean colour of the far region; none where it has no pixel.
    pub(super) fn water(&self, image: &Image<u8>) -> Option<Lab> {
        let far = image.pixels().iter().zip(&self.far).filter(|(_, far)| **far);
        mean(far.map(|(pixel, _)| lab_of(pixel)))
    }
}

fn near(depth: &DepthMap) -> Vec<bool> {
    let most = depth.percentile(NEAR);
    depth.distances().iter().map(|&z| z <= most).collect()
}

/// How an output differs from its content: the water, near objects, and detail.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    /// [`way`], as a share; none where the waters of content and reference are alike, or an image has no far region.
    pub(super) way: Option<f64>,
    /// [`near_change`], in ΔE.
    pub(super) near: f64,
    /// [`sharpness`]; not a number where the content has no detail.
    pub(super) sharpness: f64,
}

impl Change {
    /// Compares an output with its content, of the same size, and with the colour of the reference's far region.
    pub(super) fn of(
        content: &Image<u8>,
        made: &Image<u8>,
        regions: &Regions,
        reference: Option<Lab>,
    ) -> Self {
        let waters = regions.water(content).zip(regions.water(made)).zip(reference);
        Self {
            way: waters.and_then(|((content, made), reference)| way(content, made, reference)),
            near: near_change(content, made, regions),
            sharpness: sharpness(content, made),
        }
    }
}

/// The share of the way from the content's water to the reference's that an output has gone.
///
/// `1 − |w(output) − w(reference)| / |w(content) − w(reference)|`, where w is the mean CIELab colour of a far region: the content's
/// for content and output, the reference's for the reference. At most 1, the reference's colour; 0 for the content itself; negative
/// where the output is farther from the reference than the content is. None where the waters differ by less than ΔE 10.
fn way(content: Lab, made: Lab, reference: Lab) -> Option<f64> {
    let whole = delta_e(content, reference);
    (whole >= ALIKE).then(|| 1.0 - delta_e(made, reference) / whole)
}

/// How much near objects changed colour: the mean ΔE (CIE76) of the near pixels, 0 if nothing changed.
fn near_change(content: &Image<u8>, made: &Image<u8>, regions: &Regions) -> f64 {
    let both = content.pixels().iter().zip(made.pixels()).zip(&regions.near).filter(|(_, near)| **near);
    let changes = both.map(|((content, made), _)| [delta_e(lab_of(content), lab_of(made))]);
    mean(changes).map_or(0.0, |[mean]| mean)
}

/// How much of its detail an image kept: the standard deviation of the Laplacian of luma, output over content.
///
/// The Laplacian is `l(x−1) + l(x+1) + l(y−1) + l(y+1) − 4 l`, inside the image. 1 if nothing changed, below 1 for a blurred or
/// veiled output, above 1 where contrast or noise grew. Not finite where the content has no detail.
fn sharpness(content: &Image<u8>, made: &Image<u8>) -> f64 {
    detail(made) / detail(content)
}

fn detail(image: &Image<u8>) -> f64 {
    let luma = |[r, g, b]: &[u8; 3]| 0.299 * f64::from(*r) + 0.587 * f64::from(*g) + 0.114 * f64::from(*b);
    let luma: Vec<f64> = image.pixels().iter().map(luma).collect();
    let rows: Vec<&[f64]> = luma.chunks_exact(image.width()).collect();
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for three in rows.windows(3) {
        let [above, row, below] = three else { continue };
        let columns = row.windows(3).zip(above.iter().skip(1)).zip(below.iter().skip(1));
        for ((beside, above), below) in columns {
            let [left, middle, right] = beside else { continue };
            let laplacian = left + right + above + below - 4.0 * middle;
            count += 1.0;
            sum += laplacian;
            squares += laplacian * laplacian;
        }
    }
    let mean: f64 = sum / count;
    (squares / count - mean * mean).max(0.0).sqrt()
}

fn lab_of(pixel: &[u8; 3]) -> Lab {
    lab(pixel.map(|value| f32::from(value) / 255.0))
}

fn delta_e(a: Lab, b: Lab) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + (a - b) * (a - b)).sqrt()
}

/// The mean, value by value; none of nothing.
fn mean<const N: usize>(all: impl Iterator<Item = [f64; N]>) -> Option<[f64; N]> {
    let (mut count, mut sums) = (0.0, [0.0; N]);
    for one in all {
        count += 1.0;
        sums.iter_mut().zip(one).for_each(|(sum, value)| *sum += value);
    }
    (count > 0.0).then(|| sums.map(|sum| sum / count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIDE: usize = 12;
    const PIXELS: usize = SIDE * SIDE;

    fn image(pixels: &[[u8; 3]]) -> Image<u8> {
        Image::from_raw(SIDE, SIDE, pixels.concat()).unwrap()
    }

    /// Depth that grows from row to row upwards.
    fn depth() -> DepthMap {
        let levels = (0..PIXELS).map(|i| 20 * (SIDE - 1 - i / SIDE) as u8);
        DepthMap::from_levels(SIDE, SIDE, levels.collect()).unwrap()
    }

    fn pixels() -> impl Strategy<Value = Vec<[u8; 3]>> {
        prop::collection::vec(any::<[u8; 3]>(), PIXELS)
    }

    #[test]
    fn far_and_near_are_the_ends_of_the_depth_map() {
        let regions = Regions::of_depth(&depth());
        let rows = |region: &[bool]| -> Vec<usize> { (0..SIDE).filter(|y| region[y * SIDE]).collect() };
        assert_eq!(rows(&regions.far), [0, 1, 2]);
        assert_eq!(rows(&regions.near), [8, 9, 10, 11]);
    }

    #[test]
    fn like_waters_have_no_way_between_them() {
        let water = |grey: f64| [grey, 0.0, 0.0];
        assert_eq!(way(water(50.0), water(90.0), water(59.0)), None);
        assert_eq!(way(water(50.0), water(55.0), water(60.0)), Some(0.5));
        // Away from the reference, and beyond it.
        assert_eq!(way(water(50.0), water(40.0), water(60.0)), Some(-1.0));
        assert_eq!(way(water(50.0), water(65.0), water(60.0)), Some(0.5));
    }

    #[test]
    fn an_image_without_a_far_region_has_no_way() {
        let content = image(&vec![[90, 120, 140]; PIXELS]);
        let regions = Regions::of_estimate(vec![false; PIXELS], &depth());
        assert_eq!(regions.water(&content), None);
        assert_eq!(Change::of(&content, &content, &regions, Some([0.0; 3])).way, None);
    }

    #[test]
    fn what_changes_far_away_is_no_near_change() {
        let content = vec![[90, 120, 140]; PIXELS];
        let mut made = content.clone();
        made[..3 * SIDE].fill([200, 30, 10]);
        let regions = Regions::of_depth(&depth());
        assert_eq!(near_change(&image(&content), &image(&made), &regions), 0.0);
        made.fill([200, 30, 10]);
        let whole = delta_e(lab_of(&content[0]), lab_of(&made[0]));
        assert!((near_change(&image(&content), &image(&made), &regions) - whole).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn doing_nothing_goes_no_way_and_changes_nothing(content in pixels(), other in pixels()) {
            let (content, other) = (image(&content), image(&other));
            let regions = Regions::of_depth(&depth());
            let found = Change::of(&content, &content, &regions, regions.water(&other));
            prop_assert!(found.way.is_none_or(|way| way == 0.0), "{:?}", found);
            prop_assert_eq!((found.near, found.sharpness), (0.0, 1.0));
        }

        #[test]
        fn a_far_region_of_the_references_colour_has_gone_all_the_way(
            content in pixels(),
            grey in 0..20_u8,
            water: [u8; 3],
        ) {
            let dark: Vec<[u8; 3]> = content.iter().map(|pixel| pixel.map(|value| value / 16 + grey)).collect();
            let bright = water.map(|value| 155 + value / 3);
            let (regions, mut made) = (Regions::of_depth(&depth()), dark.clone());
            made[..3 * SIDE].fill(bright);
            let reference = regions.water(&image(&vec![bright; PIXELS]));
            let found = Change::of(&image(&dark), &image(&made), &regions, reference);
            prop_assert!(found.way.is_some_and(|way| (way - 1.0).abs() < 1e-9), "{:?}", found);
            prop_assert!(found.near == 0.0, "{:?}", found);
        }

        #[test]
        fn no_output_goes_more_than_all_the_way(content in pixels(), made in pixels(), other in pixels()) {
            let regions = Regions::of_depth(&depth());
            let reference = regions.water(&image(&other));
            let found = Change::of(&image(&content), &image(&made), &regions, reference);
            prop_assert!(found.way.is_none_or(|way| way <= 1.0) && found.near >= 0.0, "{:?}", found);
        }

        #[test]
        fn blur_lowers_sharpness(content in pixels()) {
            // Each pixel becomes the mean of the 3 x 3 pixels around it, as far as they are in the image.
            let blurred: Vec<[u8; 3]> = (0..PIXELS)
                .map(|i| {
                    let (x, y) = (i % SIDE, i / SIDE);
                    let around: Vec<[u8; 3]> = (y.saturating_sub(1)..SIDE.min(y + 2))
                        .flat_map(|v| (x.saturating_sub(1)..SIDE.min(x + 2)).map(move |u| v * SIDE + u))
                        .map(|place| content[place])
                        .collect();
                    std::array::from_fn(|c| {
                        let sum: usize = around.iter().map(|pixel| usize::from(pixel[c])).sum();
                        (sum / around.len()) as u8
                    })
                })
                .collect();
            let found = sharpness(&image(&content), &image(&blurred));
            prop_assert!(found < 0.8, "{found}");
        }
    }
}
