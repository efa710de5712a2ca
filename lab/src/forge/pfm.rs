//! PFM files with impossible headers, and maps in every format that are valid files but no use as depth.

use super::list::Files;
use super::list::Right::{Accept, Any, Refuse};
use super::seeds::{HEIGHT, WIDTH, depth_of, little_endian, metres};

const LIES: &str = "header lies";

pub(crate) fn add(files: &mut Files) {
    headers(files);
    unfit(files);
}

fn headers(files: &mut Files) {
    let data = little_endian(&metres());
    let mut add = |kind, right, name: &str, header: &str| {
        files.depth(kind, right, &format!("{name}.pfm"), [header.as_bytes(), &data].concat());
    };
    for sides in
        ["20000 20000", "65535 65535", "4294967295 4294967295", "1 4294967295", "18446744073709551615 2"]
    {
        let name = sides.replace(' ', "x");
        add("header too large", Refuse, &name, &format!("Pf\n{sides}\n-1.0\n"));
    }
    for (name, sides) in [
        ("zero-size", "0 0"),
        ("zero-height", "48 0"),
        ("negative-width", "-48 32"),
        ("negative-both", "-48 -32"),
        ("fractions", "48.5 32.5"),
        ("words", "wide high"),
        ("one-side", "48"),
        ("digits-without-end", &"9".repeat(10_000)),
        ("more-rows-than-data", "48 33"),
    ] {
        add(LIES, Refuse, name, &format!("Pf\n{sides}\n-1.0\n"));
    }
    // The sign of the scale is the order of bytes: these have none, or are no number.
    for scale in ["0", "NaN", "abc", ""] {
        add(LIES, Refuse, &format!("scale-{scale}"), &format!("Pf\n48 32\n{scale}\n"));
    }
    // Not finite, but with a sign.
    add(LIES, Any, "scale-infinite", "Pf\n48 32\n-inf\n");
    add(LIES, Any, "scale-1e-999", "Pf\n48 32\n-1e-999\n");
    add(LIES, Refuse, "colour-of-one-channels-data", "PF\n48 32\n-1.0\n");
    add(LIES, Refuse, "no-white-space", "Pf48x32");
    add(LIES, Refuse, "white-space-for-ever", &format!("Pf\n{}", " ".repeat(100_000)));
    files.depth(LIES, Refuse, "header-alone.pfm", *b"Pf\n48 32\n-1.0\n");
}

/// Whole files whose values do not suit: of the image's size, but invalid; or valid, of another size.
fn unfit(files: &mut Files) {
    const KIND: &str = "unfit depth";
    let size = (WIDTH * HEIGHT) as usize;
    for extension in ["pfm", "npy", "tiff", "exr"] {
        let mut add = |right, name: &str, width, height, values: &[f32]| {
            if let Ok(bytes) = depth_of(extension, width, height, values) {
                files.depth(KIND, right, &format!("{name}.{extension}"), bytes);
            }
        };
        for (name, value) in [
            ("nan-only", f32::NAN),
            ("infinite-only", f32::INFINITY),
            ("zero-only", 0.0),
            ("negative-only", -3.0),
        ] {
            add(Refuse, name, WIDTH, HEIGHT, &vec![value; size]);
        }
        add(Refuse, "one-column-less", WIDTH - 1, HEIGHT, &vec![3.0; size]);
        add(Refuse, "turned", HEIGHT, WIDTH, &vec![3.0; size]);
        add(Refuse, "one-value", 1, 1, &[3.0]);
        add(Any, "largest-numbers", WIDTH, HEIGHT, &vec![f32::MAX; size]);
        add(Any, "smallest-numbers", WIDTH, HEIGHT, &vec![f32::from_bits(1); size]);
        add(Any, "flat", WIDTH, HEIGHT, &vec![3.0; size]);
        // Holes are what measured depth has; colour fills them.
        let holes = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1.0];
        let holed: Vec<f32> = metres()
            .into_iter()
            .enumerate()
            .map(|(at, z)| if at % 7 == 0 { holes[at / 7 % holes.len()] } else { z })
            .collect();
        add(Accept, "with-holes", WIDTH, HEIGHT, &holed);
    }
}
