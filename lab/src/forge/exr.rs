//! OpenEXR files whose attributes lie (OpenEXR file layout).

use ::exr::prelude::Encoding;
use anyhow::Result;

use super::bytes::{find, put};
use super::list::Files;
use super::list::Right::{Any, Refuse};
use super::seeds::{self, HEIGHT, WIDTH};

const LIES: &str = "header lies";
const LARGE: &str = "header too large";

pub(crate) fn add(files: &mut Files) -> Result<()> {
    // Uncompressed, so that nothing but what was changed is wrong.
    let seed = seeds::exr_of(WIDTH, HEIGHT, &seeds::metres(), Encoding::UNCOMPRESSED)?;
    // The value of an attribute follows its name, its type and four bytes of length.
    let value = |name: &str, kind: &str| {
        find(&seed, format!("{name}\0{kind}\0").as_bytes()).map(|at| at + name.len() + kind.len() + 6)
    };
    let window = value("dataWindow", "box2i")?;
    let channels = value("channels", "chlist")?;
    let compression = value("compression", "compression")?;
    let line_order = value("lineOrder", "lineOrder")?;
    let ints = |ints: &[i32]| -> Vec<u8> { ints.iter().flat_map(|int| int.to_le_bytes()).collect() };
    let mut add = |kind, right, name: &str, bytes: Vec<u8>| {
        files.depth(kind, right, &format!("{name}.exr"), bytes);
    };
    for side in [20_000, 65_535, i32::MAX] {
        let bytes = put(&seed, window, &ints(&[0, 0, side - 1, side - 1]));
        add(LARGE, Refuse, &format!("window-of-{side}x{side}"), bytes);
    }
    add(LARGE, Refuse, "window-of-1x2147483647", put(&seed, window, &ints(&[0, 0, 0, i32::MAX - 1])));
    add(
        LARGE,
        Refuse,
        "window-of-all-numbers",
        put(&seed, window, &ints(&[i32::MIN, i32::MIN, i32::MAX, i32::MAX])),
    );
    // Corners can be put right without loss, and so can flags that no attribute bears out.
    add(LIES, Any, "window-turned-inside-out", put(&seed, window, &ints(&[47, 31, 0, 0])));
    add(LIES, Refuse, "window-of-33-rows", put(&seed, window, &ints(&[0, 0, 47, 32])));
    add(LIES, Refuse, "attribute-of-length-2147483647", put(&seed, window - 4, &ints(&[i32::MAX])));
    add(LIES, Refuse, "attribute-of-negative-length", put(&seed, window - 4, &ints(&[-1])));
    add(LIES, Refuse, "compression-99", put(&seed, compression, &[99]));
    add(LIES, Any, "line-order-77", put(&seed, line_order, &[77]));
    add(LIES, Refuse, "no-channels", put(&seed, channels, &[0]));
    // Name and its end, the type, "linear" and three unused bytes, then sampling across and down.
    add(LIES, Refuse, "channel-of-type-7", put(&seed, channels + 2, &ints(&[7])));
    add(LIES, Refuse, "channel-sampled-0-times", put(&seed, channels + 10, &ints(&[0, 0])));
    add(LIES, Refuse, "channel-sampled-minus-once", put(&seed, channels + 10, &ints(&[-1, -1])));
    add(LIES, Refuse, "version-99", put(&seed, 4, &[99]));
    add(LIES, Refuse, "no-attributes", [&seed[..8], &[0]].concat());
    add(LIES, Refuse, "magic-alone", seed[..4].to_vec());
    add(
        LIES,
        Refuse,
        "attributes-without-end",
        [&seed[..8], b"name\0string\0\x04\0\0\0reef".repeat(20_000).as_slice()].concat(),
    );
    add(LIES, Refuse, "name-without-end", [&seed[..8], &[b'a'; 100_000]].concat());
    for (name, flags) in [("tiled", 0x02), ("deep", 0x08)] {
        add(LIES, Any, &format!("said-to-be-{name}"), put(&seed, 5, &[seed[5] | flags]));
    }
    // Headers of many parts end differently; flags nobody knows may change anything.
    for (name, flags) in [("of-many-parts", 0x10), ("of-a-later-kind", 0xe0)] {
        add(LIES, Refuse, &format!("said-to-be-{name}"), put(&seed, 5, &[seed[5] | flags]));
    }
    // 32 offsets, one a line, then the lines: y, length, 48 floats.
    let (line, lines) = (8 + 4 * WIDTH as usize, HEIGHT as usize);
    let first = seed.len() - line * lines;
    let table = first - 8 * lines;
    // A reader that goes through the file in order needs no offsets.
    for (name, offset) in [("0", [0; 8]), ("out-of-the-file", [0x7f; 8]), ("negative", [0xff; 8])] {
        add("damaged data", Any, &format!("offsets-{name}"), put(&seed, table, &offset.repeat(lines)));
    }
    add(
        "damaged data",
        Any,
        "offsets-all-the-same",
        put(&seed, table, &seed[table..table + 8].repeat(lines)),
    );
    add("damaged data", Refuse, "line-of-negative-length", put(&seed, first + 4, &ints(&[-1])));
    add("damaged data", Refuse, "line-of-2147483647-bytes", put(&seed, first + 4, &ints(&[i32::MAX])));
    add("damaged data", Refuse, "line-outside-the-window", put(&seed, first, &ints(&[9999])));
    add("damaged data", Refuse, "line-at-most-negative", put(&seed, first, &ints(&[i32::MIN])));
    add("damaged data", Any, "line-twice", put(&seed, first, &ints(&[1])));
    Ok(())
}
