//! Published spectra of the Jerlov water types, and daylight: numbers as printed, in the units printed.

/// Wavelengths of the tables of water in nanometres.
pub(super) static WAVELENGTHS: [f64; 13] =
    [400.0, 425.0, 450.0, 475.0, 500.0, 525.0, 550.0, 575.0, 600.0, 625.0, 650.0, 675.0, 700.0];

/// One type of water, at [`WAVELENGTHS`].
pub(super) struct Spectra {
    /// Absorption a, per metre.
    pub(super) absorption: [f64; 13],
    /// Scattering b, per metre.
    pub(super) scattering: [f64; 13],
    /// Diffuse attenuation of downwelling light K_d, per metre.
    pub(super) downwelling: [f64; 13],
}

pub(super) const ABSORPTION_SOURCE: &str = "Solonenko and Mobley 2015, Tables 4 to 8; \
    3C at 675 and 700 nm and 5C from 600 nm, where the paper repeats other rows: Williamson and Hollins 2022";
pub(super) const SCATTERING_SOURCE: &str = "Solonenko and Mobley 2015, Tables 4 to 8; \
    3C at 675 and 700 nm and 5C from 600 nm, where the paper repeats other rows: its own Eq. 8";
pub(super) const DOWNWELLING_SOURCE: &str = "Jerlov 1976, Table XXVII";
pub(super) const DAYLIGHT_SOURCE: &str = "CIE standard illuminant D65, relative to 100 at 560 nm";

