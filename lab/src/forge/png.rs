//! PNG files whose headers lie, whose chunks are wrong, or which would inflate to hundreds of megabytes.

use super::bytes::{put, zlib, zlib_zeros};
use super::list::Files;
use super::list::Right::{Any, Refuse};
use super::png_bytes::{
    GREY, PALETTE, RGB, bit_rows, chunk, end, file, header, idat, index_rows, palette, plain, rgb_rows, with,
};
use super::seeds::{HEIGHT, WIDTH};

const LIES: &str = "header lies";
const CHUNKS: &str = "palette and chunks";
const LARGE: &str = "header too large";
const INFLATES: &str = "inflates too far";
/// What the streams that inflate too far inflate to.
const FAR: usize = 300 << 20;

pub(crate) fn add(files: &mut Files) {
    large(files);
    lies(files);
    palettes(files);
    chunks(files);
    streams(files);
}

/// Sizes with hardly any data: refusing is right whatever the limit, for the pixels are not there.
fn large(files: &mut Files) {
    for (width, height) in
        [(20_000, 20_000), (65_535, 65_535), (u32::MAX, u32::MAX), (1, u32::MAX), (0x7fff_ffff, 1)]
    {
        let bomb = file(&[header(width, height, 8, RGB, [0; 3]), idat(&[0; 64]), end()]);
        files.image(LARGE, Refuse, &format!("{width}x{height}.png"), bomb.clone());
        files.depth(LARGE, Refuse, &format!("{width}x{height}.png"), {
            file(&[header(width, height, 16, GREY, [0; 3]), idat(&[0; 64]), end()])
        });
    }
    let deep = file(&[header(0x7fff_ffff, 0x7fff_ffff, 16, 6, [0, 0, 1]), idat(&[0; 64]), end()]);
    files.image(LARGE, Refuse, "interlaced-16-bit-2147483647.png", deep);
    // The one bomb whose pixels are all there: 400 million in 310 kB. A limit may refuse it, and may not.
    let zeros = zlib_zeros(20_000 * (1 + 20_000 / 8));
    let whole = file(&[header(20_000, 20_000, 1, GREY, [0; 3]), chunk(b"IDAT", &zeros), end()]);
    files.image(LARGE, Any, "whole-20000x20000-1-bit.png", whole);
}

fn lies(files: &mut Files) {
    let mut add = |name: &str, header: Vec<u8>| {
        files.image(LIES, Refuse, &format!("{name}.png"), file(&[header, idat(&rgb_rows()), end()]));
    };
    let (w, h) = (WIDTH, HEIGHT);
    add("zero-width", header(0, h, 8, RGB, [0; 3]));
    add("zero-height", header(w, 0, 8, RGB, [0; 3]));
    add("zero-size", header(0, 0, 8, RGB, [0; 3]));
    add("too-few-rows-of-data", header(w, h + 1, 8, RGB, [0; 3]));
    add("too-short-rows", header(w + 1, h, 8, RGB, [0; 3]));
    add("bit-depth-3", plain(3, RGB));
    add("rgb-of-4-bits", plain(4, RGB));
    add("colour-type-5", plain(8, 5));
    add("16-bit-said-of-8", plain(16, RGB));
    add("compression-1", header(w, h, 8, RGB, [1, 0, 0]));
    add("filter-method-1", header(w, h, 8, RGB, [0, 1, 0]));
    add("interlace-2", header(w, h, 8, RGB, [0, 0, 2]));
    add("interlaced-too-large", header(w + 8, h + 8, 8, RGB, [0, 0, 1]));
    add("no-header", Vec::new());
    add("short-header", chunk(b"IHDR", &[0; 12]));
    add("header-after-another-chunk", [chunk(b"gAMA", &[0, 0, 0xb1, 0x8f]), plain(8, RGB)].concat());
    add("wrong-checksum-of-header", wrong_checksum(&plain(8, RGB)));
}

fn palettes(files: &mut Files) {
    let data = || idat(&index_rows());
    let mut add = |right, name: &str, chunks: Vec<u8>| {
        let bytes = file(&[plain(8, PALETTE), chunks, data(), end()]);
        files.image(CHUNKS, right, &format!("{name}.png"), bytes);
    };
    // "A chunk length not divisible by 3 is an error"; png 0.18.1 panics on it.
    add(Refuse, "palette-of-7-bytes", chunk(b"PLTE", &[9; 7]));
    add(Refuse, "palette-of-1-byte", chunk(b"PLTE", &[9]));
    add(Refuse, "palette-of-nothing", chunk(b"PLTE", &[]));
    add(Refuse, "palette-of-257-colours", palette(257));
    add(Refuse, "no-palette", Vec::new());
    add(Any, "index-beyond-the-palette", palette(4));
    add(Any, "two-palettes", [palette(16), palette(16)].concat());
    add(Any, "transparency-longer-than-palette", [palette(16), chunk(b"tRNS", &[7; 200])].concat());
    add(Any, "transparency-before-palette", [chunk(b"tRNS", &[7; 4]), palette(16)].concat());
    let late = file(&[plain(8, PALETTE), data(), palette(16), end()]);
    files.image(CHUNKS, Refuse, "palette-after-the-pixels.png", late);
    let grey = file(&[plain(1, GREY), palette(2), idat(&bit_rows()), end()]);
    files.image(CHUNKS, Any, "palette-in-grey.png", grey);
    files.image(CHUNKS, Any, "palette-of-7-bytes-in-rgb.png", with(&[chunk(b"PLTE", &[9; 7])]));
    files.image(CHUNKS, Any, "transparency-of-7-bytes.png", with(&[chunk(b"tRNS", &[0; 7])]));
}

