//! Fuses every content with its references and scores what comes out.

use std::error::Error;
use std::path::Path;

use aquafuse::depth::DepthModel;
use aquafuse::fusion::{Options, Waters, fuse};
use aquafuse::image::Image;
use aquafuse::metrics::{DepthRmse, depth_rmse, psnr, ssim};
use aquafuse::smooth::Smoothing;
use aquafuse_data::analysis::{Analysis, DepthSource, analyse};
use aquafuse_data::folder;
use aquafuse_data::picture::Picture;
use rayon::prelude::*;

/// References of each content, as many as in the paper.
pub(crate) const REFERENCES: usize = 8;

/// A way to fuse.
pub(crate) struct Settings {
    pub(crate) name: &'static str,
    pub(crate) options: Options,
    pub(crate) smoothing: Smoothing,
}

/// A picture and what it tells about its water.
pub(crate) struct Scene {
    pub(crate) name: String,
    picture: Image<u8>,
    found: Analysis,
}

/// How one fused picture compares with its content.
pub(crate) struct Scores {
    pub(crate) psnr: f64,
    pub(crate) ssim: f64,
    pub(crate) depth: DepthRmse,
}

/// All scenes of a folder, by name, analysed with the paper's Eq. 3.
pub(crate) fn read_all(folder: &Path) -> Result<Vec<Scene>, Box<dyn Error>> {
    let read = |path: &std::path::PathBuf| {
        let picture = Picture::read(path)?;
        let found = analyse(&picture, &DepthSource::default())?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Scene { name, picture: picture.pixels.into_bytes(), found })
    };
    Ok(folder::list(folder)?
        .pictures
        .par_iter()
        .map(read)
        .collect::<Result<Vec<_>, aquafuse_data::picture::FileError>>()?)
}

/// The references of one content: even steps through the sorted list of the others, from the one after it.
pub(crate) fn references(content: usize, scenes: usize) -> impl Iterator<Item = usize> {
    let others = scenes - 1;
    (0..REFERENCES.min(others)).map(move |k| (content + 1 + k * others / REFERENCES.min(others)) % scenes)
}

impl Scene {
    /// This content's scores with each of its references.
    pub(crate) fn scores(
        &self,
        references: &[&Scene],
        settings: &Settings,
    ) -> Result<Vec<Scores>, Box<dyn Error + Send + Sync>> {
        references.iter().map(|reference| self.score(reference, settings)).collect()
    }

    fn score(&self, reference: &Scene, settings: &Settings) -> Result<Scores, Box<dyn Error + Send + Sync>> {
        let content = &self.picture;
        let waters =
            Waters { content: &self.found.estimate.water, reference: &reference.found.estimate.water };
        let fused =
            settings.smoothing.apply(fuse(content, &self.found.depth, waters, &settings.options)?.image);
        Ok(Scores {
            psnr: psnr(content, &fused)?,
            ssim: ssim(content, &fused)?.ok_or_else(|| format!("{} is too small to be scored", self.name))?,
            depth: depth_rmse(content, &fused, DepthModel::default())?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_content_is_its_own_reference_and_none_comes_twice() {
        for scenes in [2, 5, 9, 47] {
            for content in 0..scenes {
                let mut found: Vec<usize> = references(content, scenes).collect();
                found.push(content);
                found.sort_unstable();
                found.dedup();
                assert_eq!(found.len(), 1 + REFERENCES.min(scenes - 1), "{content} of {scenes}");
            }
        }
    }
}
