//! How a camera's channels answer to light of each wavelength.

use super::conditions::{ConditionsError, within};

/// A camera whose three channels answer as Gaussian curves over wavelength.
///
/// Only the shape counts: the white sets the scale of each channel.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredCamera"))]
pub struct Camera {
    name: String,
    source: String,
    peaks_nm: [f64; 3],
    deviations_nm: [f64; 3],
}

/// As it is written to files.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredCamera {
    name: String,
    source: String,
    peaks_nm: [f64; 3],
    deviations_nm: [f64; 3],
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCamera> for Camera {
    type Error = ConditionsError;

    fn try_from(stored: StoredCamera) -> Result<Self, ConditionsError> {
        Self::new(stored.name, stored.source, stored.peaks_nm, stored.deviations_nm)
    }
}

impl Camera {
    /// A camera with the peaks of red, green and blue (380 to 720 nm) and their standard deviations
    /// (5 to 100 nm); `source` says where they come from.
    ///
    /// # Errors
    ///
    /// [`ConditionsError`] when one is outside its range.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::waterbody::presets::{Camera, Conditions, Preset};
    ///
    /// let narrow = Camera::new("narrow", "an example", [620.0, 530.0, 460.0], [15.0; 3])?;
    /// let conditions = Conditions::default().with_camera(narrow);
    /// // Water takes more of the light at 620 nm than at the usual 600.
    /// let red = |conditions: &Conditions| Preset::I.water::<aquafuse::image::Linear>(conditions).illumination(5.0)[0];
    /// assert!(red(&conditions) < red(&Conditions::default()));
    /// # Ok::<(), aquafuse::waterbody::presets::ConditionsError>(())
    /// ```
    pub fn new(
        name: impl Into<String>,
        source: impl Into<String>,
        peaks_nm: [f64; 3],
        deviations_nm: [f64; 3],
    ) -> Result<Self, ConditionsError> {
        for peak in peaks_nm {
            within("peak of a channel in nm", peak, [380.0, 720.0])?;
        }
        for deviation in deviations_nm {
            within("standard deviation of a channel in nm", deviation, [5.0, 100.0])?;
        }
        Ok(Self { name: name.into(), source: source.into(), peaks_nm, deviations_nm })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where its curves come from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The peaks of red, green and blue, in nanometres.
    pub fn peaks_nm(&self) -> [f64; 3] {
        self.peaks_nm
    }

    /// The standard deviations of red, green and blue, in nanometres.
    pub fn deviations_nm(&self) -> [f64; 3] {
        self.deviations_nm
    }

    /// Response of one channel at a wavelength in nanometres, 1 at its peak.
    pub(super) fn response(&self, channel: usize, wavelength: f64) -> f64 {
        let off = (wavelength - self.peaks_nm[channel]) / self.deviations_nm[channel];
        (-0.5 * off * off).exp()
    }
}

impl Default for Camera {
    /// Three Gaussians like the mean of common cameras: 600, 530 and 460 nm, deviations 30, 38 and 30 nm.
    ///
    /// Measured curves differ from camera to camera by more than these differ from their mean.
    fn default() -> Self {
        Self {
            name: "three Gaussians".into(),
            source: "ours: peaks and widths rounded, after the 28 cameras of Jiang et al. 2013".into(),
            peaks_nm: [600.0, 530.0, 460.0],
            deviations_nm: [30.0, 38.0, 30.0],
        }
    }
}
