//! A scene beside the same one fused, as a report: the paper's table of view synthesis, on anybody's scene.

use aquafuse::metrics::{psnr, ssim};
use aquafuse_data::evaluate::report::{
    Cell, Items, ItemsRow, Row, Score, Shown as Figure, Strip, Table, thumbnail,
};
use aquafuse_data::evaluate::{EvaluateError, Listener, Lpips, Report, Summary};
use aquafuse_data::files::display;
use aquafuse_data::run::Event;
use serde_json::json;

use super::{image, normal_deviation, normals_shown};
use crate::around::Around;
use crate::camera::Camera;
use crate::capture::View;
use crate::model::Model;
use crate::render::{Rendering, render};
use crate::splats::MAX_SH_DEGREE;

/// A scene: the images held out of training, and the model trained on the others.
#[derive(Clone, Debug)]
pub struct Side {
    /// The scene's name.
    pub name: String,
    /// The images held out.
    pub held_out: Vec<View>,
    /// The model trained on the other images.
    pub model: Model,
}

/// A scene and the same scene fused, once or several times (several waters or fusion models).
#[derive(Clone, Debug)]
pub struct Comparison {
    original: Side,
    /// A model trained on the original's images with another seed: the difference between two runs on the same images.
    floor: Option<Model>,
    fused: Vec<Side>,
    lpips: Option<Lpips>,
}

/// Scenes cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The cameras of two scenes differ.
    #[error(
        "{other} has other cameras than {original}; compare a scene with what `aquafuse scene fuse` made of it"
    )]
    OtherCameras {
        /// The original's name.
        original: String,
        /// The other's name.
        other: String,
    },
    /// No image was held out.
    #[error("no image of {scene} is compared; lower --hold")]
    NothingHeldOut {
        /// The original's name.
        scene: String,
    },
}

/// PSNR, SSIM, LPIPS, SND in percent, and the mean of 1 - cos; `None` where a score is unknown.
type Scores = [Option<f64>; 5];

const SCORES: [Score; 5] = [
    Score { key: "psnr", title: "PSNR, dB", digits: 2, shown: Figure::Mean },
    Score { key: "ssim", title: "SSIM", digits: 4, shown: Figure::Mean },
    Score { key: "lpips", title: "LPIPS", digits: 4, shown: Figure::Mean },
    Score { key: "normal_deviation_percent", title: "SND, %", digits: 2, shown: Figure::Mean },
    Score { key: "one_minus_cos", title: "1 − cos", digits: 4, shown: Figure::Mean },
];
const LPIPS: usize = 2;
const RATIOS: [Score; 3] = [
    Score { key: "psnr_percent", title: "PSNR, % of the original's", digits: 1, shown: Figure::Number },
    Score { key: "ssim_percent", title: "SSIM, % of the original's", digits: 1, shown: Figure::Number },
    Score { key: "normal_deviation_of_floor", title: "SND in floors", digits: 2, shown: Figure::Number },
];

const ABOUT: [&str; 2] = [
    "Views that were held out of training: renderings of the model trained on the original images beside those images, and \
     renderings of the models trained on fused images beside those. PSNR of all channels, SSIM of luma. Cells: the mean over \
     views and, in brackets, its interval from 95 of 100 resamplings of them.",
    "SND is the mean angle between the surface normals of two models, as a share of 180 degrees; 1 − cos is the mean of that. \
     A normal comes from the plane that best fits the distances of the splats in a window of 5 % of the view's width; it counts \
     where both models are opaque and near to their planes, 2 % of the distance. The floor is the difference between two \
     runs on the original images with different seeds: a deviation up to the floor is not caused by fusion.",
];

/// Seed of resampling: intervals are the same in every run.
const SEED: u64 = 0;
/// Views shown in the report: the first, and one half way.
const STRIPS: usize = 2;

impl Comparison {
    /// Scenes to be compared.
    ///
    /// # Errors
    ///
    /// [`CompareError`] when their cameras differ, or no image was held out.
    pub fn new(
        original: Side,
        floor: Option<Model>,
        fused: Vec<Side>,
        lpips: Option<Lpips>,
    ) -> Result<Self, CompareError> {
        if original.held_out.is_empty() {
            return Err(CompareError::NothingHeldOut { scene: original.name });
        }
        let alike = |side: &Side| {
            let cameras = side.held_out.iter().zip(&original.held_out);
            side.held_out.len() == original.held_out.len()
                && cameras.into_iter().all(|(a, b)| a.camera == b.camera)
        };
        if let Some(other) = fused.iter().find(|side| !alike(side)) {
            return Err(CompareError::OtherCameras {
                original: original.name.clone(),
                other: other.name.clone(),
            });
        }
        Ok(Self { original, floor, fused, lpips })
    }

