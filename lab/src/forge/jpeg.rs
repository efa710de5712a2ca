//! JPEG files whose headers lie, whose parts are missing, or whose scans cost more than they show.

use super::bytes::put;
use super::jpeg_bytes::{
    CMYK, COLOUR, GREY, Sampling, Scan, baseline, codes, file, frame, scan_head, segment, steps, whole_scan,
};
use super::list::Files;
use super::list::Right::{Accept, Any, Refuse};
use crate::chance::Chance;

const LIES: &str = "header lies";
const LARGE: &str = "header too large";

pub(crate) fn add(files: &mut Files) {
    large(files);
    frames(files);
    tables(files);
    data(files);
}

fn with_frame(frame: Vec<u8>, components: &[Sampling]) -> Vec<u8> {
    let head = scan_head(components.len() as u8, 0, 63);
    file(&[steps(), codes(), frame, head, whole_scan(components)])
}

fn large(files: &mut Files) {
    for (width, height) in [(65_535, 65_535), (20_000, 20_000), (1, 65_535), (65_535, 1)] {
        let kind = if width.min(height) == 1 { LIES } else { LARGE };
        let name = |what: &str| format!("{what}-{width}x{height}-without-data.jpg");
        // An empty scan holds no block of the image.
        let nothing = file(&[steps(), codes(), frame(0xc0, width, height, COLOUR), scan_head(3, 0, 63)]);
        files.image(kind, Refuse, &name("baseline"), nothing);
        let nothing = file(&[steps(), codes(), frame(0xc2, width, height, CMYK), scan_head(4, 0, 0)]);
        files.image(kind, Refuse, &name("progressive-cmyk"), nothing);
    }
    // Whole images of 256 million pixels in a megabyte: each block is two bits, "as before" and "end".
    let zeros = vec![0; 2048 * 2048 * 2 / 8];
    let short = short_codes();
    let whole = [steps(), short.clone(), frame(0xc0, 16_384, 16_384, GREY), scan_head(1, 0, 63), zeros];
    files.image(LARGE, Any, "whole-grey-16384x16384.jpg", file(&whole));
    // Scan after scan over 16 million pixels, each a few bytes long: end-of-band runs of 32,767 blocks.
    let mut parts = vec![steps(), short, frame(0xc2, 4096, 4096, GREY), scan_head(1, 0, 0), vec![0; 32_768]];
    parts.push(segment(0xc4, &[&[0x10, 1][..], &[0; 15], &[0xe0]].concat()));
    for (name, scans) in [("ninety-scans", 90), ("two-thousand-scans", 2000)] {
        // 262,144 blocks are eight such runs and a little more.
        let scan = [scan_head(1, 1, 63), runs(9)].concat();
        let bytes = file(&[&parts[..], &[scan.repeat(scans)]].concat());
        files.image(LARGE, Any, &format!("{name}.jpg"), bytes);
    }
}

/// Both codes of one bit: the difference 0, and "end of block".
fn short_codes() -> Vec<u8> {
    let one = |class: u8| [&[class, 1][..], &[0; 16]].concat();
    segment(0xc4, &[one(0), one(0x10)].concat())
}

/// End-of-band runs of the longest kind, the bit 0 and 14 ones each; a 0xff is followed by a zero.
fn runs(count: usize) -> Vec<u8> {
    let bits: Vec<bool> = (0..count).flat_map(|_| (0..15).map(|at| at > 0)).collect();
    let byte =
        |bits: &[bool]| (0..8).fold(0, |byte, at| byte << 1 | u8::from(*bits.get(at).unwrap_or(&true)));
    let stuffed = |byte: u8| if byte == 0xff { vec![0xff, 0] } else { vec![byte] };
    bits.chunks(8).flat_map(|bits| stuffed(byte(bits))).collect()
}

fn frames(files: &mut Files) {
    let mut add = |right, name: &str, bytes: Vec<u8>| {
        files.image(LIES, right, &format!("{name}.jpg"), bytes);
    };
    let good = frame(0xc0, 48, 32, COLOUR);
    let scan = || [scan_head(3, 0, 63), whole_scan(COLOUR)].concat();
    add(Refuse, "no-frame", file(&[steps(), codes(), scan()]));
    let other = frame(0xc0, 64, 64, COLOUR);
    add(Refuse, "two-frames", file(&[steps(), codes(), good.clone(), other, scan()]));
    add(Refuse, "no-scan", file(&[steps(), codes(), good.clone()]));
    add(Refuse, "start-and-end-alone", file(&[]));
    add(Refuse, "zero-width", with_frame(frame(0xc0, 0, 32, COLOUR), COLOUR));
    add(Refuse, "zero-height", with_frame(frame(0xc0, 48, 0, COLOUR), COLOUR));
    add(Refuse, "more-rows-than-data", with_frame(frame(0xc0, 48, 320, COLOUR), COLOUR));
    add(Refuse, "no-components", with_frame(frame(0xc0, 48, 32, &[]), COLOUR));
    add(Refuse, "frame-shorter-than-its-components", with_frame(segment(0xc0, &good[4..12]), COLOUR));
    add(Any, "200-components", with_frame(frame(0xc0, 48, 32, &[(1, 1); 200]), COLOUR));
    add(Refuse, "sampling-0", with_frame(frame(0xc0, 48, 32, &[(0, 0); 3]), COLOUR));
    add(Refuse, "sampling-15", with_frame(frame(0xc0, 48, 32, &[(15, 15); 3]), COLOUR));
    add(Any, "sampling-3-by-4", with_frame(frame(0xc0, 48, 32, &[(3, 4), (2, 1), (1, 3)]), COLOUR));
    // Baseline is of 8 bits; nothing is of 0.
    add(Refuse, "baseline-of-12-bits", with_frame(put(&good, 4, &[12]), COLOUR));
    add(Refuse, "baseline-of-0-bits", with_frame(put(&good, 4, &[0]), COLOUR));
    add(Any, "twice-the-same-component", with_frame(put(&good, 13, &[1]), COLOUR));
    for marker in [0xc3, 0xc5, 0xc9, 0xcb, 0xcf] {
        let bytes = with_frame(frame(marker, 48, 32, COLOUR), COLOUR);
        add(Any, &format!("frame-of-kind-{marker:x}"), bytes);
    }
}

