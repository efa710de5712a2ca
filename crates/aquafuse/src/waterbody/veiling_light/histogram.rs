//! Medians of bytes by counting.

/// Counts of each byte per channel: an exact median without sorting.
pub(super) struct Histogram {
    pub(super) count: u64,
    bins: [[u64; 256]; 3],
}

impl Default for Histogram {
    fn default() -> Self {
        Self { count: 0, bins: [[0; 256]; 3] }
    }
}

impl Histogram {
    pub(super) fn add(&mut self, pixel: &[u8; 3]) {
        self.count += 1;
        for (bins, &value) in self.bins.iter_mut().zip(pixel) {
            bins[usize::from(value)] += 1;
        }
    }

    /// Encoded per-channel value in `[0, 1]` that `share` of the colours do not exceed.
    pub(super) fn quantile(&self, share: f64) -> [f32; 3] {
        let rank = (share * self.count as f64) as u64;
        self.bins.each_ref().map(|bins| {
            let mut seen = 0;
            let value = bins.iter().position(|count| {
                seen += count;
                seen > rank
            });
            value.unwrap_or(0) as f32 / 255.0
        })
    }

    /// Encoded per-channel median in `[0, 1]`; of an even number, the mean of the middle two.
    pub(super) fn median(&self) -> [f32; 3] {
        let at = |bins: &[u64; 256], rank: u64| {
            let mut seen = 0;
            let value = bins.iter().position(|count| {
                seen += count;
                seen > rank
            });
            value.unwrap_or(0) as f32
        };
        let (low, high) = (self.count.saturating_sub(1) / 2, self.count / 2);
        self.bins.each_ref().map(|bins| (at(bins, low) + at(bins, high)) / 510.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_is_the_mean_of_the_middle_two() {
        let mut histogram = Histogram::default();
        histogram.add(&[0, 10, 20]);
        histogram.add(&[2, 20, 20]);
        let median = histogram.median().map(|v| v * 255.0);
        assert!((median[0] - 1.0).abs() < 1e-4 && (median[1] - 15.0).abs() < 1e-4);
    }
}
