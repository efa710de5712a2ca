//! The exact image formation over the spectrum, which the coefficients of a channel approximate.

use super::conditions::{Conditions, White};
use super::tables::{DAYLIGHT, Spectra};
use crate::image::{Encoding, Linear};

/// Scattering of pure sea water at 400 nm, per metre, and the power of 400/λ it falls with.
pub(super) const SEA_WATER_SCATTERING: [f64; 2] = [0.005_83, 4.322];
pub(super) const SEA_WATER_SCATTERING_SOURCE: &str =
    "Haltrin 1999, Eq. 5, as rounded in Solonenko and Mobley 2015, Eq. 8";
/// Share of the scattering of particles that goes backwards.
pub(super) const PARTICLES_BACKWARDS: f64 = 0.0183;
pub(super) const PARTICLES_BACKWARDS_SOURCE: &str =
    "the mean of Petzold's particle phase functions, Mobley et al. 1993";
/// Molecules scatter as much backwards as forwards.
pub(super) const MOLECULES_BACKWARDS: f64 = 0.5;

/// One wavelength as one channel sees it.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// What the channel shows of a white diffuser in this light.
    light: f64,
    /// Radiance of open water, against that of a white diffuser in the same light.
    veil: f64,
    /// Beam attenuation c = a + b, per metre.
    beam: f64,
}

/// What one channel sees, by exact sums over the spectrum, in linear light.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    lines: Vec<Line>,
}

/// The three channels of a camera in a water.
pub(super) fn channels(spectra: Spectra, conditions: &Conditions) -> [Channel; 3] {
    let weighed: [Vec<(f64, Line)>; 3] = std::array::from_fn(|c| weigh(&spectra, conditions, c));
    // Each channel's signal of a white diffuser: in daylight, and in the light that is left below.
    let daylight = weighed.each_ref().map(|lines| lines.iter().map(|(surface, _)| surface).sum::<f64>());
    let below = weighed.each_ref().map(|lines| lines.iter().map(|(_, line)| line.light).sum::<f64>());
    let left = |c: usize| below[c] / daylight[c];
    let white = match conditions.white() {
        White::Daylight => {
            let (brightest, balance) = (left(0).max(left(1)).max(left(2)), conditions.balance());
            // Without balance to the bit: a power of 0 is 1.
            std::array::from_fn(|c| daylight[c] * brightest.powf(1.0 - balance) * left(c).powf(balance))
        }
        White::AtDepth => below,
        White::AtSurface => daylight,
    };
    let level = f64::from(Linear::from_encoded(conditions.white_level() as f32));
    std::array::from_fn(|c| {
        let exposure = level / white[c];
        let expose = |&(_, line): &(f64, Line)| Line { light: exposure * line.light, ..line };
        Channel { lines: weighed[c].iter().map(expose).collect() }
    })
}

/// All wavelengths as one channel sees them before exposure, and the light at the surface beside each.
fn weigh(spectra: &Spectra, conditions: &Conditions, channel: usize) -> Vec<(f64, Line)> {
    let depth = conditions.depth_below_surface_m();
    let last = DAYLIGHT.values.len() - 1;
    let sample = |(i, wavelength): (usize, f64)| {
        // The first and last count half: the trapezium rule.
        let end = if i == 0 || i == last { 0.5 } else { 1.0 };
        let surface = end * DAYLIGHT.values[i] * conditions.camera().response(channel, wavelength);
        let light = surface * (-spectra.downwelling.at(wavelength) * depth).exp();
        let absorption = spectra.optics.absorption.at(wavelength);
        let scattering = spectra.optics.scattering.at(wavelength);
        let backwards = backscattering(scattering, wavelength);
        let veil = conditions.veil_factor() * backwards / (absorption + backwards);
        (surface, Line { light, veil, beam: absorption + scattering })
    };
    DAYLIGHT.wavelengths().enumerate().map(sample).collect()
}

impl Channel {
    /// B∞: what is seen of open water.
    pub(super) fn veil(&self) -> f64 {
        self.sum(|line| line.veil)
    }

    /// B(z): what is seen of the water before a black thing at distance z.
    pub(super) fn backscatter(&self, z: f64) -> f64 {
        self.sum(|line| -line.veil * (-line.beam * z).exp_m1())
    }

    /// What is seen of a thing of this reflectance at distance z, without backscatter.
    pub(super) fn direct(&self, reflectance: f64, z: f64) -> f64 {
        reflectance * self.sum(|line| (-line.beam * z).exp())
    }

    /// The least beam attenuation of the lines, per metre: how far this water lets anyone see.
    pub(super) fn clearest(&self) -> f64 {
        self.lines.iter().map(|line| line.beam).fold(f64::INFINITY, f64::min)
    }

    fn sum(&self, of: impl Fn(&Line) -> f64) -> f64 {
        self.lines.iter().map(|line| line.light * of(line)).sum::<f64>()
    }
}

/// b_b: molecules scatter half backwards, particles little. No table scatters less than sea water alone.
fn backscattering(scattering: f64, wavelength: f64) -> f64 {
    let [at_400, power] = SEA_WATER_SCATTERING;
    let molecules = at_400 * (400.0 / wavelength).powf(power);
    MOLECULES_BACKWARDS * molecules + PARTICLES_BACKWARDS * (scattering - molecules)
}