fn tables(files: &mut Files) {
    let mut add = |right, name: &str, bytes: Vec<u8>| {
        files.image(LIES, right, &format!("{name}.jpg"), bytes);
    };
    let parts = |before: &[Vec<u8>]| {
        let own = [frame(0xc0, 48, 32, GREY), scan_head(1, 0, 63), whole_scan(GREY)];
        file(&[before, &own].concat())
    };
    add(Refuse, "no-steps", parts(&[codes()]));
    // Streams of single frames leave out the usual tables; a reader may know them.
    add(Any, "no-codes", parts(&[steps()]));
    add(Any, "steps-of-zero", parts(&[segment(0xdb, &[0; 65]), codes()]));
    add(Refuse, "steps-of-table-15", parts(&[segment(0xdb, &[&[15][..], &[8; 64]].concat()), codes()]));
    add(Refuse, "half-a-table-of-steps", parts(&[segment(0xdb, &[0; 30]), codes()]));
    let many = segment(0xc4, &[&[0][..], &[255; 16], &[1; 4080]].concat());
    add(Refuse, "4080-codes-in-a-table", parts(&[steps(), many]));
    // Three codes of one bit: there are two.
    let three = segment(0xc4, &[&[0, 3][..], &[0; 15], &[0, 1, 2, 0x10, 1], &[0; 16]].concat());
    add(Refuse, "three-codes-of-one-bit", parts(&[steps(), three]));
    add(Refuse, "codes-cut-off", parts(&[steps(), segment(0xc4, &[0, 9, 9, 9])]));
    // The length counts itself, so these are impossible; libjpeg goes on all the same, and loses nothing.
    add(Any, "segment-of-length-0", parts(&[steps(), codes(), vec![0xff, 0xe1, 0, 0]]));
    add(Any, "segment-of-length-1", parts(&[steps(), codes(), vec![0xff, 0xe1, 0, 1]]));
    add(Refuse, "segment-past-the-end", parts(&[vec![0xff, 0xe1, 0xff, 0xff], steps(), codes()]));
    let scan_of =
        |head: Vec<u8>| file(&[steps(), codes(), frame(0xc0, 48, 32, GREY), head, whole_scan(GREY)]);
    add(Refuse, "scan-of-no-component", scan_of(scan_head(0, 0, 63)));
    add(Refuse, "scan-of-an-unknown-component", scan_of(segment(0xda, &[1, 77, 0, 0, 63, 0])));
    add(Refuse, "scan-of-200-components", scan_of(segment(0xda, &[200, 1, 0, 0, 63, 0])));
    add(Refuse, "scan-with-table-9", scan_of(segment(0xda, &[1, 1, 0x99, 0, 63, 0])));
    add(Any, "scan-of-coefficients-70-to-3", scan_of(scan_head(1, 70, 3)));
    add(Any, "restart-interval-of-1-byte", parts(&[steps(), codes(), segment(0xdd, &[1])]));
    add(Any, "restarts-that-never-come", parts(&[steps(), codes(), segment(0xdd, &[0, 1])]));
    let comments = segment(0xfe, b"a comment").repeat(50_000);
    add(Accept, "50000-comments", parts(&[comments, steps(), codes()]));
}

fn data(files: &mut Files) {
    let whole = baseline(COLOUR);
    let (at, half) = (whole.len() - 2 - whole_scan(COLOUR).len(), whole_scan(COLOUR).len() / 2);
    let mut add = |right, name: &str, bytes: Vec<u8>| {
        files.image("damaged data", right, &format!("{name}.jpg"), bytes);
    };
    add(Any, "hole-of-zeros", put(&whole, at + half / 2, &vec![0; half]));
    add(Any, "hole-of-ones", put(&whole, at + half / 2, &vec![0xff; half]));
    add(Any, "noise-for-data", put(&whole, at, &Chance(3).bytes(half * 2)));
    add(Any, "a-picture-in-the-data", put(&whole, at + 3, &whole[..half]));
    let early = [&whole[..at + half], b"\xff\xd9"].concat();
    add(Refuse, "an-end-mark-in-the-middle", early);
    let restart = Scan { components: GREY, units: 24, restart: 2, block_ends: true }.bytes();
    let parts = |scan: Vec<u8>| {
        let interval = segment(0xdd, &[0, 2]);
        file(&[steps(), codes(), interval, frame(0xc0, 48, 32, GREY), scan_head(1, 0, 63), scan])
    };
    let wrong = restart.iter().map(|&byte| if byte == 0xd2 { 0xd6 } else { byte }).collect();
    add(Any, "restart-mark-out-of-turn", parts(wrong));
    add(Refuse, "nothing-but-restart-marks", parts(b"\xff\xd0".repeat(20_000)));
    add(Any, "bytes-of-fill-before-the-end", [&whole[..whole.len() - 2], &[0xff; 100_000], b"\xd9"].concat());
}
