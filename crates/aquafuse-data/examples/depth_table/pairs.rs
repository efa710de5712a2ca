//! Pictures with measured depth (FLSea): 8-bit RGB and metres in 32-bit float TIFF, 0 where there is none.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use aquafuse::depth::DepthModel;
use aquafuse::image::Image;
use aquafuse::metrics::spearman;
use tiff::decoder::{Decoder, DecodingResult};

type Error = Box<dyn std::error::Error>;

/// One picture at the pixels whose depth was measured.
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) image: Image<u8>,
    /// Places of the measured pixels, row by row.
    measured: Vec<usize>,
    /// Their depth.
    pub(crate) metres: Vec<f32>,
    /// Rows from the bottom: the prior that the top is far.
    pub(crate) rows: Vec<f32>,
}

impl Pair {
    /// Rank correlation of a model's depth with the measured one.
    pub(crate) fn score(&self, model: DepthModel) -> Option<f64> {
        let distances = model.estimate(&self.image).distances();
        let estimated: Vec<f32> = self.measured.iter().map(|&place| distances[place]).collect();
        spearman(&estimated, &self.metres)
    }
}

/// Mean over places of the mean over a place's pictures.
pub(crate) fn by_place(pairs: &[Pair], scores: &[f64]) -> f64 {
    let mut places: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (pair, score) in pairs.iter().zip(scores) {
        places.entry(place(&pair.name)).or_default().push(*score);
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    mean(&places.values().map(|scores| mean(scores)).collect::<Vec<_>>())
}

/// Three of the pictures show one place.
fn place(name: &str) -> &str {
    if matches!(name, "flsea_0010" | "flsea_0011") { "flsea_0007" } else { name }
}

/// All pairs, by name.
pub(crate) fn read_all(data: &Path) -> Result<Vec<Pair>, Error> {
    let folder = data.join("depth_pairs");
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder.join("rgb"))? {
        names.push(entry?.path().file_stem().unwrap_or_default().to_string_lossy().into_owned());
    }
    names.sort();
    names.into_iter().map(|name| read(&folder, name)).collect()
}

fn read(folder: &Path, name: String) -> Result<Pair, Error> {
    let decode = |path: std::path::PathBuf| -> Result<_, Error> {
        let mut decoder = Decoder::new(BufReader::new(File::open(path)?))?;
        let (width, height) = decoder.dimensions()?;
        Ok((width as usize, height as usize, decoder.read_image()?))
    };
    let (width, height, rgb) = decode(folder.join("rgb").join(format!("{name}.tiff")))?;
    let (_, _, depth) = decode(folder.join("depth").join(format!("{name}.tif")))?;
    let (DecodingResult::U8(rgb), DecodingResult::F32(depth)) = (rgb, depth) else {
        return Err(format!("{name} is no pair of 8-bit RGB and 32-bit depth").into());
    };
    let measured: Vec<usize> = (0..depth.len()).filter(|&place| depth[place] > 0.0).collect();
    Ok(Pair {
        name,
        image: Image::from_raw(width, height, rgb)?,
        metres: measured.iter().map(|&place| depth[place]).collect(),
        rows: measured.iter().map(|&place| (height - place / width) as f32).collect(),
        measured,
    })
}
