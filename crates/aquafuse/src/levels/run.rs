//! Levels set, pixel by pixel, in blocks of which the compiler makes vectors.

use super::power::{ROUND, power};
use super::{Before, LEAD, LEAD_GROWTH, LEAD_MADE, LUMA, Levels, unit};
use crate::bands;
use crate::image::{Clipping, ImageMut, Sample};
use crate::simd::{self, Work};

/// Pixels of a block.
const BLOCK: usize = 64;

/// Red, green and blue of a block.
type Planes = [[f32; BLOCK]; 3];

pub(super) fn run<T: Sample>(levels: &Levels, image: ImageMut<'_, T>, before: &impl Before) -> Clipping {
    let (width, stride) = (image.width(), image.stride());
    let pixels = width as u64 * image.height() as u64;
    let add = |a: [u64; 3], b: [u64; 3]| std::array::from_fn(|c| a[c] + b[c]);
    let curves = Curves::new(levels);
    let band = |first: usize, band: &mut [T]| {
        let rows = (first..).zip(band.chunks_mut(stride));
        rows.fold([0; 3], |sum, (y, row)| {
            let row = &mut row[..3 * width];
            add(
                sum,
                match T::bytes_mut(row) {
                    Some(bytes) => {
                        let pixels = bytes.as_chunks_mut().0;
                        simd::widest(RowOfBytes { levels, curves: &curves, pixels, y, before })
                    }
                    None => simd::widest(Row { levels, pixels: row.as_chunks_mut().0, y, before }),
                },
            )
        })
    };
    let values = bands::sum(image.into_samples(), stride, band, add);
    Clipping { values, pixels }
}

/// A row of any samples.
struct Row<'a, T, B> {
    levels: &'a Levels,
    pixels: &'a mut [[T; 3]],
    y: usize,
    before: &'a B,
}

impl<T: Sample, B: Before> Work for Row<'_, T, B> {
    type Output = [u64; 3];

    #[inline(always)]
    fn run(self) -> [u64; 3] {
        let Self { levels, pixels, y, before } = self;
        let (mut raw, mut planes) = ([[0.0; BLOCK]; 3], [[0.0; BLOCK]; 3]);
        let mut clipped = [0; 3];
        for (block, pixels) in pixels.chunks_mut(BLOCK).enumerate() {
            for (i, pixel) in pixels.iter().enumerate() {
                let unit = pixel.map(Sample::to_unit);
                let after = before.at(BLOCK * block + i, y, unit);
                for c in 0..3 {
                    (raw[c][i], planes[c][i]) = (unit[c], after[c]);
                }
            }
            stretch(levels, &mut planes);
            count(&planes, pixels.len(), &mut clipped);
            finish::<B>(levels, &raw, &mut planes, |c, x| power(x, levels.exponent[c]));
            for (i, pixel) in pixels.iter_mut().enumerate() {
                *pixel = [0, 1, 2].map(|c| T::from_unit(planes[c][i]));
            }
        }
        clipped
    }
}

/// Places of a curve: what lies between two of them is less than a byte.
const PLACES: usize = 1 << 12;

/// Powers as tables, for bytes.
struct Curves(Box<[[f32; PLACES]; 3]>);

impl Curves {
    fn new(levels: &Levels) -> Self {
        let mut curves = Box::new([[0.0; PLACES]; 3]);
        for (curve, exponent) in curves.iter_mut().zip(levels.exponent) {
            let places = curve.iter_mut().enumerate();
            places.for_each(|(place, y)| *y = power(place as f32 / (PLACES - 1) as f32, exponent));
        }
        Self(curves)
    }

    #[inline(always)]
    fn at(&self, c: usize, x: f32) -> f32 {
        let place = (x * (PLACES - 1) as f32 + ROUND).to_bits() as usize % PLACES;
        self.0[c][place]
    }
}

/// A row of bytes.
struct RowOfBytes<'a, B> {
    levels: &'a Levels,
    curves: &'a Curves,
    pixels: &'a mut [[u8; 3]],
    y: usize,
    before: &'a B,
}