    /// Renders and scores every view.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when the network of LPIPS cannot take a view.
    pub fn report(&self, listener: Listener<'_>) -> Result<Report, EvaluateError> {
        let sides = self.sides();
        listener(Event::Started { total: sides.len() * self.original.held_out.len() });
        // Of each side, view by view.
        let mut scores: Vec<Vec<Scores>> = vec![Vec::new(); sides.len()];
        let mut gallery = Vec::new();
        for (view, one) in self.original.held_out.iter().enumerate() {
            let rendered: Vec<Rendering<f32>> =
                sides.iter().map(|side| rendering_of(side.model, &one.camera)).collect();
            for (place, side) in sides.iter().enumerate() {
                let held = &side.held_out[view];
                let against = (place > 0).then(|| &rendered[0]);
                scores[place].push(self.scores(held, &rendered[place], against)?);
                listener(Event::Done { item: &display(&held.name).to_string(), result: () });
            }
            if view.is_multiple_of(self.original.held_out.len().div_ceil(STRIPS)) {
                gallery.extend(strips(&sides, view, &rendered));
            }
        }
        gallery.extend(self.above(&sides));
        Ok(Report {
            command: "scene compare",
            title: format!("{} in 3D, and fused", self.original.name),
            about: ABOUT.map(str::to_owned).to_vec(),
            settings: json!({
                "scene": self.original.name,
                "fused": self.fused.iter().map(|side| side.name.as_str()).collect::<Vec<_>>(),
                "views": self.original.held_out.len(),
            }),
            tables: [Some(self.table(&sides, &scores)), self.ratios(&scores)].into_iter().flatten().collect(),
            items: self.items(&sides, &scores),
            failed: Vec::new(),
            gallery,
        })
    }

