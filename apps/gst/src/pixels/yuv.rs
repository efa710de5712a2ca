//! Luma and chroma, one pair of chroma values for four pixels, as red, green and blue and back.

use gst_video::VideoInfo;

/// Fractions have so many bits.
const BITS: u32 = 14;
const HALF: i32 = 1 << (BITS - 1);

/// Where the two chroma values of four pixels are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chroma {
    /// In one plane, side by side (NV12).
    Interleaved,
    /// In two planes (I420).
    Planar,
}

/// The matrix of a video, and its range: bytes from 16 to 235, or all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colours {
    /// Luma of black.
    black: i32,
    /// A step of luma in red, green and blue.
    luma: i32,
    /// What a step of V adds to red, and to green; what a step of U adds to green, and to blue.
    of_v: [i32; 2],
    of_u: [i32; 2],
    /// What steps of red, green and blue add to Y, U and V.
    rows: [[i32; 3]; 3],
}

impl Colours {
    /// By the colorimetry of the caps; none where it has no matrix.
    pub(super) fn of(info: &VideoInfo) -> Option<Self> {
        let (kr, kb) = info.colorimetry().matrix().kr_kb().ok()?;
        let (offset, scale) = info.range_offsets(info.colorimetry().range());
        let kg = 1.0 - kr - kb;
        let [of_luma, of_chroma] = [scale[0], scale[1]].map(|steps| f64::from(steps.max(1)) / 255.0);
        #[allow(clippy::cast_possible_truncation, reason = "all lie within a few thousand")]
        let fixed = |value: f64| (value * f64::from(1 << BITS)).round() as i32;
        let (red, blue) = (2.0 * (1.0 - kr), 2.0 * (1.0 - kb));
        Some(Self {
            black: offset[0],
            luma: fixed(1.0 / of_luma),
            of_v: [fixed(red / of_chroma), fixed(-red * kr / kg / of_chroma)],
            of_u: [fixed(-blue * kb / kg / of_chroma), fixed(blue / of_chroma)],
            rows: [
                [kr, kg, kb].map(|k| fixed(k * of_luma)),
                [-kr, -kg, 1.0 - kb].map(|k| fixed(k / blue * of_chroma)),
                [1.0 - kr, -kg, -kb].map(|k| fixed(k / red * of_chroma)),
            ],
        })
    }

    #[inline]
    fn rgb(&self, y: u8, u: u8, v: u8) -> [u8; 3] {
        let y = (i32::from(y) - self.black) * self.luma + HALF;
        let (u, v) = (i32::from(u) - 128, i32::from(v) - 128);
        [y + self.of_v[0] * v, y + self.of_v[1] * v + self.of_u[0] * u, y + self.of_u[1] * u]
            .map(|value| byte(value >> BITS))
    }
}

/// The planes of a frame, each with its stride.
pub(super) struct Planes<'a> {
    pub(super) luma: (&'a mut [u8], usize),
    pub(super) chroma: [(&'a mut [u8], usize); 2],
    pub(super) layout: Chroma,
}

impl Planes<'_> {
    /// The frame in red, green and blue: chroma values are taken for each of their four pixels.
    pub(super) fn read(&self, colours: &Colours, width: usize, rgb: &mut [u8]) {
        let [first, second] = &self.chroma;
        for (y, rgb) in rgb.chunks_exact_mut(3 * width).enumerate() {
            let luma = &self.luma.0[y * self.luma.1..][..width];
            let of_row = |plane: &(&mut [u8], usize)| y / 2 * plane.1;
            let pixels = luma.chunks(2).zip(rgb.chunks_mut(6));
            match self.layout {
                Chroma::Interleaved => {
                    let pairs = first.0[of_row(first)..].as_chunks::<2>().0;
                    pixels.zip(pairs).for_each(|((luma, rgb), &[u, v])| colour(colours, luma, u, v, rgb));
                }
                Chroma::Planar => {
                    let pairs = first.0[of_row(first)..].iter().zip(&second.0[of_row(second)..]);
                    pixels.zip(pairs).for_each(|((luma, rgb), (&u, &v))| colour(colours, luma, u, v, rgb));
                }
            }
        }
    }

    /// Adds what has changed of red, green and blue; chroma by the mean of its four pixels.
    pub(super) fn write(&mut self, colours: &Colours, width: usize, before: &[u8], after: &[u8]) {
        let height = after.len() / (3 * width);
        let [first, second] = &mut self.chroma;
        for y in (0..height).step_by(2) {
            let rows = y..(y + 2).min(height);
            for x in (0..width).step_by(2) {
                let (mut sum, mut count) = ([0; 3], 0);
                for y in rows.clone() {
                    for x in x..(x + 2).min(width) {
                        let at = 3 * (y * width + x);
                        let step: [i32; 3] =
                            std::array::from_fn(|c| i32::from(after[at + c]) - i32::from(before[at + c]));
                        add(&mut self.luma.0[y * self.luma.1 + x], dot(colours.rows[0], step), 1);
                        (0..3).for_each(|c| sum[c] += step[c]);
                        count += 1;
                    }
                }
                let [u, v] = [1, 2].map(|row| dot(colours.rows[row], sum));
                match self.layout {
                    Chroma::Interleaved => {
                        let at = y / 2 * first.1 + x;
                        add(&mut first.0[at], u, count);
                        add(&mut first.0[at + 1], v, count);
                    }
                    Chroma::Planar => {
                        add(&mut first.0[y / 2 * first.1 + x / 2], u, count);
                        add(&mut second.0[y / 2 * second.1 + x / 2], v, count);
                    }
                }
            }
        }
    }
}

/// One or two pixels of a row, which share their chroma.
#[inline]
fn colour(colours: &Colours, luma: &[u8], u: u8, v: u8, rgb: &mut [u8]) {
    luma.iter().zip(rgb.as_chunks_mut::<3>().0).for_each(|(&y, rgb)| *rgb = colours.rgb(y, u, v));
}

#[inline]
fn dot(row: [i32; 3], step: [i32; 3]) -> i32 {
    row[0] * step[0] + row[1] * step[1] + row[2] * step[2]
}

/// Adds the mean of `count` steps, whose sum is given in fractions.
#[inline]
fn add(value: &mut u8, sum: i32, count: i32) {
    let whole = count << BITS;
    *value = byte(i32::from(*value) + (2 * sum + whole).div_euclid(2 * whole));
}

#[inline]
fn byte(value: i32) -> u8 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is within a byte")]
    let byte = value.clamp(0, 255) as u8;
    byte
}
