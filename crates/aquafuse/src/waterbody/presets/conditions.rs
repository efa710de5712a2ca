//! Where a preset is looked at from, and with what camera.

use super::camera::Camera;

/// How a camera is balanced and exposed: what it shows of a white diffuser close by that faces it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum White {
    /// Balanced for daylight, exposed at depth: the brightest channel of the diffuser is at the white level. The
    /// default.
    ///
    /// So are images with a strobe, and about so are those of cameras that balance themselves: what water they
    /// show is blue or green. Balanced further, every water is nearly grey.
    #[default]
    Daylight,
    /// Balanced and exposed at depth: all channels of the diffuser are at the white level.
    AtDepth,
    /// Balanced and exposed for daylight just below the surface: going deeper, all gets darker.
    AtSurface,
}

/// Where and how a water is looked at: all that a colour needs beside the spectra of the water.
///
/// The camera looks level; it and all it sees are at one depth below the surface.
///
/// # Examples
///
/// ```
/// use aquafuse::waterbody::presets::{Conditions, White};
///
/// let shallow = Conditions::default().with_depth_below_surface(3.0)?.with_white(White::AtDepth);
/// assert_eq!(shallow.depth_below_surface_m(), 3.0);
/// assert!(Conditions::default().with_depth_below_surface(-3.0).is_err());
/// # Ok::<(), aquafuse::waterbody::presets::ConditionsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "StoredConditions")
)]
pub struct Conditions {
    depth_below_surface_m: f64,
    white: White,
    balance: f64,
    white_level: f64,
    range_m: f64,
    veil_factor: f64,
    camera: Camera,
}

/// As they are written to files.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredConditions {
    depth_below_surface_m: f64,
    white: White,
    /// Files of before have none.
    #[serde(default)]
    balance: f64,
    white_level: f64,
    range_m: f64,
    veil_factor: f64,
    camera: Camera,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredConditions> for Conditions {
    type Error = ConditionsError;

    fn try_from(stored: StoredConditions) -> Result<Self, ConditionsError> {
        let conditions = Self::default().with_camera(stored.camera).with_white(stored.white);
        conditions
            .with_depth_below_surface(stored.depth_below_surface_m)?
            .with_balance(stored.balance)?
            .with_white_level(stored.white_level)?
            .with_range(stored.range_m)?
            .with_veil_factor(stored.veil_factor)
    }
}

/// A condition outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what} is {found}, but must be from {least} to {most}")]
#[non_exhaustive]
pub struct ConditionsError {
    /// Which, and its unit.
    pub what: &'static str,
    /// What was given.
    pub found: f64,
    /// The least it may be.
    pub least: f64,
    /// The most it may be.
    pub most: f64,
}

pub(super) fn within(
    what: &'static str,
    found: f64,
    [least, most]: [f64; 2],
) -> Result<f64, ConditionsError> {
    // A NaN lies in no range.
    if (least..=most).contains(&found) {
        Ok(found)
    } else {
        Err(ConditionsError { what, found, least, most })
    }
}

impl Default for Conditions {
    /// A camera balanced for daylight 5 m down, distances to 20 m.
    fn default() -> Self {
        Self {
            depth_below_surface_m: 5.0,
            white: White::Daylight,
            balance: 0.0,
            // Exposed to the right as cameras do, a tenth left for what glitters.
            white_level: 0.9,
            range_m: 20.0,
            veil_factor: VEIL_FACTOR,
            camera: Camera::default(),
        }
    }
}

/// Radiance of open water seen level against a white diffuser facing the camera, in units of b_b/(a + b_b).
const VEIL_FACTOR: f64 = 4.5;
/// Where [`VEIL_FACTOR`] comes from.
pub(super) const VEIL_FACTOR_SOURCE: &str = "Tyler 1958, Lake Pend Oreille, 10.4 m: level radiance, the mean of all \
    directions, is 3.1 times the upward irradiance over π, which is .33 b_b/(a + b_b) E_d (Gordon et al. 1975); \
    an upright face gets .23 E_d, the mean of facing the sun, across and away from it";

impl Conditions {
    /// The same, `metres` below the surface, 0 to 100. Default: 5.
    ///
    /// # Errors
    ///
    /// [`ConditionsError`] when it is outside that range.
    pub fn with_depth_below_surface(self, metres: f64) -> Result<Self, ConditionsError> {
        let depth_below_surface_m = within("depth below the surface in metres", metres, [0.0, 100.0])?;
        Ok(Self { depth_below_surface_m, ..self })
    }

    /// The same with another white. Default: [`White::Daylight`].
    #[must_use]
    pub fn with_white(self, white: White) -> Self {
        Self { white, ..self }
    }

    /// The same with a camera that balances itself by this share, 0 to 1: 0 is [`White::Daylight`], 1 is [`White::AtDepth`]; the
    /// exposure follows the white. Default: 0. Only [`White::Daylight`] reads it.
    ///
    /// # Errors
    ///
    /// [`ConditionsError`] when it is outside that range.
    pub fn with_balance(self, share: f64) -> Result<Self, ConditionsError> {
        Ok(Self { balance: within("share of the white balance", share, [0.0, 1.0])?, ..self })
    }

    /// The same with white at the encoded value `level`, .1 to 1. Default: .9.
    ///
    /// # Errors
    ///
    /// [`ConditionsError`] when it is outside that range.
    pub fn with_white_level(self, level: f64) -> Result<Self, ConditionsError> {
        Ok(Self { white_level: within("the encoded value of white", level, [0.1, 1.0])?, ..self })
    }

    /// The same with curves fitted to distances up to `metres`, .5 to 100. Default: 20.
    ///
    /// Turbid water is fitted only as far as one can see.
    ///
    /// # Errors
    ///
    /// [`ConditionsError`] when it is outside that range.
    pub fn with_range(self, metres: f64) -> Result<Self, ConditionsError> {
        Ok(Self { range_m: within("range of distances in metres", metres, [0.5, 100.0])?, ..self })
    }

    /// The same with a brighter or darker open water, .1 to 5. Default: 4.5.
    ///
    /// Open water seen level has the radiance `factor · b_b/(a + b_b)` of a white diffuser facing the camera. Towards
    /// the sun's side it is brighter, with the sun behind darker; molecules send about half of that sideways.
    ///
    /// # Errors
    ///
    /// [`ConditionsError`] when it is outside that range.
    pub fn with_veil_factor(self, factor: f64) -> Result<Self, ConditionsError> {
        Ok(Self { veil_factor: within("veil factor", factor, [0.1, 5.0])?, ..self })
    }

    /// The same with another camera. Default: [`Camera::default`].
    #[must_use]
    pub fn with_camera(self, camera: Camera) -> Self {
        Self { camera, ..self }
    }

    /// Depth of camera and scene below the surface in metres.
    pub fn depth_below_surface_m(&self) -> f64 {
        self.depth_below_surface_m
    }

    /// How the camera is balanced and exposed.
    pub fn white(&self) -> White {
        self.white
    }

    /// How far the camera balances itself.
    pub fn balance(&self) -> f64 {
        self.balance
    }

    /// Encoded value of white.
    pub fn white_level(&self) -> f64 {
        self.white_level
    }

    /// The farthest distance curves are fitted to, in metres.
    pub fn range_m(&self) -> f64 {
        self.range_m
    }

    /// Radiance of open water seen level against white, in units of `b_b/(a + b_b)`.
    pub fn veil_factor(&self) -> f64 {
        self.veil_factor
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }
}
