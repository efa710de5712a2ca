//! Draws that depend on seed, key and number alone, as those of `aquafuse augment`.

use aquafuse_data::augment;
use pyo3::prelude::*;

use crate::error::Fault;
use crate::settings::{gain, incidence};

/// What is drawn for a sample: which water, theta and alpha.
#[pyclass(frozen, module = "aquafuse._native")]
pub(crate) struct Draws(augment::Draws);

#[pymethods]
impl Draws {
    #[new]
    fn new(
        seed: u64,
        theta_range: (f32, f32),
        alpha_range: (f32, f32),
        with_replacement: bool,
    ) -> Result<Self, Fault> {
        for degrees in [theta_range.0, theta_range.1] {
            incidence(degrees)?;
        }
        for alpha in [alpha_range.0, alpha_range.1] {
            gain(alpha)?;
        }
        for (name, (low, high)) in [("theta_range", theta_range), ("alpha_range", alpha_range)] {
            if low > high {
                return Err(Fault::argument(format!(
                    "{name} is ({low}, {high}); give the smaller number first"
                )));
            }
        }
        Ok(Self(augment::Draws { seed, with_replacement, theta: theta_range, alpha: alpha_range }))
    }

    /// The index of the water, theta, alpha and the number of a water of the sea of draw `number` for `key`, of so many waters.
    fn draw(&self, key: &str, number: u32, waters: usize) -> Result<(usize, f32, f32, u32), Fault> {
        if waters == 0 {
            return Err(Fault::argument("there is no water to draw from; give at least one"));
        }
        let drawn = self.0.draw(key, number, waters);
        Ok((drawn.water, drawn.theta, drawn.alpha, drawn.sea))
    }
}
