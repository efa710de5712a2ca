//! What keeps a restoration from burning what its estimates do not know.

use super::RestoreOptions;
use crate::depth::DepthMap;
use crate::image::{Encoding, ImageError, ImageRef, Sample};
use crate::waterbody::{Estimate, VeilingLight, Waterbody};

/// Water and options of a restoration after the safety bounds, and which of these acted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct BoundedRestoration<E: Encoding> {
    /// The water to take out.
    pub water: Waterbody<E>,
    /// How far to go in each channel.
    pub options: RestoreOptions,
    /// Which bounds acted.
    pub bounds: RestoreBounds,
    /// Whether depth was read off colours.
    pub(super) depth_from_colour: bool,
}

/// Which safety bounds acted on a restoration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RestoreBounds {
    /// Less backscatter is taken off than the estimate says: more of it than there is light.
    pub backscatter: bool,
    /// Some channel is strengthened less than the estimate says: it would have burnt.
    pub gain: bool,
    /// Red is strengthened less than the estimate says: it would have led.
    pub red: bool,
}

/// Share of a channel that may leave the range at either end.
const CLIPPED: f64 = 0.01;
/// So far below 0 (encoded) is what noise and a good estimate leave; only what lies lower counts.
const NOISE: f32 = 0.02;
/// Pixels looked at.
const SAMPLES: usize = 1 << 15;
/// Halvings of the range in which a bound is looked for: to less than a thousandth.
const HALVINGS: usize = 12;

impl<E: Encoding> BoundedRestoration<E> {
    /// Bounds the restoration of an image by what comes of it.
    ///
    /// - The backscatter of a channel is taken down until at most 1 % of its values would become darker than black;
    /// - the gain of a channel until at most 1 % become brighter than white; with supplied depth the attenuation that is undone, in
    ///   all channels alike, so that hues do not change with distance;
    /// - with depth from colour the gain of red until its mean does not exceed those of green and blue: what
    ///   colour says of distance says too much where red is all but gone.
    ///
    /// A right estimate of an ordinary scene meets none of them.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when image and depth map differ in size.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::formation::{BoundedRestoration, RestoreBounds, RestoreOptions};
    /// use aquafuse::truth::{Scene, Size, waters};
    /// use aquafuse::waterbody::Estimate;
    ///
    /// let scene = Scene::new(1, Size { width: 96, height: 64 });
    /// let water = waters()[0].water;
    /// let seen = scene.seen_through(&water);
    /// let options = RestoreOptions::default();
    /// let right = BoundedRestoration::new(&seen, &scene.depth, &Estimate::given(water), &options)?;
    /// assert_eq!(right.bounds, RestoreBounds::default());
    /// # Ok::<(), aquafuse::image::ImageError>(())
    /// ```
    pub fn new<'a, T: Sample>(
        image: impl Into<ImageRef<'a, T, E>>,
        depth: &DepthMap,
        estimate: &Estimate<E>,
        options: &RestoreOptions,
    ) -> Result<Self, ImageError> {
        let image = image.into();
        depth.check_fits(image.size())?;
        let depth_from_colour = estimate.depth_model.is_some();
        let bounds = RestoreBounds::default();
        let mut found = Self { water: estimate.water, options: *options, bounds, depth_from_colour };
        let mut channels = channels(image, depth, &estimate.water);
        let mut veil = estimate.water.veiling_light.rgb();
        for (c, channel) in channels.iter_mut().enumerate() {
            let noise = E::from_encoded(NOISE);
            let kept = largest(0.0, 1.0, |share| channel.share(|p| p.value - share * p.backscatter < -noise));
            if kept < 1.0 {
                veil[c] *= kept;
                channel.0.iter_mut().for_each(|place| place.backscatter *= kept);
                found.bounds.backscatter = true;
            }
            let most = options.max_gain[c].max(1.0);
            let gain = largest(1.0, most, |gain| channel.share(|p| p.restored(gain) > 1.0));
            if depth_from_colour && gain < most {
                found.options.max_gain[c] = gain;
                found.bounds.gain = true;
            }
        }
        found.water.veiling_light = VeilingLight::new(veil);
        if depth_from_colour {
            found.hold_red(&channels);
        } else {
            found.hold_attenuation(&channels);
        }
        Ok(found)
    }

    /// All channels alike: held one by one, the far of a scene would turn to the hue of those that are not.
    fn hold_attenuation(&mut self, channels: &[Channel; 3]) {
        let most = self.options.max_gain.map(|gain| gain.max(1.0));
        let burns = |part: f32| {
            let shares = channels
                .iter()
                .zip(most)
                .map(|(channel, most)| channel.share(|place| place.restored_in_part(part, most) > 1.0));
            shares.fold(0.0, f64::max)
        };
        let kept = largest(0.0, 1.0, burns);
        if kept < 1.0 {
            self.water.attenuation = self.water.attenuation.map(|curve| curve.in_part(kept));
            self.bounds.gain = true;
        }
    }

    fn hold_red(&mut self, [red, green, blue]: &[Channel; 3]) {
        let gain = self.options.max_gain;
        let most = green.mean(gain[1]).max(blue.mean(gain[2]));
        // A red thing close by leads already, and nothing is strengthened there.
        let most = most.max(red.mean(1.0));
        let held = largest(1.0, gain[0], |gain| if red.mean(gain) > most { 1.0 } else { 0.0 });
        if held < gain[0] {
            self.options.max_gain[0] = held;
            self.bounds.red = true;
        }
    }
}

