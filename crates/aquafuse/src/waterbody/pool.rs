//! One water from many images of it.

use super::{Estimate, Intervals, Quality, Reason, Reasons, VeilingLight, Waterbody};
use crate::image::Encoding;

/// Pools estimates of one water, such as those of the frames of a sequence; none if there are no estimates.
///
/// Each number is the median of the estimates', weighted by how narrow their intervals are, so that neither
/// frames that saw little nor a few that went wrong count for much. β_D is taken as a whole from the frame
/// whose B∞ is nearest to the pooled one. An interval is the weighted median of the ends: frames of one
/// sequence err alike, so more of them do not make it narrower. A reason stands if it holds in more than half
/// of the frames. β_B and β_D must be per one unit of z; relative depth has one only within an image.
///
/// # Examples
///
/// ```
/// use aquafuse::image::Encoded;
/// use aquafuse::truth::{Scene, Size, waters};
/// use aquafuse::waterbody::{self, pool};
///
/// let seen = |seed| {
///     let scene = Scene::new(seed, Size { width: 96, height: 64 });
///     (scene.seen_through(&waters()[0].water).convert::<u8>(), scene.depth)
/// };
/// let frames = [1, 2, 3].map(|seed| {
///     let (image, z) = seen(seed);
///     waterbody::estimate::<Encoded>(&image, &z, &Default::default())
/// });
/// let frames: Vec<_> = frames.into_iter().collect::<Result<_, _>>()?;
/// let pooled = pool(&frames).expect("three frames");
/// let blue = pooled.water.veiling_light.rgb()[2];
/// assert!((blue - waters()[0].water.veiling_light.rgb()[2]).abs() < 0.02);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn pool<E: Encoding>(estimates: &[Estimate<E>]) -> Option<Estimate<E>> {
    let [first, ..] = estimates else { return None };
    let veil = |c: usize| {
        pooled(estimates, |one| (one.water.veiling_light.rgb()[c], one.intervals.veiling_light[c]))
    };
    let growth = |c: usize| {
        pooled(estimates, |one| {
            (one.water.backscatter_coefficient[c], one.intervals.backscatter_coefficient[c])
        })
    };
    let (veils, growths): ([Pooled; 3], [Pooled; 3]) =
        (std::array::from_fn(veil), std::array::from_fn(growth));
    let rgb = veils.each_ref().map(|pooled| pooled.value);
    let distance = |one: &Estimate<E>| -> f32 {
        let own = one.water.veiling_light.rgb();
        (0..3).map(|c| (own[c] - rgb[c]).powi(2)).sum()
    };
    let typical = estimates.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(first);
    Some(Estimate {
        water: Waterbody {
            veiling_light: VeilingLight::new(rgb),
            backscatter_coefficient: growths.each_ref().map(|pooled| pooled.value),
            attenuation: typical.water.attenuation,
        },
        intervals: Intervals {
            veiling_light: veils.map(|pooled| pooled.interval),
            backscatter_coefficient: growths.map(|pooled| pooled.interval),
        },
        quality: Quality::of(common_reasons(estimates)),
        // Depth from colour means another thing in each frame.
        depth_factors: None,
        near_colour: pooled_colour(estimates),
        ..*typical
    })
}

struct Pooled {
    value: f32,
    interval: [f32; 2],
}

fn pooled<E: Encoding>(estimates: &[Estimate<E>], read: impl Fn(&Estimate<E>) -> (f32, [f32; 2])) -> Pooled {
    // An interval of no width is one that is not known: it counts as a wide one.
    let weight = |[low, high]: [f32; 2]| if high > low { (high - low).recip() } else { 1.0 };
    let median = |of: &dyn Fn(f32, [f32; 2]) -> f32| {
        let weighted = estimates.iter().map(|one| {
            let (value, interval) = read(one);
            (of(value, interval), weight(interval))
        });
        weighted_median(weighted.collect())
    };
    Pooled {
        value: median(&|value, _| value),
        interval: [median(&|_, interval| interval[0]), median(&|_, interval| interval[1])],
    }
}

/// The median of the frames that have a colour of near things.
fn pooled_colour<E: Encoding>(estimates: &[Estimate<E>]) -> Option<[f32; 3]> {
    let colours: Vec<[f32; 3]> = estimates.iter().filter_map(|one| one.near_colour).collect();
    let median = |c: usize| weighted_median(colours.iter().map(|colour| (colour[c], 1.0)).collect());
    (!colours.is_empty()).then(|| std::array::from_fn(median))
}

/// The value at which half of the weight is reached.
fn weighted_median(mut values: Vec<(f32, f32)>) -> f32 {
    values.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let half = 0.5 * values.iter().map(|(_, weight)| weight).sum::<f32>();
    let mut seen = 0.0;
    let middle = values.iter().find(|(_, weight)| {
        seen += weight;
        seen >= half
    });
    middle.or(values.last()).map_or(0.0, |&(value, _)| value)
}

fn common_reasons<E: Encoding>(estimates: &[Estimate<E>]) -> Reasons {
    let mut common = Reasons::default();
    for &reason in Reason::ALL {
        let holding = estimates.iter().filter(|one| one.quality.reasons.contains(reason)).count();
        common.add_if(2 * holding > estimates.len(), reason);
    }
    common
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Encoded;
    use crate::truth::waters;
    use crate::waterbody::{VeilingLightSource, Verdict};

    fn estimate(green: f32, width: f32) -> Estimate<Encoded> {
        let water = Waterbody { veiling_light: VeilingLight::new([0.1, green, 0.5]), ..waters()[0].water };
        let around = |value: f32| [value - width, value + width];
        Estimate {
            water,
            veiling_light_source: VeilingLightSource::OpenWater,
            veiling_light_share: 0.1,
            depth_model: None,
            depth_factors: None,
            near_colour: None,
            intervals: Intervals {
                veiling_light: water.veiling_light.rgb().map(around),
                backscatter_coefficient: water.backscatter_coefficient.map(around),
            },
            quality: Quality::default(),
        }
    }

    #[test]
    fn one_frame_is_itself_and_none_is_none() {
        assert_eq!(pool(&[estimate(0.4, 0.01)]), Some(estimate(0.4, 0.01)));
        assert_eq!(pool::<Encoded>(&[]), None);
    }

    #[test]
    fn neither_a_frame_gone_wrong_nor_the_order_moves_the_water() {
        let frames = [estimate(0.40, 0.01), estimate(0.41, 0.01), estimate(0.9, 0.01), estimate(0.42, 0.01)];
        let mut turned = frames;
        turned.reverse();
        let pooled = pool(&frames).unwrap();
        assert!(pooled.water.veiling_light.rgb()[1] < 0.43);
        assert_eq!(pool(&turned), Some(pooled));
    }

    #[test]
    fn a_sure_frame_outweighs_unsure_ones() {
        let pooled = pool(&[estimate(0.4, 0.005), estimate(0.6, 0.2), estimate(0.65, 0.2)]).unwrap();
        assert_eq!(pooled.water.veiling_light.rgb()[1], 0.4);
    }

    #[test]
    fn a_reason_stands_where_most_frames_have_it() {
        let doubtful = |reason| Estimate { quality: Quality::default().with(reason), ..estimate(0.4, 0.01) };
        let (water, dark) = (doubtful(Reason::NoOpenWater), doubtful(Reason::FewDarkPixels));
        let pooled = pool(&[water, water, dark]).unwrap().quality;
        assert_eq!(pooled.verdict, Verdict::Doubtful);
        assert_eq!(pooled.reasons.iter().collect::<Vec<_>>(), [Reason::NoOpenWater]);
    }
}
