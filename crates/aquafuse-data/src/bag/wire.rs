//! The fields of a message as ROS writes them: CDR, in which numbers are aligned, and the packed form of ROS 1.

use std::ops::Range;

/// How a message is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wire {
    /// OMG's Common Data Representation, of ROS 2.
    Cdr,
    /// Of ROS 1: little-endian and packed.
    Ros1,
}

/// Reads one field after another; nothing where the message ends before it.
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Where places are counted from, if numbers are aligned.
    origin: Option<usize>,
    is_big: bool,
}

/// Bytes of the head of CDR: its kind, and options.
const HEAD: usize = 4;

impl<'a> Fields<'a> {
    /// The fields of a message; nothing where its kind of CDR is not plain.
    pub(super) fn new(bytes: &'a [u8], wire: Wire) -> Option<Self> {
        match wire {
            Wire::Ros1 => Some(Self { bytes, at: 0, origin: None, is_big: false }),
            Wire::Cdr => {
                // 0 and 1 are CDR, 6 and 7 its second version without options; of fields that are no wider than 4 bytes both are alike.
                let is_big = match bytes.first_chunk::<HEAD>()? {
                    [0, 0 | 6, ..] => true,
                    [0, 1 | 7, ..] => false,
                    _ => return None,
                };
                Some(Self { bytes, at: HEAD, origin: Some(HEAD), is_big })
            }
        }
    }

    /// Whether numbers begin with their largest digits.
    pub(super) fn is_big(&self) -> bool {
        self.is_big
    }

    fn take(&mut self, length: usize) -> Option<Range<usize>> {
        let end = self.at.checked_add(length)?;
        let range = self.at..end;
        self.bytes.get(range.clone())?;
        self.at = end;
        Some(range)
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        let range = self.take(1)?;
        self.bytes.get(range)?.first().copied()
    }

    pub(super) fn number(&mut self) -> Option<u32> {
        if let Some(origin) = self.origin {
            let past = self.at.checked_sub(origin)? % 4;
            self.take(4_usize.checked_sub(past)? % 4)?;
        }
        let range = self.take(4)?;
        let bytes: [u8; 4] = self.bytes.get(range)?.try_into().ok()?;
        Some(if self.is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// A text, without the zero that ends it in CDR.
    pub(super) fn text(&mut self) -> Option<&'a str> {
        let range = self.block()?;
        let text = std::str::from_utf8(self.bytes.get(range)?).ok()?;
        Some(text.trim_end_matches('\0'))
    }

    /// The place of bytes that their number precedes.
    pub(super) fn block(&mut self) -> Option<Range<usize>> {
        let length = self.number()?;
        self.take(usize::try_from(length).ok()?)
    }

    /// Passes over `std_msgs/Header`, time and frame; the time in nanoseconds.
    pub(super) fn header(&mut self) -> Option<i64> {
        if self.origin.is_none() {
            self.number()?;
        }
        // Seconds have a sign in ROS 2.
        let seconds = self.number()?.cast_signed();
        let nanoseconds = self.number()?;
        self.block()?;
        time(seconds.into(), nanoseconds.into())
    }
}

/// A time in nanoseconds.
pub(super) fn time(seconds: i64, nanoseconds: i64) -> Option<i64> {
    seconds.checked_mul(1_000_000_000)?.checked_add(nanoseconds)
}
