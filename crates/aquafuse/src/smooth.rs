//! Smoothing of the fused picture, the paper's last step.
//!
//! The paper ends with a bilateral filter and gives no parameters. Here nothing is smoothed unless asked for:
//! what the filter takes for noise is as often texture.

use crate::image::{Encoding, Image, Sample};

/// How a fused picture is smoothed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Smoothing {
    /// Not at all.
    #[default]
    None,
    /// By [`bilateral`].
    Bilateral,
}

impl Smoothing {
    /// All ways, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::None, Self::Bilateral];

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Bilateral => "bilateral",
        }
    }

    /// The way of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|way| way.name() == name)
    }

    /// The picture, smoothed.
    pub fn apply<T: Sample, E: Encoding>(self, image: Image<T, E>) -> Image<T, E> {
        match self {
            Self::None => image,
            Self::Bilateral => bilateral(&image),
        }
    }
}

/// Reach of the window, a circle of diameter d = 5.
const RADIUS: isize = 2;
/// σ of the difference of two colours (the sum over the channels, in steps of a byte), and of their distance
/// in pixels: the values of many OpenCV examples. Over a window this small the latter hardly counts.
const SIGMA_COLOUR: f64 = 75.0;
const SIGMA_SPACE: f64 = 75.0;
/// The weight of a pixel itself. Weights and values are whole numbers, whose sums are the same in any order, on
/// any machine.
const ONE: f64 = 65536.0;
/// Differences two colours can have.
const DIFFERENCES: usize = 3 * 255 + 1;

/// Smooths a picture but not its edges: each pixel becomes the mean of those within two pixels of it, weighted by
/// `e^(-Δ² / 2σ²)` of their distance in pixels and in colour.
///
/// d = 5, both σ = 75, Δ of colours the sum of the channels' differences in steps of a byte, whatever the samples
/// are. Beyond the border the
/// picture is mirrored about its outermost pixels. The filter of C. Tomasi and R. Manduchi, "Bilateral filtering
/// for gray and color images" (1998), as OpenCV's `bilateralFilter` computes it for bytes.
///
/// # Examples
///
/// An edge of 200 steps stays sharp, one of 8 is worn down:
///
/// ```
/// use aquafuse::{image::Image, smooth::bilateral};
///
/// let row = |left: u8, right: u8| Image::<u8>::from_raw(4, 1, [[left; 6], [right; 6]].concat());
/// assert_eq!(bilateral(&row(20, 220)?), row(20, 220)?);
/// let worn: Vec<u8> = bilateral(&row(20, 28)?).pixels().iter().map(|pixel| pixel[0]).collect();
/// assert!(20 < worn[1] && worn[1] < worn[2] && worn[2] < 28);
/// # Ok::<(), aquafuse::image::SizeError>(())
/// ```
pub fn bilateral<T: Sample, E: Encoding>(image: &Image<T, E>) -> Image<T, E> {
    let taps = taps();
    let mut smoothed = image.clone();
    let width = image.width();
    let row = |(y, row): (usize, &mut [[T; 3]])| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = mean_around(image, x, y, &taps);
        }
    };
    #[cfg(feature = "threads")]
    {
        use rayon::prelude::*;
        smoothed.pixels_mut().par_chunks_mut(width).enumerate().for_each(row);
    }
    #[cfg(not(feature = "threads"))]
    smoothed.pixels_mut().chunks_mut(width).enumerate().for_each(row);
    smoothed
}

/// A place in the window and the weights there, by difference of colour.
struct Tap {
    dx: isize,
    dy: isize,
    weights: Vec<u32>,
}

fn taps() -> Vec<Tap> {
    let bell = |distance: f64, sigma: f64| (-0.5 * (distance / sigma).powi(2)).exp();
    let places = (-RADIUS..=RADIUS).flat_map(|dy| (-RADIUS..=RADIUS).map(move |dx| (dx, dy)));
    let tap = |(dx, dy): (isize, isize)| {
        let nearness = bell(((dx * dx + dy * dy) as f64).sqrt(), SIGMA_SPACE);
        let weight = |difference| (ONE * nearness * bell(difference as f64, SIGMA_COLOUR)).round() as u32;
        Tap { dx, dy, weights: (0..DIFFERENCES).map(weight).collect() }
    };
    places.filter(|(dx, dy)| dx * dx + dy * dy <= RADIUS * RADIUS).map(tap).collect()
}

