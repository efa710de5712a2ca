//! Splats as `.spz` (Niantic): a tenth of a PLY file. Gzip around a head of sixteen bytes and one array for each property.
//!
//! Positions are whole numbers of 24 bits, scales steps of a sixteenth of their logarithm, everything else bytes. Its axes are
//! right, up and back; those of our scenes right, down and ahead.

use std::io::{Read, Write};
use std::path::Path;

use aquafuse_data::files::{FileError, write_bytes};
use aquafuse_data::image_file::ReadOptions;
use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;

use super::SceneFileError;
use super::bytes::{self, Bytes};
use super::quaternion::{self, Order};
use crate::splats::{self, HARMONICS, LOG_SCALE, MAX_SH_DEGREE, MEAN, OPACITY, ROTATION, Splats};

const MARK: [u8; 4] = *b"NGSP";
/// The version that is written; 2, whose quaternions lack their largest number, is read too.
const VERSION: u32 = 3;
/// Splats were trained with the 2D filter of Mip-Splatting.
const ANTIALIASED: u8 = 1;
/// Bits of a position behind the point, unless the scene is too large for them.
const FRACTION: u8 = 12;
/// A colour's harmonic of degree 0 is stored times this.
const COLOUR: f32 = 0.15;
/// Bits of a harmonic of degree 1, and of a higher one, as the reference has them.
const STEPS: [f32; 2] = [8.0, 16.0];
/// The signs of the harmonics beyond the first where y and z point the other way.
const TURNED: [f32; 15] = [-1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0, 1.0];
/// Opacities of 0 and 1 have no logit: half a step is kept off both.
const EDGE: f32 = 0.5 / 255.0;
/// Bytes of a splat without its harmonics, in the file.
const LEAST: usize = 9 + 1 + 3 + 3 + 3;

/// Writes splats as a `.spz` file, whole or not at all.
///
/// # Errors
///
/// [`SceneFileError`] when a position is no number that fits, the file exists and may not be replaced, or the system refuses.
pub fn write_spz(path: &Path, splats: &Splats<f32>, overwrite: bool) -> Result<(), SceneFileError> {
    let Some(bytes) = spz_bytes(splats) else {
        let cause =
            "a splat lies too far away for .spz, beyond 8,388,607 units of the scene. Write .ply instead";
        return Err(SceneFileError::content(path, cause));
    };
    Ok(write_bytes(path, &bytes, overwrite)?)
}

/// The bytes of such a file; `None` where a position does not fit.
pub fn spz_bytes(splats: &Splats<f32>) -> Option<Vec<u8>> {
    let all = || splats.rows().chunks_exact(splats.width());
    let of = |row: &[f32], at: usize| row.get(at).copied().unwrap_or(0.0);
    let distances = || all().flat_map(|row| (MEAN..LOG_SCALE).map(move |at| of(row, at).abs()));
    let fits = |bits: &u8| distances().all(|v| v * 2_f32.powi(i32::from(*bits)) < 8_388_607.0);
    let fraction = (0..=FRACTION).rev().find(fits)?;

    let count = u32::try_from(splats.len()).ok()?;
    let mut raw = [MARK, VERSION.to_le_bytes(), count.to_le_bytes()].concat();
    raw.extend([splats.sh_degree(), fraction, ANTIALIASED, 0]);
    let scale = 2_f32.powi(i32::from(fraction));
    for row in all() {
        for (at, sign) in (MEAN..).zip([1.0, -1.0, -1.0]) {
            let [low, middle, high, _] = whole(sign * of(row, at) * scale).to_le_bytes();
            raw.extend([low, middle, high]);
        }
    }
    raw.extend((0..splats.len()).map(|i| byte(255.0 * splats.opacity(i))));
    for row in all() {
        raw.extend((HARMONICS..).take(3).map(|at| byte(255.0 * (COLOUR * of(row, at) + 0.5))));
    }
    for row in all() {
        raw.extend((LOG_SCALE..ROTATION).map(|at| byte(16.0 * (of(row, at) + 10.0))));
    }
    for i in 0..splats.len() {
        let [w, x, y, z] = splats.rotation(i);
        raw.extend(quaternion::packed([x, -y, -z, w]).to_le_bytes());
    }
    for row in all() {
        for (at, place) in places(splats.sh_degree()) {
            let step = STEPS.get(usize::from(place >= 3)).copied().unwrap_or(1.0);
            let level = 128.0 * (turned(place) * of(row, at)) + 128.0;
            raw.push(byte(((level / step).round() * step).min(255.0)));
        }
    }
    let mut file = GzEncoder::new(Vec::new(), Compression::default());
    // Writing to memory does not fail.
    file.write_all(&raw).ok()?;
    file.finish().ok()
}

