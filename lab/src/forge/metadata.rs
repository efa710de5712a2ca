//! EXIF blocks and colour profiles that loop, point nowhere or promise too much. The image beside them is good, so
//! a reader may take it without them or refuse it; it may not panic, hang or fill memory.

use anyhow::Result;

use super::list::Files;
use super::list::Right::{Accept, Any};
use super::png_bytes;
use super::seeds;
use crate::chance::Chance;

const KIND: &str = "metadata";

pub(crate) fn add(files: &mut Files) -> Result<()> {
    let jpeg = seeds::image("jpg")?;
    let with = |segments: &[Vec<u8>]| [&jpeg[..2], &segments.concat(), &jpeg[2..]].concat();
    let app = |marker: u8, body: &[u8]| {
        [&[0xff, marker][..], &(body.len() as u16 + 2).to_be_bytes(), body].concat()
    };
    for (name, exif) in exif_blocks() {
        let segment = app(0xe1, &[b"Exif\0\0", &exif[..]].concat());
        files.image(KIND, Any, &format!("exif-{name}.jpg"), with(&[segment]));
        let chunk = png_bytes::chunk(b"eXIf", &exif);
        files.image(KIND, Any, &format!("exif-{name}.png"), png_bytes::with(&[chunk]));
    }
    for orientation in 1..=8 {
        let segment = app(0xe1, &[b"Exif\0\0", &directory(&[orientation_tag(orientation)], 0)[..]].concat());
        files.image("unusual but valid", Accept, &format!("orientation-{orientation}.jpg"), with(&[segment]));
    }
    let mut profile = |name: &str, chunks: &[[u8; 2]]| {
        let chunk = |numbers: &[u8; 2]| app(0xe2, &[b"ICC_PROFILE\0", &numbers[..], &[7; 50]].concat());
        let segments: Vec<_> = chunks.iter().map(chunk).collect();
        files.image(KIND, Any, &format!("profile-{name}.jpg"), with(&segments));
    };
    profile("of-noise", &[[1, 1]]);
    profile("part-5-of-2", &[[5, 2]]);
    profile("part-0-of-0", &[[0, 0]]);
    profile("part-missing", &[[1, 3], [3, 3]]);
    profile("parts-twice", &[[1, 2], [1, 2], [2, 2]]);
    profile("of-255-parts-of-one-number", &[[1, 255]; 255]);
    let noise = app(0xe1, &[b"http://ns.adobe.com/xap/1.0/\0", &Chance(9).bytes(4000)[..]].concat());
    files.image(KIND, Any, "xmp-of-noise.jpg", with(&[noise]));
    files.image(KIND, Any, "short-jfif.jpg", with(&[app(0xe0, b"JFI")]));
    files.image(KIND, Any, "short-adobe.jpg", with(&[app(0xee, b"Adobe")]));
    Ok(())
}

/// A TIFF entry: tag, type, count, value.
type Tag = (u16, u16, u32, u32);

/// A little-endian TIFF of one directory and where the next one is.
fn directory(tags: &[Tag], next: u32) -> Vec<u8> {
    let mut bytes = b"II\x2a\0\x08\0\0\0".to_vec();
    bytes.extend((tags.len() as u16).to_le_bytes());
    for (tag, kind, count, value) in tags {
        bytes.extend(tag.to_le_bytes().into_iter().chain(kind.to_le_bytes()));
        bytes.extend(count.to_le_bytes().into_iter().chain(value.to_le_bytes()));
    }
    bytes.extend(next.to_le_bytes());
    bytes
}

fn orientation_tag(orientation: u32) -> Tag {
    (0x0112, 3, 1, orientation)
}

fn exif_blocks() -> Vec<(&'static str, Vec<u8>)> {
    const SUB: u16 = 0x8769;
    let one = |tag: Tag| directory(&[tag], 0);
    let mut full = directory(&[orientation_tag(6)], 0);
    full[8..10].copy_from_slice(&[0xff; 2]);
    vec![
        ("of-nothing", Vec::new()),
        ("of-noise", Chance(4).bytes(500)),
        ("of-a-header-alone", b"II\x2a\0".to_vec()),
        ("directory-out-of-range", b"II\x2a\0\xff\xff\xff\xff".to_vec()),
        ("directory-inside-the-header", b"MM\0\x2a\0\0\0\0".to_vec()),
        ("loops", directory(&[orientation_tag(6)], 8)),
        ("sub-directory-is-itself", one((SUB, 4, 1, 8))),
        ("sub-directory-out-of-range", one((SUB, 4, 1, u32::MAX))),
        ("65535-entries", full),
        ("orientation-0", one(orientation_tag(0))),
        ("orientation-9", one(orientation_tag(9))),
        ("orientation-65535", one(orientation_tag(65_535))),
        ("orientation-as-4294967295-values", one((0x0112, 3, u32::MAX, 8))),
        ("orientation-of-an-unknown-type", one((0x0112, 99, 1, 6))),
        ("orientation-elsewhere", one((0x0112, 5, 1, u32::MAX - 3))),
        ("text-of-4-gigabytes", one((0x010e, 2, u32::MAX, 8))),
        ("thumbnail-out-of-range", directory(&[(0x0201, 4, 1, u32::MAX), (0x0202, 4, 1, u32::MAX)], 0)),
    ]
}
