//! A few waters to look at a place through.

use crate::waterbody::{Attenuation, VeilingLight, Waterbody};

/// A water with a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedWater {
    /// A word for it.
    pub name: &'static str,
    /// The water, encoded, coefficients per metre.
    pub water: Waterbody,
}

/// Five synthetic waters that span what divers see: blue, green, turbid, clear and deep.
///
/// The numbers are chosen by eye to be plausible, not measured: red fades first, green water takes blue as
/// well. All hide what lies at [`OPEN_WATER`](super::OPEN_WATER).
pub fn waters() -> [NamedWater; 5] {
    let water = |name, veil, backscatter_coefficient, attenuation: [f32; 3]| NamedWater {
        name,
        water: Waterbody {
            veiling_light: VeilingLight::new(veil),
            backscatter_coefficient,
            attenuation: attenuation
                .map(|coefficient| Attenuation::constant(coefficient).expect("positive and finite")),
        },
    };
    [
        water("blue", [0.04, 0.36, 0.66], [0.20, 0.17, 0.15], [0.36, 0.13, 0.10]),
        water("green", [0.10, 0.50, 0.33], [0.24, 0.18, 0.22], [0.42, 0.14, 0.24]),
        water("turbid", [0.42, 0.47, 0.30], [0.34, 0.32, 0.40], [0.40, 0.32, 0.50]),
        water("clear", [0.30, 0.62, 0.74], [0.15, 0.13, 0.12], [0.17, 0.10, 0.09]),
        water("deep", [0.02, 0.16, 0.34], [0.22, 0.18, 0.16], [0.40, 0.20, 0.16]),
    ]
}