/// Reads splats from a `.spz` file, version 2 or 3.
///
/// # Errors
///
/// [`SceneFileError`] when it is no such file, is damaged or cut short, or takes more memory than `reading` allows.
pub(super) fn read(path: &Path, reading: &ReadOptions) -> Result<Splats<f32>, SceneFileError> {
    parse(path, &bytes::read(path, reading)?, reading.max_memory)
}

fn parse(path: &Path, file: &[u8], most: u64) -> Result<Splats<f32>, SceneFileError> {
    if file.starts_with(&MARK) {
        let cause = "it is of version 4, and 2 and 3 are read. Export it again as version 3, or as .ply";
        return Err(SceneFileError::content(path, cause));
    }
    let mut raw = Vec::new();
    // Its array and the rows that are made of it: bytes become floats.
    let room = most.checked_div(8).unwrap_or(0);
    let read = MultiGzDecoder::new(file).take(room.saturating_add(1)).read_to_end(&mut raw);
    read.map_err(|error| SceneFileError::content(path, format!("it is no gzip file, or damaged: {error}")))?;
    if raw.len() as u64 > room {
        let cause =
            format!("unpacked it has more than {room} bytes, an eighth of --max-memory. Raise the limit");
        return Err(FileError::TooLarge { path: path.to_owned(), cause }.into());
    }
    unpacked(path, &raw)
}

