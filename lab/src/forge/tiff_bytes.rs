//! TIFF by hand: one directory in front, values that fit into their entries, pixels behind (TIFF 6.0).

use super::seeds::{HEIGHT, WIDTH, little_endian, metres, pixel};

pub(crate) const SHORT: u16 = 3;
pub(crate) const LONG: u16 = 4;

pub(crate) const IMAGE_WIDTH: u16 = 256;
pub(crate) const IMAGE_LENGTH: u16 = 257;
pub(crate) const BITS: u16 = 258;
pub(crate) const COMPRESSION: u16 = 259;
pub(crate) const PHOTOMETRIC: u16 = 262;
pub(crate) const OFFSETS: u16 = 273;
pub(crate) const SAMPLES: u16 = 277;
pub(crate) const ROWS: u16 = 278;
pub(crate) const BYTE_COUNTS: u16 = 279;
pub(crate) const SAMPLE_FORMAT: u16 = 339;

/// A file to be.
#[derive(Clone)]
pub(crate) struct Tiff {
    /// Tag, type, count, value; sorted by tag when written.
    entries: Vec<(u16, u16, u32, u32)>,
    data: Vec<u8>,
    big_endian: bool,
    /// Where the next directory is.
    next: u32,
}

impl Tiff {
    fn new(bits: u32, format: u32, data: Vec<u8>) -> Self {
        let length = data.len() as u32;
        let tiff = Self { entries: Vec::new(), data, big_endian: false, next: 0 };
        [
            (IMAGE_WIDTH, WIDTH),
            (IMAGE_LENGTH, HEIGHT),
            (BITS, bits),
            (COMPRESSION, 1),
            (PHOTOMETRIC, 1),
            (SAMPLES, 1),
            (ROWS, HEIGHT),
            (BYTE_COUNTS, length),
            (SAMPLE_FORMAT, format),
        ]
        .into_iter()
        .fold(tiff, |tiff, (tag, value)| tiff.with(tag, value))
    }

    /// The seed in grey.
    pub(crate) fn grey() -> Self {
        let green = |y| (0..WIDTH).map(move |x| pixel(x, y)[1] + (x % 3) as u8);
        Self::new(8, 1, (0..HEIGHT).flat_map(green).collect())
    }

    /// The seed's depth.
    pub(crate) fn depth() -> Self {
        Self::new(32, 3, little_endian(&metres()))
    }

    /// With one value of a tag, be it new or not.
    pub(crate) fn with(self, tag: u16, value: u32) -> Self {
        let kind = if matches!(tag, OFFSETS | BYTE_COUNTS | ROWS | IMAGE_WIDTH | IMAGE_LENGTH) {
            LONG
        } else {
            SHORT
        };
        self.entry((tag, kind, 1, value))
    }

    /// With a whole entry.
    pub(crate) fn entry(self, entry: (u16, u16, u32, u32)) -> Self {
        let mut tiff = self.without(entry.0);
        tiff.entries.push(entry);
        tiff
    }

    pub(crate) fn without(mut self, tag: u16) -> Self {
        self.entries.retain(|entry| entry.0 != tag);
        self
    }

    pub(crate) fn next(mut self, next: u32) -> Self {
        self.next = next;
        self
    }

    pub(crate) fn data(mut self, data: Vec<u8>) -> Self {
        self.data = data;
        self
    }

    pub(crate) fn big_endian(mut self) -> Self {
        self.big_endian = true;
        self
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut tiff = self.clone();
        // The pixels' place, unless a test has its own.
        let has_place = tiff.entries.iter().any(|entry| entry.0 == OFFSETS || entry.0 == 324);
        let after = 8 + 2 + 12 * (tiff.entries.len() + usize::from(!has_place)) + 4;
        if !has_place {
            tiff = tiff.with(OFFSETS, after as u32);
        }
        tiff.entries.sort_unstable();
        let short = |value: u16| if self.big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
        let long = |value: u32| if self.big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
        let start = if self.big_endian { b"MM" } else { b"II" };
        let mut bytes = [&start[..], &short(42), &long(8), &short(tiff.entries.len() as u16)].concat();
        for &(tag, kind, count, value) in &tiff.entries {
            bytes.extend([short(tag), short(kind)].concat());
            bytes.extend(long(count));
            // A short stands at the left of its four bytes, whatever the order.
            let value = if kind == SHORT && count == 1 {
                [short(value as u16), [0; 2]].concat()
            } else {
                long(value).into()
            };
            bytes.extend(value);
        }
        bytes.extend(long(self.next));
        bytes.extend_from_slice(&self.data);
        bytes
    }
}
