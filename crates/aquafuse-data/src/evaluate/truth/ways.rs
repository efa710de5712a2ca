//! How depth and water are come by.

use aquafuse::depth::{DepthMap, DepthModel};
use aquafuse::fusion::{Bounded, Incidence, Model, Options, TransferLaw, Waters};
use aquafuse::image::Encoding;
use aquafuse::truth::{Case, Exchange};
use aquafuse::waterbody::{BackscatterMethod, Estimate, EstimateOptions, estimate};

use super::compare::Found;

/// How depth is come by, and whose estimators tell the water; no estimators: the truth is given.
pub(super) struct Way {
    pub(super) name: &'static str,
    depth: Option<DepthModel>,
    water: Option<EstimateOptions>,
}

pub(super) fn ways() -> Vec<Way> {
    let ours = Some(EstimateOptions::default());
    let papers = Some(EstimateOptions::as_published());
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

impl Way {
    /// The paper has no verdict, and so no bound.
    fn is_papers(&self) -> bool {
        self.water.is_some_and(|options| options.backscatter == BackscatterMethod::Published)
    }

    /// What each model makes of an exchange, at full strength.
    pub(super) fn all_models<E: Encoding>(&self, exchange: &Exchange<E>) -> Vec<Found> {
        let z = self.depth(&exchange.content);
        let (own, other) = (self.water(&exchange.content), self.water(&exchange.reference));
        let of = |model: &Model| {
            let incidence = Incidence::from_degrees(0.0).expect("in range");
            let options = Options::for_model(*model).with_incidence(incidence);
            let law = match (&own, &other) {
                (Some(own), Some(other)) if self.is_papers() => {
                    TransferLaw::new(Waters::new(&own.water, &other.water), &options)
                }
                (Some(own), Some(other)) => {
                    let bounded = Bounded::new(own, other, options);
                    TransferLaw::new(bounded.waters(), &bounded.options)
                }
                _ => {
                    let (content, reference) = (&exchange.content.water, &exchange.reference.water);
                    TransferLaw::new(Waters::new(content, reference), &options)
                }
            };
            let distances = z.distances();
            Found::of(exchange, |i, pixel| law.at(distances[i]).of(pixel))
        };
        Model::ALL.iter().map(of).collect()
    }

    fn depth<E: Encoding>(&self, case: &Case<E>) -> DepthMap {
        self.depth.map_or_else(|| case.depth.clone(), |model| model.estimate(&case.image))
    }

    /// The estimate of a case's water; none where the truth is given.
    fn water<E: Encoding>(&self, case: &Case<E>) -> Option<Estimate<E>> {
        let told = |options| estimate(&case.image, &self.depth(case), &options).expect("a map of this image");
        self.water.map(told)
    }
}
