//! One water for all images of a scene, in its unit of length.
//!
//! Depth from colour is relative within an image, and so is the water that is estimated by it, as for an image by itself. The
//! points of the scene that a camera sees give the length of relative depth 1: with it, the waters of all images have one unit
//! and are pooled ([`estimate`]).
//!
//! The water is **not** estimated by a map that was scaled first. Such a map would pass for a measured one, whose distances are
//! right: the dark things of a real image do not follow the curve of backscatter by distances from colour, and β_B came out at a
//! tenth of the true one.

use aquafuse::depth::{DepthKind, DepthMap};
use aquafuse::image::{Encoded, ImageError};
use aquafuse::waterbody::{
    self, Attenuation, Estimate, EstimateOptions, Reason, WaterShare, pool, water_share,
};
use aquafuse_data::files::{Step, count};
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::run::{RunOptions, Stopped};

use crate::lens::Lens;
use crate::medium::Water;
use crate::points::Point;

/// Points in view of a camera, at the least, for its depth to have a unit.
const LEAST_POINTS: usize = 12;

/// The unit of an image that has too few points in view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MissingUnit {
    /// The median of the units of the other images; 1 if none has one.
    OfOthers,
    /// This many units of the scene.
    Fixed(f32),
}

/// The water that the images of a scene share.
#[derive(Clone, Debug)]
pub struct SharedWater {
    /// What relative depth 1 is in each image, in units of the scene.
    pub units: Vec<f32>,
    /// The median of the units that points gave; `None` where no image has enough points in view.
    pub unit: Option<f32>,
    /// The water, per unit of the scene.
    pub water: Estimate<Encoded>,
    /// How far away things are, in units of the scene: the median over the images of their median distance.
    pub distance: f32,
}

impl SharedWater {
    /// Whether the images surely show open water: the verdict that most of them share has no doubt of it.
    pub fn shows_open_water(&self) -> bool {
        let reasons = self.water.quality.reasons;
        ![Reason::NoOpenWater, Reason::OpenWaterUnsure].iter().any(|one| reasons.contains(*one))
    }

    /// How much of each pixel of an image is open water, which hides nothing and is nowhere: no distance from colour says so.
    ///
    /// The views of a scene must agree, and each by itself is not equally sure that it sees water. So the estimate that they share
    /// decides whether any of them does: if it is unsure, no view has a share.
    ///
    /// # Errors
    ///
    /// [`SharedWaterError::Size`] when image and depth differ in size.
    pub fn share_in(&self, image: &ImageFile, relative: &DepthMap) -> Result<WaterShare, SharedWaterError> {
        if !self.shows_open_water() {
            return Ok(WaterShare::none(relative.size()));
        }
        let veil = &self.water.water.veiling_light;
        Ok(water_share(&image.bytes(), relative, veil, &options(image))?)
    }
}

/// Images give no water together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SharedWaterError {
    /// There is no image.
    #[error("the scene has no image; name a folder with images and their cameras")]
    NoImages,
    /// An image and its depth map differ in size.
    #[error(transparent)]
    Size(#[from] ImageError),
}

/// Shows an image and its relative depth: what `estimate` asks for, by the index of the image.
pub type Show<'a, E> = dyn Fn(usize, &mut dyn FnMut(&ImageFile, &DepthMap)) -> Result<(), E> + Sync + 'a;

/// What one image contributes.
#[derive(Clone, Copy, Debug)]
struct Contribution {
    /// Its unit, if points give it.
    unit: Option<f32>,
    /// The unit that was used, the water and the median distance in it; `None` until a unit is known.
    water: Option<(f32, Estimate<Encoded>, f32)>,
}

