//! Quantiles of what was found.

pub(crate) fn median(values: &[f32]) -> f32 {
    quantile(values, 0.5)
}

pub(crate) fn quantile(values: &[f32], share: f64) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

pub(crate) fn share<T>(values: &[T], keep: impl Fn(&T) -> bool) -> f64 {
    values.iter().filter(|value| keep(value)).count() as f64 / values.len() as f64
}
