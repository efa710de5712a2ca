//! From splats to an image, and from the gradient of the image back to the gradient of the splats.
//!
//! The steps are those of Kerbl et al.: each splat is projected to an ellipse (`project.rs`), ellipses are sorted by
//! distance and listed for the tiles they touch (`tiles.rs`), and each tile is rendered front to back (`raster.rs`).
//! Threads share splats and rows of tiles; sums are taken in one order, so that the number of threads changes no bit.

mod harmonics;
pub(crate) mod project;
mod raster;
mod tiles;

use aquafuse::simd::widest;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::medium::{Medium, PARAMETERS};
use crate::scalar::Scalar;
use crate::splats::Splats;
use project::{Footprint, Sight, Sums};
use raster::{Draw, Planes, Source, Strip, Undraw};
use tiles::{SIDE, Tiles};

/// Splats that one thread takes at a time.
const SHARE: usize = 256;
/// Stands for a splat that is not seen.
const UNSEEN: u32 = u32::MAX;

/// Five planes of an image, rows from the top: a rendering, or the gradient of a loss by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering<T> {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue.
    pub colour: [Vec<T>; 3],
    /// Distances along the line of sight, each weighted by how much is seen of its splat: divided by
    /// 1 - `transmittance`, this is their mean.
    pub distance: Vec<T>,
    /// The share of the light from behind all splats that reaches the camera.
    pub transmittance: Vec<T>,
}

impl<T: Scalar> Rendering<T> {
    /// Zeros.
    pub fn zeros(width: usize, height: usize) -> Self {
        let plane = vec![T::ZERO; width * height];
        Self {
            width,
            height,
            colour: [plane.clone(), plane.clone(), plane.clone()],
            distance: plane.clone(),
            transmittance: plane,
        }
    }

    /// Colours pixel by pixel.
    pub fn pixels(&self) -> impl Iterator<Item = [T; 3]> {
        let [r, g, b] = &self.colour;
        r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b])
    }

    fn strip(&self, row: usize) -> Planes<'_, T> {
        let range = row * SIDE * self.width..(((row + 1) * SIDE).min(self.height)) * self.width;
        Planes {
            colour: self.colour.each_ref().map(|plane| &plane[range.clone()]),
            distance: &self.distance[range.clone()],
            transmittance: &self.transmittance[range],
        }
    }
}

/// A rendering, with what its gradients need.
#[derive(Clone, Debug)]
pub struct Rendered<T> {
    /// The rendering.
    pub rendering: Rendering<T>,
    width: usize,
    sight: Sight<T>,
    background: [T; 3],
    /// In order of distance.
    footprints: Vec<Footprint<T>>,
    /// The footprint of each splat.
    ranks: Vec<u32>,
    tiles: Tiles,
}

/// The gradient of a loss by everything that was rendered.
#[derive(Clone, Debug)]
pub struct Gradient<T> {
    /// By the splats, row by row; zeros for those that were not seen.
    pub splats: Splats<T>,
    /// By the parameters of a learned water.
    pub water: [T; PARAMETERS],
    /// By each splat's projected mean, per pixel, which density control needs; `None` where it was not seen.
    pub grad2d: Vec<Option<[T; 2]>>,
}

/// Bytes that [`render`] takes for a view: its planes, and all tiles that splats touch, which in a view full of large splats
/// are many more.
///
/// More than 2^32 such tiles are not rendered: then it is [`u64::MAX`].
pub fn memory<T: Scalar>(splats: &Splats<T>, degree: u8, camera: &Camera, medium: &Medium<T>) -> u64 {
    let footprints = in_view(splats, &Sight::of(splats, degree, camera, medium), camera);
    let entries = Tiles::entries(camera.width, camera.height, &footprints);
    if entries > u64::from(u32::MAX) {
        return u64::MAX;
    }
    let pixels = (camera.width as u64).saturating_mul(camera.height as u64);
    // Its samples as bytes, and distances, beside five planes.
    let of_pixels = pixels.saturating_mul(5 * size_of::<T>() as u64 + 8);
    let of_splats = (splats.len() as u64).saturating_mul(size_of::<Footprint<T>>() as u64 + 4);
    // Two numbers for each.
    of_pixels.saturating_add(of_splats).saturating_add(8 * entries)
}

