//! PNG by hand, chunk by chunk (PNG specification, third edition).

use super::bytes::{crc32, zlib};
use super::seeds::{HEIGHT, WIDTH, pixel};

pub(crate) const GREY: u8 = 0;
pub(crate) const RGB: u8 = 2;
pub(crate) const PALETTE: u8 = 3;

pub(crate) fn chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let named = [name, data].concat();
    let length = (data.len() as u32).to_be_bytes();
    [&length, &named[..], &crc32(&named).to_be_bytes()].concat()
}

/// IHDR with its seven fields.
pub(crate) fn header(width: u32, height: u32, bits: u8, colour: u8, [c, f, i]: [u8; 3]) -> Vec<u8> {
    chunk(b"IHDR", &[&width.to_be_bytes()[..], &height.to_be_bytes(), &[bits, colour, c, f, i]].concat())
}

/// IHDR of the seed's size, plain.
pub(crate) fn plain(bits: u8, colour: u8) -> Vec<u8> {
    header(WIDTH, HEIGHT, bits, colour, [0; 3])
}

pub(crate) fn idat(raw: &[u8]) -> Vec<u8> {
    chunk(b"IDAT", &zlib(raw))
}

pub(crate) fn end() -> Vec<u8> {
    chunk(b"IEND", &[])
}

pub(crate) fn file(chunks: &[Vec<u8>]) -> Vec<u8> {
    [b"\x89PNG\r\n\x1a\n", &chunks.concat()[..]].concat()
}

/// Rows with filter 0 in front.
fn rows(height: u32, row: impl Fn(u32) -> Vec<u8>) -> Vec<u8> {
    (0..height).flat_map(|y| [vec![0], row(y)].concat()).collect()
}

/// The seed's pixels.
pub(crate) fn rgb_rows() -> Vec<u8> {
    rows(HEIGHT, |y| (0..WIDTH).flat_map(|x| pixel(x, y)).collect())
}

/// 16 palette indices, one a byte.
pub(crate) fn index_rows() -> Vec<u8> {
    rows(HEIGHT, |y| (0..WIDTH).map(|x| ((x / 6 + y / 4) % 16) as u8).collect())
}

/// Grey of one bit.
pub(crate) fn bit_rows() -> Vec<u8> {
    rows(HEIGHT, |y| (0..WIDTH / 8).map(|x| (17 * (x + y)) as u8).collect())
}

/// The seed's pixels in the seven passes of Adam7.
fn interlaced_rows() -> Vec<u8> {
    const PASSES: [[u32; 4]; 7] =
        [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];
    let pass = |[left, top, across, down]: [u32; 4]| {
        let row = move |y| [0].into_iter().chain(steps(left, across, WIDTH).flat_map(move |x| pixel(x, y)));
        steps(top, down, HEIGHT).flat_map(row)
    };
    PASSES.into_iter().flat_map(pass).collect()
}

fn steps(from: u32, step: u32, to: u32) -> impl Iterator<Item = u32> {
    (from..to).step_by(step as usize)
}

/// The seed, interlaced.
pub(crate) fn interlaced() -> Vec<u8> {
    file(&[header(WIDTH, HEIGHT, 8, RGB, [0, 0, 1]), idat(&interlaced_rows()), end()])
}

/// PLTE of so many colours.
pub(crate) fn palette(colours: u32) -> Vec<u8> {
    chunk(b"PLTE", &(0..colours).flat_map(|index| pixel(3 * index % 48, 2 * index % 32)).collect::<Vec<u8>>())
}

/// The seed with chunks before its pixels.
pub(crate) fn with(chunks: &[Vec<u8>]) -> Vec<u8> {
    file(&[plain(8, RGB), chunks.concat(), idat(&rgb_rows()), end()])
}
