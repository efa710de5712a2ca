//! Coefficients of one channel that follow the exact sums over the spectrum as closely as they can.

use super::spectral::Channel;
use crate::image::{Encoding, Linear};
use crate::waterbody::Attenuation;

/// Distances a curve is compared at.
const STEPS: u32 = 64;
/// Beyond this optical depth of the clearest light nothing is left to fit: e^-6 is a quarter of a percent.
const FAINTEST: f64 = 6.0;
/// Reflectance of the grey whose fading β_D follows, where encoding makes that depend on brightness.
pub(super) const GREY: f64 = 0.18;

/// What one channel comes to, and how far it is off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitted {
    /// A white diffuser at z = 0, in encoding E.
    pub(super) white: f64,
    /// B∞ in encoding E.
    pub(super) veil: f64,
    /// β_B, per metre.
    pub(super) backscatter: f64,
    /// β_D(z), per metre.
    pub(super) attenuation: Attenuation,
    /// The greatest errors of backscatter, of the direct signal of grey, and of grey as seen.
    pub(super) off: [f64; 3],
}

/// Fits all coefficients of one channel on distances up to `range` metres.
pub(super) fn fit<E: Encoding>(channel: &Channel, range: f64) -> Fitted {
    let far = range.min(FAINTEST / channel.clearest());
    let distances = (1..=STEPS).map(|step| far * f64::from(step) / f64::from(STEPS));
    let veil = encode::<E>(channel.veil());
    let grey = encode::<E>(channel.direct(GREY, 0.0));
    let exact: Vec<Exact> = distances.map(|z| Exact::new::<E>(channel, z)).collect();
    // In shares of the veil and of the grey, so that a channel all but dark is fitted like any other.
    let grown: Vec<[f64; 2]> = exact.iter().map(|at| [at.z, at.backscatter / veil]).collect();
    let left: Vec<[f64; 2]> = exact.iter().map(|at| [at.z, at.direct() / grey]).collect();
    let backscatter = fit_backscatter(&grown, far);
    let attenuation = fit_attenuation(&left, far);
    let mut off = [0.0_f64; 3];
    for at in &exact {
        let fitted_backscatter = -veil * (-backscatter * at.z).exp_m1();
        let fitted_direct = grey * (-f64::from(attenuation.optical_depth(at.z as f32))).exp();
        let [b, d] = [fitted_backscatter - at.backscatter, fitted_direct - at.direct()];
        off = std::array::from_fn(|i| off[i].max([b, d, b + d][i].abs()));
    }
    let white = encode::<E>(channel.direct(1.0, 0.0));
    Fitted { white, veil, backscatter, attenuation, off }
}

/// What a channel shows of black and of grey at one distance, in some encoding.
struct Exact {
    z: f64,
    backscatter: f64,
    grey: f64,
}

impl Exact {
    fn new<E: Encoding>(channel: &Channel, z: f64) -> Self {
        let backscatter = channel.backscatter(z);
        Self {
            z,
            backscatter: encode::<E>(backscatter),
            grey: encode::<E>(channel.direct(GREY, z) + backscatter),
        }
    }

    /// U - B, as estimators read it off an image.
    fn direct(&self) -> f64 {
        self.grey - self.backscatter
    }
}

/// A linear value in encoding E.
pub(super) fn encode<E: Encoding>(linear: f64) -> f64 {
    f64::from(E::from_encoded(Linear::to_encoded(linear as f32)))
}

/// β of `1 - e^(-βz)` closest to the points by least squares: golden section over ln β.
fn fit_backscatter(points: &[[f64; 2]], far: f64) -> f64 {
    let cost = |log: f64| {
        let beta = log.exp();
        points.iter().map(|[z, y]| (-(-beta * z).exp_m1() - y).powi(2)).sum::<f64>()
    };
    // Between a thousandth of an optical depth at the far end and a thousand.
    let (mut low, mut high) = ((1e-3 / far).ln(), (1e3 / far).ln());
    let share = (5.0_f64.sqrt() - 1.0) / 2.0;
    for _ in 0..60 {
        let (left, right) = (high - share * (high - low), low + share * (high - low));
        if cost(left) < cost(right) {
            high = right;
        } else {
            low = left;
        }
    }
    (0.5 * (low + high)).exp()
}

/// Decays tried for the part of β_D that falls, in units of one over the far end.
const DECAYS: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

/// β_D(z) = p + q e^(-dz) whose e^(-β_D z) is closest to the points by least squares.
///
/// The light that goes first leaves the light that stays: the curve falls with z. For each decay d, p and q are
/// the weighted least squares for the optical depth, which a step in e^(-τ) changes by its inverse.
fn fit_attenuation(points: &[[f64; 2]], far: f64) -> Attenuation {
    let candidates = DECAYS.iter().flat_map(|decay| {
        let decay = decay / far;
        non_negative(points, decay).map(|[p, q]| [p, 0.0, q, -decay].map(|mu| mu as f32))
    });
    // Some decays let the optical depth fall somewhere; the law sorts these out.
    let curves = candidates.filter_map(|mu| Attenuation::new(mu, far as f32).ok());
    let cost = |curve: &Attenuation| -> f64 {
        points.iter().map(|[z, y]| ((-f64::from(curve.optical_depth(*z as f32))).exp() - y).powi(2)).sum()
    };
    curves
        .min_by(|left, right| cost(left).total_cmp(&cost(right)))
        .expect("a constant is among the candidates, and its optical depth never falls")
}

/// The candidates for p and q >= 0: both, or one alone.
fn non_negative(points: &[[f64; 2]], decay: f64) -> [[f64; 2]; 3] {
    let [mut pp, mut pq, mut qq, mut py, mut qy] = [0.0; 5];
    for &[z, y] in points {
        // The weight of τ = -ln y is y²; where nothing is left it is 0, and so is y² ln y.
        let tau = if y > 0.0 { -y.ln() } else { 0.0 };
        let [p, q] = [z * y, z * (-decay * z).exp() * y];
        pp += p * p;
        pq += p * q;
        qq += q * q;
        py += p * tau * y;
        qy += q * tau * y;
    }
    let determinant = pp * qq - pq * pq;
    let both = [(py * qq - qy * pq) / determinant, (qy * pp - py * pq) / determinant];
    [both.map(|weight| weight.max(0.0)), [py / pp, 0.0], [0.0, qy / qq]]
}