/// The footprints of the splats that the image shows.
fn in_view<T: Scalar>(splats: &Splats<T>, sight: &Sight<T>, camera: &Camera) -> Vec<Footprint<T>> {
    let (width, height) = (camera.width, camera.height);
    let shown = |footprint: &Footprint<T>| {
        let [x, y] = footprint.mean.map(T::get);
        let [rx, ry] = footprint.reach.map(T::get);
        x + rx > 0.0 && y + ry > 0.0 && x - rx < width as f64 && y - ry < height as f64
    };
    let row_width = splats.width();
    splats
        .rows()
        .par_chunks(row_width * SHARE)
        .enumerate()
        .flat_map_iter(|(share, rows)| {
            rows.chunks_exact(row_width).enumerate().filter_map(move |(i, row)| {
                project::project((share * SHARE + i) as u32, row, sight).filter(shown)
            })
        })
        .collect()
}

/// Footprints from the nearest on; those at one distance stay in their order.
fn in_order<T: Scalar>(footprints: &[Footprint<T>]) -> Vec<Footprint<T>> {
    // Bits of floats from 0 on are in the order of the floats: whole numbers sort faster, and footprints move once.
    let key = |footprint: &Footprint<T>| u64::from((footprint.distance.get() as f32).to_bits());
    let mut order: Vec<u64> =
        footprints.iter().zip(0_u64..).map(|(footprint, i)| (key(footprint) << 32) | i).collect();
    order.sort_unstable();
    order.into_iter().map(|entry| footprints[(entry & 0xffff_ffff) as usize]).collect()
}

/// Renders the splats as the camera sees them through the medium, with spherical harmonics up to `degree`.
///
/// # Panics
///
/// When splats touch more than 2^32 tiles together; [`memory`] says so beforehand.
pub fn render<T: Scalar>(splats: &Splats<T>, degree: u8, camera: &Camera, medium: &Medium<T>) -> Rendered<T> {
    let sight = Sight::of(splats, degree, camera, medium);
    let (width, height) = (camera.width, camera.height);
    let footprints = in_order(&in_view(splats, &sight, camera));
    let mut ranks = vec![UNSEEN; splats.len()];
    for (rank, footprint) in footprints.iter().enumerate() {
        ranks[footprint.splat as usize] = rank as u32;
    }
    let tiles = Tiles::new(width, height, &footprints);
    let mut rendered = Rendered {
        rendering: Rendering::zeros(0, 0),
        width,
        sight,
        background: medium.background(),
        footprints,
        ranks,
        tiles,
    };
    let mut rendering = Rendering::zeros(width, height);
    let strip = SIDE * width;
    let [r, g, b] = &mut rendering.colour;
    let colours = r.par_chunks_mut(strip).zip(g.par_chunks_mut(strip)).zip(b.par_chunks_mut(strip));
    let others = rendering.distance.par_chunks_mut(strip).zip(rendering.transmittance.par_chunks_mut(strip));
    colours.zip(others).enumerate().for_each(|(row, (((r, g), b), (distance, transmittance)))| {
        let strip = Strip { colour: [r, g, b], distance, transmittance };
        widest(Draw { source: rendered.source(row), strip });
    });
    rendered.rendering = rendering;
    rendered
}

impl<T: Scalar> Rendered<T> {
    /// The number of splats in view.
    pub fn seen(&self) -> usize {
        self.footprints.len()
    }

