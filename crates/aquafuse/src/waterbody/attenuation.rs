//! How fast the direct signal fades: the curve β_D(z) and its fit (Eq. 6-8).

mod supplied;

use super::statistics::{Bin, Statistics};
use crate::image::Encoding;
pub(super) use supplied::fit_supplied;

/// Attenuation coefficient of the direct signal in one channel, per unit of z:
/// `β_D(z) = μ5 e^(μ6 z) + μ7 e^(μ8 z)`.
///
/// The optical depth `τ(z) = β_D(z) z` must not fall with z, or farther things would look brighter for it.
/// A fitted curve is only known where there was something to see: beyond that distance β_D is held.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "StoredAttenuation")
)]
pub struct Attenuation {
    mu: [f32; 4],
    held_beyond: f32,
}

/// As it is written to files.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredAttenuation {
    mu: [f32; 4],
    held_beyond: f32,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredAttenuation> for Attenuation {
    type Error = AttenuationError;

    fn try_from(stored: StoredAttenuation) -> Result<Self, AttenuationError> {
        Self::new(stored.mu, stored.held_beyond)
    }
}

/// Not an attenuation curve.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AttenuationError {
    /// A number is not finite, or the end of the range is negative.
    #[error("μ5 to μ8 = {mu:?} up to z = {held_beyond}: all must be finite, and the distance not negative")]
    NotFinite {
        /// μ5 to μ8.
        mu: [f32; 4],
        /// End of the range.
        held_beyond: f32,
    },
    /// β_D is negative, or the optical depth falls, at this distance.
    #[error("at z = {z} the curve is negative or its optical depth β_D(z) z falls")]
    Falls {
        /// Where.
        z: f32,
    },
}

/// Places at which a curve is checked. Two exponentials turn at most twice: coarser would do.
const CHECKS: u16 = 256;

impl Attenuation {
    /// The curve with μ5 to μ8 in the paper's order, constant beyond `held_beyond`.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when a number is not finite, or on `[0, held_beyond]` β_D is negative or the
    /// optical depth falls.
    pub fn new(mu: [f32; 4], held_beyond: f32) -> Result<Self, AttenuationError> {
        if !(mu.iter().all(|m| m.is_finite()) && held_beyond.is_finite() && held_beyond >= 0.0) {
            return Err(AttenuationError::NotFinite { mu, held_beyond });
        }
        let curve = Self { mu, held_beyond };
        let mut before = 0.0_f32;
        for check in 0..=CHECKS {
            let z = held_beyond * f32::from(check) / f32::from(CHECKS);
            let tau = curve.optical_depth(z);
            // A flat stretch may fall by a rounding error.
            if curve.coefficient(z) < 0.0 || tau.is_nan() || tau < before - 1e-5 * before.abs() {
                return Err(AttenuationError::Falls { z });
            }
            before = tau;
        }
        Ok(curve)
    }

    /// The same coefficient at every distance.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when it is negative or not finite.
    pub fn constant(coefficient: f32) -> Result<Self, AttenuationError> {
        Self::new([coefficient, 0.0, 0.0, 0.0], 0.0)
    }

    /// μ5 to μ8.
    pub fn mu(&self) -> [f32; 4] {
        self.mu
    }

    /// The distance beyond which β_D is held.
    pub fn held_beyond(&self) -> f32 {
        self.held_beyond
    }

    /// β_D(z).
    pub fn coefficient(&self, z: f32) -> f32 {
        let [mu5, mu6, mu7, mu8] = self.mu;
        let z = z.min(self.held_beyond);
        mu5 * (mu6 * z).exp() + mu7 * (mu8 * z).exp()
    }

    /// So large a part of it, from 0 to 1.
    pub(crate) fn in_part(self, part: f32) -> Self {
        Self { mu: [part * self.mu[0], self.mu[1], part * self.mu[2], self.mu[3]], ..self }
    }

    /// Optical depth τ(z) = β_D(z) z.
    pub fn optical_depth(&self, z: f32) -> f32 {
        self.coefficient(z) * z
    }
}

