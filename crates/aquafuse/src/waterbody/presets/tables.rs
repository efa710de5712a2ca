//! Published spectra, as numbers printed in the units printed: one file a publication.

mod jerlov;
mod solonenko;
#[allow(clippy::approx_constant, reason = "a measured .318 is not 1/π")]
mod williamson;

/// A spectrum given in even steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    /// The first wavelength, nm.
    pub(super) from: f64,
    /// From one value to the next, nm.
    pub(super) step: f64,
    /// The values, at least two.
    pub(super) values: &'static [f64],
    /// Publication and table.
    pub(super) source: &'static str,
}

impl Curve {
    /// The value at a wavelength, linear between the tabled ones and held beyond them.
    pub(super) fn at(&self, wavelength: f64) -> f64 {
        let last = self.values.len() - 1;
        let place = ((wavelength - self.from) / self.step).clamp(0.0, last as f64);
        let left = (place as usize).min(last - 1);
        self.values[left] + (place - left as f64) * (self.values[left + 1] - self.values[left])
    }

    /// The wavelengths of the values, nm.
    pub(super) fn wavelengths(&self) -> impl Iterator<Item = f64> + use<> {
        let Self { from, step, .. } = *self;
        (0..self.values.len()).map(move |i| from + step * i as f64)
    }
}

/// The inherent optical properties of a water.
#[derive(Clone, Copy, Debug)]
pub(super) struct Optics {
    /// Absorption a, per metre.
    pub(super) absorption: Curve,
    /// Scattering b, per metre.
    pub(super) scattering: Curve,
}

/// All that is tabled of a type of water.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spectra {
    /// a and b.
    pub(super) optics: &'static Optics,
    /// Diffuse attenuation K_d of the light from above, per metre.
    pub(super) downwelling: &'static Curve,
}

/// The spectra of the type at this place in `Preset`: I, IA, IB, II, III, 1C, 3C, 5C, 7C, 9C.
///
/// a and b are those that were measured, where there are any; the others were found from K_d. That way each type is
/// murkier than the one before, too: were all found from K_d, III would scatter more than twice as much as 1C.
pub(super) fn of(place: usize) -> Spectra {
    Spectra { optics: OPTICS[place], downwelling: &jerlov::DOWNWELLING[place] }
}

static OPTICS: [&Optics; 10] = [
    &solonenko::I,
    &solonenko::IA,
    &williamson::IB,
    &williamson::II,
    &williamson::III,
    &williamson::COASTAL_1C,
    &williamson::COASTAL_3C,
    &williamson::COASTAL_5C,
    &solonenko::COASTAL_7C,
    &solonenko::COASTAL_9C,
];

/// Daylight at the surface: relative power, 100 at 560 nm.
#[rustfmt::skip]
pub(super) static DAYLIGHT: Curve = Curve {
    from: 400.0,
    step: 10.0,
    values: &[
        82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923, 108.811, 109.354,
        107.802, 104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856, 90.0062, 89.5991, 87.6987,
        83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091,
    ],
    source: "CIE standard illuminant D65, ISO/CIE 11664-2",
};
