//! Adam (`kingma2015adam` in the bibliography), over rows of splats or any few numbers.

use aquafuse::simd::{Work, widest};
use rayon::prelude::*;

const FIRST: f32 = 0.9;
const SECOND: f32 = 0.999;
/// As published for splats: gradients of a mean over pixels are small.
const EPSILON: f32 = 1e-15;
/// Rows that one thread takes at a time.
const SHARE: usize = 512;

/// Running means of a gradient and of its square.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    pub(crate) first: Vec<f32>,
    pub(crate) second: Vec<f32>,
}

impl Moments {
    pub(crate) fn new(numbers: usize) -> Self {
        Self { first: vec![0.0; numbers], second: vec![0.0; numbers] }
    }

    /// One step, counted from 1, against the gradient; `rates` are those of a row.
    pub(crate) fn step(&mut self, values: &mut [f32], gradient: &[f32], rates: &[f32], step: u32) {
        let exponent = i32::try_from(step).unwrap_or(i32::MAX);
        let mean = 1.0 / (1.0 - FIRST.powi(exponent));
        let spread = 1.0 / (1.0 - SECOND.powi(exponent));
        let share = SHARE * rates.len();
        let moments = self.first.par_chunks_mut(share).zip(self.second.par_chunks_mut(share));
        values.par_chunks_mut(share).zip(gradient.par_chunks(share)).zip(moments).for_each(
            |((values, gradient), (first, second))| {
                widest(Step { values, gradient, first, second, rates, mean, spread });
            },
        );
    }
}

struct Step<'a> {
    values: &'a mut [f32],
    gradient: &'a [f32],
    first: &'a mut [f32],
    second: &'a mut [f32],
    rates: &'a [f32],
    mean: f32,
    spread: f32,
}

impl Work for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let width = self.rates.len();
        let rows = self.values.chunks_exact_mut(width).zip(self.gradient.chunks_exact(width));
        let moments = self.first.chunks_exact_mut(width).zip(self.second.chunks_exact_mut(width));
        for ((values, gradient), (first, second)) in rows.zip(moments) {
            for i in 0..width {
                let slope = gradient[i];
                first[i] = FIRST * first[i] + (1.0 - FIRST) * slope;
                second[i] = SECOND * second[i] + (1.0 - SECOND) * slope * slope;
                let step = self.mean * first[i] / ((self.spread * second[i]).sqrt() + EPSILON);
                values[i] -= self.rates[i] * step;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_is_as_long_as_the_rate() {
        let (mut values, mut moments) = ([1.0, 2.0, 3.0, 4.0], Moments::new(4));
        moments.step(&mut values, &[3.0, -1e-6, 0.0, 5.0], &[0.1, 0.2], 1);
        let expected = [0.9, 2.2, 3.0, 3.8];
        assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{values:?}");
    }
}
