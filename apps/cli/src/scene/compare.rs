//! `aquafuse scene compare`: how alike a scene and the same one fused are.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse::metrics::{psnr, ssim};
use aquafuse_scene::capture::{self, Shown, pictures_of};
use aquafuse_scene::compare::{NormalDeviation, normal_deviation, picture};
use aquafuse_scene::render::{Rendered, render};
use aquafuse_scene::splats::MOST_DEGREE;
use clap::Args;
use serde_json::json;

use super::splats_file::Trained;
use crate::common::Common;
use crate::failure::Failure;
use crate::output;

/// Compare a trained scene with the same one fused: PSNR and SSIM of views, and how far surfaces lean away.
#[derive(Args)]
#[command(after_help = "\
SND is the mean angle between the normals of both scenes' surfaces, of 180 degrees, over pixels opaque in both,
1 - cos its mean. The floor is what two runs on the originals differ by: train twice with other --seed.

Example:
  aquafuse scene train reef/ -o a.ply --hold 8 && aquafuse scene train reef/ -o b.ply --hold 8 --seed 1
  aquafuse scene train reef_green/ -o green.ply --hold 8
  aquafuse scene compare reef/ reef_green/ --original a.ply --fused green.ply --floor b.ply")]
pub(crate) struct Compare {
    /// The folder of the scene.
    original_scene: PathBuf,
    /// The folder of the same scene, fused.
    fused_scene: PathBuf,
    /// What was trained on the first.
    #[arg(long, value_name = "FILE.ply")]
    original: PathBuf,
    /// What was trained on the second.
    #[arg(long, value_name = "FILE.ply")]
    fused: PathBuf,
    /// What was trained on the first with another seed.
    #[arg(long, value_name = "FILE.ply")]
    floor: Option<PathBuf>,
    /// Every Nth picture is compared: those that `scene train --hold N` held back.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    hold: u32,
    /// Pictures are compared at this many pixels on their longer side.
    #[arg(long, value_name = "PIXELS", default_value_t = 400, value_parser = clap::value_parser!(u32).range(16..=65535))]
    longest: u32,
    /// Print JSON for programs.
    #[arg(long)]
    json: bool,
}

/// Means over views.
#[derive(Clone, Copy, Default, serde::Serialize)]
struct Scores {
    psnr: f64,
    ssim: f64,
}

impl Compare {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let original = self.views(&self.original_scene, common)?;
        let fused = self.views(&self.fused_scene, common)?;
        let same =
            original.len() == fused.len() && original.iter().zip(&fused).all(|(a, b)| a.camera == b.camera);
        if !same {
            return Err(Failure::usage(anyhow!(
                "the two scenes have other cameras; compare one with what `aquafuse scene fuse` made of it"
            )));
        }
        let drawn = |path: &Path, views: &[Shown]| -> Result<Vec<Rendered<f32>>, Failure> {
            let trained = Trained::read(path)?;
            Ok(views
                .iter()
                .map(|one| render(&trained.splats, MOST_DEGREE, &one.camera, &trained.medium))
                .collect())
        };
        let (first, second) = (drawn(&self.original, &original)?, drawn(&self.fused, &fused)?);
        let found = mean_deviation(&original, &first, &second);
        let floor = match &self.floor {
            Some(path) => Some(mean_deviation(&original, &first, &drawn(path, &original)?)),
            None => None,
        };
        let scores = [scores(&original, &first)?, scores(&fused, &second)?];
        output::print(&if self.json {
            let told = |of: NormalDeviation| json!({ "angle": of.angle, "one_minus_cos": of.cosine, "pixels": of.pixels });
            let report = json!({
                "schema": 1,
                "views": original.len(),
                "original": scores[0],
                "fused": scores[1],
                "normal_deviation": told(found),
                "floor": floor.map(told),
            });
            format!("{report:#}\n")
        } else {
            table(original.len(), &scores, &found, floor.as_ref())
        })
    }

    fn views(&self, scene: &Path, common: &Common) -> Result<Vec<Shown>, Failure> {
        let taken =
            capture::read(scene, &pictures_of(scene), self.longest as usize, &common.reading.options())?;
        let kept = taken.shown.into_iter().enumerate().filter(|(i, _)| i.is_multiple_of(self.hold as usize));
        Ok(kept.map(|(_, one)| one).collect())
    }
}

fn scores(views: &[Shown], drawn: &[Rendered<f32>]) -> Result<Scores, Failure> {
    let mut sum = Scores::default();
    for (one, drawn) in views.iter().zip(drawn) {
        let drawn = picture(&drawn.drawing);
        sum.psnr += psnr(&drawn, &one.picture).map_err(Failure::work)?;
        sum.ssim += ssim(&drawn, &one.picture).map_err(Failure::work)?.unwrap_or(f64::NAN);
    }
    let count = views.len() as f64;
    Ok(Scores { psnr: sum.psnr / count, ssim: sum.ssim / count })
}

/// Each pixel that was compared counts once.
fn mean_deviation(views: &[Shown], a: &[Rendered<f32>], b: &[Rendered<f32>]) -> NormalDeviation {
    let each =
        views.iter().zip(a).zip(b).map(|((one, a), b)| normal_deviation(&one.camera, &a.drawing, &b.drawing));
    let sum = each.fold(NormalDeviation::default(), |sum, one| NormalDeviation {
        angle: sum.angle + one.angle * one.pixels as f64,
        cosine: sum.cosine + one.cosine * one.pixels as f64,
        pixels: sum.pixels + one.pixels,
    });
    let count = sum.pixels.max(1) as f64;
    NormalDeviation { angle: sum.angle / count, cosine: sum.cosine / count, ..sum }
}

fn table(
    views: usize,
    scores: &[Scores; 2],
    found: &NormalDeviation,
    floor: Option<&NormalDeviation>,
) -> String {
    let mut text = format!("Means over {views} views.\n\n| scene | PSNR, dB | SSIM |\n|---|---|---|\n");
    for (name, scores) in ["original", "fused"].into_iter().zip(scores) {
        text += &format!("| {name} | {:.2} | {:.4} |\n", scores.psnr, scores.ssim);
    }
    text += "\n| surfaces | SND | 1 - cos |\n|---|---|---|\n";
    let deviations = [("original against fused", Some(found)), ("floor: original, two seeds", floor)];
    for (name, one) in deviations.into_iter().filter_map(|(name, one)| Some((name, one?))) {
        text += &format!("| {name} | {:.4} | {:.4} |\n", one.angle, one.cosine);
    }
    text
}
