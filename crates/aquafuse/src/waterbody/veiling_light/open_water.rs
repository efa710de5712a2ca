//! The veiling light by the far region: the colour of open water where it is that, and what there is where it is not.

use super::places::Places;
use super::reading::{ROUNDING, Reading, VeilingLightSource};
use crate::waterbody::far_region::{Region, median};

/// A far region that is less likely than this to be water is none.
const LIKELY: f32 = 0.68;
/// Water spreads no more than this many bytes beside the camera's noise.
const MOST_NOISE: f32 = 4.0;

/// The colour of a region; none where it is not likely to be water.
pub(super) fn read(region: &Region) -> Option<Reading> {
    (region.seen >= LIKELY).then(|| {
        let cells = region.cells.all();
        let of_read =
            |value: &dyn Fn(usize) -> f32| median(region.read.iter().map(|&cell| value(cell)).collect());
        Reading {
            rgb: region.colour,
            source: VeilingLightSource::OpenWater,
            share: region.read.len() as f64 / cells.len() as f64,
            places: Places::Cells(region.read.iter().map(|&cell| region.cells.place(cell)).collect()),
            standard_error: std::array::from_fn(|c| {
                let values = region.read.iter().map(|&cell| f64::from(cells[cell].mean[c]));
                standard_error_of_median(values) / 255.0
            }),
            seen: Some(region.seen),
            level: Some(region.level()),
            noise: of_read(&|cell| cells[cell].spread).clamp(ROUNDING, MOST_NOISE),
        }
    })
}

/// The colour of things, where no region is likely to be water. Depth from colour does not know well enough which are farthest: a wide
/// mean changes little from frame to frame.
pub(super) fn read_things(region: &Region) -> Reading {
    Reading {
        rgb: region.of_things,
        source: VeilingLightSource::FarRegion,
        share: region.things.len() as f64 / region.cells.all().len() as f64,
        places: Places::Cells(region.things.iter().map(|&cell| region.cells.place(cell)).collect()),
        standard_error: [0.0; 3],
        seen: None,
        level: None,
        noise: ROUNDING,
    }
}

/// Standard error of the median of values that scatter evenly: 1.253 deviations over the root of their number.
fn standard_error_of_median(values: impl ExactSizeIterator<Item = f64>) -> f32 {
    let count = values.len() as f64;
    let (sum, squares) = values.fold((0.0, 0.0), |(sum, squares), v| (sum + v, squares + v * v));
    let variance = (squares / count - (sum / count).powi(2)).max(0.0);
    (1.253 * (variance / count).sqrt()) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, TopEdge};
    use crate::waterbody::cells::Cells;

    fn read_of(image: &Image<u8>, levels: &[u8]) -> Option<Reading> {
        read(&Region::of(Cells::new(image.view(), levels), false, TopEdge::First))
    }

    #[test]
    fn smooth_water_is_read_though_textured_sand_is_taken_for_far() {
        // Three tenths water of one colour, the rest sand that flickers, and depth the wrong way round.
        let at = |x: usize, y: usize| match (y < 30, (x * 7 + y * 13) % 5 * 12) {
            (true, _) => [20, 120, 160],
            (false, flicker) => [90 + flicker as u8, 130, 120 + flicker as u8],
        };
        let samples = (0..100).flat_map(|y| (0..150).flat_map(move |x| at(x, y))).collect();
        let levels: Vec<u8> = (0..100).flat_map(|y| [if y < 30 { 80 } else { 200 }; 150]).collect();
        let image = Image::from_raw(150, 100, samples).unwrap();
        let Reading { rgb, share, .. } = read_of(&image, &levels).unwrap();
        let bytes = rgb.map(|value| (value * 255.0).round() as u8);
        assert_eq!(bytes, [20, 120, 160]);
        assert!(share > 0.08 && share < 0.35, "{share}");
    }

    #[test]
    fn without_a_smooth_place_there_is_no_open_water() {
        let samples = (0..96 * 96).flat_map(|i| [40, (i * 37 % 120) as u8 + 60, (i * 91 % 100) as u8 + 90]);
        let image = Image::from_raw(96, 96, samples.collect()).unwrap();
        assert!(read_of(&image, &[128; 96 * 96]).is_none());
    }
}
