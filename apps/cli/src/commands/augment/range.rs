//! `LOW,HIGH`.

use anyhow::{Result, anyhow};
use aquafuse::fusion::{Gain, Incidence};

/// Two numbers, the first not above the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    low: f32,
    high: f32,
}

impl std::str::FromStr for Range {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (low, high) = text.split_once(',').ok_or_else(|| anyhow!("give two numbers, as 0,60"))?;
        let number = |text: &str| text.trim().parse::<f32>().map_err(|_| anyhow!("{text:?} is not a number"));
        let (low, high) = (number(low)?, number(high)?);
        if low > high {
            return Err(anyhow!("the first number must not exceed the second"));
        }
        Ok(Self { low, high })
    }
}

impl Range {
    /// As a range of θ.
    pub(super) fn of_theta(self) -> Result<(f32, f32)> {
        Incidence::from_degrees(self.low).and(Incidence::from_degrees(self.high))?;
        Ok((self.low, self.high))
    }

    /// As a range of α.
    pub(super) fn of_alpha(self) -> Result<(f32, f32)> {
        Gain::new(self.low).and(Gain::new(self.high))?;
        Ok((self.low, self.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_two_numbers_in_order() {
        assert_eq!("0, 60".parse::<Range>().unwrap().of_theta().unwrap(), (0.0, 60.0));
        for wrong in ["", "5", "60,0", "a,b", "0;1", "nan,1"] {
            let is_range = wrong.parse::<Range>().and_then(Range::of_alpha);
            assert!(is_range.is_err(), "{wrong}");
        }
        assert!("0,91".parse::<Range>().unwrap().of_theta().is_err());
        assert!("-1,1".parse::<Range>().unwrap().of_alpha().is_err());
    }
}
