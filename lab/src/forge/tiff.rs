//! TIFF files whose directories loop, point nowhere, or count more than there is.

use super::bytes::put;
use super::list::Right::{self, Any, Refuse};
use super::list::{Files, Role};
use super::tiff_bytes::{
    BITS, BYTE_COUNTS, COMPRESSION, IMAGE_LENGTH, IMAGE_WIDTH, LONG, OFFSETS, PHOTOMETRIC, ROWS,
    SAMPLE_FORMAT, SAMPLES, SHORT, Tiff,
};
use crate::chance::Chance;

const LIES: &str = "header lies";
const LARGE: &str = "header too large";

pub(crate) fn add(files: &mut Files) {
    for (role, seed) in [(Role::Image, Tiff::grey()), (Role::Depth, Tiff::depth())] {
        large(files, role, &seed);
        directories(files, role, &seed);
        strips(files, role, &seed);
    }
    values(files);
}

fn large(files: &mut Files, role: Role, seed: &Tiff) {
    for (width, height) in [(20_000, 20_000), (65_535, 65_535), (u32::MAX, u32::MAX), (1, u32::MAX)] {
        let sized = seed.clone().with(IMAGE_WIDTH, width).with(IMAGE_LENGTH, height);
        let one_strip = sized.clone().with(ROWS, height);
        files.add(LARGE, role, Refuse, &format!("{width}x{height}.tiff"), sized.bytes());
        files.add(LARGE, role, Refuse, &format!("{width}x{height}-in-one-strip.tiff"), one_strip.bytes());
    }
    let tile = |side| {
        let bare = seed.clone().without(ROWS).without(BYTE_COUNTS);
        bare.with(322, side).with(323, side).with(324, 300).with(325, 100).bytes()
    };
    // The width of a tile may be a short or a long; here it is a short.
    files.add(LARGE, role, Refuse, "tiles-of-65520x65520.tiff", tile(65_520));
    files.add(LIES, role, Refuse, "tiles-of-0x0.tiff", tile(0));
    for (name, tag) in [("strip-offsets", OFFSETS), ("strip-sizes", BYTE_COUNTS)] {
        let many = seed.clone().entry((tag, LONG, u32::MAX, 8));
        files.add(LARGE, role, Refuse, &format!("4294967295-{name}.tiff"), many.bytes());
    }
    let bits = seed.clone().entry((BITS, SHORT, u32::MAX, 8));
    files.add(LARGE, role, Refuse, "4294967295-bits-per-sample.tiff", bits.bytes());
    let text = seed.clone().entry((270, 2, u32::MAX, 8));
    files.add(LARGE, role, Any, "description-of-4-gigabytes.tiff", text.bytes());
}

fn directories(files: &mut Files, role: Role, seed: &Tiff) {
    let whole = seed.bytes();
    let mut add = |right: Right, name: &str, bytes: Vec<u8>| {
        files.add(LIES, role, right, &format!("{name}.tiff"), bytes);
    };
    add(Any, "directory-that-loops", seed.clone().next(8).bytes());
    add(Any, "next-directory-out-of-the-file", seed.clone().next(u32::MAX).bytes());
    add(Any, "directory-inside-itself", seed.clone().entry((330, LONG, 1, 8)).bytes());
    add(Refuse, "first-directory-out-of-the-file", put(&whole, 4, &[0xff; 4]));
    add(Refuse, "first-directory-at-0", put(&whole, 4, &[0; 4]));
    add(Refuse, "first-directory-at-the-end", put(&whole, 4, &(whole.len() as u32).to_le_bytes()));
    add(Refuse, "no-entries", put(&whole[..14], 8, &[0; 6]));
    add(Refuse, "65535-entries", put(&whole, 8, &[0xff; 2]));
    add(Refuse, "neither-42-nor-43", put(&whole, 2, &[41]));
    add(Refuse, "big-tiff-said-of-a-small-one", put(&whole, 2, &[43]));
    for (name, tag) in [("width", IMAGE_WIDTH), ("height", IMAGE_LENGTH)] {
        add(Refuse, &format!("no-{name}"), seed.clone().without(tag).bytes());
        add(Refuse, &format!("zero-{name}"), seed.clone().with(tag, 0).bytes());
    }
    // Without the offsets of strips: as a seed has none of its own, the entry gets another, private tag.
    let offsets = [OFFSETS.to_le_bytes(), LONG.to_le_bytes()].concat();
    if let Ok(at) = super::bytes::find(&whole, &offsets) {
        add(Refuse, "no-strip-offsets", put(&whole, at, &274_u16.to_le_bytes()));
    }
    add(Refuse, "width-of-an-unknown-type", seed.clone().entry((IMAGE_WIDTH, 77, 1, 48)).bytes());
    add(Refuse, "width-of-two-values", seed.clone().entry((IMAGE_WIDTH, LONG, 0, 48)).bytes());
}

