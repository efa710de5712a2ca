//! UIQM, underwater image quality without a reference.

use crate::image::{ImageRef, Sample};
use crate::simd;

/// The three parts of UIQM.
///
/// K. Panetta et al., "Human-visual-system-inspired underwater image quality measures" (2016). Values are the
/// nearest encoded bytes: a gradient of nothing must be exactly that, or its logarithm would be huge. The publication leaves much open and implementations differ (size of the blocks, what a block with
/// a 0 counts, the sign of the last part): compare only numbers of one implementation. Ours:
///
/// - blocks are 10 x 10 from the upper left corner; what is left at the right and below does not count;
/// - logarithms are natural, and a block whose ratio has no logarithm counts 0;
/// - edges are the length of the Sobel gradient, mirrored at the border, times the channel;
/// - contrast is that of luma (.299, .587, .114) and has the sign that makes it positive, with the ordinary
///   mean over the blocks: the PLIP mean of a number that is no grey level has no meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Uiqm {
    /// UICM, `-.0268 √(μ²_RG + μ²_YB) + .1586 √(σ²_RG + σ²_YB)`; 0 for grey, negative for an image of one colour.
    ///
    /// RG = R - G and YB = (R + G) / 2 - B. The means leave the lowest and the highest tenth out; the
    /// variances are over all pixels, about those means.
    pub colourfulness: f64,
    /// UISM, `Σ λ EME(edges)` with λ as for luma and EME the mean of `2 ln(max / min)` of the blocks; >= 0, most
    /// often 2 to 8.
    pub sharpness: f64,
    /// UIConM, the mean of `-m ln m` over the blocks with `m = (max ⊖ min) / (max ⊕ min)`, in `[0, 1/e]`.
    ///
    /// `a ⊕ b = a + b - ab / 1026` and `a ⊖ b = 1026 (a - b) / (1026 - b)` (PLIP). It falls again where m
    /// exceeds 1/e: the publication's entropy, not a slip of ours.
    pub contrast: f64,
}

impl Uiqm {
    /// `.0282 UICM + .2953 UISM + 3.5753 UIConM`, most often 1 to 4.
    pub fn score(&self) -> f64 {
        0.0282 * self.colourfulness + 0.2953 * self.sharpness + 3.5753 * self.contrast
    }
}

/// Side of a block.
const BLOCK: usize = 10;
/// Weights of red, green and blue in luma.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
/// γ and k of PLIP, the grey level at which its medium is opaque.
const OPAQUE: f64 = 1026.0;
/// Share left out of the means at either end.
const TRIMMED: f64 = 0.1;

/// Underwater image quality of one image; see [`Uiqm`] for what is summed. None for images smaller than a block.
///
/// It rewards noise, for noise is sharp.
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, metrics::uiqm};
///
/// let flat: Image<u8> = Image::from_raw(10, 10, [90, 90, 90].repeat(100))?;
/// assert_eq!(uiqm(&flat).map(|found| found.score()), Some(0.0));
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[must_use]
pub fn uiqm<'a, T: Sample>(image: impl Into<ImageRef<'a, T>>) -> Option<Uiqm> {
    let image = image.into();
    let (width, height) = image.size();
    if width < BLOCK || height < BLOCK {
        return None;
    }
    let levels = |pixel: &[T; 3]| pixel.map(|value| f64::from(value.to_byte()));
    let pixels: Vec<[f64; 3]> = image.pixels().map(levels).collect();
    let sharpness = (0..3).map(|c| {
        let channel: Vec<f64> = pixels.iter().map(|pixel| pixel[c]).collect();
        LUMA[c] * mean_of_blocks(&edges(&channel, width, height), width, twice_log_ratio)
    });
    let luma: Vec<f64> = pixels.iter().map(|pixel| (0..3).map(|c| LUMA[c] * pixel[c]).sum()).collect();
    Some(Uiqm {
        colourfulness: colourfulness(&pixels),
        sharpness: sharpness.sum(),
        contrast: mean_of_blocks(&luma, width, entropy_of_contrast),
    })
}

