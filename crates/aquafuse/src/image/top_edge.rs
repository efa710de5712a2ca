//! Which stored edge of an image is up.

/// The stored edge of an image that is up as seen.
///
/// Pixels stay in stored order, so for a camera held on its side "the top corners" are not the first
/// rows. The EXIF orientation tag says which edge it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TopEdge {
    /// Row 0 is up: orientation 1 and 2, or none given.
    #[default]
    First,
    /// The last row is up: orientation 3 and 4.
    Last,
    /// Column 0 is up: orientation 5 and 6.
    Left,
    /// The last column is up: orientation 7 and 8.
    Right,
}

impl TopEdge {
    /// The edge that an EXIF orientation tag (1 to 8) puts on top; unknown values count as 1.
    pub fn from_exif(orientation: u8) -> Self {
        match orientation {
            3 | 4 => Self::Last,
            5 | 6 => Self::Left,
            7 | 8 => Self::Right,
            _ => Self::First,
        }
    }

    /// The edge across the image.
    pub(crate) fn opposite(self) -> Self {
        match self {
            Self::First => Self::Last,
            Self::Last => Self::First,
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}
