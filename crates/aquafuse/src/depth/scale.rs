//! What a relative depth of 1 is in metres.

/// A scale between relative depth and metres: `metres = metres_at_one · z`.
///
/// Depth estimated from colour lies in `[0, 1]` and knows no unit; waters from tables are per metre. This names the
/// distance that relative depth 1 stands for, and [`Waterbody::per_relative`](crate::waterbody::Waterbody::per_relative)
/// takes a water there.
///
/// # Examples
///
/// ```
/// use aquafuse::depth::RelativeScale;
///
/// let scale = RelativeScale::default();
/// assert_eq!(scale.metres(0.5), 5.0);
/// assert_eq!(scale.relative(20.0), 2.0);
/// # Ok::<(), aquafuse::depth::ScaleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredScale"))]
pub struct RelativeScale {
    metres_at_one: f32,
}

/// As it is written to files.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredScale {
    metres_at_one: f32,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredScale> for RelativeScale {
    type Error = ScaleError;

    fn try_from(stored: StoredScale) -> Result<Self, ScaleError> {
        Self::new(stored.metres_at_one)
    }
}

/// Not a scale of depth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("relative depth 1 cannot be at {metres_at_one} m: give a distance from 0.01 to 1000 m")]
#[non_exhaustive]
pub struct ScaleError {
    /// The distance given.
    pub metres_at_one: f32,
}

impl Default for RelativeScale {
    /// 10 m: about as far as things stand out in the images people take under water.
    fn default() -> Self {
        Self { metres_at_one: 10.0 }
    }
}

impl RelativeScale {
    /// The scale on which relative depth 1 is at this distance, .01 to 1000 m.
    ///
    /// # Errors
    ///
    /// [`ScaleError`] when it is outside that range.
    pub fn new(metres_at_one: f32) -> Result<Self, ScaleError> {
        // A NaN lies in no range.
        if (0.01..=1000.0).contains(&metres_at_one) {
            Ok(Self { metres_at_one })
        } else {
            Err(ScaleError { metres_at_one })
        }
    }

    /// The distance in metres at which relative depth is 1.
    pub fn metres_at_one(self) -> f32 {
        self.metres_at_one
    }

    /// Metres of a relative depth.
    pub fn metres(self, relative: f32) -> f32 {
        self.metres_at_one * relative
    }

    /// Relative depth of metres.
    pub fn relative(self, metres: f32) -> f32 {
        metres / self.metres_at_one
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_needs_a_distance() {
        for wrong in [0.0, -10.0, f32::NAN, f32::INFINITY] {
            assert!(RelativeScale::new(wrong).is_err(), "{wrong} m");
        }
        assert_eq!(RelativeScale::new(10.0), Ok(RelativeScale::default()));
    }
}
