//! NPY files: headers are Python literals, and invite what Python would do with them (NumPy Enhancement Proposal 1).

use super::list::Files;
use super::list::Right::{Accept, Any, Refuse};
use super::seeds::{little_endian, metres, npy};

const LIES: &str = "header lies";
const LARGE: &str = "header too large";

pub(crate) fn add(files: &mut Files) {
    let data = little_endian(&metres());
    let file = |descr: &str, shape: &str| {
        npy(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}"), &data)
    };
    for (name, shape) in [
        ("20000x20000", "(20000, 20000)"),
        ("65535x65535", "(65535, 65535)"),
        ("4294967295x4294967295", "(4294967295, 4294967295)"),
        ("1x4294967295", "(1, 4294967295)"),
        ("9223372036854775807-twice", "(9223372036854775807, 9223372036854775807)"),
        ("18446744073709551616x48", "(18446744073709551616, 48)"),
        ("2147483648x8589934592", "(2147483648, 8589934592)"),
    ] {
        files.depth(LARGE, Refuse, &format!("{name}.npy"), file("'<f4'", shape));
    }
    let mut add = |right, name: &str, bytes: Vec<u8>| {
        files.depth(LIES, right, &format!("{name}.npy"), bytes);
    };
    for (name, shape) in [
        ("0x0", "(0, 0)"),
        ("0x48", "(0, 48)"),
        ("negative", "(-32, 48)"),
        ("twice-negative", "(-32, -48)"),
        ("of-one-side", "(1536,)"),
        ("of-no-side", "()"),
        ("of-a-fraction", "(32.0, 48)"),
        ("of-words", "('a', 'b')"),
        ("not-closed", "(32, 48"),
        ("of-a-thousand-sides", &format!("({})", "1, ".repeat(1000))),
    ] {
        add(Refuse, &format!("shape-{name}"), file("'<f4'", shape));
    }
    // A pickle follows such a type; loading it would run whatever it holds.
    add(Refuse, "objects", file("'|O'", "(32, 48)"));
    for (name, descr) in [
        ("complex", "'<c8'"),
        ("text", "'<U4'"),
        ("times", "'<M8[s]'"),
        ("records", "[('a', '<f4')]"),
        ("size-0", "'<f0'"),
        ("size-4294967296", "'<f4294967296'"),
        ("nothing", "''"),
        ("not-closed", "'<f4"),
        ("a-call", "__import__('os').system('true')"),
        ("snowman", "'\u{2603}'"),
    ] {
        add(Refuse, &format!("type-{name}"), file(descr, "(32, 48)"));
    }
    add(Refuse, "header-of-nothing", npy("", &data));
    add(Refuse, "header-of-none", npy("{}", &data));
    add(Refuse, "header-is-a-program", npy("exit(1)", &data));
    add(Refuse, "header-of-brackets", npy(&"[".repeat(20_000), &data));
    add(Refuse, "header-of-braces", npy(&"{'descr':".repeat(5000), &data));
    add(Refuse, "header-without-shape", npy("{'descr': '<f4', 'fortran_order': False, }", &data));
    add(Refuse, "header-without-order", npy("{'descr': '<f4', 'shape': (32, 48), }", &data));
    add(
        Refuse,
        "order-is-maybe",
        npy("{'descr': '<f4', 'fortran_order': Maybe, 'shape': (32, 48), }", &data),
    );
    let start = |version: [u8; 2], length: &[u8]| [b"\x93NUMPY", &version[..], length, &[b' '; 100]].concat();
    add(Refuse, "version-9", start([9, 0], &[0; 4]));
    add(Refuse, "header-longer-than-the-file", start([1, 0], &[0xff; 2]));
    add(Refuse, "header-of-4-gigabytes", start([2, 0], &[0xff; 4]));
    add(Refuse, "header-of-bytes-that-are-no-text", start([1, 0], &[4, 0, 0xff, 0xfe, 0xc0, 0x80]));
    add(Refuse, "magic-alone", b"\x93NUMPY".to_vec());
    add(Refuse, "eight-bytes-said-of-four", file("'<f8'", "(32, 48)"));
    let values = |bytes: &[u8]| bytes.repeat(32 * 48);
    let short = |descr: &str, data: &[u8]| {
        npy(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': (32, 48), }}"), data)
    };
    // 1.5, infinity, no number and the smallest one there is, as floats of 16 bits.
    for (name, right, value) in [
        ("of-1.5", Accept, [0x00, 0x3e]),
        ("of-infinity", Any, [0x00, 0x7c]),
        ("of-no-number", Any, [0x01, 0x7e]),
        ("of-the-smallest", Any, [0x01, 0x00]),
    ] {
        add(right, &format!("float16-{name}"), short("'<f2'", &values(&value)));
    }
    add(Refuse, "float16-cut-short", short("'<f2'", &values(&[0])));
    add(Accept, "int32", short("'<i4'", &values(&[3, 0, 0, 0])));
    add(Refuse, "bfloat16", short("'<V2'", &values(&[0x80, 0x3f])));
    let trailing = [file("'<f4'", "(32, 48)"), vec![7; 5000]].concat();
    add(Any, "bytes-after-the-end", trailing);
}
