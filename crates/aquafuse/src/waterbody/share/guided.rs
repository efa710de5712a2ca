//! A map in cells as functions of colour: He, Sun and Tang, "Guided Image Filtering" (2013), with colour as guide.

use super::super::cells::mean_around;

/// Cells to either side of which a function is fitted.
const REACH: usize = 2;
/// Variance of colours, in units of `[0, 1]`, below which they do not guide.
const FLAT: f32 = 1e-3;

/// `a · U + b`: red, green and blue of a, then b.
pub(super) type Affine = [f32; 4];

/// For each cell the affine function of colour that follows `map` around it, a mean of those of its neighbours.
pub(super) fn fit(columns: usize, colours: &[[f32; 3]], map: &[f32]) -> Vec<Affine> {
    let mean = |of: &dyn Fn(usize) -> f32| {
        mean_around(columns, REACH, &(0..map.len()).map(of).collect::<Vec<f32>>())
    };
    let of_colour = [0, 1, 2].map(|c| mean(&|i| colours[i][c]));
    let of_map = mean(&|i| map[i]);
    let products = [0, 1, 2].map(|c| mean(&|i| colours[i][c] * map[i]));
    let squares = PAIRS.map(|(a, b)| mean(&|i| colours[i][a] * colours[i][b]));
    let fits: Vec<Affine> = (0..map.len())
        .map(|i| {
            let means = of_colour.each_ref().map(|mean| mean[i]);
            let with_map = [0, 1, 2].map(|c| products[c][i] - means[c] * of_map[i]);
            let mut with_one_another = [0.0; 6];
            for (covariance, (k, (a, b))) in with_one_another.iter_mut().zip(PAIRS.into_iter().enumerate()) {
                *covariance = squares[k][i] - means[a] * means[b] + if a == b { FLAT } else { 0.0 };
            }
            let [r, g, b] = solve(with_one_another, with_map);
            [r, g, b, of_map[i] - r * means[0] - g * means[1] - b * means[2]]
        })
        .collect();
    let [r, g, b, one] = [0, 1, 2, 3].map(|k| mean(&|i| fits[i][k]));
    (0..map.len()).map(|i| [r[i], g[i], b[i], one[i]]).collect()
}

/// The entries of a symmetric matrix, in the order in which they are kept.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// x of `M x = y`, M symmetric and positive definite.
fn solve([rr, rg, rb, gg, gb, bb]: [f32; 6], [r, g, b]: [f32; 3]) -> [f32; 3] {
    // By cofactors: three unknowns need no pivots.
    let (c_rr, c_rg, c_rb) = (gg * bb - gb * gb, gb * rb - rg * bb, rg * gb - gg * rb);
    let (c_gg, c_gb, c_bb) = (rr * bb - rb * rb, rg * rb - rr * gb, rr * gg - rg * rg);
    let scale = (rr * c_rr + rg * c_rg + rb * c_rb).recip();
    [
        scale * (c_rr * r + c_rg * g + c_rb * b),
        scale * (c_rg * r + c_gg * g + c_gb * b),
        scale * (c_rb * r + c_gb * g + c_bb * b),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_solution_is_the_right_side() {
        let [x, y, z] = solve([2.0, 0.5, 0.25, 3.0, -0.5, 1.5], [1.0, -2.0, 0.5]);
        let sides = [2.0 * x + 0.5 * y + 0.25 * z, 0.5 * x + 3.0 * y - 0.5 * z, 0.25 * x - 0.5 * y + 1.5 * z];
        for (found, expected) in sides.into_iter().zip([1.0, -2.0, 0.5]) {
            assert!((found - expected).abs() < 1e-5, "{found} is not {expected}");
        }
    }

    #[test]
    fn a_map_that_is_an_edge_of_the_image_follows_it_within_a_cell() {
        // Left dark things, right bright water; the map is known in cells, and a pixel of either colour in the middle
        // cell is as its side.
        let colours: Vec<[f32; 3]> =
            (0..81).map(|i| if i % 9 < 4 { [0.1; 3] } else { [0.2, 0.5, 0.8] }).collect();
        let map: Vec<f32> = (0..81).map(|i| if i % 9 < 4 { 0.0 } else { 1.0 }).collect();
        let [r, g, b, one] = fit(9, &colours, &map)[4 * 9 + 4];
        let at = |colour: [f32; 3]| r * colour[0] + g * colour[1] + b * colour[2] + one;
        let [thing, water] = [at([0.1; 3]), at([0.2, 0.5, 0.8])];
        assert!(water > 0.95 && water - thing > 0.5, "{thing} {water}");
    }

    #[test]
    fn without_colours_to_guide_it_the_map_is_smoothed() {
        let map: Vec<f32> = (0..49).map(|i| (i % 7) as f32 / 6.0).collect();
        let [r, g, b, one] = fit(7, &[[0.5; 3]; 49], &map)[24];
        assert!((0.5 * (r + g + b) + one - 0.5).abs() < 1e-3);
    }
}
