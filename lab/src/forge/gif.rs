//! GIF files without frames, with impossible codes, and with more frames than anyone shows (GIF89a).

use super::list::Files;
use super::list::Right::{self, Any, Refuse};
use super::seeds::{HEIGHT, WIDTH};

const LIES: &str = "header lies";

pub(crate) fn add(files: &mut Files) {
    let (w, h) = (WIDTH as u16, HEIGHT as u16);
    let mut add = |kind, right: Right, name: &str, parts: &[Vec<u8>]| {
        files.image(kind, right, &format!("{name}.gif"), [parts.concat(), b"\x3b".to_vec()].concat());
    };
    add(LIES, Refuse, "no-frame", &[screen(w, h)]);
    add(LIES, Refuse, "extensions-alone", &[screen(w, h), b"\x21\xfe\x04reef\0".repeat(3)]);
    add(LIES, Refuse, "frame-of-0x0", &[screen(w, h), frame(0, 0, 7), data(0)]);
    add(LIES, Any, "screen-of-0x0", &[screen(0, 0), frame(w, h, 7), data(1536)]);
    add(LIES, Any, "frame-larger-than-the-screen", &[screen(8, 8), frame(w, h, 7), data(1536)]);
    add(LIES, Any, "frame-outside-the-screen", &[screen(w, h), outside(), data(1536)]);
    add(LIES, Refuse, "codes-of-255-bits", &[screen(w, h), frame(w, h, 255), data(1536)]);
    add(LIES, Refuse, "codes-of-13-bits", &[screen(w, h), frame(w, h, 13), data(1536)]);
    add(LIES, Any, "codes-of-0-bits", &[screen(w, h), frame(w, h, 0), data(1536)]);
    add(LIES, Any, "no-colours", &[b"GIF89a\x30\0\x20\0\0\0\0".to_vec(), frame(w, h, 7), data(1536)]);
    add(LIES, Any, "version-90z", &[[b"GIF90z", &screen(w, h)[6..]].concat(), frame(w, h, 7), data(1536)]);
    // The first code is one that nothing has defined yet.
    add(
        "damaged data",
        Refuse,
        "undefined-code",
        &[screen(w, h), frame(w, h, 7), b"\x04\x80\xff\xff\xff\0".to_vec()],
    );
    add("damaged data", Refuse, "ends-after-ten-pixels", &[screen(w, h), frame(w, h, 7), data(10)]);
    add("damaged data", Refuse, "no-data", &[screen(w, h), frame(w, h, 7), vec![0]]);
    add("damaged data", Any, "more-data-than-pixels", &[screen(w, h), frame(w, h, 7), data(20_000)]);
    add(
        "damaged data",
        Any,
        "clear-codes-for-ever",
        &[screen(w, h), frame(w, h, 7), [&[255][..], &[0x80; 255]].concat().repeat(4000), data(1536)],
    );
    add(
        "header too large",
        Refuse,
        "frame-of-65535x65535",
        &[screen(u16::MAX, u16::MAX), frame(u16::MAX, u16::MAX, 7), data(10)],
    );
    add(
        "header too large",
        Any,
        "screen-of-65535x65535",
        &[screen(u16::MAX, u16::MAX), frame(w, h, 7), data(1536)],
    );
    add(
        "header too large",
        Any,
        "fifty-thousand-frames",
        &[screen(w, h), [frame(1, 1, 7), data(1)].concat().repeat(50_000)],
    );
}

/// The header and a table of 128 colours.
pub(crate) fn screen(width: u16, height: u16) -> Vec<u8> {
    let colours: Vec<u8> = (0..128).flat_map(|index| [index, index + 60, 127 + index / 2]).collect();
    let sides = [width.to_le_bytes(), height.to_le_bytes()].concat();
    [b"GIF89a", &sides[..], &[0xf6, 0, 0], &colours].concat()
}

/// A frame at the upper left, with the size of its codes less one.
pub(crate) fn frame(width: u16, height: u16, bits: u8) -> Vec<u8> {
    let sides = [width.to_le_bytes(), height.to_le_bytes()].concat();
    [&[0x2c, 0, 0, 0, 0][..], &sides, &[0, bits]].concat()
}

/// One of the seed's size at the lower right of where a screen can end.
fn outside() -> Vec<u8> {
    [&[0x2c, 0xff, 0xff, 0xff, 0xff][..], &[WIDTH as u8, 0, HEIGHT as u8, 0, 0, 7]].concat()
}

/// Pixels as codes of one byte: the table is cleared before codes would grow longer.
pub(crate) fn data(pixels: usize) -> Vec<u8> {
    let indices: Vec<u8> = (0..pixels).map(|at| ((at % 48 + at / 48) % 128) as u8).collect();
    let mut codes: Vec<u8> = indices.chunks(100).flat_map(|run| [&[0x80], run].concat()).collect();
    codes.push(0x81);
    let block = |block: &[u8]| [&[block.len() as u8], block].concat();
    [codes.chunks(255).flat_map(block).collect(), vec![0]].concat()
}