fn strips(files: &mut Files, role: Role, seed: &Tiff) {
    let mut add = |right: Right, name: &str, tiff: Tiff| {
        files.add(LIES, role, right, &format!("{name}.tiff"), tiff.bytes());
    };
    add(Refuse, "strip-out-of-the-file", seed.clone().with(OFFSETS, 0x7fff_ffff));
    add(Refuse, "strip-at-4294967295", seed.clone().with(OFFSETS, u32::MAX));
    add(Any, "strip-at-0", seed.clone().with(OFFSETS, 0));
    // Some readers work the size of a plain strip out for themselves.
    add(Any, "strip-of-no-bytes", seed.clone().with(BYTE_COUNTS, 0));
    add(Any, "strip-of-4-gigabytes", seed.clone().with(BYTE_COUNTS, u32::MAX));
    add(Refuse, "strips-of-no-rows", seed.clone().with(ROWS, 0));
    add(Refuse, "one-strip-of-four", seed.clone().with(ROWS, 8).with(BYTE_COUNTS, 384));
    add(Refuse, "more-rows-than-data", seed.clone().with(IMAGE_LENGTH, 64).with(ROWS, 64));
    for (name, compression) in [("lzw", 5), ("deflate", 8), ("runs", 32_773)] {
        let noise = Chance(u64::from(compression)).bytes(60);
        let tiff = seed.clone().with(COMPRESSION, compression).with(BYTE_COUNTS, 60).data(noise);
        add(Refuse, &format!("noise-as-{name}"), tiff);
    }
    for compression in [0, 99, 65_000] {
        add(Refuse, &format!("compression-{compression}"), seed.clone().with(COMPRESSION, compression));
    }
    for compression in [3, 6, 7, 34_712] {
        // Fax, both kinds of JPEG, JPEG 2000: not what the data are.
        let tiff = seed.clone().with(COMPRESSION, compression);
        add(Refuse, &format!("pixels-as-compression-{compression}"), tiff);
    }
}

fn values(files: &mut Files) {
    let mut add = |right: Right, name: &str, edits: &[(u16, u32)]| {
        for (role, seed) in [(Role::Image, Tiff::grey()), (Role::Depth, Tiff::depth())] {
            let tiff = edits.iter().fold(seed, |tiff, &(tag, value)| tiff.with(tag, value));
            files.add(LIES, role, right, &format!("{name}.tiff"), tiff.bytes());
        }
    };
    add(Refuse, "0-bits", &[(BITS, 0)]);
    add(Refuse, "65535-bits", &[(BITS, 65_535)]);
    add(Any, "7-bits", &[(BITS, 7)]);
    add(Refuse, "no-samples", &[(SAMPLES, 0)]);
    add(Refuse, "65535-samples", &[(SAMPLES, 65_535)]);
    add(Refuse, "photometric-999", &[(PHOTOMETRIC, 999)]);
    add(Any, "palette-without-colours", &[(PHOTOMETRIC, 3)]);
    add(Any, "sample-format-9", &[(SAMPLE_FORMAT, 9)]);
    add(Any, "planes-of-kind-7", &[(284, 7)]);
    add(Any, "predictor-3", &[(317, 3)]);
    add(Any, "predictor-77", &[(317, 77)]);
}
