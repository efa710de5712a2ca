//! Messages of robots' logs, behind a byte that says their kind, as the fuzz target reads them.

use std::io::Cursor;
use std::path::Path;

use anyhow::Result;
use image::{ImageBuffer, ImageFormat, Luma, Rgb};

use super::add;

const SIZE: [u32; 2] = [6, 4];

/// Fields as ROS writes them: aligned in CDR, packed in ROS 1.
struct Fields(Vec<u8>, bool);

impl Fields {
    fn header(is_cdr: bool) -> Self {
        let mut fields = Self(if is_cdr { vec![0, 1, 0, 0] } else { vec![7, 0, 0, 0] }, is_cdr);
        fields.number(1_700_000_000);
        fields.number(5);
        fields.text("cam");
        fields
    }

    fn number(&mut self, number: u32) {
        let length = if self.1 { self.0.len().next_multiple_of(4) } else { self.0.len() };
        self.0.resize(length, 0);
        self.0.extend(number.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        let zero = usize::from(self.1);
        self.number((text.len() + zero) as u32);
        self.0.extend(text.bytes());
        self.0.resize(self.0.len() + zero, 0);
    }

    fn block(mut self, kind: u8, data: &[u8]) -> Vec<u8> {
        self.number(data.len() as u32);
        [&[kind], &self.0[..], data].concat()
    }
}

fn raw(kind: u8, encoding: &str, bytes: u32) -> Vec<u8> {
    let [width, height] = SIZE;
    let mut fields = Fields::header(kind == 0);
    fields.number(height);
    fields.number(width);
    fields.text(encoding);
    fields.0.push(0);
    fields.number(width * bytes + 2);
    let data: Vec<u8> = (0..height * (width * bytes + 2)).map(|at| (at * 37 % 251) as u8).collect();
    fields.block(kind, &data)
}

fn packed(kind: u8, format: &str, file: &[u8]) -> Vec<u8> {
    let mut fields = Fields::header(kind == 2);
    fields.text(format);
    fields.block(kind, file)
}

pub(super) fn add_all(corpus: &Path) -> Result<()> {
    let [width, height] = SIZE;
    let colour = ImageBuffer::from_fn(width, height, |x, y| Rgb([40 * x as u8, 60 * y as u8, 90]));
    let depth = ImageBuffer::from_fn(width, height, |x, y| Luma([500 * (x + y) as u16]));
    let [mut png, mut millimetres] = [Vec::new(), vec![0; 12]];
    colour.write_to(&mut Cursor::new(&mut png), ImageFormat::Png)?;
    let mut map = Vec::new();
    depth.write_to(&mut Cursor::new(&mut map), ImageFormat::Png)?;
    millimetres.extend(map);
    // Time, frame, data and format, each behind its tag and length.
    let mut foxglove = vec![4, 0x0a, 4, 0x08, 3, 0x10, 5, 0x22, 3, b'c', b'a', b'm', 0x12];
    foxglove.extend([(png.len() & 127) as u8 | 128, (png.len() >> 7) as u8]);
    foxglove.extend(&png);
    foxglove.extend([0x1a, 3, b'p', b'n', b'g']);
    for (name, bytes) in [
        ("rgb8.cdr", raw(0, "rgb8", 3)),
        ("bgra8.ros1", raw(1, "bgra8", 4)),
        ("16UC1.cdr", raw(0, "16UC1", 2)),
        ("32FC1.cdr", raw(0, "32FC1", 4)),
        ("png.cdr", packed(2, "png", &png)),
        ("png.ros1", packed(3, "png", &png)),
        ("depth.cdr", packed(2, "16UC1; compressedDepth png", &millimetres)),
        ("png.foxglove", foxglove),
    ] {
        add(corpus, "bag-message", name, &bytes)?;
    }
    Ok(())
}
