//! The waters to sample from.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse::depth::DepthKind;
use aquafuse::waterbody::Verdict;
use aquafuse_data::augment::{OnDoubtful, Water};
use aquafuse_data::files::sha256;
use aquafuse_data::files::{FileError, display};
use aquafuse_data::image_file;
use aquafuse_data::pipeline::{DepthEstimator, PixelEncoding};
use aquafuse_data::water_file::{WaterFile, has_suffix};

use crate::args::common::Common;
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;

/// The named waters; a folder contributes its images and water files.
pub(super) fn sources(named: &[PathBuf]) -> Result<Vec<WaterSource>, Failure> {
    let mut sources = Vec::new();
    for path in named {
        if !path.is_dir() {
            sources.push(WaterSource::parse(path)?);
            continue;
        }
        let failed = |error| FileError::Read { path: path.clone(), error };
        let mut inside: Vec<PathBuf> = image_file::list(path)?.images;
        for entry in std::fs::read_dir(path).map_err(failed)? {
            inside.extend(Some(entry.map_err(failed)?.path()).filter(|path| has_suffix(path)));
        }
        if inside.is_empty() {
            let cause = anyhow!(
                "{} holds no images and no *.water.json files; name a folder that does",
                display(path)
            );
            return Err(Failure::usage(cause));
        }
        inside.sort();
        for path in inside {
            sources.push(WaterSource::parse(&path)?);
        }
    }
    Ok(sources)
}

/// Reads a water, per unit of the images' depth.
pub(super) fn read(
    source: &WaterSource,
    arguments: &WaterArguments,
    model: &DepthEstimator,
    kind: DepthKind,
    encoding: PixelEncoding,
    common: &Common,
) -> Result<Water, Failure> {
    let file: WaterFile = arguments.read(source, model, encoding, &common.reading)?;
    let estimate = arguments.per(kind, &file)?;
    let digest = |path: &std::path::Path| {
        let failed = |error| FileError::Read { path: path.to_owned(), error };
        std::fs::read(path).map_err(failed).map(|bytes| sha256(&bytes))
    };
    let sha256 = source.path().map(digest).transpose()?;
    let file = WaterFile { depth_kind: kind, estimate, ..file };
    Ok(Water { name: source.name(), sha256, file })
}

/// The waters to sample from, after --on-doubtful.
pub(super) fn without_doubtful(waters: Vec<Water>, how: &OnDoubtful) -> Vec<Water> {
    let is_good = |water: &Water| water.file.estimate.quality().verdict == Verdict::Good;
    match how {
        OnDoubtful::Flag => waters,
        OnDoubtful::Skip => waters.into_iter().filter(is_good).collect(),
        OnDoubtful::Instead(water) => {
            let mut good: Vec<Water> = Vec::new();
            for kept in waters.into_iter().map(|own| if is_good(&own) { own } else { (**water).clone() }) {
                // A water that replaces several is not sampled more often for that.
                if !good.iter().any(|other| other.name == kept.name) {
                    good.push(kept);
                }
            }
            good
        }
    }
}
