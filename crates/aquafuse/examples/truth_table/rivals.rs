//! What others do with colours alone: statistics of the reference put on the content.

use aquafuse::image::Image;

/// A way to give a picture the colours of another one, in encoded values.
pub(crate) type Rival = fn(&Image<u8>, &Image<u8>) -> Vec<[f32; 3]>;

pub(crate) const RIVALS: [(&str, Rival); 2] =
    [("Reinhard 2001 (lαβ)", reinhard), ("histogram matching", match_histograms)];

/// RGB to LMS and its inverse, of Reinhard et al., "Color Transfer between Images" (2001).
const LMS: [[f32; 3]; 3] = [[0.3811, 0.5783, 0.0402], [0.1967, 0.7244, 0.0782], [0.0241, 0.1288, 0.8444]];
const RGB: [[f32; 3]; 3] = [[4.4679, -3.5873, 0.1193], [-1.2186, 2.3809, -0.1624], [0.0497, -0.2439, 1.2045]];

fn times(matrix: &[[f32; 3]; 3], [a, b, c]: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * a + row[1] * b + row[2] * c)
}

/// Mean and deviation of each channel of lαβ are made those of the reference.
fn reinhard(content: &Image<u8>, reference: &Image<u8>) -> Vec<[f32; 3]> {
    let (mut values, target) = (to_lab(content), to_lab(reference));
    let moments = |values: &[[f32; 3]], c: usize| {
        let mean = values.iter().map(|v| f64::from(v[c])).sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|v| (f64::from(v[c]) - mean).powi(2)).sum::<f64>();
        (mean as f32, (variance / values.len() as f64).sqrt() as f32)
    };
    for c in 0..3 {
        let ((from, spread), (to, wanted)) = (moments(&values, c), moments(&target, c));
        let gain = if spread > 0.0 { wanted / spread } else { 1.0 };
        values.iter_mut().for_each(|v| v[c] = (v[c] - from) * gain + to);
    }
    values.into_iter().map(from_lab).collect()
}

fn to_lab(image: &Image<u8>) -> Vec<[f32; 3]> {
    let of = |pixel: &[u8; 3]| {
        // The logarithm of black is not defined: half a step stands for it.
        let rgb = pixel.map(|value| f32::from(value).max(0.5) / 255.0);
        let [l, m, s] = times(&LMS, rgb).map(f32::log10);
        [(l + m + s) / 3.0_f32.sqrt(), (l + m - 2.0 * s) / 6.0_f32.sqrt(), (l - m) / 2.0_f32.sqrt()]
    };
    image.pixels().iter().map(of).collect()
}

fn from_lab([l, a, b]: [f32; 3]) -> [f32; 3] {
    let (l, a, b) = (l / 3.0_f32.sqrt(), a / 6.0_f32.sqrt(), b / 2.0_f32.sqrt());
    times(&RGB, [l + a + b, l + a - b, l - 2.0 * a].map(|log| 10.0_f32.powf(log)))
}

/// Each channel's values are given the reference's distribution, by rank.
fn match_histograms(content: &Image<u8>, reference: &Image<u8>) -> Vec<[f32; 3]> {
    let tables: [[f32; 256]; 3] = std::array::from_fn(|c| {
        let (own, other) = (ranks(content, c), ranks(reference, c));
        std::array::from_fn(|value| {
            let at = other.iter().position(|&rank| rank >= own[value]).unwrap_or(255);
            at as f32 / 255.0
        })
    });
    let of = |pixel: &[u8; 3]| std::array::from_fn(|c| tables[c][usize::from(pixel[c])]);
    content.pixels().iter().map(of).collect()
}

/// Share of the pixels that do not exceed each value.
fn ranks(image: &Image<u8>, channel: usize) -> [f64; 256] {
    let mut counts = [0_u64; 256];
    image.pixels().iter().for_each(|pixel| counts[usize::from(pixel[channel])] += 1);
    let mut seen = 0;
    counts.map(|count| {
        seen += count;
        seen as f64 / image.pixels().len() as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_given_its_own_colours_is_itself() {
        let samples = (0..300).map(|i| (20 + i * 37 % 200) as u8).collect();
        let image = Image::<u8>::from_raw(10, 10, samples).unwrap();
        for (name, rival) in RIVALS {
            for (out, pixel) in rival(&image, &image).iter().zip(image.pixels()) {
                for c in 0..3 {
                    assert!((out[c] - f32::from(pixel[c]) / 255.0).abs() < 0.01, "{name}");
                }
            }
        }
    }

    #[test]
    fn a_picture_takes_on_the_reference_and_not_the_other_way() {
        let make = |low: usize, step: usize| {
            let samples = (0..300).map(|i| (low + i * step % 90) as u8).collect();
            Image::<u8>::from_raw(10, 10, samples).unwrap()
        };
        let (content, reference) = (make(20, 37), make(140, 53));
        let mean =
            |values: &[[f32; 3]], c: usize| values.iter().map(|v| v[c]).sum::<f32>() / values.len() as f32;
        let wanted: Vec<_> = reference.pixels().iter().map(|p| p.map(|v| f32::from(v) / 255.0)).collect();
        for (name, rival) in RIVALS {
            let out = rival(&content, &reference);
            for c in 0..3 {
                assert!((mean(&out, c) - mean(&wanted, c)).abs() < 0.02, "{name}");
            }
        }
    }
}
