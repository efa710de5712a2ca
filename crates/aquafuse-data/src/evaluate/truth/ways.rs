//! How depth and water are obtained, and how near each way comes to the truth.

use aquafuse::depth::{DepthMap, DepthModel};
use aquafuse::fusion::{Bounded, Incidence, Model, Options, TransferLaw, Waters};
use aquafuse::image::{Encoding, Image};
use aquafuse::metrics::ssim;
use aquafuse::truth::{Case, Exchange};
use aquafuse::waterbody::{BackscatterMethod, Estimate, EstimateOptions, WaterShare, estimate_with_share};

/// How depth is obtained, and whose estimators give the water; no estimators: the truth is given.
pub(super) struct Way {
    pub(super) name: &'static str,
    depth: Option<DepthModel>,
    water: Option<EstimateOptions>,
}

pub(super) fn ways() -> Vec<Way> {
    let ours = Some(EstimateOptions::default());
    let papers = Some(EstimateOptions::as_published());
    let eq3 = Some(DepthModel::default());
    let published = Some(DepthModel::Eq3Median);
    let ratio = Some(DepthModel::Ratio);
    let way = |name, depth, water| Way { name, depth, water };
    vec![
        way("everything given: the ceiling", None, None),
        way("z given, water ours", None, ours),
        way("z given, water the paper's way", None, papers),
        way("z by `eq3`, water ours", eq3, ours),
        way("z by `eq3-median`, water the paper's way", published, papers),
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
        let share = own.as_ref().map_or_else(|| WaterShare::none(z.size()), |(_, share)| share.clone());
        let [own, other] = [own, other].map(|found| found.map(|(estimate, _)| estimate));
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
            let width = z.width();
            Found::of(exchange, |i, pixel| {
                let things = law.at(distances[i]);
                let reads_share = *model != Model::Aquafuse;
                let w =
                    if reads_share { share.at(i % width, i / width, pixel.map(E::to_encoded)) } else { 0.0 };
                law.in_share(things, w).of(pixel)
            })
        };
        Model::ALL.iter().map(of).collect()
    }

    fn depth<E: Encoding>(&self, case: &Case<E>) -> DepthMap {
        self.depth.map_or_else(|| case.depth.clone(), |model| model.estimate(&case.image))
    }

    /// The estimate of a case's water; none where the truth is given.
    fn water<E: Encoding>(&self, case: &Case<E>) -> Option<(Estimate<E>, WaterShare)> {
        let estimated = |options| {
            estimate_with_share(&case.image, &self.depth(case), &options).expect("a map of this image")
        };
        self.water.map(estimated)
    }
}

/// A result beside the truths and its content; the first of two is about truth A, the second about truth B.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Share of the true change.
    pub(super) share: [f64; 2],
    /// To the truth, in steps of 255, in the encoding of the exchange.
    pub(super) rmse: [f64; 2],
    /// SSIM with the content, as a camera would store both.
    pub(super) structure: f64,
}

impl Found {
    /// Compares what `fused` makes of each pixel, by its place and colour, before clipping.
    pub(super) fn of<E: Encoding>(
        exchange: &Exchange<E>,
        fused: impl Fn(usize, [f32; 3]) -> [f32; 3],
    ) -> Self {
        let content = &exchange.content.image;
        let (mut after, mut before) = ([0.0_f64; 2], [0.0_f64; 2]);
        let mut shown = Vec::with_capacity(content.as_raw().len());
        for (i, bytes) in content.pixels().iter().enumerate() {
            let pixel = bytes.map(|value| E::from_encoded(f32::from(value) / 255.0));
            let made = fused(i, pixel);
            shown.extend(made.map(|value| E::to_encoded(value.max(0.0))));
            for (t, truth) in exchange.truths.iter().enumerate() {
                for c in 0..3 {
                    let truth = truth.pixels()[i][c];
                    after[t] += f64::from(made[c] - truth).powi(2);
                    before[t] += f64::from(pixel[c] - truth).powi(2);
                }
            }
        }
        let values = content.as_raw().len() as f64;
        let (width, height) = content.size();
        let shown = Image::<f32>::from_raw(width, height, shown).expect("a colour for each pixel");
        let structure = ssim(content, &shown.convert::<u8>()).expect("of one size");
        Self {
            share: std::array::from_fn(|t| 1.0 - (after[t] / before[t]).sqrt()),
            rmse: after.map(|sum| 255.0 * (sum / values).sqrt()),
            structure: structure.expect("scenes are larger than the window"),
        }
    }
}