fn colourfulness(pixels: &[[f64; 3]]) -> f64 {
    let [mean_rg, variance_rg] = trimmed(pixels.iter().map(|[r, g, _]| r - g).collect());
    let [mean_yb, variance_yb] = trimmed(pixels.iter().map(|[r, g, b]| 0.5 * (r + g) - b).collect());
    -0.0268 * mean_rg.hypot(mean_yb) + 0.1586 * (variance_rg + variance_yb).sqrt()
}

/// The mean without both ends, and the mean square about it of all values.
fn trimmed(mut values: Vec<f64>) -> [f64; 2] {
    let share = TRIMMED * values.len() as f64;
    let (from, to) = (share.ceil() as usize, values.len() - share.floor() as usize);
    // In any order: they are half steps of bytes, and sums of these and of their squares are exact.
    let (kept, ..) = values.select_nth_unstable_by(to - 1, f64::total_cmp);
    let most = kept.len();
    if from < most {
        kept.select_nth_unstable_by(from, f64::total_cmp);
    }
    let kept = &values[from..to];
    let mean = kept.iter().sum::<f64>() / kept.len() as f64;
    let [sum, squares] = values.iter().fold([0.0, 0.0], |[sum, squares], v| [sum + v, squares + v * v]);
    let count = values.len() as f64;
    [mean, (squares / count - mean * (2.0 * sum / count - mean)).max(0.0)]
}

/// Length of the Sobel gradient times the value itself. Its scale cancels in [`twice_log_ratio`].
fn edges(channel: &[f64], width: usize, height: usize) -> Vec<f64> {
    let mut edges = vec![0.0; channel.len()];
    // A row with its outermost values once more at either side.
    let padded = |y: usize| -> Vec<f64> {
        let row = &channel[y * width..][..width];
        let ends = [row[0], row[width - 1]];
        std::iter::once(ends[0]).chain(row.iter().copied()).chain([ends[1]]).collect()
    };
    let (mut above, mut row) = (padded(0), padded(0));
    for (y, edges) in edges.chunks_exact_mut(width).enumerate() {
        let below = padded((y + 1).min(height - 1));
        simd::widest(Edges { rows: [&above, &row, &below], edges });
        above = std::mem::replace(&mut row, below);
    }
    edges
}

/// The edges of one row between its neighbours.
struct Edges<'a> {
    rows: [&'a [f64]; 3],
    edges: &'a mut [f64],
}

impl simd::Work for Edges<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [above, row, below] = self.rows.map(|row| &row[..self.edges.len() + 2]);
        for (x, edge) in self.edges.iter_mut().enumerate() {
            let column = |x: usize| above[x] + 2.0 * row[x] + below[x];
            let along = |row: &[f64]| row[x] + 2.0 * row[x + 1] + row[x + 2];
            let (across, down) = (column(x + 2) - column(x), along(below) - along(above));
            *edge = row[x + 1] * (across * across + down * down).sqrt();
        }
    }
}

/// The mean over all whole blocks of what `of` makes of a block's smallest and largest value.
fn mean_of_blocks(values: &[f64], width: usize, of: impl Fn(f64, f64) -> f64) -> f64 {
    let columns = width / BLOCK;
    let [mut least, mut most] = [(); 2].map(|()| vec![0.0; columns * BLOCK]);
    let (mut sum, mut blocks) = (0.0, 0_u32);
    for rows in values.chunks_exact(width * BLOCK) {
        least.fill(f64::INFINITY);
        most.fill(f64::NEG_INFINITY);
        for row in rows.chunks_exact(width) {
            simd::widest(Widen { row, least: &mut least, most: &mut most });
        }
        for (least, most) in least.chunks_exact(BLOCK).zip(most.chunks_exact(BLOCK)) {
            let least = least.iter().copied().fold(f64::INFINITY, f64::min);
            sum += of(least, most.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            blocks += 1;
        }
    }
    sum / f64::from(blocks)
}

/// Widens the range of each column by the value of a row.
struct Widen<'a> {
    row: &'a [f64],
    least: &'a mut [f64],
    most: &'a mut [f64],
}