fn chunks(files: &mut Files) {
    let mut add = |right, name: &str, chunks: &[Vec<u8>]| {
        files.image(CHUNKS, right, &format!("{name}.png"), file(chunks));
    };
    let head = || plain(8, RGB);
    let data = || idat(&rgb_rows());
    add(Refuse, "no-data", &[head(), end()]);
    add(Refuse, "empty-data", &[head(), chunk(b"IDAT", &[]), end()]);
    add(Any, "no-end", &[head(), data()]);
    add(Refuse, "signature-alone", &[]);
    add(Refuse, "header-alone", &[head()]);
    add(Refuse, "wrong-checksum-of-data", &[head(), wrong_checksum(&data()), end()]);
    let text = chunk(b"tEXt", b"Title\0reef");
    add(Any, "wrong-checksum-of-text", &[head(), wrong_checksum(&text), data(), end()]);
    let long = put(&data(), 0, &0x7fff_ffff_u32.to_be_bytes());
    add(Refuse, "data-of-2-gigabytes", &[head(), long, end()]);
    let longer = put(&text, 0, &[0xff; 4]);
    add(Refuse, "text-of-4-gigabytes", &[head(), longer, data(), end()]);
    add(Any, "unknown-critical-chunk", &[head(), chunk(b"ABCD", b"what is this"), data(), end()]);
    add(Any, "two-headers", &[head(), head(), data(), end()]);
    let animation = [chunk(b"acTL", &[0xff; 8]), chunk(b"fcTL", &[0xff; 26])].concat();
    add(Any, "animation-of-4294967295-frames", &[head(), animation, data(), end()]);
    add(
        Any,
        "animation-with-short-chunks",
        &[head(), chunk(b"acTL", &[0]), data(), chunk(b"fdAT", &[]), end()],
    );
    let many = chunk(b"tEXt", b"k\0v").repeat(20_000);
    add(Any, "20000-texts", &[head(), many, data(), end()]);
    let odd = [chunk(b"gAMA", &[0; 4]), chunk(b"cHRM", &[0; 32]), chunk(b"pHYs", &[0xff; 9])].concat();
    add(Any, "gamma-of-zero", &[head(), odd, data(), end()]);
    add(Any, "short-gamma", &[head(), chunk(b"gAMA", &[1]), chunk(b"sRGB", &[]), data(), end()]);
    add(Any, "bytes-after-the-end", &[head(), data(), end(), vec![0x55; 1000]]);
}

/// The same chunk with the last byte of its checksum turned over.
fn wrong_checksum(chunk: &[u8]) -> Vec<u8> {
    let last = chunk.len() - 1;
    put(chunk, last, &[!chunk[last]])
}

/// Compressed data that are wrong, or far larger than what they are for.
fn streams(files: &mut Files) {
    let mut add = |right, name: &str, stream: &[u8]| {
        let bytes = file(&[plain(8, RGB), chunk(b"IDAT", stream), end()]);
        files.image(CHUNKS, right, &format!("{name}.png"), bytes);
    };
    add(Refuse, "stream-of-noise", &crate::chance::Chance(5).bytes(3000));
    add(Refuse, "stream-with-a-reserved-block", &[0x78, 0x01, 0b111, 0, 0, 0, 0]);
    // Distance 1 before anything stands there: fixed code, length 258.
    add(Refuse, "stream-that-reaches-before-its-start", &[0x78, 0x01, 0x1b, 0x05, 0x00, 0, 0, 0, 0]);
    add(Refuse, "filter-9", &zlib(&[9; 4640]));
    let whole = zlib(&rgb_rows());
    add(Any, "wrong-checksum-of-stream", &put(&whole, whole.len() - 4, &[1, 2, 3, 4]));
    add(Refuse, "stream-without-its-second-half", &whole[..whole.len() / 2]);
    let zeros = zlib_zeros(FAR);
    let data = file(&[plain(8, RGB), chunk(b"IDAT", &zeros), end()]);
    files.image(INFLATES, Any, "data-inflate-to-300-megabytes.png", data);
    let mut named = |name: &str, chunk_name, head: &[u8]| {
        let bomb = chunk(chunk_name, &[head, &zeros].concat());
        files.image(INFLATES, Any, &format!("{name}-inflates-to-300-megabytes.png"), with(&[bomb]));
    };
    named("profile", b"iCCP", b"icc\0\0");
    named("text", b"zTXt", b"Title\0\0");
    named("international-text", b"iTXt", b"Title\0\x01\0\0\0");
    files.image(CHUNKS, Any, "profile-of-noise.png", with(&[chunk(b"iCCP", &[7; 100])]));
    files.image(CHUNKS, Any, "profile-without-name.png", with(&[chunk(b"iCCP", &[0])]));
}