/// A direct signal below this (encoded) is no measurement: two steps of a byte, which the estimate of the
/// backscatter is at least wrong by. Its logarithm would be noise that pulls the curve down.
const FAINTEST: f32 = 2.0 / 255.0;
/// Times the scale of E is corrected; each time shrinks what is missing to the nearest bin's share of z.
const SCALINGS: usize = 3;
/// Decays tried for μ6 and μ8, in units of 1/z of the farthest bin. At 1 the optical depth just stops
/// rising there; nothing steeper is allowed, and so every fit keeps the law.
const DECAYS: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Fits β_D of one channel to what is left of the direct signal at each depth.
///
/// E(z) is the mean of U - B over pixels of similar depth, scaled to at most 1 (depth-colour consistency).
/// The curve is the least-squares fit of β_D(z) z to -ln E(z) with μ5, μ7 >= 0, over a grid of decays.
/// The nearest bin is already some way off: the scale is then corrected by the fit's own E there.
///
/// Depths at which nothing is left to measure do not count; beyond the last that does, β_D is held.
///
/// The paper refits while smoothing E along the fitted curve. The fit is the nearest point of a closed set,
/// and a point halfway to its nearest point has the same nearest point: such rounds change E but not β_D.
pub(super) fn fit<E: Encoding>(
    statistics: &Statistics<E>,
    channel: usize,
    veiling_light: f32,
    backscatter_coefficient: f32,
) -> Fit {
    let faintest = E::from_encoded(FAINTEST);
    let direct = direct_signals(statistics, channel, veiling_light, backscatter_coefficient);
    let brightest = direct.iter().map(|&(_, signal)| signal).fold(faintest, f32::max);
    let far = direct.last().map_or(0.0, |&(z, _)| z);
    if far <= 0.0 {
        let curve = Attenuation { mu: [0.0; 4], held_beyond: 0.0 };
        return Fit { curve, residual: 0.0, at_camera: brightest, faintest };
    }
    // Depth in units of the farthest bin, so that the fit does not know the unit of z.
    let mut points: Vec<(f32, f32)> =
        direct.iter().map(|&(z, signal)| (z / far, (brightest / signal).ln())).collect();
    let bases = bases(&points);
    let mut curve = fit_unit_curve(&points, &bases);
    let mut at_camera = brightest;
    for _ in 0..SCALINGS {
        // -ln E at the nearest bin is what the fit says, not 0.
        let missing = curve.optical_depth(points[0].0) - points[0].1;
        if missing > 0.0 {
            points.iter_mut().for_each(|(_, y)| *y += missing);
            at_camera *= missing.exp();
            curve = fit_unit_curve(&points, &bases);
        }
    }
    Fit {
        residual: residual(&curve, &points),
        curve: Attenuation { mu: curve.mu.map(|mu| mu / far), held_beyond: far },
        at_camera,
        faintest,
    }
}

/// z and direct signal of the bins in which there is enough of it.
fn direct_signals<E: Encoding>(
    statistics: &Statistics<E>,
    channel: usize,
    veiling_light: f32,
    backscatter_coefficient: f32,
) -> Vec<(f32, f32)> {
    let faintest = E::from_encoded(FAINTEST);
    let of = |bin: &Bin<E>| (bin.z, direct_signal(bin, channel, veiling_light, backscatter_coefficient));
    statistics.bins.iter().map(of).filter(|&(_, signal)| signal > faintest).collect()
}

/// Mean of U - B over a bin.
pub(super) fn direct_signal<E: Encoding>(
    bin: &Bin<E>,
    channel: usize,
    veiling_light: f32,
    backscatter_coefficient: f32,
) -> f32 {
    bin.mean(channel) - veiling_light * (1.0 - (-backscatter_coefficient * bin.z).exp())
}

/// A curve and how well it fits.
pub(super) struct Fit {
    pub(super) curve: Attenuation,
    /// L_z of the paper with z in units of the farthest bin: mean of (z + ln E / β_D)², each term at most 1
    /// (where hardly anything fades, a distance cannot be read off it).
    pub(super) residual: f32,
    /// The direct signal that E = 1 stands for.
    at_camera: f32,
    /// A direct signal no stronger than this did not count.
    faintest: f32,
}

impl Fit {
    /// E of a direct signal, if it counted.
    pub(super) fn illumination(&self, direct: f32) -> Option<f32> {
        (direct > self.faintest).then(|| direct / self.at_camera)
    }
}

fn residual(curve: &Attenuation, points: &[(f32, f32)]) -> f32 {
    let off = |&(z, y): &(f32, f32)| (z - y / curve.coefficient(z).max(1e-6)).clamp(-1.0, 1.0).powi(2);
    points.iter().map(off).sum::<f32>() / points.len() as f32
}

/// `z e^(-a z)` of each place for each of [`DECAYS`]: the places stay while the values are corrected.
type Bases = [Vec<f32>; DECAYS.len()];

fn bases(points: &[(f32, f32)]) -> Bases {
    DECAYS.map(|decay| points.iter().map(|&(z, _)| z * (-decay * z).exp()).collect())
}

