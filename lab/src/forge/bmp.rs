//! BMP files with negative sizes, impossible depths and colours that lie outside.

use super::bytes::put;
use super::list::Files;
use super::list::Right::{Accept, Any, Refuse};
use super::seeds::{HEIGHT, WIDTH, pixel};

/// Where the fields of the header stand.
const DATA_AT: usize = 10;
const HEADER_SIZE: usize = 14;
const WIDTH_AT: usize = 18;
const HEIGHT_AT: usize = 22;
const BITS_AT: usize = 28;
const COMPRESSION_AT: usize = 30;
const COLOURS_AT: usize = 46;

pub(crate) fn add(files: &mut Files) {
    let seed = bytes();
    let mut add = |right, name: &str, edits: &[(usize, i32)]| {
        let edited = edits.iter().fold(seed.clone(), |bytes, (at, value)| {
            // Bits are a field of two bytes.
            let width = if *at == BITS_AT { 2 } else { 4 };
            put(&bytes, *at, &value.to_le_bytes()[..width])
        });
        let large = name.starts_with("size");
        let kind = match right {
            Accept => "unusual but valid",
            _ if large => "header too large",
            _ => "header lies",
        };
        files.image(kind, right, &format!("{name}.bmp"), edited);
    };
    add(Refuse, "size-20000x20000", &[(WIDTH_AT, 20_000), (HEIGHT_AT, 20_000)]);
    add(Refuse, "size-65535x65535", &[(WIDTH_AT, 65_535), (HEIGHT_AT, 65_535)]);
    add(Refuse, "size-2147483647x2147483647", &[(WIDTH_AT, i32::MAX), (HEIGHT_AT, i32::MAX)]);
    add(Refuse, "size-1x2147483647", &[(WIDTH_AT, 1), (HEIGHT_AT, i32::MAX)]);
    add(Refuse, "size-2147483647x1", &[(WIDTH_AT, i32::MAX), (HEIGHT_AT, 1)]);
    let runs = [(WIDTH_AT, 65_535), (HEIGHT_AT, 65_535), (BITS_AT, 8), (COMPRESSION_AT, 1)];
    add(Any, "size-65535x65535-of-runs", &runs);
    add(Refuse, "zero-width", &[(WIDTH_AT, 0)]);
    add(Refuse, "zero-height", &[(HEIGHT_AT, 0)]);
    add(Refuse, "negative-width", &[(WIDTH_AT, -48)]);
    add(Refuse, "most-negative-height", &[(HEIGHT_AT, i32::MIN)]);
    add(Refuse, "too-few-rows", &[(HEIGHT_AT, 33)]);
    // Rows from the top, as the format allows.
    add(Accept, "negative-height", &[(HEIGHT_AT, -32)]);
    for bits in [3, 7, 255, 0x7fff] {
        add(Refuse, &format!("{bits}-bits"), &[(BITS_AT, bits)]);
    }
    add(Refuse, "64-bits-of-half-the-data", &[(BITS_AT, 64)]);
    add(Refuse, "32-bits-of-too-few-data", &[(BITS_AT, 32)]);
    add(Refuse, "compression-99", &[(COMPRESSION_AT, 99)]);
    add(Any, "runs-of-24-bits", &[(COMPRESSION_AT, 1)]);
    add(Any, "runs-that-leave-the-row", &[(BITS_AT, 8), (COMPRESSION_AT, 1)]);
    add(Any, "short-runs-that-leave-the-row", &[(BITS_AT, 4), (COMPRESSION_AT, 2)]);
    add(Any, "bit-fields-without-masks", &[(BITS_AT, 16), (COMPRESSION_AT, 3)]);
    add(Any, "a-jpeg-inside", &[(BITS_AT, 0), (COMPRESSION_AT, 4)]);
    add(Refuse, "header-of-13-bytes", &[(HEADER_SIZE, 13)]);
    add(Refuse, "header-of-4-gigabytes", &[(HEADER_SIZE, -1)]);
    add(Refuse, "data-after-the-end", &[(DATA_AT, 0x7fff_ffff)]);
    add(Any, "data-inside-the-header", &[(DATA_AT, 0)]);
    add(Any, "4294967295-colours", &[(COLOURS_AT, -1)]);
    add(Any, "4294967295-colours-of-8-bits", &[(COLOURS_AT, -1), (BITS_AT, 8)]);
    add(Any, "file-size-of-0", &[(2, 0)]);
}

/// The seed, 24 bits, rows from the bottom; 48 pixels need no padding.
fn bytes() -> Vec<u8> {
    let pixels: Vec<u8> =
        (0..HEIGHT).rev().flat_map(|y| (0..WIDTH).flat_map(move |x| pixel(x, y).into_iter().rev())).collect();
    let mut file = b"BM".to_vec();
    for field in [54 + pixels.len() as u32, 0, 54, 40, WIDTH, HEIGHT, 24 << 16 | 1, 0, pixels.len() as u32] {
        file.extend(field.to_le_bytes());
    }
    file.extend([0; 16]);
    [file, pixels].concat()
}
