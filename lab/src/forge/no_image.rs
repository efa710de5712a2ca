//! What people give instead of an image: text, web pages, nothing, noise behind a good beginning.

use super::list::Files;
use super::list::Right::Refuse;
use super::list::Role;
use crate::chance::Chance;

const KIND: &str = "no image";

pub(crate) fn add(files: &mut Files) {
    let things: [(&str, Vec<u8>); 15] = [
        ("empty", Vec::new()),
        ("one-byte", vec![0]),
        ("text", b"depth of the reef, in metres: about five\n".to_vec()),
        ("wide-text", "\u{feff}reef".encode_utf16().flat_map(u16::to_le_bytes).collect()),
        ("web-page", b"<!DOCTYPE html><html><body><h1>404 Not Found</h1></body></html>".to_vec()),
        ("json", br#"{"error": "no such picture"}"#.to_vec()),
        ("pdf", b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n<< /Type /Pages >>\nendobj\n%%EOF\n".to_vec()),
        // What stands in for a large file until it is fetched.
        ("pointer", b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n".to_vec()),
        // What a Mac leaves beside each file on a foreign disk.
        ("resource-fork", [&b"\0\x05\x16\x07\0\x02\0\0Mac OS X        "[..], &[0; 4000]].concat()),
        ("archive", [b"PK\x03\x04\x14\0\0\0\x08\0", &[0; 300][..]].concat()),
        ("program", [b"\x7fELF\x02\x01\x01\0", &[0; 3000][..]].concat()),
        ("film", [b"\0\0\0\x20ftypisom\0\0\x02\0", &[0; 3000][..]].concat()),
        ("camera-heic-header-alone", b"\0\0\0\x18ftypheic\0\0\0\0mif1heic".to_vec()),
        ("zeros", vec![0; 1 << 20]),
        ("ones", vec![0xff; 1 << 20]),
    ];
    for (name, bytes) in things {
        files.image(KIND, Refuse, &format!("{name}.jpg"), bytes.clone());
        files.depth(KIND, Refuse, &format!("{name}.npy"), bytes);
    }
    let magics: [(Role, &str, &[u8]); 15] = [
        (Role::Image, "magic.png", b"\x89PNG\r\n\x1a\n"),
        (Role::Image, "header.png", b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR"),
        (Role::Image, "magic.jpg", b"\xff\xd8\xff\xe0"),
        (Role::Image, "frame.jpg", b"\xff\xd8\xff\xc0"),
        (Role::Image, "magic.webp", b"RIFF\0\x10\0\0WEBPVP8L\0\x10\0\0"),
        (Role::Image, "lossy.webp", b"RIFF\0\x10\0\0WEBPVP8 \0\x10\0\0"),
        (Role::Image, "magic.tiff", b"II\x2a\0\x08\0\0\0"),
        (Role::Image, "big-endian.tiff", b"MM\0\x2a\0\0\0\x08"),
        (Role::Image, "magic.bmp", b"BM"),
        (Role::Image, "magic.gif", b"GIF89a"),
        (Role::Depth, "magic.png", b"\x89PNG\r\n\x1a\n"),
        (Role::Depth, "magic.tiff", b"II\x2a\0\x08\0\0\0"),
        (Role::Depth, "magic.exr", b"\x76\x2f\x31\x01\x02\0\0\0"),
        (Role::Depth, "magic.npy", b"\x93NUMPY\x01\0\x76\0"),
        (Role::Depth, "magic.pfm", b"Pf\n"),
    ];
    for (seed, (role, name, magic)) in (100..).zip(magics) {
        let noise = [magic, &Chance(seed).bytes(4096)].concat();
        files.add(KIND, role, Refuse, &format!("noise-behind-{name}"), noise);
    }
}
