//! The search for the exponents, with all that is linear eliminated.

use super::cells::{Cell, LabelledImage};
use super::terms::{Table, Terms, bounded};
use super::{Options, Scale, Start, Target};

/// Where searches begin: μ2 by μ4.
const STARTS: [[f64; 2]; 6] =
    [[-8.0, -3.0], [-8.0, -0.5], [-3.0, -3.0], [-3.0, 1.0], [-0.5, -0.5], [1.0, -3.0]];
/// Steps of the search along an exponent, from first to last; the last is the precision of the result.
const STEPS: [f64; 9] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01];
/// Rounds of Huber's weights, at most; they hardly change after five.
const ROUNDS: usize = 10;

/// Deviation of numbers spread evenly over `[0, 1]`: 1 / sqrt(12).
const SPREAD_OF_RANKS: f64 = 0.288_675;

/// Labels of all images, ready to be fitted to.
pub(super) struct Search {
    points: Vec<Point>,
    /// Ends in `points` of those that share scale and shift.
    groups: Vec<usize>,
    huber: f64,
    images: f64,
}

/// A cell with its label in units of the labels' spread.
struct Point {
    red: f32,
    max: f32,
    z: f64,
    /// Share of its image, times the weight of that.
    share: f64,
}

/// The best model for given exponents and weights.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) terms: Terms,
    /// Huber's loss, mean over images.
    pub(super) loss: f64,
    /// No group's labels rise with the model.
    pub(super) explains_nothing: bool,
}

impl Search {
    pub(super) fn new(images: &[LabelledImage], options: &Options) -> Self {
        // Sums depend on their order in the last bit, and the result must not depend on the order of adding.
        let mut ordered: Vec<&LabelledImage> = images.iter().collect();
        ordered.sort_by(|a, b| a.canonical_order(b));
        let common = ordered.iter().map(|image| image.spread).sum::<f64>() / ordered.len() as f64;
        let label = |image: &LabelledImage, cell: &Cell| match (options.target, options.scale) {
            (Target::Distances, Scale::PerImage) => f64::from(cell.z) / image.spread,
            (Target::Distances, Scale::Shared) => f64::from(cell.z) / common,
            (Target::Order, _) => f64::from(cell.rank) / (SPREAD_OF_RANKS * image.count),
        };
        let (mut points, mut groups) = (Vec::new(), Vec::new());
        for image in &ordered {
            points.extend(image.cells.iter().map(|cell| Point {
                red: cell.red,
                max: cell.max,
                z: label(image, cell),
                share: image.weight * f64::from(cell.count) / image.count,
            }));
            groups.push(points.len());
        }
        if options.scale == Scale::Shared {
            groups = vec![points.len()];
        }
        Self { points, groups, huber: options.huber, images: ordered.iter().map(|image| image.weight).sum() }
    }

    /// Searches from every start; the best, and all in order of their loss.
    pub(super) fn run(&self) -> (Found, Vec<Start>) {
        let mut searches: Vec<(Found, Start)> = STARTS.iter().map(|&from| self.from(from)).collect();
        searches.sort_by(|a, b| a.1.loss.total_cmp(&b.1.loss));
        let starts = searches.iter().map(|(_, start)| *start).collect();
        (searches.swap_remove(0).0, starts)
    }

    /// Whether labels inverted would be explained better than they are.
    pub(super) fn would_rather_be_turned_round(mut self, found: &Found) -> bool {
        self.points.iter_mut().for_each(|point| point.z = -point.z);
        let searches = [STARTS[0], found.terms.exponents].map(|from| self.from(from).0);
        searches.iter().any(|turned| !turned.explains_nothing && turned.loss < found.loss)
    }

    fn from(&self, from: [f64; 2]) -> (Found, Start) {
        let mut weights: Vec<f64> = self.points.iter().map(|point| point.share).collect();
        let mut exponents = from;
        let mut first_step = 0;
        for _ in 0..ROUNDS {
            let before = exponents;
            exponents = self.descend(exponents, &STEPS[first_step..], &weights);
            weights = self.reweighted(exponents, &weights).0;
            let moved = (0..2).map(|i| (exponents[i] - before[i]).abs()).fold(0.0, f64::max);
            if first_step > 0 && moved < STEPS[STEPS.len() - 1] {
                break;
            }
            // Weights move the minimum a little; the wide steps are for finding it.
            first_step = 3;
        }
        let (_, found) = self.reweighted(exponents, &weights);
        let start = Start { from, reached: found.terms.exponents, loss: found.loss };
        (found, start)
    }

    /// Compass search: the better neighbour along either exponent, until there is none at the last step.
    fn descend(&self, from: [f64; 2], steps: &[f64], weights: &[f64]) -> [f64; 2] {
        let loss = |at: [f64; 2]| self.eliminate(at, weights).loss;
        let mut best = (from.map(bounded), loss(from));
        for &step in steps {
            loop {
                let neighbours = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
                let better = neighbours
                    .map(|[a, b]| [bounded(best.0[0] + a), bounded(best.0[1] + b)])
                    .into_iter()
                    .filter(|&at| at != best.0)
                    .map(|at| (at, loss(at)))
                    .min_by(|a, b| a.1.total_cmp(&b.1))
                    .filter(|next| next.1 < best.1);
                match better {
                    Some(next) => best = next,
                    None => break,
                }
            }
        }
        best.0
    }