    fn source(&self, row: usize) -> Source<'_, T> {
        Source {
            footprints: &self.footprints,
            tiles: &self.tiles,
            width: self.width,
            row,
            background: self.background,
        }
    }

    /// From the gradient of a loss by the rendering to its gradient by the splats and by the water.
    ///
    /// # Panics
    ///
    /// When `splats` are not the splats that were rendered, or the sizes differ.
    pub fn back(&self, splats: &Splats<T>, medium: &Medium<T>, gradient: &Rendering<T>) -> Gradient<T> {
        assert_eq!(self.ranks.len(), splats.len(), "the splats that were rendered");
        let mut entries = vec![Sums::<T>::default(); self.tiles.places.len()];
        let of_background = self.undraw(gradient, &mut entries);

        let row_width = splats.width();
        let mut of_splats = splats.zeros();
        let mut grad2d = vec![None; splats.len()];
        let shares = splats.rows().par_chunks(row_width * SHARE);
        let written = of_splats.rows_mut().par_chunks_mut(row_width * SHARE);
        let ranks = self.ranks.par_chunks(SHARE).zip(grad2d.par_chunks_mut(SHARE));
        let waters: Vec<[T; PARAMETERS]> = shares
            .zip(written)
            .zip(ranks)
            .map(|((rows, written), (ranks, grad2d))| {
                let mut water = [T::ZERO; PARAMETERS];
                let rows = rows.chunks_exact(row_width).zip(written.chunks_exact_mut(row_width));
                for (((row, written), &rank), grad2d) in rows.zip(ranks).zip(grad2d) {
                    let Some(footprint) = self.footprints.get(rank as usize) else { continue };
                    let mut sums = Sums::default();
                    for &place in self.tiles.places_of(rank as usize) {
                        sums.add(&entries[place as usize]);
                    }
                    *grad2d = Some(project::grad2d(footprint, &sums));
                    project::back(row, &self.sight, footprint, &sums, written, &mut water);
                }
                water
            })
            .collect();
        let mut water = [T::ZERO; PARAMETERS];
        for share in waters {
            for i in 0..PARAMETERS {
                water[i] += share[i];
            }
        }
        medium.background_back(of_background, &mut water);
        Gradient { splats: of_splats, water, grad2d }
    }

    /// Fills the sums of the footprints of each row of tiles; gives the gradient of the background.
    fn undraw(&self, gradient: &Rendering<T>, entries: &mut [Sums<T>]) -> [T; 3] {
        let mut rest = entries;
        let mut strips = Vec::with_capacity(self.tiles.down);
        for row in 0..self.tiles.down {
            let (strip, after) = rest.split_at_mut(self.tiles.in_row(row));
            strips.push((row, strip));
            rest = after;
        }
        let backgrounds: Vec<[T; 3]> = strips
            .into_par_iter()
            .map(|(row, sums)| {
                widest(Undraw {
                    source: self.source(row),
                    rendered: self.rendering.strip(row),
                    gradient: gradient.strip(row),
                    sums,
                })
            })
            .collect();
        backgrounds.into_iter().fold([T::ZERO; 3], |sum, row| std::array::from_fn(|c| sum[c] + row[c]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So large that each fills the view: what takes memory is then their tiles.
    #[test]
    fn memory_counts_the_tiles_that_are_listed_afterwards() {
        let camera = Camera {
            width: 100,
            height: 60,
            focal: [80.0, 80.0],
            centre: [50.0, 30.0],
            rotation: Camera::rotation_of([1.0, 0.0, 0.0, 0.0]),
            translation: [0.0; 3],
        };
        let of = |count: usize| {
            let rows = (0..count)
                .flat_map(|i| Splats::<f32>::ball(0, [0.0, 0.0, 2.0 + i as f64], 9.0, 0.5, [0.5; 3]));
            Splats::from_rows(0, rows.collect()).expect("whole rows")
        };
        let tiles = (100_u64).div_ceil(8) * 60_u64.div_ceil(8);
        for count in [1, 30] {
            let splats = of(count);
            let listed = render(&splats, 0, &camera, &Medium::Air).tiles.entries.len() as u64;
            assert_eq!(listed, count as u64 * tiles);
            let without = memory(&of(0), 0, &camera, &Medium::Air);
            assert!(memory(&splats, 0, &camera, &Medium::Air) >= without + 8 * listed);
        }
    }
}
