//! Means with their variance, and how far off they may be.

use serde::Serialize;

use super::chance::Chance;

/// Samples that are drawn to see how far off a mean may be.
const RESAMPLES: usize = 1000;
/// Shares of their means that lie below the interval, and below its upper end.
const ENDS: [f64; 2] = [0.025, 0.975];

/// What is said of many values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Values.
    pub count: usize,
    /// Values that are not finite, left out: the decibels of an image that equals its content, the way between like waters.
    pub left_out: usize,
    /// Their mean.
    pub mean: f64,
    /// Their variance about it, as in the paper's tables: of these values, not of what they were drawn from.
    pub variance: f64,
    /// Where the mean lies in 95 of 100 samples of as many images, drawn from these with replacement (the percentile
    /// bootstrap). All values of one image are drawn together, for they are not independent. None of one image.
    pub interval: Option<[f64; 2]>,
}

impl Summary {
    /// Summarises values, a list for each image; none of no finite value. The interval is that of the same seed and key.
    pub fn of(images: &[Vec<f64>], seed: u64, key: &[&str]) -> Option<Self> {
        summarise(images, Chance::keyed(seed, key))
    }
}

/// Summarises values, a list for each image; none of no finite value.
pub(crate) fn summarise(images: &[Vec<f64>], mut chance: Chance) -> Option<Summary> {
    let kept: Vec<Part> =
        images.iter().map(|values| Part::of(values)).filter(|part| part.count > 0.0).collect();
    let all = Part::total(&kept);
    let mean = all.mean()?;
    let finite = images.iter().flatten().filter(|value| value.is_finite());
    let squares = finite.clone().fold(0.0, |sum, value| sum + (value - mean) * (value - mean));
    let count = finite.count();
    let mut resampled = || Part::total(kept.iter().filter_map(|_| chance.pick(&kept))).mean();
    let interval = (kept.len() > 1).then(|| {
        let mut means: Vec<f64> = (0..RESAMPLES).filter_map(|_| resampled()).collect();
        means.sort_by(f64::total_cmp);
        ENDS.map(|share| quantile_of_sorted(&means, share))
    });
    let left_out = images.iter().map(Vec::len).fold(0, usize::saturating_add).saturating_sub(count);
    Some(Summary { count, left_out, mean, variance: squares / all.count, interval })
}

/// The finite values of one image, or of several, summed.
#[derive(Clone, Copy, Default)]
struct Part {
    sum: f64,
    count: f64,
}

impl Part {
    fn of(values: &[f64]) -> Self {
        let finite = values.iter().filter(|value| value.is_finite());
        finite.fold(Self::default(), |part, value| Self { sum: part.sum + value, count: part.count + 1.0 })
    }

    fn total<'a>(parts: impl IntoIterator<Item = &'a Self>) -> Self {
        let add = |all: Self, part: &Self| Self { sum: all.sum + part.sum, count: all.count + part.count };
        parts.into_iter().fold(Self::default(), add)
    }

    fn mean(self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

/// The value that this share of the values does not exceed; 0 of none.
pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile_of_sorted(&sorted, share)
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length is a place")]
fn quantile_of_sorted(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1) as f64;
    sorted.get((share * last).round() as usize).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(images: &[Vec<f64>]) -> Option<Summary> {
        summarise(images, Chance::keyed(1, &["test"]))
    }

    #[test]
    fn what_has_no_mean_is_left_out_and_counted() {
        let found = of(&[vec![1.0, f64::INFINITY], vec![3.0], vec![f64::INFINITY]]).unwrap();
        assert_eq!((found.count, found.left_out, found.mean, found.variance), (2, 2, 2.0, 1.0));
        assert_eq!(of(&[vec![f64::INFINITY], Vec::new()]), None);
    }

    #[test]
    fn one_image_has_no_interval_however_many_values_it_has() {
        assert_eq!(of(&[vec![1.0, 2.0, 3.0]]).unwrap().interval, None);
    }

    #[test]
    fn values_of_one_image_stand_and_fall_together() {
        // Sixteen values either way: the interval is wider for two images than for sixteen.
        let width = |images: &[Vec<f64>]| {
            let [low, high] = of(images).unwrap().interval.unwrap();
            high - low
        };
        let (together, alone) =
            ([vec![0.0; 8], vec![1.0; 8]], [vec![vec![0.0]; 8], vec![vec![1.0]; 8]].concat());
        assert!(width(&together) > 1.5 * width(&alone), "{} and {}", width(&together), width(&alone));
    }

    #[test]
    fn intervals_of_many_normal_samples_hold_the_truth_about_as_often_as_they_say() {
        let mut chance = Chance::keyed(3, &["truth"]);
        let unit = |chance: &mut Chance| (chance.number() >> 11) as f64 / (1_u64 << 53) as f64;
        let mut held = 0;
        for trial in 0..400 {
            let normal = |chance: &mut Chance| (0..12).map(|_| unit(chance)).sum::<f64>() - 6.0;
            let values: Vec<Vec<f64>> = (0..40).map(|_| vec![normal(&mut chance)]).collect();
            let found = summarise(&values, Chance::keyed(trial, &["sample"])).unwrap();
            let [low, high] = found.interval.unwrap();
            held += u32::from((low..=high).contains(&0.0));
        }
        // 95 % but for the bootstrap's own bias of small samples, a per cent or two.
        assert!((364..=392).contains(&held), "{held} of 400");
    }

    proptest! {
        #[test]
        fn a_seed_gives_the_same_interval_again_and_it_holds_the_mean(
            values in prop::collection::vec(prop::collection::vec(-5.0..5.0_f64, 1..4), 2..9),
        ) {
            let found = of(&values).unwrap();
            prop_assert_eq!(of(&values).unwrap(), found);
            let [low, high] = found.interval.unwrap();
            let all: Vec<f64> = values.concat();
            let (least, most) = (quantile(&all, 0.0), quantile(&all, 1.0));
            prop_assert!(least - 1e-9 <= low && low <= high && high <= most + 1e-9);
        }
    }
}
