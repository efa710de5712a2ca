//! How depth and water are obtained, and how near each way comes to the truth.

use aquafuse::depth::{DepthMap, DepthModel};
use aquafuse::fusion::{Bounded, Incidence, Model, Options, TransferLaw, Waters};
use aquafuse::image::{Encoding, Image};
use aquafuse::metrics::ssim;
use aquafuse::truth::{Case, Exchange, LitCase, LitExchange};
#[cfg(feature = "network")]
use aquafuse::waterbody::WaterMap;
use aquafuse::waterbody::{
    BackscatterMethod, Estimate, EstimateOptions, WaterShare, Waterbody, estimate_with_share,
};

/// What is fused, and the truths of it.
pub(super) struct Pair<'a, E: Encoding> {
    content: Given<'a, E>,
    reference: Given<'a, E>,
    truths: Vec<&'a Image<f32, E>>,
}

/// An image and what is known of it.
struct Given<'a, E: Encoding> {
    image: &'a Image<u8>,
    depth: &'a DepthMap,
    /// None where no numbers of this encoding describe it.
    water: Option<&'a Waterbody<E>>,
}

impl<'a, E: Encoding> Pair<'a, E> {
    pub(super) fn new(exchange: &'a Exchange<E>) -> Self {
        let of =
            |case: &'a Case<E>| Given { image: &case.image, depth: &case.depth, water: Some(&case.water) };
        let (content, reference) = (of(&exchange.content), of(&exchange.reference));
        Self { content, reference, truths: exchange.truths.iter().collect() }
    }

    /// The same for an exchange of water and light, whose truth is given in the encoding.
    pub(super) fn lit(exchange: &'a LitExchange, truth: &'a Image<f32, E>) -> Self {
        let of = |case: &'a LitCase| Given { image: &case.image, depth: &case.depth, water: None };
        let (content, reference) = (of(&exchange.content), of(&exchange.reference));
        Self { content, reference, truths: vec![truth] }
    }

    /// The truths.
    pub(super) fn truths(&self) -> &[&'a Image<f32, E>] {
        &self.truths
    }

    /// Content and reference as images.
    pub(super) fn images(&self) -> [&'a Image<u8>; 2] {
        [self.content.image, self.reference.image]
    }
}

/// How depth is obtained, and whose estimators the water is from; no estimators: the truth is known.
pub(super) struct Way {
    pub(super) name: &'static str,
    depth: Option<DepthModel>,
    water: Option<EstimateOptions>,
}

/// All ways.
pub(super) fn ways() -> Vec<Way> {
    let ours = Some(EstimateOptions::default());
    #[cfg(feature = "network")]
    let both = ours.map(|ours| ours.with_water_map(WaterMap::Both));
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
        #[cfg(feature = "network")]
        way("z given, water by `both`", None, both),
        #[cfg(feature = "network")]
        way("z by `eq3`, water by `both`", eq3, both),
        #[cfg(feature = "network")]
        way("z by `network`, water by `both`", Some(DepthModel::Network), both),
    ]
}

impl Way {
    /// Whether the water is estimated.
    pub(super) fn estimates(&self) -> bool {
        self.water.is_some()
    }

    /// The paper has no verdict, and so no bound.
    fn is_papers(&self) -> bool {
        self.water.is_some_and(|options| options.backscatter == BackscatterMethod::Published)
    }

    /// What each model makes of an exchange, at full strength.
    pub(super) fn all_models<E: Encoding>(&self, pair: &Pair<'_, E>) -> Vec<Found> {
        let z = self.depth(&pair.content);
        let (own, other) = (self.water(&pair.content), self.water(&pair.reference));
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
                    let water = |given: &Given<'_, E>| *given.water.expect("the way of a known water");
                    let (content, reference) = (water(&pair.content), water(&pair.reference));
                    TransferLaw::new(Waters::new(&content, &reference), &options)
                }
            };
            let distances = z.distances();
            let width = z.width();
            Found::of(pair, |i, pixel| {
                let things = law.at(distances[i]);
                let reads_share = *model != Model::Aquafuse;
                let w =
                    if reads_share { share.at(i % width, i / width, pixel.map(E::to_encoded)) } else { 0.0 };
                law.in_share(things, w).of(pixel)
            })
        };
        Model::ALL.iter().map(of).collect()
    }

    fn depth<E: Encoding>(&self, given: &Given<'_, E>) -> DepthMap {
        self.depth.map_or_else(|| given.depth.clone(), |model| model.estimate(given.image))
    }

    /// The estimate of an image's water; none where the truth is known.
    fn water<E: Encoding>(&self, given: &Given<'_, E>) -> Option<(Estimate<E>, WaterShare)> {
        let estimated = |options| {
            estimate_with_share(given.image, &self.depth(given), &options).expect("a map of this image")
        };
        self.water.map(estimated)
    }
}

/// A result beside the truths and its content, truth by truth.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Share of the true change.
    pub(super) share: Vec<f64>,
    /// To the truth, in steps of 255, in the encoding of the exchange.
    pub(super) rmse: Vec<f64>,
    /// SSIM with the content, as a camera would store both.
    pub(super) structure: f64,
}

impl Found {
    /// Compares what `fused` makes of each pixel, by its place and colour, before clipping.
    pub(super) fn of<E: Encoding>(pair: &Pair<'_, E>, fused: impl Fn(usize, [f32; 3]) -> [f32; 3]) -> Self {
        let content = pair.content.image;
        let mut after = vec![0.0_f64; pair.truths.len()];
        let mut before = after.clone();
        let mut shown = Vec::with_capacity(content.as_raw().len());
        for (i, bytes) in content.pixels().iter().enumerate() {
            let pixel = bytes.map(|value| E::from_encoded(f32::from(value) / 255.0));
            let made = fused(i, pixel);
            shown.extend(made.map(|value| E::to_encoded(value.max(0.0))));
            for (truth, (after, before)) in pair.truths.iter().zip(after.iter_mut().zip(&mut before)) {
                for c in 0..3 {
                    let truth = truth.pixels()[i][c];
                    *after += f64::from(made[c] - truth).powi(2);
                    *before += f64::from(pixel[c] - truth).powi(2);
                }
            }
        }
        let values = content.as_raw().len() as f64;
        let (width, height) = content.size();
        let shown = Image::<f32>::from_raw(width, height, shown).expect("a colour for each pixel");
        let structure = ssim(content, &shown.convert::<u8>()).expect("of one size");
        Self {
            share: after.iter().zip(&before).map(|(after, before)| 1.0 - (after / before).sqrt()).collect(),
            rmse: after.iter().map(|sum| 255.0 * (sum / values).sqrt()).collect(),
            structure: structure.expect("scenes are larger than the window"),
        }
    }
}
