//! The compressed PLY of PlayCanvas (SuperSplat, splat-transform): 16 bytes a splat, within the bounds of its chunk of 256.
//!
//! Elements stand one after the other: `chunk` with the least and the most of position, scale and, in newer files, colour;
//! `vertex` with four words a splat; and `sh`, one byte for each harmonic beyond the first.

use std::path::Path;

use super::{Bytes, Element, Kind, Property};
use crate::files::SceneFileError;
use crate::files::quaternion::{self, Order};
use crate::splats::{self, FLAT, HARMONICS, LOG_SCALE, MAX_SH_DEGREE, MEAN, OPACITY, ROTATION, Splats};

/// Splats that share bounds.
const CHUNK: usize = 256;
const BOUNDS: [&str; 12] = [
    "min_x",
    "min_y",
    "min_z",
    "max_x",
    "max_y",
    "max_z",
    "min_scale_x",
    "min_scale_y",
    "min_scale_z",
    "max_scale_x",
    "max_scale_y",
    "max_scale_z",
];
/// Of colours, which older files do not have: 0 and 1.
const COLOURS: [&str; 6] = ["min_r", "min_g", "min_b", "max_r", "max_g", "max_b"];
const WORDS: [&str; 4] = ["packed_position", "packed_rotation", "packed_scale", "packed_color"];
/// Harmonics lie between minus and plus a half of this.
const SPREAD: f32 = 8.0;
/// Opacities of 0 and 1 have no logit.
const EDGE: f32 = 0.5 / 255.0;

/// Whether these are the elements of such a file.
pub(super) fn is_one(elements: &[Element]) -> bool {
    elements.first().is_some_and(|element| element.name == "chunk")
}

/// Reads what follows the header.
pub(super) fn parse(
    path: &Path,
    elements: &[Element],
    mut bytes: Bytes<'_>,
) -> Result<Splats<f32>, SceneFileError> {
    let unlike = || {
        let cause =
            "it is no compressed PLY as SuperSplat writes it. Export it again, as .ply without compression";
        SceneFileError::content(path, cause)
    };
    let (chunk, vertex, harmonic) = match elements {
        [chunk, vertex] => (chunk, vertex, None),
        [chunk, vertex, harmonic] => (chunk, vertex, Some(harmonic)),
        _ => return Err(unlike()),
    };
    let is = |element: &Element, name: &str, kind: Kind, wanted: &[&str]| {
        let alike =
            |(property, wanted): (&Property, &&str)| property.name == **wanted && property.kind == kind;
        element.name == name
            && element.properties.len() == wanted.len()
            && element.properties.iter().zip(wanted).all(alike)
    };
    let with_colours = [&BOUNDS[..], &COLOURS[..]].concat();
    let has_colours = is(chunk, "chunk", Kind::Float, &with_colours);
    let names: Vec<String> = harmonic
        .map(|element| (0..element.properties.len()).map(|i| format!("f_rest_{i}")).collect())
        .unwrap_or_default();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let degree = (0..=MAX_SH_DEGREE)
        .find(|&degree| splats::harmonics(degree).saturating_sub(1).saturating_mul(3) == names.len());
    let is_known = (has_colours || is(chunk, "chunk", Kind::Float, &BOUNDS))
        && is(vertex, "vertex", Kind::Unsigned(4), &WORDS)
        && harmonic.is_none_or(|element| {
            is(element, "sh", Kind::Unsigned(1), &names) && element.count == vertex.count
        });
    let Some(degree) = degree.filter(|_| is_known && chunk.count == vertex.count.div_ceil(CHUNK)) else {
        return Err(unlike());
    };
    let needed = elements.iter().fold(0_usize, |sum, element| sum.saturating_add(element.bytes()));
    if bytes.left() < needed {
        return Err(bytes.wrong(format!("it promises {needed} bytes, and has {}", bytes.left())));
    }

    let mut chunks = Vec::with_capacity(chunk.count);
    for _ in 0..chunk.count {
        let mut bounds = [0.0_f32; 18];
        let known = if has_colours { 18 } else { 12 };
        // As if they were there.
        bounds.iter_mut().skip(15).for_each(|most| *most = 1.0);
        for bound in bounds.iter_mut().take(known) {
            *bound = f32::from_le_bytes(bytes.take()?);
            if !bound.is_finite() {
                return Err(bytes.wrong("a bound that is no number"));
            }
        }
        chunks.push(bounds);
    }
    let width = Splats::<f32>::width_of(degree);
    let mut rows = vec![0.0_f32; vertex.count.saturating_mul(width)];
    let bounds = chunks.iter().flat_map(|chunk| [chunk; CHUNK]);
    for (row, bounds) in rows.chunks_exact_mut(width).zip(bounds) {
        let [position, turn, scale, colour] = [bytes.word()?, bytes.word()?, bytes.word()?, bytes.word()?];
        let between = |axis: usize, at: usize, share: f32| {
            let [least, most] = [at, at.saturating_add(3)]
                .map(|at| bounds.get(at.saturating_add(axis)).copied().unwrap_or(0.0));
            least + (most - least) * share
        };
        for (axis, (place, size)) in shares(position).into_iter().zip(shares(scale)).enumerate() {
            put(row, MEAN.saturating_add(axis), between(axis, 0, place));
            put(row, LOG_SCALE.saturating_add(axis), between(axis, 6, size));
        }
        for (at, q) in (ROTATION..).zip(quaternion::unpacked(turn, Order::Even)) {
            put(row, at, q);
        }
        let [opacity, blue, green, red] = colour.to_le_bytes().map(|v| f32::from(v) / 255.0);
        for (axis, value) in [red, green, blue].into_iter().enumerate() {
            put(row, HARMONICS.saturating_add(axis), (between(axis, 12, value) - 0.5) / flat());
        }
        let opacity = opacity.clamp(EDGE, 1.0 - EDGE);
        put(row, OPACITY, (opacity / (1.0 - opacity)).ln());
    }
    let beyond = splats::harmonics(degree).saturating_sub(1);
    for row in rows.chunks_exact_mut(width).filter(|_| beyond > 0) {
        for channel in 0..3_usize {
            for place in 1..=beyond {
                let value = match bytes.take::<1>()? {
                    [0] => 0.0,
                    [255] => 1.0,
                    [v] => (f32::from(v) + 0.5) / 256.0,
                };
                let at = HARMONICS.saturating_add(place.saturating_mul(3)).saturating_add(channel);
                put(row, at, (value - 0.5) * SPREAD);
            }
        }
    }
    // Between bounds far apart a number may have gone beyond all floats.
    let is_finite = rows.iter().all(|value| value.is_finite());
    Splats::from_rows(degree, rows).filter(|_| is_finite).ok_or_else(unlike)
}