/// The best curve for -ln E against z in `[0, 1]`.
fn fit_unit_curve(points: &[(f32, f32)], bases: &Bases) -> Attenuation {
    let places = 0..DECAYS.len();
    let pairs = places.clone().flat_map(|a| (a + 1..DECAYS.len()).map(move |b| (a, b)));
    let fitted = pairs.map(|(a, b)| {
        let ([p, q], cost) = non_negative_fit(points, [&bases[a], &bases[b]]);
        // 0 - a, not -a: a decay of nothing is 0, not -0.
        (cost, [p, 0.0 - DECAYS[a], q, 0.0 - DECAYS[b]])
    });
    let best = fitted.min_by(|(left, _), (right, _)| left.total_cmp(right));
    Attenuation { mu: best.map_or([0.0; 4], |(_, mu)| mu), held_beyond: 1.0 }
}

/// Weights >= 0 of two functions, given at each of `points`, that fit them best, and the squared error left.
fn non_negative_fit(points: &[(f32, f32)], [of_p, of_q]: [&[f32]; 2]) -> ([f32; 2], f32) {
    let (mut pp, mut pq, mut qq, mut py, mut qy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for ((&(_, y), p), q) in points.iter().zip(of_p).zip(of_q) {
        pp += p * p;
        pq += p * q;
        qq += q * q;
        py += p * y;
        qy += q * y;
    }
    let alone = |square: f32, product: f32| if square > 0.0 { (product / square).max(0.0) } else { 0.0 };
    let determinant = pp * qq - pq * pq;
    let both = [(py * qq - qy * pq) / determinant, (qy * pp - py * pq) / determinant];
    let allowed = |w: &[f32; 2]| w.iter().all(|w| w.is_finite() && *w >= 0.0);
    let error = |w: &[f32; 2]| {
        let off = |((&(_, y), p), q): ((&(f32, f32), &f32), &f32)| (p * w[0] + q * w[1] - y).powi(2);
        points.iter().zip(of_p).zip(of_q).map(off).sum::<f32>()
    };
    [both, [alone(pp, py), 0.0], [0.0, alone(qq, qy)]]
        .into_iter()
        .filter(allowed)
        .map(|w| (w, error(&w)))
        .min_by(|(_, left), (_, right)| left.total_cmp(right))
        .unwrap_or(([0.0; 2], f32::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::Quantised;
    use crate::image::{Encoded, Image};
    use proptest::prelude::*;

    fn gathered(image: &Image<u8>, levels: &[u8]) -> Statistics<Encoded> {
        Statistics::of_all(
            image.view(),
            &Quantised { levels: levels.into(), step: 1.0 / 255.0, beyond: None },
        )
    }

    #[test]
    fn a_curve_whose_optical_depth_falls_is_refused() {
        assert!(matches!(Attenuation::new([1.0, -2.0, 0.0, 0.0], 2.0), Err(AttenuationError::Falls { .. })));
        assert!(Attenuation::new([1.0, -0.5, 0.0, 0.0], 2.0).is_ok());
    }

    #[test]
    fn negative_and_infinite_curves_are_refused() {
        assert!(Attenuation::constant(-0.1).is_err());
        assert!(Attenuation::constant(f32::NAN).is_err());
    }

    #[test]
    fn beyond_its_range_the_coefficient_is_held() {
        let curve = Attenuation::new([0.5, -0.2, 0.1, 0.0], 3.0).unwrap();
        assert_eq!(curve.coefficient(50.0), curve.coefficient(3.0));
        assert!(curve.optical_depth(50.0) > curve.optical_depth(3.0));
    }

    #[test]
    fn a_grey_world_gives_its_attenuation_back() {
        let (veil, backscatter, truth) = (0.4, 1.0_f32, 1.5_f32);
        let levels: Vec<u8> = (0..=255).flat_map(|level| [level; 16]).collect();
        let samples = levels.iter().flat_map(|&level| {
            let z = f32::from(level) / 255.0;
            let value = 0.9 * (-truth * z).exp() + veil * (1.0 - (-backscatter * z).exp());
            [(255.0 * value.min(1.0) + 0.5) as u8; 3]
        });
        let image = Image::from_raw(levels.len(), 1, samples.collect()).unwrap();
        let Fit { curve, .. } = fit(&gathered(&image, &levels), 0, veil, backscatter);
        for z in [0.3, 0.6, 0.9] {
            assert!((curve.optical_depth(z) - truth * z).abs() < 0.05, "{curve:?} at {z}");
        }
    }

    proptest! {
        #[test]
        fn every_fit_is_a_valid_curve(bytes in prop::collection::vec(any::<[u8; 3]>(), 700), veil in 0.0..1.0_f32) {
            let levels: Vec<u8> = (0..700).map(|i| (i % 256) as u8).collect();
            let image = Image::from_raw(700, 1, bytes.concat()).unwrap();
            let Fit { curve, .. } = fit(&gathered(&image, &levels), 1, veil, 2.0);
            prop_assert!(Attenuation::new(curve.mu(), curve.held_beyond()).is_ok(), "{:?}", curve);
        }
    }
}