/// Estimates the water that images share: a unit for each image, its water in that unit, and all waters pooled.
///
/// `lenses` belong to the images, in their order. `show` is asked for every image once, on the threads of the run. It is
/// asked a second time only for an image whose unit comes from the others.
///
/// # Errors
///
/// What `show` returns, [`SharedWaterError`] when there is no image or a depth map is not its image's, or [`Stopped`].
pub fn estimate<E: From<SharedWaterError> + From<Stopped> + Send + Sync>(
    lenses: &[&Lens],
    points: &[Point],
    missing: MissingUnit,
    options: &RunOptions,
    show: &Show<'_, E>,
) -> Result<SharedWater, E> {
    let assumed = match missing {
        MissingUnit::Fixed(unit) => Some(unit),
        // Without points no image will have a unit: there is no need to wait for the others.
        MissingUnit::OfOthers => points.is_empty().then_some(1.0),
    };
    let numbered: Vec<(usize, &Lens)> = lenses.iter().copied().enumerate().collect();
    let contribution = |&(index, lens): &(usize, &Lens), assumed: Option<f32>| -> Result<Contribution, E> {
        let mut found = None;
        show(index, &mut |image, relative| {
            found = Some(Contribution::of(image, relative, lens, points, assumed));
        })?;
        found.unwrap_or(Err(SharedWaterError::NoImages)).map_err(E::from)
    };
    let mut found = options.try_map(&numbered, |one| contribution(one, assumed))?;
    let unit = median(&mut found.iter().filter_map(|one| one.unit).collect::<Vec<_>>());
    let without = numbered.into_iter().zip(&found).filter(|(_, one)| one.water.is_none());
    let without: Vec<(usize, &Lens)> = without.map(|(one, _)| one).collect();
    let again = options.try_map(&without, |one| contribution(one, Some(unit.unwrap_or(1.0))))?;
    for ((index, _), one) in without.iter().zip(again) {
        found[*index] = one;
    }
    let (mut units, mut waters, mut distances) = (Vec::new(), Vec::new(), Vec::new());
    for (unit, water, distance) in found.into_iter().filter_map(|one| one.water) {
        units.push(unit);
        waters.push(water);
        distances.push(distance);
    }
    let water = pool(&waters).ok_or(SharedWaterError::NoImages)?;
    Ok(SharedWater { units, unit, water, distance: median(&mut distances).unwrap_or(1.0) })
}

impl Contribution {
    fn of(
        image: &ImageFile,
        relative: &DepthMap,
        lens: &Lens,
        points: &[Point],
        assumed: Option<f32>,
    ) -> Result<Self, SharedWaterError> {
        let unit = unit_of(relative, lens, points);
        let Some(used) = unit.or(assumed) else { return Ok(Self { unit, water: None }) };
        let water = per_unit(water_of(image, relative)?, used);
        Ok(Self { unit, water: Some((used, water, used * relative.percentile(0.5))) })
    }
}

/// How many units of the scene relative depth 1 is in an image; `None` if too few points are in its view.
///
/// The median of distance over relative depth at the points: half of them may lie on something that hides them, or where
/// colour errs.
pub fn unit_of(relative: &DepthMap, lens: &Lens, points: &[Point]) -> Option<f32> {
    let (width, height) = relative.size();
    let lens = Lens { camera: lens.camera.scaled_to(width, height), ..lens.clone() };
    let camera = &lens.camera;
    let mut units: Vec<f32> = points
        .iter()
        .filter_map(|point| {
            let seen = camera.to_camera(point.position);
            let straight = std::array::from_fn(|a| camera.focal[a] * seen[a] / seen[2] + camera.centre[a]);
            let [x, y] = lens.distorted(straight);
            let inside = seen[2] > 0.0 && x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
            let z = inside.then(|| relative.at(x as usize, y as usize))?;
            let distance = seen.iter().map(|v| v * v).sum::<f64>().sqrt() as f32;
            (z > 0.0).then(|| distance / z)
        })
        .collect();
    (units.len() >= LEAST_POINTS).then(|| median(&mut units)).flatten()
}

/// The median, the upper one of an even number; `None` of no value.
fn median(values: &mut [f32]) -> Option<f32> {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}

/// An image's depth in units of the scene; unchanged if the unit is no length.
#[must_use]
pub fn in_scene(relative: &DepthMap, unit: f32) -> DepthMap {
    let (width, height) = relative.size();
    let distances = relative.distances().into_iter().map(|z| z * unit).collect();
    let scaled = DepthMap::from_distances(width, height, DepthKind::Metres, distances);
    scaled.unwrap_or_else(|_| relative.clone())
}

/// The water of one image, per unit of relative depth.
///
/// # Errors
///
/// [`ImageError`] when image and depth differ in size.
pub fn water_of(image: &ImageFile, depth: &DepthMap) -> Result<Estimate<Encoded>, ImageError> {
    count(Step::WaterEstimated);
    waterbody::estimate(&image.bytes(), depth, &options(image))
}

fn options(image: &ImageFile) -> EstimateOptions {
    EstimateOptions::default().with_top(image.top_edge()).with_water_map(image.water_map())
}

/// The same water per unit of the scene, of which relative depth 1 is so many; unchanged if that is no length.
#[must_use]
pub fn per_unit(estimate: Estimate<Encoded>, unit: f32) -> Estimate<Encoded> {
    let rescale =
        |curve: &Attenuation| Attenuation::new(curve.mu().map(|mu| mu / unit), curve.held_beyond() * unit);
    let [Ok(red), Ok(green), Ok(blue)] = estimate.water.attenuation.each_ref().map(rescale) else {
        return estimate;
    };
    let mut scaled = estimate;
    scaled.water.attenuation = [red, green, blue];
    let of_image = (estimate.water.backscatter_coefficient, estimate.intervals.backscatter_coefficient);
    scaled.water.backscatter_coefficient = of_image.0.map(|beta| beta / unit);
    scaled.intervals.backscatter_coefficient = of_image.1.map(|interval| interval.map(|beta| beta / unit));
    // A table by relative depth.
    scaled.depth_factors = None;
    scaled
}