fn unpacked(path: &Path, raw: &[u8]) -> Result<Splats<f32>, SceneFileError> {
    let mut bytes = Bytes::new(path, raw);
    if bytes.take()? != MARK {
        return Err(SceneFileError::content(path, "it is no .spz file: its first bytes are not \"NGSP\""));
    }
    let version = bytes.word()?;
    if !(2..=3).contains(&version) {
        return Err(bytes.wrong(format!("it is of version {version}, and 2 and 3 are read")));
    }
    let count = bytes.word()? as usize;
    let [degree, fraction, _, _] = bytes.take()?;
    if degree > MAX_SH_DEGREE || fraction > 23 {
        return Err(
            bytes.wrong(format!("it has harmonics of degree {degree} and positions of {fraction} bits"))
        );
    }
    let width = Splats::<f32>::width_of(degree);
    let turn = if version == 3 { 4_usize } else { 3 };
    let each = width.saturating_sub(HARMONICS).saturating_sub(3);
    let each = each.saturating_add(LEAST).saturating_sub(3).saturating_add(turn);
    if bytes.left() != count.saturating_mul(each) {
        let cause = format!("it promises {count} splats of {each} bytes, and has {} bytes", bytes.left());
        return Err(bytes.wrong(cause));
    }
    let mut rows = vec![0.0_f32; count.saturating_mul(width)];
    let unit = 2_f32.powi(i32::from(fraction)).recip();
    for row in rows.chunks_exact_mut(width) {
        for (at, sign) in (MEAN..).zip([1.0, -1.0, -1.0]) {
            let [low, middle, high] = bytes.take()?;
            // The sign lies in the highest bit: shifted up, and down again.
            put(row, at, sign * unit * (i32::from_le_bytes([0, low, middle, high]) >> 8) as f32);
        }
    }
    for row in rows.chunks_exact_mut(width) {
        let [opacity] = bytes.take()?.map(|v: u8| (f32::from(v) / 255.0).clamp(EDGE, 1.0 - EDGE));
        put(row, OPACITY, (opacity / (1.0 - opacity)).ln());
    }
    for row in rows.chunks_exact_mut(width) {
        let colour: [u8; 3] = bytes.take()?;
        for (at, v) in (HARMONICS..).zip(colour) {
            put(row, at, (f32::from(v) / 255.0 - 0.5) / COLOUR);
        }
    }
    for row in rows.chunks_exact_mut(width) {
        let scale: [u8; 3] = bytes.take()?;
        for (at, v) in (LOG_SCALE..).zip(scale) {
            put(row, at, f32::from(v) / 16.0 - 10.0);
        }
    }
    for row in rows.chunks_exact_mut(width) {
        let [w, x, y, z] = if version == 3 {
            let [x, y, z, w] = quaternion::unpacked(bytes.word()?, Order::SignAndSize);
            [w, x, y, z]
        } else {
            let [x, y, z] = bytes.take()?.map(|v: u8| f32::from(v) / 127.5 - 1.0);
            [(1.0 - x * x - y * y - z * z).max(0.0).sqrt(), x, y, z]
        };
        for (at, q) in (ROTATION..).zip([w, x, -y, -z]) {
            put(row, at, q);
        }
    }
    for row in rows.chunks_exact_mut(width) {
        for (at, place) in places(degree) {
            let [v] = bytes.take()?;
            put(row, at, turned(place) * (f32::from(v) - 128.0) / 128.0);
        }
    }
    Splats::from_rows(degree, rows).ok_or_else(|| bytes.wrong("its rows are not whole"))
}

/// Where the harmonics beyond the first lie in a row, each with its number: the file has the same order.
fn places(degree: u8) -> impl Iterator<Item = (usize, usize)> {
    let beyond = splats::harmonics(degree).saturating_sub(1);
    (HARMONICS.saturating_add(3)..).zip((0..beyond).flat_map(|place| [place; 3]))
}

fn turned(place: usize) -> f32 {
    TURNED.get(place).copied().unwrap_or(1.0)
}

fn put(row: &mut [f32], at: usize, value: f32) {
    if let Some(cell) = row.get_mut(at) {
        *cell = value;
    }
}

#[allow(clippy::cast_possible_truncation, reason = "what lies outside becomes the nearest one inside")]
fn whole(value: f32) -> i32 {
    value.round() as i32
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "of floats this alone makes whole numbers; what lies outside becomes the nearest one inside"
)]
fn byte(value: f32) -> u8 {
    value.round() as u8
}

