//! All that a preset rests on, as data: every number with its unit and its source.

use super::conditions::{Conditions, VEIL_FACTOR_SOURCE};
use super::tables::{self, Curve};
use super::{Preset, fit, spectral};

/// A spectrum as published.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Spectrum {
    /// What it is, with its symbol.
    pub quantity: &'static str,
    /// Unit of the values.
    pub unit: &'static str,
    /// Publication and table.
    pub source: &'static str,
    /// Wavelengths in nanometres; between them values are interpolated linearly.
    pub wavelengths_nm: Vec<f64>,
    /// Values at the wavelengths.
    pub values: &'static [f64],
}

/// A number that holds for every preset.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Constant {
    /// What it is.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// Unit of the value; 1 for a ratio.
    pub unit: &'static str,
    /// Where it comes from.
    pub source: &'static str,
}

/// All that a preset's colour and coefficients rest on.
///
/// # Examples
///
/// ```
/// use aquafuse::waterbody::presets::{Conditions, Preset};
///
/// let assumed = Preset::Coastal1C.assumptions(&Conditions::default());
/// let absorption = &assumed.spectra[0];
/// assert_eq!((absorption.quantity, absorption.unit), ("absorption a", "1/m"));
/// assert!(absorption.source.contains("Williamson and Hollins 2022"));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Assumptions {
    /// Name of the preset.
    pub preset: &'static str,
    /// The spectra of the water and of daylight.
    pub spectra: [Spectrum; 4],
    /// Numbers the formulas of [`presets`](super) need beside.
    pub constants: [Constant; 5],
    /// What the veil factor of the conditions is by default.
    pub veil_factor_source: &'static str,
    /// Where and how the water is looked at.
    pub conditions: Conditions,
}

pub(super) fn of(preset: Preset, conditions: &Conditions) -> Assumptions {
    let spectra = preset.spectra();
    let spectrum = |quantity, unit, curve: &Curve| Spectrum {
        quantity,
        unit,
        source: curve.source,
        wavelengths_nm: curve.wavelengths().collect(),
        values: curve.values,
    };
    let constant = |quantity, value, unit, source| Constant { quantity, value, unit, source };
    let [at_400, power] = spectral::SEA_WATER_SCATTERING;
    Assumptions {
        preset: preset.name(),
        spectra: [
            spectrum("absorption a", "1/m", &spectra.optics.absorption),
            spectrum("scattering b", "1/m", &spectra.optics.scattering),
            spectrum("diffuse attenuation K_d", "1/m", spectra.downwelling),
            spectrum("daylight at the surface", "relative power", &tables::DAYLIGHT),
        ],
        constants: [
            constant(
                "scattering of pure sea water at 400 nm",
                at_400,
                "1/m",
                spectral::SEA_WATER_SCATTERING_SOURCE,
            ),
            constant("its power of 400 nm/λ", power, "1", spectral::SEA_WATER_SCATTERING_SOURCE),
            constant(
                "share of it that goes backwards",
                spectral::MOLECULES_BACKWARDS,
                "1",
                "molecules scatter alike forwards and backwards",
            ),
            constant(
                "share of particles' scattering that goes backwards",
                spectral::PARTICLES_BACKWARDS,
                "1",
                spectral::PARTICLES_BACKWARDS_SOURCE,
            ),
            constant(
                "reflectance of the grey β_D is fitted to",
                fit::GREY,
                "1",
                "ours: a photographer's grey card",
            ),
        ],
        veil_factor_source: VEIL_FACTOR_SOURCE,
        conditions: conditions.clone(),
    }
}
