//! One stored colour value and how it stands for a number in `[0, 1]`.

use std::fmt::Debug;

/// A colour value as stored: bytes and 16-bit words span `[0, 1]` evenly, floats are that number.
///
/// Sealed: [`u8`], [`u16`] and [`f32`] are all there is.
pub trait Sample: kernels::Kernels + Copy + Debug + Default + PartialEq + Send + Sync + 'static {
    /// The value in `[0, 1]`.
    fn to_unit(self) -> f32;
    /// The nearest storable value; clips to the range, and a NaN becomes 0.
    fn from_unit(value: f32) -> Self;
    /// The nearest byte.
    fn to_byte(self) -> u8;
}

/// Out of reach from outside the crate, which seals [`Sample`].
pub(crate) mod kernels {
    /// What the kernels of this crate do with samples.
    pub trait Kernels: Sized {
        /// The nearest 16-bit word.
        fn to_word(self) -> u16;
        /// The value in whole steps, so that sums do not depend on their order: those of the stored type, or 2^-24.
        fn to_steps(self) -> u64;
        /// The value of so many steps.
        fn from_steps(steps: u64) -> Self;
        /// Whether values lie closer together than bytes.
        const FINE: bool;
        /// The values as bytes, if that is what they are: bytes have faster ways.
        fn bytes_mut(_: &mut [Self]) -> Option<&mut [u8]> {
            None
        }
        /// [`Kernels::bytes_mut`] for reading.
        fn bytes(_: &[Self]) -> Option<&[u8]> {
            None
        }
        /// This value plus `shift`, rounded to the nearest storable value and clipped to `[0, 1]`,
        /// and whether clipping changed it.
        fn shifted(self, shift: Self::Shift) -> (Self, bool);
        /// `gain` times this value plus `offset` in units of `[0, 1]`, rounded to the nearest storable value and
        /// clipped to `[0, 1]`, and whether clipping changed it.
        fn changed(self, gain: f32, offset: f32) -> (Self, bool);
        /// A difference of two values in steps of the stored type, so that adding it is exact.
        type Shift: Copy + Default + Send + Sync;
        /// Rounds a difference in units of `[0, 1]` to steps: halves go up, towards positive infinity.
        fn shift_from_unit(shift: f32) -> Self::Shift;
    }
}

use kernels::Kernels;

/// `round(255 (v + s)) = 255 v + round(255 s)`: for whole steps the rounding can be done on the shift
/// alone, once a table instead of once a pixel.
macro_rules! integer_sample {
    ($stored:ty, $step:ty, $to_byte:expr, $to_word:expr $(, $more:item)*) => {
        impl Sample for $stored {
            fn to_unit(self) -> f32 {
                f32::from(self) / f32::from(Self::MAX)
            }

            fn from_unit(value: f32) -> Self {
                (value.clamp(0.0, 1.0) * f32::from(Self::MAX) + 0.5) as Self
            }

            #[inline]
            fn to_byte(self) -> u8 {
                $to_byte(self)
            }
        }

        impl Kernels for $stored {
            $($more)*

            type Shift = $step;

            #[inline]
            fn to_word(self) -> u16 {
                $to_word(self)
            }

            #[inline]
            fn to_steps(self) -> u64 {
                u64::from(self)
            }

            #[inline]
            fn from_steps(steps: u64) -> Self {
                steps.min(u64::from(Self::MAX)) as Self
            }

            const FINE: bool = size_of::<Self>() > 1;

            #[inline]
            fn shifted(self, shift: $step) -> (Self, bool) {
                let moved = <$step>::from(self) + shift;
                let clipped = moved.clamp(0, <$step>::from(Self::MAX));
                (clipped as Self, moved != clipped)
            }

            #[inline]
            fn changed(self, gain: f32, offset: f32) -> (Self, bool) {
                let most = f32::from(Self::MAX);
                // What lies between two steps is cut off by the cast.
                let steps = gain * f32::from(self) + most * offset + 0.5;
                (steps.clamp(0.0, most) as Self, !(0.0..most + 1.0).contains(&steps))
            }

            fn shift_from_unit(shift: f32) -> $step {
                let steps = f64::from(shift) * f64::from(Self::MAX) + 0.5;
                // A full range either way clips every value; beyond it the sum could overflow.
                let limit = f64::from(Self::MAX);
                steps.floor().clamp(-limit, limit) as $step
            }
        }
    };
}

integer_sample!(
    u8,
    i16,
    |byte| byte,
    |byte: u8| u16::from(byte) * 257,
    fn bytes_mut(values: &mut [Self]) -> Option<&mut [u8]> {
        Some(values)
    },
    fn bytes(values: &[Self]) -> Option<&[u8]> {
        Some(values)
    }
);
integer_sample!(u16, i32, |word: u16| ((u32::from(word) + 128) / 257) as u8, |word| word);

/// Steps of a float: as many as its fraction distinguishes below 1.
const FLOAT_STEPS: f64 = (1 << 24) as f64;

impl Sample for f32 {
    fn to_unit(self) -> f32 {
        self
    }

    fn from_unit(value: f32) -> Self {
        // Not `clamp` alone: that would hand a NaN on.
        value.max(0.0).clamp(0.0, 1.0)
    }

    fn to_byte(self) -> u8 {
        u8::from_unit(self)
    }
}

impl Kernels for f32 {
    type Shift = f32;

    fn to_word(self) -> u16 {
        u16::from_unit(self)
    }

    fn to_steps(self) -> u64 {
        (f64::from(Self::from_unit(self)) * FLOAT_STEPS).round() as u64
    }

    fn from_steps(steps: u64) -> Self {
        Self::from_unit((steps as f64 / FLOAT_STEPS) as Self)
    }

    const FINE: bool = true;

    fn shifted(self, shift: f32) -> (Self, bool) {
        let moved = self + shift;
        let clipped = Self::from_unit(moved);
        (clipped, moved != clipped)
    }

    fn changed(self, gain: f32, offset: f32) -> (Self, bool) {
        (gain * self).shifted(offset)
    }

    fn shift_from_unit(shift: f32) -> f32 {
        shift
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rounded_shift_equals_rounding_the_sum() {
        for stored in 0..=255_u8 {
            for step in -600..=600_i32 {
                let shift = step as f32 / 512.0;
                let exact = (f64::from(stored) + 255.0 * f64::from(shift) + 0.5).floor().clamp(0.0, 255.0);
                assert_eq!(f64::from(stored.shifted(u8::shift_from_unit(shift)).0), exact);
            }
        }
    }

    #[test]
    fn clipping_is_reported_only_when_it_changes_the_value() {
        assert_eq!(250_u8.shifted(5), (255, false));
        assert_eq!(250_u8.shifted(6), (255, true));
        assert_eq!(3_u8.shifted(-3), (0, false));
        assert_eq!(3_u8.shifted(-4), (0, true));
    }

    #[test]
    fn a_change_is_rounded_and_clipped_once() {
        assert_eq!(100_u8.changed(1.5, 0.1), (176, false));
        assert_eq!(200_u8.changed(1.0, 0.0), (200, false));
        assert_eq!(200_u8.changed(1.5, 0.0), (255, true));
        assert_eq!(60_000_u16.changed(1.0, -0.5), (27_233, false));
        assert_eq!(0.5_f32.changed(2.0, -1.5), (0.0, true));
    }

    #[test]
    fn values_that_are_no_number_become_black() {
        assert_eq!(u8::from_unit(f32::NAN), 0);
        assert_eq!(f32::from_unit(f32::NAN), 0.0);
        assert_eq!(f32::from_unit(f32::INFINITY), 1.0);
    }
}