/// The weighted mean of the window around one place, rounded; halves go up.
fn mean_around<T: Sample, E: Encoding>(image: &Image<T, E>, x: usize, y: usize, taps: &[Tap]) -> [T; 3] {
    let (width, height) = image.size();
    let pixels = image.pixels();
    let middle = pixels[y * width + x].map(T::to_byte);
    let (mut sums, mut total) = ([0_u64; 3], 0_u64);
    for tap in taps {
        let column = mirrored(x as isize + tap.dx, width);
        let other = pixels[mirrored(y as isize + tap.dy, height) * width + column];
        let difference: usize = (0..3).map(|c| usize::from(middle[c].abs_diff(other[c].to_byte()))).sum();
        let weight = u64::from(tap.weights[difference]);
        total += weight;
        for c in 0..3 {
            sums[c] += weight * other[c].to_steps();
        }
    }
    // The pixel itself weighs ONE, so there is something to divide by.
    sums.map(|sum| T::from_steps((sum + total / 2) / total))
}

/// A place beyond the border, mirrored about the outermost pixels: -1 is 1, `length` is `length - 2`.
fn mirrored(place: isize, length: usize) -> usize {
    let last = length as isize - 1;
    let mut place = place;
    // In a picture smaller than the window the mirror is met more than once.
    while !(0..=last).contains(&place) {
        place = if last == 0 {
            0
        } else if place < 0 {
            -place
        } else {
            2 * last - place
        };
    }
    place as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn picture(width: usize, height: usize) -> impl Strategy<Value = Image<u8>> {
        prop::collection::vec(any::<u8>(), 3 * width * height)
            .prop_map(move |samples| Image::from_raw(width, height, samples).unwrap())
    }

    #[test]
    fn the_border_is_a_mirror_whatever_the_size() {
        let places = |length: usize| (-2..length as isize + 2).map(move |place| mirrored(place, length));
        assert_eq!(places(4).collect::<Vec<_>>(), [2, 1, 0, 1, 2, 3, 2, 1]);
        assert_eq!(places(2).collect::<Vec<_>>(), [0, 1, 0, 1, 0, 1]);
        assert_eq!(places(1).collect::<Vec<_>>(), [0; 5]);
    }

    #[test]
    fn the_window_is_a_circle() {
        assert_eq!(taps().len(), 13);
    }

    proptest! {
        #[test]
        fn a_flat_picture_is_left_as_it_is(rgb: [u8; 3], width in 1..7_usize, height in 1..7_usize) {
            let flat = Image::<u8>::from_raw(width, height, rgb.repeat(width * height)).unwrap();
            prop_assert_eq!(bilateral(&flat), flat);
        }

        #[test]
        fn no_value_leaves_the_range_of_the_picture(image in picture(6, 5)) {
            let of = |image: &Image<u8>, c: usize| {
                let values: Vec<u8> = image.pixels().iter().map(|pixel| pixel[c]).collect();
                (values.iter().min().copied(), values.iter().max().copied())
            };
            let smoothed = bilateral(&image);
            for c in 0..3 {
                prop_assert!(of(&smoothed, c).0 >= of(&image, c).0 && of(&smoothed, c).1 <= of(&image, c).1);
            }
        }

        #[test]
        fn the_mirror_image_is_smoothed_to_the_mirror(image in picture(7, 4)) {
            let mirror = |image: &Image<u8>| {
                let samples = image.rows().flat_map(|row| row.iter().rev().copied()).flatten().collect();
                Image::<u8>::from_raw(7, 4, samples).unwrap()
            };
            prop_assert_eq!(bilateral(&mirror(&image)), mirror(&bilateral(&image)));
        }
    }

    #[test]
    fn finer_samples_are_smoothed_as_bytes_are() {
        let image = Image::<u8>::from_raw(9, 5, (0..135).map(|i| (i * 37 % 251) as u8).collect()).unwrap();
        let smoothed = bilateral(&image);
        assert_eq!(bilateral(&image.to_samples::<u16>()).to_samples::<u8>(), smoothed);
        assert_eq!(bilateral(&image.to_unit()).to_samples::<u8>(), smoothed);
    }

    #[cfg(feature = "threads")]
    #[test]
    fn threads_change_no_bit() {
        let image = Image::<u8>::from_raw(64, 40, (0..7680).map(|i| (i * 37 % 251) as u8).collect()).unwrap();
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(alone.install(|| bilateral(&image)), bilateral(&image));
    }
}
