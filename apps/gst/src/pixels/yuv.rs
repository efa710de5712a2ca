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
}

/// The planes of a frame, each with its stride.
pub(super) struct Planes<'a> {
    pub(super) luma: (&'a mut [u8], usize),
    pub(super) chroma: [(&'a mut [u8], usize); 2],
    pub(super) layout: Chroma,
}

/// A frame in planes, in memory that is used again. Loops over such rows become vectors; those over three interleaved bytes do not.
#[derive(Debug, Default)]
pub(super) struct Memory {
    /// Red, green and blue of the frame as it was read.
    colours: [Vec<u8>; 3],
    /// What chroma adds to red, green and blue of each pixel of a row.
    tint: [Vec<i32>; 3],
    /// What has changed of red, green and blue in a row.
    steps: [Vec<i32>; 3],
    /// The same of two pixels, or four.
    sums: [Vec<i32>; 3],
}

impl Memory {
    /// For a frame of this size; an odd last pixel of a row has a neighbour that stays empty.
    fn resize(&mut self, width: usize, height: usize) {
        let even = width.next_multiple_of(2);
        self.tint.iter_mut().chain(&mut self.steps).for_each(|row| row.resize(even, 0));
        self.sums.iter_mut().for_each(|row| row.resize(even / 2, 0));
        self.colours.iter_mut().for_each(|plane| plane.resize(width * height, 0));
    }

    fn tint(&mut self, colours: &Colours, at: usize, u: u8, v: u8) {
        let (u, v) = (i32::from(u) - 128, i32::from(v) - 128);
        let tint = [colours.of_v[0] * v, colours.of_v[1] * v + colours.of_u[0] * u, colours.of_u[1] * u];
        for (row, tint) in self.tint.iter_mut().zip(tint) {
            row[2 * at..][..2].fill(tint);
        }
    }
}

impl Planes<'_> {
    /// The frame in red, green and blue: chroma values are taken for each of their four pixels.
    pub(super) fn read(&self, colours: &Colours, width: usize, memory: &mut Memory, rgb: &mut [u8]) {
        memory.resize(width, rgb.len() / (3 * width));
        let columns = width.div_ceil(2);
        let [first, second] = &self.chroma;
        for (y, rgb) in rgb.chunks_exact_mut(3 * width).enumerate() {
            if y % 2 == 0 {
                let first = &first.0[y / 2 * first.1..];
                match self.layout {
                    Chroma::Interleaved => first.as_chunks::<2>().0[..columns]
                        .iter()
                        .enumerate()
                        .for_each(|(at, &[u, v])| memory.tint(colours, at, u, v)),
                    Chroma::Planar => first[..columns]
                        .iter()
                        .zip(&second.0[y / 2 * second.1..])
                        .enumerate()
                        .for_each(|(at, (&u, &v))| memory.tint(colours, at, u, v)),
                }
            }
            let luma = &self.luma.0[y * self.luma.1..][..width];
            for (plane, tint) in memory.colours.iter_mut().zip(&memory.tint) {
                let row = &mut plane[y * width..][..width];
                for ((value, &y), tint) in row.iter_mut().zip(luma).zip(tint) {
                    *value = byte(((i32::from(y) - colours.black) * colours.luma + HALF + tint) >> BITS);
                }
            }
            let [red, green, blue] = memory.colours.each_ref().map(|plane| &plane[y * width..][..width]);
            let own = red.iter().zip(green).zip(blue);
            for (pixel, ((&r, &g), &b)) in rgb.as_chunks_mut().0.iter_mut().zip(own) {
                *pixel = [r, g, b];
            }
        }
    }

    /// Adds what has changed of red, green and blue; chroma by the mean of its four pixels.
    pub(super) fn write(&mut self, colours: &Colours, width: usize, memory: &mut Memory, after: &[u8]) {
        let (columns, height) = (width.div_ceil(2), after.len() / (3 * width));
        for (y, after) in after.chunks_exact(3 * width).enumerate() {
            let after = after.as_chunks::<3>().0;
            for (c, steps) in memory.steps.iter_mut().enumerate() {
                let before = &memory.colours[c][y * width..][..width];
                for ((step, before), after) in steps.iter_mut().zip(before).zip(after) {
                    *step = i32::from(after[c]) - i32::from(*before);
                }
            }
            let luma = &mut self.luma.0[y * self.luma.1..][..width];
            let [red, green, blue] = &memory.steps;
            let of_luma = colours.rows[0];
            for (value, ((&r, &g), &b)) in luma.iter_mut().zip(red.iter().zip(green).zip(blue)) {
                let step = of_luma[0] * r + of_luma[1] * g + of_luma[2] * b;
                *value = byte(i32::from(*value) + ((step + HALF) >> BITS));
            }
            let is_first = y % 2 == 0;
            for (sums, steps) in memory.sums.iter_mut().zip(&memory.steps) {
                for (sum, &[left, right]) in sums.iter_mut().zip(steps.as_chunks::<2>().0) {
                    *sum = if is_first { 0 } else { *sum } + left + right;
                }
            }
            if is_first && y + 1 < height {
                continue;
            }
            let [red, green, blue] = &memory.sums;
            // Means of one, two or four pixels: of one row where the height is odd, of one column where the width is.
            let lines = u32::from(!is_first);
            let step = |row: usize, at: usize| -> i32 {
                let [r, g, b] = colours.rows[row];
                let bits = BITS + lines + u32::from(2 * at + 1 < width);
                (r * red[at] + g * green[at] + b * blue[at] + (1 << (bits - 1))) >> bits
            };
            let [first, second] = &mut self.chroma;
            let first = &mut first.0[y / 2 * first.1..];
            match self.layout {
                Chroma::Interleaved => {
                    for (at, pair) in first.as_chunks_mut::<2>().0[..columns].iter_mut().enumerate() {
                        *pair =
                            [byte(i32::from(pair[0]) + step(1, at)), byte(i32::from(pair[1]) + step(2, at))];
                    }
                }
                Chroma::Planar => {
                    let second = &mut second.0[y / 2 * second.1..];
                    for (at, (u, v)) in first[..columns].iter_mut().zip(second).enumerate() {
                        *u = byte(i32::from(*u) + step(1, at));
                        *v = byte(i32::from(*v) + step(2, at));
                    }
                }
            }
        }
    }
}

#[inline]
fn byte(value: i32) -> u8 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is within a byte")]
    let byte = value.clamp(0, 255) as u8;
    byte
}