/// The largest number up to `most` at which not too much leaves the range; what does grows with the number.
fn largest(least: f32, most: f32, leaves: impl Fn(f32) -> f64) -> f32 {
    if leaves(most) <= CLIPPED {
        return most;
    }
    let (mut below, mut above) = (least, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (below + above);
        if leaves(middle) <= CLIPPED { below = middle } else { above = middle }
    }
    below
}

/// Some places of one channel.
struct Channel(Vec<Place>);

struct Place {
    value: f32,
    backscatter: f32,
    /// e^τ.
    gain: f32,
}

impl Place {
    fn restored(&self, max_gain: f32) -> f32 {
        (self.value - self.backscatter) * self.gain.min(max_gain)
    }

    /// The same where only a part of the attenuation is undone.
    fn restored_in_part(&self, part: f32, max_gain: f32) -> f32 {
        (self.value - self.backscatter) * self.gain.powf(part).min(max_gain)
    }
}

impl Channel {
    fn share(&self, holds: impl Fn(&Place) -> bool) -> f64 {
        self.0.iter().filter(|place| holds(place)).count() as f64 / self.0.len().max(1) as f64
    }

    fn mean(&self, max_gain: f32) -> f64 {
        let sum: f64 = self.0.iter().map(|place| f64::from(place.restored(max_gain).clamp(0.0, 1.0))).sum();
        sum / self.0.len().max(1) as f64
    }
}

fn channels<T: Sample, E: Encoding>(
    image: ImageRef<'_, T, E>,
    depth: &DepthMap,
    water: &Waterbody<E>,
) -> [Channel; 3] {
    let mut channels = [const { Vec::new() }; 3];
    for (y, row) in image.sampled_rows(SAMPLES) {
        for (x, pixel) in row.iter().enumerate() {
            let z = depth.at(x, y).min(depth.measured_to());
            let (left, backscatter) = (water.illumination(z), water.backscatter(z));
            for c in 0..3 {
                let value = pixel[c].to_unit();
                channels[c].push(Place { value, backscatter: backscatter[c], gain: left[c].recip() });
            }
        }
    }
    channels.map(Channel)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formation::restore_mut;
    use crate::truth::{Scene, Size, waters};
    use crate::waterbody::Attenuation;

    fn burnt(water: Waterbody) -> (RestoreBounds, f64) {
        let scene = Scene::new(3, Size { width: 96, height: 64 });
        let mut seen = scene.seen_through(&waters()[1].water).convert::<u8>();
        let mut estimate = Estimate::given(water);
        estimate.depth_model = Some(crate::depth::DepthModel::default());
        let options = RestoreOptions::default();
        let bounded = BoundedRestoration::new(&seen, &scene.depth, &estimate, &options).unwrap();
        let clipping = restore_mut(&mut seen, &scene.depth, &bounded.water, &bounded.options).unwrap();
        let white = seen.pixels().iter().flatten().filter(|&&value| value == 255).count();
        assert!(clipping.share() < 1.0);
        (bounded.bounds, white as f64 / (3 * seen.pixels().len()) as f64)
    }

    #[test]
    fn a_wrong_attenuation_burns_nothing() {
        let wrong = Waterbody { attenuation: [Attenuation::constant(2.0).unwrap(); 3], ..waters()[1].water };
        let (bounds, white) = burnt(wrong);
        assert!(bounds.gain && white < 0.03, "{bounds:?} {white}");
    }

    #[test]
    fn too_bright_a_veil_is_not_taken_off() {
        let wrong = Waterbody { veiling_light: VeilingLight::new([0.9; 3]), ..waters()[1].water };
        assert!(burnt(wrong).0.backscatter);
    }

    #[test]
    fn with_supplied_depth_no_channel_is_held_alone() {
        let scene = Scene::new(3, Size { width: 96, height: 64 });
        let seen = scene.seen_through(&waters()[1].water).convert::<u8>();
        let [red, green, blue] = [0.1, 0.2, 2.0].map(|beta| Attenuation::constant(beta).unwrap());
        let wrong = Waterbody { attenuation: [red, green, blue], ..waters()[1].water };
        let options = RestoreOptions::default();
        let bounded =
            BoundedRestoration::new(&seen, &scene.depth, &Estimate::given(wrong), &options).unwrap();
        assert!(bounded.bounds.gain);
        assert_eq!(bounded.options, options);
        let ratio = |water: Waterbody| water.attenuation[1].mu()[0] / water.attenuation[2].mu()[0];
        assert!((ratio(bounded.water) - ratio(wrong)).abs() < 1e-6);
    }
}
