//! What keeps a doubtful estimate from painting what is not there.

use super::{Model, Options, Waters, light};
use crate::image::Encoding;
use crate::waterbody::{
    DepthFactors, Estimate, Reason, VeilingLight, VeilingLightSource, Verdict, Waterbody,
};

/// Brightest channel (encoded) of a veil that is taken from glare: as bright as water in the sun. On lit truth scenes .7 held the
/// bright grey veils of turbid water back, and no limit at all made as much of the true change as this one.
const BRIGHTEST_WATER: f32 = 0.85;

/// A content's veil whose brightest channel (encoded) is as bright as the second of these is exchanged; one as faint as the first
/// is the black of night, where colour says nothing of distance.
const NIGHT: [f32; 2] = [0.05, 0.14];

/// Waters and options of a fusion after the safety bounds, and which of these acted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct Bounded<E: Encoding> {
    content: Waterbody<E>,
    reference: Waterbody<E>,
    depth_factors: Option<DepthFactors>,
    light_gain: [f32; 3],
    haze: [f32; 3],
    /// The options to fuse with.
    pub options: Options,
    /// Which bounds acted.
    pub bounds: Bounds,
}

/// Gain of the direct signal that a doubtful estimate with supplied depth may ask for.
const DOUBTFUL_GAIN: f32 = 2.0;

/// Which safety bounds acted on a fusion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Bounds {
    /// The reference's veil may be glare: it was darkened to the brightest water, or its red to its green or blue.
    pub glare: bool,
    /// The content is doubtful and its red faded into the veil faster than the others: it was held to them, in β_B or, where F
    /// is a table, there.
    pub red: bool,
    /// One of the two is doubtful: exchange strengthens the direct signal less than asked for, or leaves it as it is.
    pub gain: bool,
    /// The content's own veil is nearly black and its depth is from colour: of its water less is exchanged, or nothing.
    pub night: bool,
}

impl Bounds {
    /// Whether any acted.
    pub fn any(self) -> bool {
        self.glare || self.red || self.gain || self.night
    }
}

impl<E: Encoding> Bounded<E> {
    /// Bounds a fusion by what its two estimates are worth.
    ///
    /// [`Model::Aquafuse`] needs no bound: it adds a quarter of the difference of the veils at most. Of the
    /// others, with an estimate that is not good:
    ///
    /// - a reference whose light has no colour of water gives no brighter veil than water in the sun, and no more red than green or
    ///   blue, unless open water was seen in it or a supplied map says what is farthest: that water is brown;
    /// - red of a doubtful content fades no faster into the veil than green or blue: a dead red channel with a
    ///   huge β_B would otherwise turn near things red;
    /// - exchange strengthens the direct signal to its double at most; with depth from colour it leaves it as it
    ///   is and exchanges the backscatter alone: β_D is the most fragile of the estimates, and tints near things.
    ///
    /// Whatever the verdict, with depth from colour: of a veil that is nearly black less is exchanged the darker it is, for what
    /// colour says of distance there is noise.
    ///
    /// One's own water is not glare to itself: fused with its own estimate, an image is still itself.
    pub fn new(content: &Estimate<E>, reference: &Estimate<E>, options: Options) -> Self {
        let mut bounded = Self {
            content: content.water,
            reference: reference.water,
            depth_factors: content.depth_factors.filter(|_| options.model.reads_depth_factors()),
            light_gain: [1.0; 3],
            haze: [1.0; 3],
            options,
            bounds: Bounds::default(),
        };
        if options.model == Model::Aquafuse || content.water == reference.water {
            return bounded;
        }
        if options.model == Model::Relight {
            bounded.change_light(content, reference);
        }
        if reference.quality.reasons.contains(Reason::LightOutsideWaterHues) {
            let is_water = reference.veiling_light_source == VeilingLightSource::OpenWater;
            bounded.hold_glare(is_water || reference.depth_model.is_none());
        }
        if content.quality.verdict != Verdict::Good {
            bounded.hold_red();
        }
        if content.depth_model.is_some() {
            bounded.hold_night();
        }
        let both = [content, reference];
        if options.model == Model::Exchange && both.iter().any(|one| one.quality.verdict != Verdict::Good) {
            bounded.hold_gain(both.iter().any(|one| one.depth_model.is_some()));
        }
        bounded
    }

