//! How much of the true change each way of fusing makes.
//!
//! Share = 1 - RMSE(out, truth) / RMSE(content, truth) over all pixels and channels, before clipping: 1 is the
//! truth, 0 the content. Truth A is the content's place with nothing exchanged but B∞; truth B is the same place
//! wholly in the other water.

use aquafuse::depth::{DepthMap, DepthModel};
use aquafuse::fusion::{Bounded, Incidence, Law, Model, Options, Waters};
use aquafuse::image::{Encoding, SizeError};
use aquafuse::waterbody::{BackscatterMethod, Estimate, EstimateOptions, VeilingLightMethod, estimate};

use crate::exchange::Exchange;
use crate::rivals::RIVALS;
use crate::scenes::Case;
use crate::statistics::{mean, median, share};

const EXCHANGES: usize = 120;

/// How depth is come by, and whose estimators tell the water; no estimators: the truth is given.
struct Way {
    name: &'static str,
    depth: Option<DepthModel>,
    water: Option<EstimateOptions>,
}

impl Way {
    /// The paper has no verdict, and so no bound.
    fn is_papers(&self) -> bool {
        self.water.is_some_and(|options| options.backscatter == BackscatterMethod::Published)
    }
}

fn ways() -> Vec<Way> {
    let ours = Some(EstimateOptions::default());
    let papers = Some(EstimateOptions {
        veiling_light: VeilingLightMethod::Published,
        backscatter: BackscatterMethod::Published,
        ..Default::default()
    });
    let eq3 = Some(DepthModel::default());
    let ratio = Some(DepthModel::Ratio);
    let way = |name, depth, water| Way { name, depth, water };
    vec![
        way("everything given: the ceiling", None, None),
        way("z given, water ours", None, ours),
        way("z given, water the paper's way", None, papers),
        way("z by `eq3`, water ours", eq3, ours),
        way("z by `eq3`, water the paper's way", eq3, papers),
        way("z by `ratio`, water ours", ratio, ours),
        way("z by `ratio`, water the paper's way", ratio, papers),
    ]
}

/// Prints the table for one encoding.
pub(crate) fn print<E: Encoding>() -> Result<(), SizeError> {
    println!(
        "| way | model | truth A, mean | median | worse than the content | open water in both | truth B, mean | median |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let cases: Vec<Exchange<E>> = (0..EXCHANGES).map(Exchange::new).collect();
    for way in ways() {
        let all = cases.iter().map(|case| case.by(&way)).collect::<Result<Vec<_>, _>>()?;
        for (m, model) in Model::ALL.into_iter().enumerate() {
            let of_model: Vec<[f32; 2]> = all.iter().map(|shares| shares[m]).collect();
            row(way.name, &format!("`{}`", model.name()), &cases, &of_model);
        }
    }
    for (name, rival) in RIVALS {
        let shares: Vec<[f32; 2]> = cases
            .iter()
            .map(|case| {
                let out = rival(&case.content.image, &case.reference.image);
                case.shares(|i, _| out[i].map(E::from_encoded))
            })
            .collect();
        row(name, "", &cases, &shares);
    }
    Ok(())
}

fn row<E: Encoding>(way: &str, model: &str, cases: &[Exchange<E>], shares: &[[f32; 2]]) {
    let of = |truth: usize| shares.iter().map(|share| share[truth]).collect::<Vec<f32>>();
    let (a, b) = (of(0), of(1));
    let open: Vec<f32> =
        cases.iter().zip(&a).filter(|(case, _)| case.open()).map(|(_, share)| *share).collect();
    println!(
        "| {way} | {model} | {:.2} | {:.2} | {:.0} % | {:.2} | {:.2} | {:.2} |",
        mean(&a),
        median(&a),
        100.0 * share(&a, |share| *share < 0.0),
        mean(&open),
        mean(&b),
        median(&b),
    );
}

impl<E: Encoding> Exchange<E> {
    /// Shares of both truths by each model.
    fn by(&self, way: &Way) -> Result<Vec<[f32; 2]>, SizeError> {
        let z = self.depth(&self.content, way);
        let (own, other) = (self.water(&self.content, way)?, self.water(&self.reference, way)?);
        let shares = Model::ALL.map(|model| {
            let incidence = Incidence::from_degrees(0.0).expect("in range");
            let options = Options { incidence, ..Options::for_model(model) };
            match (&own, &other) {
                (Some(own), Some(other)) if way.is_papers() => {
                    let waters = Waters { content: &own.water, reference: &other.water };
                    self.of_law(&z, &Law::new(waters, &options))
                }
                (Some(own), Some(other)) => {
                    let bounded = Bounded::new(own, other, options);
                    self.of_law(&z, &Law::new(bounded.waters(), &bounded.options))
                }
                _ => {
                    let waters = Waters { content: &self.content.water, reference: &self.reference.water };
                    self.of_law(&z, &Law::new(waters, &options))
                }
            }
        });
        Ok(shares.to_vec())
    }

    fn depth(&self, case: &Case<E>, way: &Way) -> DepthMap {
        way.depth.map_or_else(|| case.depth.clone(), |model| model.estimate(&case.image))
    }

    /// The estimate of a case's water; none where the truth is given.
    fn water(&self, case: &Case<E>, way: &Way) -> Result<Option<Estimate<E>>, SizeError> {
        way.water.map(|options| estimate(&case.image, &self.depth(case, way), &options)).transpose()
    }

    fn of_law(&self, z: &DepthMap, law: &Law<E>) -> [f32; 2] {
        let distances = z.distances();
        self.shares(|i, pixel| law.at(distances[i]).of(pixel))
    }

    /// Shares of what `fused` makes of each pixel.
    fn shares(&self, fused: impl Fn(usize, [f32; 3]) -> [f32; 3]) -> [f32; 2] {
        let (mut out, mut before) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (i, bytes) in self.content.image.pixels().iter().enumerate() {
            let pixel = bytes.map(|value| E::from_encoded(f32::from(value) / 255.0));
            let made = fused(i, pixel);
            for (t, truth) in self.truths.iter().enumerate() {
                for c in 0..3 {
                    let truth = truth.pixels()[i][c];
                    out[t] += f64::from(made[c] - truth).powi(2);
                    before[t] += f64::from(pixel[c] - truth).powi(2);
                }
            }
        }
        std::array::from_fn(|t| 1.0 - (out[t] / before[t]).sqrt() as f32)
    }
}