/// The types in the order of `Preset`: I, IA, IB, II, III, 1C, 3C, 5C, 7C, 9C.
///
/// a and b: Solonenko and Mobley 2015, found by them from the K_d of an earlier edition of Jerlov.
/// K_d: Jerlov 1976. His is measured, without gaps, and so preferred to the K_d they modelled.
#[rustfmt::skip]
pub(super) static SPECTRA: [Spectra; 10] = [
    Spectra {
        absorption:  [0.022, 0.017, 0.018, 0.019, 0.026, 0.046, 0.062, 0.082, 0.228, 0.295, 0.334, 0.434, 0.582],
        scattering:  [0.0062, 0.00482, 0.00381, 0.00306, 0.00249, 0.00205, 0.0017, 0.00143, 0.00122, 0.00104, 0.000899, 0.000782, 0.000685],
        downwelling: [0.028, 0.022, 0.019, 0.018, 0.027, 0.043, 0.063, 0.089, 0.235, 0.305, 0.36, 0.42, 0.56],
    },
    Spectra {
        absorption:  [0.0295, 0.0225, 0.0221, 0.0216, 0.0282, 0.0468, 0.0622, 0.0821, 0.228, 0.295, 0.334, 0.435, 0.582],
        scattering:  [0.0092, 0.00755, 0.00631, 0.00536, 0.00461, 0.00402, 0.00354, 0.00315, 0.00283, 0.00256, 0.00234, 0.00214, 0.00198],
        downwelling: [0.038, 0.031, 0.026, 0.025, 0.032, 0.048, 0.067, 0.094, 0.24, 0.31, 0.37, 0.43, 0.57],
    },
    Spectra {
        absorption:  [0.0331, 0.0246, 0.0235, 0.0225, 0.0287, 0.0469, 0.0623, 0.0822, 0.2278, 0.296, 0.334, 0.435, 0.582],
        scattering:  [0.0795, 0.0732, 0.068, 0.0635, 0.0597, 0.0565, 0.0536, 0.0511, 0.0488, 0.0468, 0.045, 0.0434, 0.042],
        downwelling: [0.051, 0.042, 0.036, 0.033, 0.042, 0.054, 0.072, 0.099, 0.245, 0.315, 0.375, 0.435, 0.58],
    },
    Spectra {
        absorption:  [0.0355, 0.0257, 0.0241, 0.0228, 0.0288, 0.0469, 0.0622, 0.0821, 0.228, 0.296, 0.334, 0.436, 0.582],
        scattering:  [0.616, 0.555, 0.504, 0.459, 0.421, 0.387, 0.358, 0.332, 0.309, 0.288, 0.27, 0.253, 0.238],
        downwelling: [0.096, 0.081, 0.068, 0.062, 0.07, 0.076, 0.089, 0.115, 0.26, 0.335, 0.4, 0.465, 0.61],
    },
    Spectra {
        absorption:  [0.0615, 0.0449, 0.0388, 0.0335, 0.0358, 0.0507, 0.0646, 0.0838, 0.229, 0.297, 0.336, 0.439, 0.583],
        scattering:  [1.69, 1.52, 1.38, 1.26, 1.152, 1.06, 0.98, 0.908, 0.845, 0.788, 0.737, 0.692, 0.65],
        downwelling: [0.185, 0.16, 0.135, 0.116, 0.115, 0.116, 0.12, 0.148, 0.295, 0.375, 0.445, 0.52, 0.66],
    },
    Spectra {
        absorption:  [0.227, 0.147, 0.105, 0.077, 0.064, 0.068, 0.076, 0.092, 0.236, 0.304, 0.344, 0.455, 0.586],
        scattering:  [0.63, 0.567, 0.514, 0.469, 0.429, 0.395, 0.365, 0.338, 0.314, 0.293, 0.274, 0.257, 0.242],
        downwelling: [0.51, 0.36, 0.25, 0.17, 0.14, 0.13, 0.12, 0.15, 0.3, 0.37, 0.45, 0.51, 0.65],
    },
    Spectra {
        absorption:  [0.388, 0.236, 0.154, 0.105, 0.081, 0.078, 0.082, 0.095, 0.239, 0.307, 0.346, 0.477, 0.592],
        scattering:  [1.83, 1.65, 1.5, 1.36, 1.25, 1.15, 1.06, 0.985, 0.916, 0.855, 0.8, 0.754, 0.709],
        downwelling: [0.78, 0.54, 0.39, 0.29, 0.22, 0.2, 0.19, 0.21, 0.33, 0.4, 0.46, 0.56, 0.71],
    },
    Spectra {
        absorption:  [0.66, 0.437, 0.297, 0.204, 0.151, 0.127, 0.117, 0.119, 0.259, 0.327, 0.367, 0.499, 0.598],
        scattering:  [2.28, 2.06, 1.87, 1.71, 1.56, 1.44, 1.33, 1.23, 1.147, 1.070, 1.001, 0.940, 0.883],
        downwelling: [1.1, 0.78, 0.56, 0.43, 0.36, 0.31, 0.3, 0.33, 0.4, 0.48, 0.54, 0.65, 0.8],
    },
    Spectra {
        absorption:  [1.03, 0.753, 0.542, 0.388, 0.29, 0.233, 0.195, 0.175, 0.301, 0.367, 0.403, 0.559, 0.621],
        scattering:  [4.02, 3.63, 3.3, 3.01, 2.76, 2.54, 2.35, 2.18, 2.03, 1.89, 1.77, 1.66, 1.56],
        downwelling: [1.6, 1.2, 0.89, 0.71, 0.58, 0.49, 0.46, 0.46, 0.48, 0.54, 0.63, 0.78, 0.92],
    },
    Spectra {
        absorption:  [1.613, 1.242, 0.943, 0.709, 0.543, 0.43, 0.348, 0.291, 0.39, 0.436, 0.456, 0.604, 0.651],
        scattering:  [5.36, 4.84, 4.39, 4.01, 3.67, 3.38, 3.12, 2.89, 2.69, 2.51, 2.35, 2.2, 2.07],
        downwelling: [2.4, 1.9, 1.6, 1.23, 0.99, 0.78, 0.63, 0.58, 0.6, 0.65, 0.76, 0.92, 1.1],
    },
];

/// First wavelength of [`DAYLIGHT`] and its step, nanometres.
pub(super) const DAYLIGHT_FROM: f64 = 400.0;
pub(super) const DAYLIGHT_STEP: f64 = 10.0;

/// CIE D65, relative spectral power, 400 to 700 nm.
#[rustfmt::skip]
pub(super) static DAYLIGHT: [f64; 31] = [
    82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923, 108.811, 109.354, 107.802,
    104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886,
    83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091,
];
