//! COLMAP's depth maps, whose header is text: columns, rows and channels, with `&` behind each.

use super::list::Files;
use super::list::Right::{Accept, Any, Refuse};
use super::seeds::{little_endian, metres};

const LIES: &str = "header lies";
const LARGE: &str = "header too large";

pub(crate) fn add(files: &mut Files) {
    let data = little_endian(&metres());
    let mut add = |kind, right, name: &str, head: &str, data: &[u8]| {
        files.depth(kind, right, &format!("{name}.geometric.bin"), [head.as_bytes(), data].concat());
    };
    add("unusual but valid", Accept, "as-it-is", "48&32&1&", &data);
    for (name, head) in [
        ("20000x20000", "20000&20000&1&"),
        ("4294967295x4294967295", "4294967295&4294967295&1&"),
        ("9999999999x1", "9999999999&1&1&"),
    ] {
        add(LARGE, Refuse, name, head, &data);
    }
    for (name, head) in [
        ("0x32", "0&32&1&"),
        ("three-channels", "48&32&3&"),
        ("no-channels", "48&32&0&"),
        ("two-numbers", "48&32&"),
        ("negative", "48&-32&1&"),
        ("of-words", "48&tall&1&"),
        ("blanks", "48 & 32 & 1 &"),
        ("of-twenty-digits", "48000000000000000000&32&1&"),
        ("one-row-more", "48&33&1&"),
    ] {
        add(LIES, Refuse, name, head, &data);
    }
    add(LIES, Refuse, "header-alone", "48&32&1&", &[]);
    add(LIES, Any, "bytes-after-the-end", "48&32&1&", &[&data[..], &[7; 5000]].concat());
    let nan: Vec<u8> = f32::NAN.to_le_bytes().repeat(data.len() / 4);
    add("values", Any, "nan", "48&32&1&", &nan);
}