/// Reads splats for fuzzing, without gzip around them, whose sums hide everything else: what was read is written and read
/// again, within the steps of the format.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(path: &Path, raw: &[u8]) -> Result<(), SceneFileError> {
    let splats = unpacked(path, raw)?;
    if let Some(file) = spz_bytes(&splats) {
        assert_eq!(parse(path, &file, u64::MAX)?.len(), splats.len());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some(degree: u8) -> Splats<f32> {
        let width = Splats::<f32>::width_of(degree);
        let mut rows: Vec<f32> = (0..40 * width).map(|i| 0.9 * (i as f32 * 1.7).sin()).collect();
        for row in rows.chunks_exact_mut(width) {
            row[LOG_SCALE..ROTATION].iter_mut().for_each(|v| *v = 4.0 * *v - 4.0);
            row[OPACITY] *= 3.0;
        }
        Splats::from_rows(degree, rows).unwrap()
    }

    fn again(splats: &Splats<f32>) -> Splats<f32> {
        parse(Path::new("a.spz"), &spz_bytes(splats).unwrap(), u64::MAX).unwrap()
    }

    #[test]
    fn splats_come_back_within_the_steps_of_the_format() {
        for degree in 0..=3 {
            let (splats, found) = (some(degree), again(&some(degree)));
            assert_eq!((found.len(), found.sh_degree()), (splats.len(), degree));
            for i in 0..splats.len() {
                let near =
                    |a: &[f32], b: &[f32], within: f32| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within);
                let (a, b) = (splats.row(i), found.row(i));
                assert!(near(&a[MEAN..LOG_SCALE], &b[MEAN..LOG_SCALE], 0.5 / 4096.0 + 1e-6));
                assert!(near(&a[LOG_SCALE..ROTATION], &b[LOG_SCALE..ROTATION], 1.0 / 32.0 + 1e-5));
                assert!(near(&[splats.opacity(i)], &[found.opacity(i)], 0.5 / 255.0 + 1e-6));
                assert!(near(&splats.colour(i), &found.colour(i), 0.005));
                // The two quaternions of one rotation.
                let turn = splats.rotation(i).iter().zip(found.rotation(i)).map(|(a, b)| a * b).sum::<f32>();
                assert!(turn.abs() > 0.9999, "{turn}");
                assert!(near(&a[HARMONICS + 3..], &b[HARMONICS + 3..], 9.0 / 128.0));
            }
            // What is on a step already stays there.
            assert_eq!(again(&found).rows()[..LOG_SCALE], found.rows()[..LOG_SCALE]);
        }
    }

    #[test]
    fn a_far_splat_takes_bits_from_the_fraction_and_one_too_far_is_refused() {
        let at = |x: f64| {
            let mut splats = Splats::<f32>::new(0);
            splats.push(&Splats::<f32>::ball(0, [x, 0.0, 0.0], 0.1, 0.5, [0.5; 3]));
            splats
        };
        assert!((again(&at(1e5)).mean(0)[0] - 1e5).abs() < 0.02);
        assert_eq!(spz_bytes(&at(1e7)), None);
        assert_eq!(spz_bytes(&at(f64::NAN)), None);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let file = spz_bytes(&some(1)).unwrap();
        let said = |bytes: &[u8], most: u64| parse(Path::new("a.spz"), bytes, most).unwrap_err().to_string();
        assert!(said(&file[..40], u64::MAX).contains("a.spz"));
        assert!(said(b"NGSP\x04\0\0\0", u64::MAX).contains("version 4"));
        assert!(said(b"no gzip", u64::MAX).contains("no gzip file"));
        assert!(said(&file, 800).contains("--max-memory"));
        let of = |raw: &[u8]| unpacked(Path::new("a.spz"), raw).unwrap_err().to_string();
        let head = |version: u8, count: u8, degree: u8| {
            [&MARK[..], &[version, 0, 0, 0, count, 0, 0, 0, degree, 12, 0, 0]].concat()
        };
        // One ahead of the camera, a half turn about x, opaque.
        let two = [&head(2, 1, 0)[..], &[0, 0, 0, 0, 0, 0, 0, 240, 255], &[255], &[128; 6], &[255, 128, 128]];
        let one = unpacked(Path::new("a.spz"), &two.concat()).unwrap();
        assert_eq!(one.mean(0), [0.0, 0.0, 1.0]);
        assert!((one.rotation(0)[1] - 1.0).abs() < 1e-4 && one.opacity(0) > 0.99 && one.scale(0)[0] < 0.15);
        assert!(of(b"PK\0\0").contains("not \"NGSP\""));
        assert!(of(&head(4, 0, 0)).contains("version 4"));
        assert!(of(&head(2, 9, 0)).contains("promises 9 splats of 19 bytes"));
        assert!(of(&head(2, 0, 9)).contains("degree 9"));
        assert_eq!(unpacked(Path::new("a.spz"), &head(3, 0, 0)).unwrap().len(), 0);
    }
}