/// The first guess of a water to be learned: β_D is constant, with its value at `distance`, where most things are.
pub fn to_learn(estimate: &Estimate<Encoded>, distance: f32) -> Water<f32> {
    let water = &estimate.water;
    Water::new(
        water.veiling_light.rgb().map(f64::from),
        water.backscatter_coefficient.map(f64::from),
        water.attenuation.each_ref().map(|curve| f64::from(curve.coefficient(distance))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth;
    use aquafuse::depth::DepthModel;
    use aquafuse::truth::{Size, waters};
    use aquafuse::waterbody::Verdict;

    #[test]
    fn views_give_the_water_of_their_place_together() {
        let truth = waters()[0].water;
        let views = truth::views(1, Size { width: 160, height: 120 }, 6, 1);
        let images: Vec<_> = views.iter().map(|view| view.seen_through(&truth)).collect();
        let points = truth::points(&views, &images, 60);
        let lenses: Vec<Lens> =
            views.iter().map(|view| Lens { camera: view.camera.clone(), distortion: [0.0; 4] }).collect();
        let missing = MissingUnit::OfOthers;
        let options = RunOptions::default();
        let shared = estimate(&lenses.iter().collect::<Vec<_>>(), &points, missing, &options, &|i, look| {
            let image = ImageFile::new(images[i].convert::<u8>());
            look(&image, &image.pixels.depth(&DepthModel::default(), image.top_edge()));
            Ok::<(), crate::fuse::FuseError>(())
        })
        .unwrap();
        let found = shared.water;
        assert_eq!(found.quality.verdict, Verdict::Good, "{:?}", found.quality.reasons);
        for c in 0..3 {
            let off = (found.water.veiling_light.rgb()[c] - truth.veiling_light.rgb()[c]).abs();
            assert!(off < 0.01, "B∞ of channel {c} is off by {off}");
            // Distances are from colour: β_B is about right, in units of the scene.
            let ratio = found.water.backscatter_coefficient[c] / truth.backscatter_coefficient[c];
            assert!((0.6..1.7).contains(&ratio), "β_B of channel {c} is {ratio} times the true one");
        }
        let image = ImageFile::new(images[0].convert::<u8>());
        let relative = image.pixels.depth(&DepthModel::default(), image.top_edge());
        assert!(shared.share_in(&image, &relative).unwrap().mean() > 0.05);
        let mut unsure = shared.clone();
        unsure.water.quality = found.quality.with(Reason::OpenWaterUnsure);
        assert!(unsure.share_in(&image, &relative).unwrap().is_none());
    }

    #[test]
    fn a_water_per_unit_is_the_same_at_one_place() {
        let image = truth::views(1, Size { width: 80, height: 60 }, 2, 1)[0].seen_through(&waters()[0].water);
        let image = ImageFile::new(image.convert::<u8>());
        let relative = image.pixels.depth(&DepthModel::default(), image.top_edge());
        let own = water_of(&image, &relative).unwrap();
        // A scene in millimetres has large numbers.
        for unit in [0.004, 6.0, 9000.0] {
            let per = per_unit(own, unit);
            for z in [0.2_f32, 0.5, 0.9] {
                let [a, b] = [own.water.backscatter(z), per.water.backscatter(z * unit)];
                let [c, d] = [own.water.illumination(z), per.water.illumination(z * unit)];
                assert!(a.iter().zip(b).chain(c.iter().zip(d)).all(|(a, b)| (a - b).abs() < 1e-4));
            }
        }
    }

    #[test]
    fn points_tell_the_unit_of_relative_depth() {
        let views = truth::views(2, Size { width: 80, height: 60 }, 2, 1);
        let images: Vec<_> = views.iter().map(truth::TruthView::clear).collect();
        let points = truth::points(&views[1..], &images[1..], 20);
        // The true depth, said to be relative to 40 units.
        let distances = views[1].scene.depth.distances();
        let relative = distances.iter().map(|z| z.min(40.0) / 40.0).collect();
        let relative = DepthMap::from_distances(80, 60, DepthKind::Relative, relative).unwrap();
        let lens = Lens { camera: views[1].camera.clone(), distortion: [0.0; 4] };
        let unit = unit_of(&relative, &lens, &points).unwrap();
        assert!((unit - 40.0).abs() < 1e-3, "{unit}");
        assert!((in_scene(&relative, unit).at(40, 50) - views[1].scene.depth.at(40, 50)).abs() < 1e-3);
        assert_eq!(unit_of(&relative, &lens, &points[..5]), None);
    }
}
