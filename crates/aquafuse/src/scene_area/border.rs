//! What to leave out at the sides of an image.

/// How the border of an image is obtained: `auto`, `none`, or four numbers of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// Found in each image.
    #[default]
    Auto,
    /// None: every pixel shows the scene.
    None,
    /// The same for every image.
    Given(Margins),
}

/// Rows and columns at the four sides of an image, in pixels of the stored image; written `T,R,B,L`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Margins {
    /// Rows at the top.
    pub top: usize,
    /// Columns at the right.
    pub right: usize,
    /// Rows at the bottom.
    pub bottom: usize,
    /// Columns at the left.
    pub left: usize,
}

/// A border is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BorderError {
    /// It leaves nothing of an image.
    #[error(
        "a border of {margins} (top,right,bottom,left) leaves nothing of an image of {}x{}; give a smaller one, or auto",
        .image.0, .image.1
    )]
    NothingLeft {
        /// The border.
        margins: Margins,
        /// Columns and rows of the image.
        image: (usize, usize),
    },
    /// Its text is neither a word nor four numbers.
    #[error("`{found}` is no border; give auto, none, or four numbers of pixels: TOP,RIGHT,BOTTOM,LEFT")]
    Text {
        /// What was given.
        found: String,
    },
}

impl Border {
    /// The border of an image that gives its water to others: numbers are those of the others, and here it is found.
    #[must_use]
    pub fn of_reference(self) -> Self {
        match self {
            Self::Given(_) => Self::Auto,
            other => other,
        }
    }
}

impl Margins {
    /// Columns and rows that are left of an image; `None` if there are none.
    pub(super) fn leave(&self, (width, height): (usize, usize)) -> Option<(usize, usize)> {
        let left =
            |all: usize, a: usize, b: usize| all.checked_sub(a)?.checked_sub(b).filter(|&left| left > 0);
        Some((left(width, self.left, self.right)?, left(height, self.top, self.bottom)?))
    }
}

impl std::fmt::Display for Margins {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{},{},{},{}", self.top, self.right, self.bottom, self.left)
    }
}

impl std::fmt::Display for Border {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Auto => f.pad("auto"),
            Self::None => f.pad("none"),
            Self::Given(margins) => margins.fmt(f),
        }
    }
}

impl std::str::FromStr for Border {
    type Err = BorderError;

    fn from_str(text: &str) -> Result<Self, BorderError> {
        let numbers: Option<Vec<usize>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        match (text, numbers.as_deref()) {
            ("auto", _) => Ok(Self::Auto),
            ("none", _) => Ok(Self::None),
            (_, Some(&[top, right, bottom, left])) => Ok(Self::Given(Margins { top, right, bottom, left })),
            _ => Err(BorderError::Text { found: text.to_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_border_is_read_as_it_is_written() {
        for text in ["auto", "none", "1,0,22,3"] {
            assert_eq!(text.parse::<Border>().unwrap().to_string(), text);
        }
        assert_eq!(" 1, 2,3,4 ".parse(), "1,2,3,4".parse::<Border>());
    }

    #[test]
    fn another_text_is_refused_with_what_to_give() {
        for text in ["", "Auto", "1,2,3", "1,2,3,4,5", "-1,0,0,0", "1,0,0,x", "99999999999999999999,0,0,0"] {
            let error = text.parse::<Border>().unwrap_err().to_string();
            assert!(error.contains("TOP,RIGHT,BOTTOM,LEFT"), "{error}");
        }
    }
}
