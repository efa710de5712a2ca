//! A unit quaternion in four bytes: which of its numbers is largest, in two bits, and the three others in ten bits each.
//!
//! The largest follows from the others, and is taken as positive: a quaternion and its negative are one rotation.

/// How ten bits hold a number between -√½ and √½.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// `.spz`: a sign and nine bits of its size.
    SignAndSize,
    /// The compressed PLY: evenly from the least to the most.
    Even,
}

/// The four numbers, in the order of the file.
pub(super) fn unpacked(word: u32, order: Order) -> [f32; 4] {
    let largest = word >> 30;
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let number = |bits: u32| match order {
        Order::SignAndSize => {
            let size = half * (bits & 0x1ff) as f32 / 511.0;
            if bits & 0x200 == 0 { size } else { -size }
        }
        Order::Even => 2.0 * half * (bits as f32 / 1023.0 - 0.5),
    };
    let mut others = [20_u32, 10, 0].into_iter().map(|shift| number(word >> shift & 0x3ff));
    let mut four: [f32; 4] =
        [0_u32, 1, 2, 3].map(|place| if place == largest { 0.0 } else { others.next().unwrap_or(0.0) });
    let left = (1.0 - four.iter().map(|q| q * q).fold(0.0, |sum, q| sum + q)).max(0.0).sqrt();
    if let Some(cell) = four.get_mut(largest as usize) {
        *cell = left;
    }
    four
}

/// The word of a unit quaternion in the order of the file, as `.spz` has it.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a size from 0 to 511: of floats this alone makes whole numbers"
)]
pub(super) fn packed(four: [f32; 4]) -> u32 {
    let size = |q: &f32| q.abs();
    let (largest, most) = (0_u32..)
        .zip(four)
        .fold((0, 0.0_f32), |found, (place, q)| if size(&q) > size(&found.1) { (place, q) } else { found });
    let others = (0_u32..).zip(four).filter(|(place, _)| *place != largest);
    others.fold(largest, |word, (_, q)| {
        let level = (size(&q) * std::f32::consts::SQRT_2 * 511.0).round().min(511.0) as u32;
        word << 10 | u32::from((q < 0.0) != (most < 0.0)) << 9 | level
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_comes_back_whichever_number_is_largest() {
        for shift in 0..4 {
            for sign in [1.0, -1.0] {
                let mut four = [0.8, -0.4, 0.4, -0.2];
                four.rotate_right(shift);
                let found = unpacked(packed(four.map(|q| sign * q)), Order::SignAndSize);
                assert!(four.iter().zip(found).all(|(a, b)| (a - b).abs() < 2e-3), "{four:?} {found:?}");
            }
        }
    }
}
