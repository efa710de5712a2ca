//! Images with measured depth (FLSea): what a depth model says at the pixels whose depth is known.

use std::collections::BTreeMap;
use std::path::Path;

use aquafuse::depth::{DepthModel, SuppliedKind};
use aquafuse::image::Image;
use aquafuse_data::image_file::ReadOptions;
use aquafuse_data::pairs::{PairError, list};

/// One image with its depth in metres.
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) image: Image<u8>,
    /// One distance a pixel, NaN where it is not known.
    pub(crate) distances: Vec<f32>,
    /// Places of the measured pixels, row by row.
    pub(crate) measured: Vec<usize>,
}

impl Pair {
    /// What a model says at the measured pixels.
    pub(crate) fn estimated(&self, model: DepthModel) -> Vec<f32> {
        let distances = model.estimate(&self.image).distances();
        self.measured.iter().map(|&place| distances[place]).collect()
    }

    /// Depth at the measured pixels.
    pub(crate) fn metres(&self) -> Vec<f32> {
        self.measured.iter().map(|&place| self.distances[place]).collect()
    }

    /// One over the number of images of this place: each place counts once.
    pub(crate) fn share_of_place(&self, pairs: &[Pair]) -> f64 {
        1.0 / pairs.iter().filter(|pair| pair.place() == self.place()).count() as f64
    }

    /// Three of the images show one place.
    pub(crate) fn place(&self) -> &str {
        if matches!(self.name.as_str(), "flsea_0010" | "flsea_0011") { "flsea_0007" } else { &self.name }
    }
}

/// Mean over places of the mean over a place's images.
pub(crate) fn by_place(pairs: &[Pair], scores: &[f64]) -> f64 {
    let mut places: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (pair, score) in pairs.iter().zip(scores) {
        places.entry(pair.place()).or_default().push(*score);
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    mean(&places.values().map(|scores| mean(scores)).collect::<Vec<_>>())
}

/// All pairs, by name.
pub(crate) fn read_all(data: &Path) -> Result<Vec<Pair>, PairError> {
    let read = |pair: aquafuse_data::pairs::Pair| {
        let (image, distances) = pair.read(SuppliedKind::Metres, &ReadOptions::default())?;
        let measured = (0..distances.len()).filter(|&i| distances[i].is_finite()).collect();
        Ok(Pair { name: pair.name, image, distances, measured })
    };
    list(&data.join("depth_pairs"))?.pairs.into_iter().map(read).collect()
}
