//! What supplied values are declared to be: which of them are valid, and what distance they mean.

use super::SuppliedError;

/// What the values of supplied depth are.
///
/// NaN, infinities and negative values are valid in no kind. 0 depends on it:
///
/// | kind | a value v is | z | 0 is |
/// |---|---|---|---|
/// | [`Metres`](Self::Metres) | the distance | v | no measurement: nothing touches the lens |
/// | [`Millimetres`](Self::Millimetres) | the distance | v / 1000 | no measurement |
/// | [`Relative`](Self::Relative) | the distance, without unit, larger is **farther** | v, full range of whole numbers = 1 | at the camera |
/// | [`Inverse`](Self::Inverse) | a / z + b, a and b unknown, larger is **nearer** | 1 - (v - v01) / (v99 - v01) | the far end |
/// | [`Disparity`](Self::Disparity) | a / z, a unknown, larger is **nearer** | v01 / v | no match |
///
/// v01 and v99 are the 1st and 99th percentile of the valid values; results are clipped to `[0, 1]`.
///
/// Disparity has a true zero, so 1 / v is right up to a scale. What a monocular network calls inverse depth has
/// not: with b unknown, 1 / v would be ruled by b just where the water is thickest. Inverting the values linearly keeps
/// their order and a bound, and understates how far the far end is.
/// A disparity of 0 would be infinitely far, but matchers write it where they found nothing, near or far, so colour
/// decides. A network's 0 is the end of its stretch to 8 or 16 bits: often a fifth of an image, and its open water.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum SuppliedKind {
    /// Distance in metres.
    Metres,
    /// Distance in millimetres.
    Millimetres,
    /// Distance without a unit, in `[0, 1]`.
    Relative,
    /// Inverse distance of unknown scale and shift, as monocular networks give it.
    Inverse,
    /// Disparity of a stereo pair: inverse distance of unknown scale.
    Disparity,
}

impl SuppliedKind {
    /// All kinds.
    pub const ALL: &'static [Self] =
        &[Self::Metres, Self::Millimetres, Self::Relative, Self::Inverse, Self::Disparity];

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metres => "metres",
            Self::Millimetres => "millimetres",
            Self::Relative => "relative",
            Self::Inverse => "inverse",
            Self::Disparity => "disparity",
        }
    }

    /// Whether distances of this kind have a unit.
    pub(super) fn is_metric(self) -> bool {
        matches!(self, Self::Metres | Self::Millimetres)
    }

    /// Whether a value says anything; see the table above.
    pub fn is_valid(self, value: f32) -> bool {
        let zero_is_valid = matches!(self, Self::Relative | Self::Inverse);
        value.is_finite() && (value > 0.0 || (value == 0.0 && zero_is_valid))
    }

    /// Distances of the valid values, metres or relative; 0 where there is none.
    pub(super) fn to_distances(
        self,
        values: &[f32],
        valid: &[bool],
        full_range: f32,
    ) -> Result<Vec<f32>, SuppliedError> {
        let each = |law: &dyn Fn(f32) -> f32| {
            values.iter().zip(valid).map(|(&value, &valid)| if valid { law(value) } else { 0.0 }).collect()
        };
        Ok(match self {
            Self::Metres => each(&|value| value),
            Self::Millimetres => each(&|value| value / 1000.0),
            Self::Relative => each(&|value| value / full_range),
            Self::Inverse => {
                let (far, near) = ends(values, valid)?;
                // In f64: the difference of two huge values has no place in f32.
                let spread = f64::from(near) - f64::from(far);
                let turned = |value: f32| 1.0 - (f64::from(value) - f64::from(far)) / spread;
                each(&|value| turned(value).clamp(0.0, 1.0) as f32)
            }
            Self::Disparity => {
                let (far, _) = ends(values, valid)?;
                each(&|value| (far / value).min(1.0))
            }
        })
    }
}

crate::names::named!(SuppliedKind, "kind of depth");

/// The 1st and 99th percentile of the valid values; the least and the greatest where those two are one.
///
/// Of no values at all, 0 and 1: nothing is converted by them.
fn ends(values: &[f32], valid: &[bool]) -> Result<(f32, f32), SuppliedError> {
    let mut sorted: Vec<f32> =
        values.iter().zip(valid).filter(|(_, valid)| **valid).map(|(value, _)| *value).collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return Ok((0.0, 1.0)) };
    let at = |percent: usize| sorted[last * percent / 100];
    let robust_first = [(at(1), at(99)), (sorted[0], sorted[last])];
    robust_first.into_iter().find(|(far, near)| far < near).ok_or(SuppliedError::Flat { value: sorted[0] })
}