    /// The waters to fuse with.
    pub fn waters(&self) -> Waters<'_, E> {
        let waters = Waters::new(&self.content, &self.reference).with_light_gain(self.light_gain);
        waters.with_haze(self.haze).with_depth_factors(self.depth_factors.as_ref())
    }

    /// Haze is compared where both waters are per one unit of z: of supplied depth, or of a water that is known per metre. Depth from
    /// colour has no unit; there the scale of relative depth says how far a known water hides.
    fn change_light(&mut self, content: &Estimate<E>, reference: &Estimate<E>) {
        if let (Some(own), Some(other)) = (content.near_colour, reference.near_colour) {
            self.light_gain = light::gain::<E>(own, other);
        }
        let is_given = reference.veiling_light_source == VeilingLightSource::Given;
        if is_given || (content.depth_model.is_none() && reference.depth_model.is_none()) {
            let [own, other] = [content, reference].map(|one| one.water.backscatter_coefficient);
            self.haze = [light::haze(own, other); 3];
        }
    }

    /// Water that was seen, or that lies farthest by a supplied map, may be brown.
    fn hold_glare(&mut self, may_be_brown: bool) {
        let [red, green, blue] = self.reference.veiling_light.rgb().map(E::to_encoded);
        let others = green.max(blue);
        let held = [if may_be_brown { red } else { red.min(others) }, green, blue];
        let largest = held[0].max(others);
        let scale = if largest > 0.0 { (BRIGHTEST_WATER / largest).min(1.0) } else { 1.0 };
        let held = VeilingLight::new(held.map(|value| E::from_encoded(value * scale)));
        self.bounds.glare = held != self.reference.veiling_light;
        self.reference.veiling_light = held;
    }

    /// F comes nearer to 1, and so does the gain of the light: things and black water stay as they are.
    fn hold_night(&mut self) {
        let brightest = self.content.veiling_light.rgb().map(E::to_encoded).into_iter().fold(0.0, f32::max);
        let seen = ((brightest - NIGHT[0]) / (NIGHT[1] - NIGHT[0])).clamp(0.0, 1.0);
        if seen < 1.0 {
            let coefficient = self.content.backscatter_coefficient.map(|coefficient| seen * coefficient);
            self.content.backscatter_coefficient = coefficient;
            self.depth_factors = self.depth_factors.map(|factors| factors.faded(seen));
            self.light_gain = self.light_gain.map(|gain| 1.0 + seen * (gain - 1.0));
            self.bounds.night = true;
        }
    }

    fn hold_gain(&mut self, from_colour: bool) {
        if from_colour {
            // Equal attenuation in both waters is a gain of exactly 1.
            self.reference.attenuation = self.content.attenuation;
            self.bounds.gain = true;
        } else {
            let held = self.options.max_gain.min(DOUBTFUL_GAIN);
            self.bounds.gain = held < self.options.max_gain;
            self.options.max_gain = held;
        }
    }

    fn hold_red(&mut self) {
        if let Some(factors) = &mut self.depth_factors {
            self.bounds.red = factors.hold_red();
            return;
        }
        let [red, green, blue] = &mut self.content.backscatter_coefficient;
        let others = green.max(*blue);
        if *red > others {
            *red = others;
            self.bounds.red = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::DepthModel;
    use crate::fusion::TransferLaw;
    use crate::image::Encoded;
    use crate::truth::waters;
    use crate::waterbody::{Intervals, Quality};

    fn estimate(veil: [f32; 3], coefficient: [f32; 3], quality: Quality) -> Estimate<Encoded> {
        let water = Waterbody {
            veiling_light: VeilingLight::new(veil),
            backscatter_coefficient: coefficient,
            ..waters()[0].water
        };
        Estimate {
            water,
            veiling_light_source: VeilingLightSource::OpenWater,
            veiling_light_share: 0.2,
            depth_model: None,
            depth_factors: None,
            near_colour: None,
            intervals: Intervals::default(),
            quality,
        }
    }

    const BLUE: [f32; 3] = [0.01, 0.4, 0.6];
    const GLARE: [f32; 3] = [0.95, 0.92, 0.9];
    const BROWN: [f32; 3] = [0.69, 0.57, 0.2];

    /// A light without the colour of water, that was read off things by depth from colour.
    fn of_things(light: [f32; 3]) -> Estimate<Encoded> {
        Estimate {
            veiling_light_source: VeilingLightSource::FarRegion,
            depth_model: Some(DepthModel::default()),
            ..estimate(light, [1.0; 3], Quality::default().with(Reason::LightOutsideWaterHues))
        }
    }

    #[test]
    fn water_that_was_seen_or_measured_to_be_far_may_be_brown_and_no_brighter_than_water_in_the_sun() {
        let content = estimate(BLUE, [1.0; 3], Quality::default());
        let taken = |reference: &Estimate<Encoded>| {
            let bounded = Bounded::new(&content, reference, Options::for_model(Model::Physical));
            (bounded.reference.veiling_light.rgb(), bounded.bounds.glare)
        };
        let things = of_things(BROWN);
        assert_eq!(taken(&things), ([0.57, 0.57, 0.2], true));
        let seen = Estimate { veiling_light_source: VeilingLightSource::OpenWater, ..things };
        let measured = Estimate { depth_model: None, ..things };
        assert_eq!(taken(&seen), (BROWN, false));
        assert_eq!(taken(&measured), (BROWN, false));
        let bright = VeilingLight::new(GLARE);
        let bright = Estimate { water: Waterbody { veiling_light: bright, ..seen.water }, ..seen };
        let (light, is_held) = taken(&bright);
        assert!(is_held && light.iter().all(|value| *value < 0.851), "{light:?}");
    }

    #[test]
    fn of_a_black_veil_nothing_is_exchanged_with_depth_from_colour() {
        let factors = DepthFactors::from_knots(&[(0.5, [0.4; 3]), (1.0, [0.1; 3])]);
        let other = estimate(BLUE, [1.0; 3], Quality::default());
        let most = |brightness: f32, depth_model: Option<DepthModel>| {
            let own = Estimate {
                depth_model,
                depth_factors: factors,
                ..estimate([brightness; 3], [1.0; 3], Quality::default())
            };
            let bounded = Bounded::new(&own, &other, Options::for_model(Model::Physical));
            let shift = TransferLaw::new(bounded.waters(), &bounded.options).at(1.0).offset[2];
            (bounded.bounds.night, shift)
        };
        let colour = Some(DepthModel::default());
        assert_eq!(most(0.03, colour), (true, 0.0));
        let (dim, lit) = (most(0.1, colour), most(0.14, colour));
        assert!(dim.0 && dim.1 > 0.0 && dim.1 < 0.7 * lit.1, "{dim:?} {lit:?}");
        assert!(!lit.0 && !most(0.03, None).0 && most(0.03, None).1 > 0.3, "{lit:?}");
    }

    #[test]
    fn good_estimates_are_not_bounded() {
        let (content, reference) = (
            estimate(BLUE, [9.0, 1.0, 1.0], Quality::default()),
            estimate([0.2, 0.5, 0.3], [1.0; 3], Quality::default()),
        );
        for &model in Model::ALL {
            let options = Options::for_model(model);
            let bounded = Bounded::new(&content, &reference, options);
            assert!(!bounded.bounds.any());
            assert_eq!((*bounded.waters().content, bounded.options), (content.water, options));
        }
    }

    #[test]
    fn a_dead_red_channel_and_glare_add_no_more_red_than_green_or_blue() {
        let content = estimate(BLUE, [9.0, 1.0, 1.2], Quality::default().with(Reason::DeadRed));
        let reference = of_things(GLARE);
        for model in [Model::Physical, Model::Exchange] {
            let bounded = Bounded::new(&content, &reference, Options::for_model(model));
            assert!(bounded.bounds.glare && bounded.bounds.red);
            let waters = bounded.waters();
            let [red, green, blue] = waters.reference.veiling_light.rgb();
            assert!(red <= green.max(blue) && green.max(blue) <= 0.85 + 1e-6);
            assert_eq!(waters.content.backscatter_coefficient, [1.2, 1.0, 1.2]);
            let gain = TransferLaw::new(waters, &bounded.options).at(2.0).gain;
            assert_eq!(gain, [1.0; 3], "{model:?} changes the direct signal");
            let measured = Estimate { depth_model: None, ..reference };
            let asked = Options::for_model(model).with_max_gain(8.0);
            let bounded = Bounded::new(&content, &measured, asked);
            let held = if model == Model::Exchange { (true, 2.0) } else { (false, 8.0) };
            assert_eq!((bounded.bounds.gain, bounded.options.max_gain), held);
            let gain = TransferLaw::new(bounded.waters(), &bounded.options).at(2.0).gain;
            assert!(gain.iter().all(|gain| *gain <= 2.0), "{model:?} strengthens the direct signal too much");
        }
        let paper = Bounded::new(&content, &reference, Options::for_model(Model::Aquafuse));
        assert!(!paper.bounds.any());
    }

    #[test]
    fn a_table_of_depth_factors_comes_along_and_red_of_a_doubtful_one_is_held() {
        let table = DepthFactors::from_knots(&[(0.5, [0.1, 0.8, 0.7])]);
        let content = Estimate { depth_factors: table, ..estimate(BLUE, [1.0; 3], Quality::default()) };
        let reference = estimate([0.2, 0.5, 0.3], [1.0; 3], Quality::default());
        let physical = Options::for_model(Model::Physical);
        let sure = Bounded::new(&content, &reference, physical);
        assert_eq!((sure.waters().depth_factors, sure.bounds.red), (table.as_ref(), false));
        let doubtful = Estimate { quality: Quality::default().with(Reason::DeadRed), ..content };
        let held = Bounded::new(&doubtful, &reference, physical);
        let factors = held.waters().depth_factors.map(|table| table.at(0.5));
        assert_eq!((factors, held.bounds.red), (Some([0.7, 0.8, 0.7]), true));
        // What exchange does not read is not held either.
        let exchange = Bounded::new(&doubtful, &reference, Options::for_model(Model::Exchange));
        assert_eq!((exchange.waters().depth_factors, exchange.bounds.red), (None, false));
    }

    #[test]
    fn ones_own_doubtful_water_is_not_bounded() {
        let own = estimate(GLARE, [9.0, 1.0, 1.0], Quality::default().with(Reason::LightOutsideWaterHues));
        let bounded = Bounded::new(&own, &own, Options::for_model(Model::Physical));
        assert_eq!(bounded.waters().content, bounded.waters().reference);
        assert!(!bounded.bounds.any());
    }
}