    /// The original, its floor and the fused scenes, in this order.
    fn sides(&self) -> Vec<Named<'_>> {
        let original = &self.original;
        let of = |label: String, held_out, model| Named { label, held_out, model };
        let first = of("original".into(), &original.held_out, &original.model);
        let floor =
            self.floor.iter().map(|model| of("original, another seed".into(), &original.held_out, model));
        let fused =
            self.fused.iter().map(|side| of(format!("fused: {}", side.name), &side.held_out, &side.model));
        [first].into_iter().chain(floor).chain(fused).collect()
    }

    fn scores(
        &self,
        held: &View,
        rendered: &Rendering<f32>,
        against: Option<&Rendering<f32>>,
    ) -> Result<Scores, EvaluateError> {
        let seen = image(rendered);
        let lpips = match &self.lpips {
            Some(network) => Some(network.distance(&seen.convert(), &held.image.convert())?),
            None => None,
        };
        let deviation = against.map(|original| normal_deviation(&held.camera, original, rendered));
        let deviation = deviation.filter(|found| found.pixels > 0);
        Ok([
            psnr(&seen, &held.image).ok(),
            ssim(&seen, &held.image).ok().flatten(),
            lpips,
            deviation.map(|found| 100.0 * found.angle),
            deviation.map(|found| found.cosine),
        ])
    }

    /// Indices of the scores in the tables: LPIPS only with a network.
    fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        (0..SCORES.len()).filter(|&place| place != LPIPS || self.lpips.is_some())
    }

    fn table(&self, sides: &[Named<'_>], scores: &[Vec<Scores>]) -> Table {
        let row = |(side, scores): (&Named<'_>, &Vec<Scores>)| Row {
            labels: vec![self.original.name.clone(), side.label.clone()],
            cells: self
                .columns()
                .map(|place| mean(scores, place).map_or(Cell::Nothing, Cell::Summary))
                .collect(),
        };
        Table {
            name: "reconstruction",
            title: "Views held out, and surfaces".into(),
            labels: vec!["scene", "pictures"],
            scores: self.columns().map(|place| SCORES[place]).collect(),
            rows: sides.iter().zip(scores).map(row).collect(),
        }
    }

    /// Scores of the fused scenes as shares of the original's; the unit of deviation is the floor's. `None` without a fused
    /// scene.
    fn ratios(&self, scores: &[Vec<Scores>]) -> Option<Table> {
        let value = |side: &Vec<Scores>, place| mean(side, place).map(|summary| summary.mean);
        let (original, fused) = scores.split_first()?;
        let floors = usize::from(self.floor.is_some());
        let floor = fused.first().filter(|_| floors > 0).and_then(|side| value(side, 3));
        let share = |of: Option<f64>, whole: Option<f64>, unit: f64| match (of, whole) {
            (Some(of), Some(whole)) if whole > 0.0 => Cell::Number(unit * of / whole),
            _ => Cell::Nothing,
        };
        let rows: Vec<Row> = self
            .fused
            .iter()
            .zip(fused.iter().skip(floors))
            .map(|(side, scores)| Row {
                labels: vec![self.original.name.clone(), format!("fused: {}", side.name)],
                cells: vec![
                    share(value(scores, 0), value(original, 0), 100.0),
                    share(value(scores, 1), value(original, 1), 100.0),
                    share(value(scores, 3), floor, 1.0),
                ],
            })
            .collect();
        (!rows.is_empty()).then(|| Table {
            name: "ratios",
            title: "Fused, beside the original".into(),
            labels: vec!["scene", "pictures"],
            scores: RATIOS.to_vec(),
            rows,
        })
    }

    fn items(&self, sides: &[Named<'_>], scores: &[Vec<Scores>]) -> Items {
        let rows = sides.iter().zip(scores).flat_map(|(side, scores)| {
            side.held_out.iter().zip(scores).map(|(one, scores)| ItemsRow {
                labels: vec![self.original.name.clone(), side.label.clone(), display(&one.name).to_string()],
                values: self.columns().map(|place| scores[place]).collect(),
            })
        });
        Items {
            labels: vec!["scene", "pictures", "view"],
            scores: self.columns().map(|place| SCORES[place]).collect(),
            rows: rows.collect(),
        }
    }

    /// Each scene from above.
    fn above(&self, sides: &[Named<'_>]) -> Option<Strip> {
        let cameras: Vec<&Camera> = self.original.held_out.iter().map(|one| &one.camera).collect();
        let camera = Around::new(&cameras, &self.original.model.splats)?.above();
        let images = sides
            .iter()
            .map(|side| {
                let seen = image(&rendering_of(side.model, &camera));
                (side.label.clone(), thumbnail(&seen.convert()))
            })
            .collect();
        Some(Strip { caption: "from above, where no camera was".into(), images })
    }
}

/// A row of the table.
struct Named<'a> {
    label: String,
    held_out: &'a [View],
    model: &'a Model,
}

fn rendering_of(model: &Model, camera: &Camera) -> Rendering<f32> {
    render(&model.splats, MAX_SH_DEGREE, camera, &model.medium).rendering
}

/// A score's mean over views; `None` where no view has it.
fn mean(scores: &[Scores], place: usize) -> Option<Summary> {
    let values: Vec<Vec<f64>> = scores.iter().filter_map(|scores| scores[place]).map(|v| vec![v]).collect();
    Summary::of(&values, SEED, &[SCORES[place].key])
}

/// One view of every scene: its image, its rendering, and its surfaces.
fn strips(sides: &[Named<'_>], view: usize, rendered: &[Rendering<f32>]) -> [Strip; 3] {
    let name = |one: &View| display(&one.name).to_string();
    let camera = &sides[0].held_out[view].camera;
    let strip = |what: &str, of: &dyn Fn(usize) -> aquafuse::image::Image<f32>| Strip {
        caption: format!("{}: {what}", name(&sides[0].held_out[view])),
        images: sides
            .iter()
            .enumerate()
            .map(|(place, side)| (side.label.clone(), thumbnail(&of(place).convert())))
            .collect(),
    };
    [
        strip("what the camera took", &|place| sides[place].held_out[view].image.clone()),
        strip("what the splats show", &|place| image(&rendered[place])),
        strip("their surfaces, coloured by the way they face", &|place| {
            normals_shown(camera, &rendered[place])
        }),
    ]
}

#[cfg(test)]
mod tests;