impl<B: Before> Work for RowOfBytes<'_, B> {
    type Output = [u64; 3];

    #[inline(always)]
    fn run(self) -> [u64; 3] {
        let Self { levels, curves, pixels, y, before } = self;
        let (mut bytes, mut raw, mut planes) = ([[0; BLOCK]; 3], [[0.0; BLOCK]; 3], [[0.0; BLOCK]; 3]);
        let mut clipped = [0; 3];
        for (block, pixels) in pixels.chunks_mut(BLOCK).enumerate() {
            for (i, pixel) in pixels.iter().enumerate() {
                (0..3).for_each(|c| bytes[c][i] = pixel[c]);
            }
            for c in 0..3 {
                for (unit, &byte) in raw[c].iter_mut().zip(&bytes[c]) {
                    *unit = f32::from(byte) * (1.0 / 255.0);
                }
            }
            for i in 0..pixels.len() {
                let after = before.at(BLOCK * block + i, y, [raw[0][i], raw[1][i], raw[2][i]]);
                (0..3).for_each(|c| planes[c][i] = after[c]);
            }
            stretch(levels, &mut planes);
            count(&planes, pixels.len(), &mut clipped);
            finish::<B>(levels, &raw, &mut planes, |c, x| curves.at(c, x));
            for c in 0..3 {
                for (byte, &value) in bytes[c].iter_mut().zip(&planes[c]) {
                    *byte = (255.0 * unit(value) + ROUND).to_bits() as u8;
                }
            }
            for (i, pixel) in pixels.iter_mut().enumerate() {
                *pixel = [bytes[0][i], bytes[1][i], bytes[2][i]];
            }
        }
        clipped
    }
}

#[inline(always)]
fn stretch(levels: &Levels, planes: &mut Planes) {
    for c in 0..3 {
        let (black, gain) = (levels.black[c], levels.gain[c]);
        planes[c].iter_mut().for_each(|value| *value = (*value - black) * gain);
    }
}

/// Counts the values of so many pixels that left the range.
#[inline(always)]
fn count(planes: &Planes, pixels: usize, clipped: &mut [u64; 3]) {
    for c in 0..3 {
        let outside = planes[c][..pixels].iter().map(|value| u32::from(!(0.0..=1.0).contains(value)));
        clipped[c] += u64::from(outside.sum::<u32>());
    }
}

#[inline(always)]
fn finish<B: Before>(
    levels: &Levels,
    raw: &Planes,
    [reds, greens, blues]: &mut Planes,
    curve: impl Fn(usize, f32) -> f32,
) {
    let Levels { red_from_green, colour, strength, .. } = *levels;
    let growth = if levels.holds_red { LEAD_GROWTH } else { f32::INFINITY };
    for i in 0..BLOCK {
        let [red, green, blue] = [unit(reds[i]), unit(greens[i]), unit(blues[i])];
        let red = curve(0, red + red_from_green * (1.0 - red) * green);
        let (green, blue) = (curve(1, green), curve(2, blue));
        let lightness = LUMA[0] * red + LUMA[1] * green + LUMA[2] * blue;
        let calm = |value: f32| lightness + colour * (value - lightness);
        let (red, green, blue) = (calm(red), calm(green), calm(blue));
        let lead = raw[0][i] - raw[1][i].max(raw[2][i]);
        let made = LEAD_MADE * unit(1.0 + lead / LEAD).max(B::LEAD_FROM_BEHIND);
        // Where red is free to lead, nothing is below this bound.
        let most = green.max(blue) + made + growth * (lead - LEAD).max(f32::MIN_POSITIVE);
        let red = red.min(most);
        reds[i] = raw[0][i] + strength * (red - raw[0][i]);
        greens[i] = raw[1][i] + strength * (green - raw[1][i]);
        blues[i] = raw[2][i] + strength * (blue - raw[2][i]);
    }
}
