//! Powers by polynomials: the compiler makes vectors of them, and every machine gives the same bits.

/// `log2(1 + s) / s`, s in `[0, 1)`: Chebyshev's approximation; the logarithm is off by 2e-6 at most.
const LOGARITHM: [f32; 7] =
    [0.020_490_346, -0.096_066_25, 0.215_588_53, -0.339_247_77, 0.477_705_93, -0.721_162_73, 1.442_693_3];
/// `2^s`, s in `[-.5, .5]`: to 4e-6 of it.
const EXPONENTIAL: [f32; 5] = [0.009_676_037, 0.055_922_036, 0.240_221_07, 0.693_121, 1.0];

/// Adding it rounds to a whole number, which is then in the lowest bits.
pub(super) const ROUND: f32 = 12_582_912.0;
const FRACTION: u32 = 23;
/// The exponent of 1.
const BIAS: i32 = 127;

/// `x^exponent` of x in `[0, 1]`, to 1e-4 of it; 0 is 0.
#[inline(always)]
pub(super) fn power(x: f32, exponent: f32) -> f32 {
    // What is darker than 1e-6 is black: `max` also takes a NaN to the safe side.
    let lit = x.max(1e-6);
    let bits = lit.to_bits();
    let whole = (bits >> FRACTION) as i32 - BIAS;
    let s = f32::from_bits((bits & ((1 << FRACTION) - 1)) | 1.0_f32.to_bits()) - 1.0;
    let logarithm = whole as f32 + s * polynomial(&LOGARITHM, s);
    let y = exponent * logarithm;
    let rounded = y + ROUND;
    let whole = rounded.to_bits() as i32 - ROUND.to_bits() as i32;
    let s = y - (rounded - ROUND);
    let scale = f32::from_bits(((whole + BIAS) << FRACTION) as u32);
    let result = scale * polynomial(&EXPONENTIAL, s);
    if x > 1e-6 { result } else { 0.0 }
}

#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f32; N], s: f32) -> f32 {
    let mut value = coefficients[0];
    for coefficient in &coefficients[1..] {
        value = value * s + coefficient;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::power;

    #[test]
    fn it_is_the_power_that_the_standard_library_has() {
        for exponent in [0.4, 0.7, 1.0, 1.3, 2.5] {
            for step in 0..=4096_u16 {
                let x = f32::from(step) / 4096.0;
                let expected = x.powf(exponent);
                let found = power(x, exponent);
                assert!(
                    (found - expected).abs() <= 1e-4 * expected,
                    "{x}^{exponent} is {expected}, not {found}"
                );
            }
        }
    }
}