impl simd::Work for Widen<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for ((value, least), most) in self.row.iter().zip(self.least).zip(self.most) {
            *least = if value < least { *value } else { *least };
            *most = if value > most { *value } else { *most };
        }
    }
}

fn twice_log_ratio(least: f64, most: f64) -> f64 {
    if least > 0.0 { 2.0 * (most / least).ln() } else { 0.0 }
}

fn entropy_of_contrast(least: f64, most: f64) -> f64 {
    let difference = OPAQUE * (most - least) / (OPAQUE - least);
    let sum = most + least - most * least / OPAQUE;
    let contrast = difference / sum;
    if contrast > 0.0 { -contrast * contrast.ln() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use proptest::prelude::*;

    /// 20 x 20 pixels in a fixed disorder.
    fn picture(colour: impl Fn(u8) -> [u8; 3]) -> Image<u8> {
        Image::from_raw(20, 20, (0..400_u32).flat_map(|i| colour((i * i * 37 % 251) as u8)).collect())
            .unwrap()
    }

    #[test]
    fn an_image_smaller_than_a_block_has_no_quality() {
        assert_eq!(uiqm(&Image::<u8>::from_raw(9, 20, vec![5; 540]).unwrap()), None);
    }

    #[test]
    fn grey_has_no_colourfulness_and_one_colour_less_than_none() {
        assert_eq!(uiqm(&picture(|value| [value; 3])).unwrap().colourfulness, 0.0);
        // RG = 80 and YB = -40 everywhere.
        let found = uiqm(&picture(|_| [120, 40, 120])).unwrap().colourfulness;
        assert!((found + 0.0268 * 80.0_f64.hypot(40.0)).abs() < 1e-4, "{found}");
    }

    #[test]
    fn a_tenth_of_stray_colours_does_not_move_the_means() {
        let steady = |stray: f64| {
            let values = (0..100).map(|i| if i < 9 { stray } else { 3.0 }).collect();
            trimmed(values)[0]
        };
        assert_eq!((steady(-500.0), steady(500.0)), (3.0, 3.0));
    }

    #[test]
    fn a_wider_spread_of_colours_is_more_colourful() {
        let found = |spread: u8| uiqm(&picture(|v| [v / spread, 100, 100 - v / spread / 3])).unwrap();
        assert!(found(1).colourfulness > found(2).colourfulness);
    }

    #[test]
    fn contrast_is_the_entropy_of_a_block() {
        // Half of a block is 100, half 50: PLIP difference 1026 * 50 / 976, sum 150 - 5000 / 1026.
        let rows = |y: usize| if y < 5 { [100; 30] } else { [50; 30] };
        let image = Image::<u8>::from_raw(10, 10, (0..10).flat_map(rows).collect()).unwrap();
        let m: f64 = (1026.0 * 50.0 / 976.0) / (150.0 - 5000.0 / 1026.0);
        assert!((uiqm(&image).unwrap().contrast + m * m.ln()).abs() < 1e-6);
    }

    #[test]
    fn the_sample_type_does_not_matter() {
        let bytes = picture(|value| [value / 40, value / 30, 100]);
        let score = uiqm(&bytes).unwrap().score();
        assert_eq!(uiqm(&bytes.convert::<u16>()).unwrap().score(), score);
        assert_eq!(uiqm(&bytes.to_unit()).unwrap().score(), score);
    }

    proptest! {
        #[test]
        fn the_parts_lie_in_their_ranges(bytes in prop::collection::vec(any::<u8>(), 3 * 13 * 21)) {
            let found = uiqm(&Image::<u8>::from_raw(13, 21, bytes).unwrap()).unwrap();
            prop_assert!(found.sharpness >= 0.0 && found.colourfulness.is_finite());
            prop_assert!((0.0..=(-1.0_f64).exp() + 1e-12).contains(&found.contrast));
        }
    }
}