/// 11, 10 and 11 bits, from 0 to 1.
fn shares(word: u32) -> [f32; 3] {
    [(word >> 21) as f32 / 2047.0, (word >> 11 & 0x3ff) as f32 / 1023.0, (word & 0x7ff) as f32 / 2047.0]
}

#[allow(clippy::cast_possible_truncation, reason = "a constant, to fewer digits")]
const fn flat() -> f32 {
    FLAT as f32
}

fn put(row: &mut [f32], at: usize, value: f32) {
    if let Some(cell) = row.get_mut(at) {
        *cell = value;
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;

    /// A file of one chunk from 0 to 2, scales from -6 to -2, with the words of each splat and, of degree 1, nine bytes.
    fn file(colours: bool, splats: &[[u32; 4]], harmonics: &[[u8; 9]]) -> Vec<u8> {
        let mut head = String::from("ply\nformat binary_little_endian 1.0\nelement chunk 1\n");
        let bounds = [&BOUNDS[..], if colours { &COLOURS } else { &[] }].concat();
        bounds.iter().for_each(|name| writeln!(head, "property float {name}").unwrap());
        writeln!(head, "element vertex {}", splats.len()).unwrap();
        WORDS.iter().for_each(|name| writeln!(head, "property uint {name}").unwrap());
        if !harmonics.is_empty() {
            writeln!(head, "element sh {}", harmonics.len()).unwrap();
            (0..9).for_each(|i| writeln!(head, "property uchar f_rest_{i}").unwrap());
        }
        let mut bytes = (head + "end_header\n").into_bytes();
        let values = [[0.0_f32; 3], [2.0; 3], [-6.0; 3], [-2.0; 3], [-1.0; 3], [3.0; 3]];
        bytes.extend(values.as_flattened()[..bounds.len()].iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(splats.as_flattened().iter().flat_map(|word| word.to_le_bytes()));
        bytes.extend(harmonics.as_flattened());
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Splats<f32>, SceneFileError> {
        super::super::parse(Path::new("a.ply"), bytes)
    }

    /// Far right, half way down, near; w is largest, and x half of what it may be.
    const SPLAT: [u32; 4] =
        [2047 << 21 | 511 << 11, 767 << 20 | 512 << 10 | 512, 2047 << 21, 255 << 24 | 51 << 8 | 128];

    #[test]
    fn a_splat_lies_within_the_bounds_of_its_chunk() {
        for colours in [false, true] {
            let splats = read(&file(colours, &[SPLAT, [0; 4]], &[])).unwrap();
            let [x, y, z] = splats.mean(0);
            assert!(x == 2.0 && (y - 0.999).abs() < 1e-3 && z == 0.0, "{x} {y} {z}");
            assert_eq!(splats.row(0)[LOG_SCALE..ROTATION], [-2.0, -6.0, -6.0]);
            let [w, x, y, z] = splats.rotation(0);
            assert!((w - 0.935).abs() < 2e-3 && (x - 0.354).abs() < 2e-3 && y.abs() < 1e-3 && z.abs() < 1e-3);
            assert!((splats.opacity(0) - 0.502).abs() < 1e-3);
            let red = if colours { 3.0 } else { 1.0 };
            assert!((splats.colour(0)[0] - red).abs() < 1e-5);
        }
    }

    #[test]
    fn harmonics_go_channel_by_channel() {
        let splats = read(&file(true, &[SPLAT], &[[255, 0, 128, 128, 128, 128, 128, 128, 191]])).unwrap();
        assert_eq!(splats.sh_degree(), 1);
        let row = &splats.row(0)[HARMONICS + 3..];
        // The first two of red, and the last of blue.
        assert_eq!([row[0], row[3]], [4.0, -4.0]);
        assert!((row[8] - 1.984).abs() < 1e-3, "{row:?}");
    }

    #[test]
    fn what_is_unlike_it_is_refused() {
        let whole = file(true, &[SPLAT; 3], &[]);
        assert!(read(&whole[..whole.len() - 1]).unwrap_err().to_string().contains("promises"));
        let text =
            String::from_utf8_lossy(&file(false, &[[0; 4]], &[])).replace("packed_scale", "packed_size");
        assert!(read(text.as_bytes()).unwrap_err().to_string().contains("no compressed PLY"));
        let mut wild = whole;
        let at = wild.len() - 3 * 16 - 18 * 4;
        wild[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(read(&wild).unwrap_err().to_string().contains("no number"));
    }
}