    /// Huber's weights of the residuals that the best model leaves, and that model with its loss.
    fn reweighted(&self, exponents: [f64; 2], weights: &[f64]) -> (Vec<f64>, Found) {
        let linear = self.eliminate(exponents, weights);
        let tables = Tables::new(exponents);
        let (mut next, mut loss) = (Vec::with_capacity(weights.len()), 0.0);
        let mut first = 0;
        for (&end, line) in self.groups.iter().zip(&linear.lines) {
            for point in &self.points[first..end] {
                let (g, h) = tables.at(point);
                let depth = linear.weight_of_red * g + (1.0 - linear.weight_of_red) * h;
                let residual = (point.z - line.scale * depth - line.shift).abs();
                let inside = residual <= self.huber;
                next.push(point.share * if inside { 1.0 } else { self.huber / residual });
                loss += point.share
                    * if inside {
                        residual * residual / 2.0
                    } else {
                        self.huber * (residual - self.huber / 2.0)
                    };
            }
            first = end;
        }
        let terms = Terms { weight_of_red: linear.weight_of_red, exponents: exponents.map(bounded) };
        let explains_nothing = linear.lines.iter().all(|line| line.scale <= 0.0);
        (next, Found { terms, loss: loss / self.images, explains_nothing })
    }

    /// The best w, scales and shifts for given exponents and weights.
    fn eliminate(&self, exponents: [f64; 2], weights: &[f64]) -> Linear {
        let tables = Tables::new(exponents);
        let mut moments = Vec::with_capacity(self.groups.len());
        let mut first = 0;
        for &end in &self.groups {
            moments.push(Moments::of(&self.points[first..end], &weights[first..end], &tables));
            first = end;
        }
        let loss = |w: f64| moments.iter().map(|moments| moments.loss(w)).sum::<f64>();
        let weight_of_red = least(&loss);
        Linear {
            weight_of_red,
            loss: loss(weight_of_red),
            lines: moments.iter().map(|moments| moments.line(weight_of_red)).collect(),
        }
    }
}

/// What is linear, at its best.
struct Linear {
    weight_of_red: f64,
    /// Weighted sum of squares.
    loss: f64,
    /// Of each group.
    lines: Vec<Line>,
}

/// Labels as a line in depth: scale * d + shift.
struct Line {
    scale: f64,
    shift: f64,
}

struct Tables {
    of_red: Table,
    of_max: Table,
}

impl Tables {
    fn new(exponents: [f64; 2]) -> Self {
        let [mu2, mu4] = exponents.map(bounded);
        Self { of_red: Table::falling(mu2), of_max: Table::rising(mu4) }
    }

    fn at(&self, point: &Point) -> (f64, f64) {
        (f64::from(self.of_red.at(point.red)), f64::from(self.of_max.at(point.max)))
    }
}

/// Weighted means and (co)variances of g, h and z over a group; what a model of it needs.
struct Moments {
    total: f64,
    mean: [f64; 3],
    /// gg, gh, hh, gz, hz, zz.
    co: [f64; 6],
}

impl Moments {
    fn of(points: &[Point], weights: &[f64], tables: &Tables) -> Self {
        let (mut total, mut sum, mut co) = (0.0, [0.0; 3], [0.0; 6]);
        // Labels far from 0 would lose their variance to rounding.
        let origin = points.first().map_or(0.0, |point| point.z);
        for (point, &weight) in points.iter().zip(weights) {
            let (g, h) = tables.at(point);
            let z = point.z - origin;
            total += weight;
            for (sum, value) in sum.iter_mut().zip([g, h, z]) {
                *sum += weight * value;
            }
            for (co, product) in co.iter_mut().zip([g * g, g * h, h * h, g * z, h * z, z * z]) {
                *co += weight * product;
            }
        }
        // A group of no weight has no means; any will do.
        let total = if total > 0.0 { total } else { 1.0 };
        let [g, h, z] = sum.map(|sum| sum / total);
        let products = [g * g, g * h, h * h, g * z, h * z, z * z];
        let co = std::array::from_fn(|i| co[i] / total - products[i]);
        Self { total, mean: [g, h, z + origin], co }
    }

    /// Variance of depth, and its covariance with the labels.
    fn of_depth(&self, w: f64) -> (f64, f64) {
        let [gg, gh, hh, gz, hz, _] = self.co;
        let v = 1.0 - w;
        (w * w * gg + 2.0 * w * v * gh + v * v * hh, w * gz + v * hz)
    }

    fn scale(&self, w: f64) -> f64 {
        let (variance, covariance) = self.of_depth(w);
        // An image of one colour says nothing, and depth must not fall as labels rise.
        if variance > 1e-12 { (covariance / variance).max(0.0) } else { 0.0 }
    }

    fn loss(&self, w: f64) -> f64 {
        let (_, covariance) = self.of_depth(w);
        self.total * (self.co[5] - self.scale(w) * covariance)
    }

    fn line(&self, w: f64) -> Line {
        let (scale, [g, h, z]) = (self.scale(w), self.mean);
        Line { scale, shift: z - scale * (w * g + (1.0 - w) * h) }
    }
}

/// Where in `[0, 1]` a function is least: the best of even places, then golden sections around it.
fn least(of: &impl Fn(f64) -> f64) -> f64 {
    const PLACES: usize = 20;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let place = |i: usize| i as f64 / PLACES as f64;
    let best = (0..=PLACES).min_by(|&a, &b| of(place(a)).total_cmp(&of(place(b)))).unwrap_or_default();
    let (mut low, mut high) = (place(best.saturating_sub(1)), place((best + 1).min(PLACES)));
    while high - low > 1e-6 {
        let (left, right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if of(left) <= of(right) { high = right } else { low = left }
    }
    // The ends are values of their own: a term without weight.
    [0.0, 1.0, (low + high) / 2.0].into_iter().min_by(|&a, &b| of(a).total_cmp(&of(b))).unwrap_or_default()
}
