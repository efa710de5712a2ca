//! Rivals take turns, so that a busy machine is busy for all of them.

use std::collections::BTreeMap;

/// Turns of one comparison; each turn's median counts once.
pub(super) const TURNS: usize = 5;

/// Milliseconds, one entry a turn, by case.
#[derive(Default)]
pub(super) struct Turns(BTreeMap<String, Vec<f64>>);

impl Turns {
    pub(super) fn add(&mut self, case: &str, milliseconds: f64) {
        self.0.entry(case.to_owned()).or_default().push(milliseconds);
    }

    /// Reads lines of a name and a number.
    pub(super) fn read(&mut self, printed: &str) {
        for line in printed.lines() {
            if let Some((name, Ok(milliseconds))) = line.split_once(' ').map(|(n, m)| (n, m.parse())) {
                self.add(name, milliseconds);
            }
        }
    }

    pub(super) fn median(&self, case: &str) -> f64 {
        self.0.get(case).cloned().map_or(f64::NAN, middle)
    }

    /// How many times as long as `other` a case takes: the median of the turns' ratios.
    pub(super) fn times(&self, case: &str, other: (&Turns, &str)) -> f64 {
        match (self.0.get(case), other.0.0.get(other.1)) {
            (Some(own), Some(other)) => {
                middle(own.iter().zip(other).map(|(own, other)| own / other).collect())
            }
            _ => f64::NAN,
        }
    }
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_is_the_median_of_the_turns_ratios() {
        let (mut ours, mut theirs) = (Turns::default(), Turns::default());
        for (our, their) in [(1.0, 10.0), (2.0, 22.0), (4.0, 36.0)] {
            ours.add("cached", our);
            theirs.read(&format!("opencv 5\ncached {their}\n"));
        }
        assert_eq!(theirs.times("cached", (&ours, "cached")), 10.0);
        assert_eq!(ours.median("cached"), 2.0);
        assert!(ours.median("estimated").is_nan());
    }
}
