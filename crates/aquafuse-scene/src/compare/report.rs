//! A scene beside the same one fused, as a report: the paper's table of view synthesis, on anybody's scene.

use aquafuse::metrics::{psnr, ssim};
use aquafuse_data::evaluate::report::{
    Cell, Items, ItemsRow, Row, Score, Shown as Figure, Strip, Table, thumbnail,
};
use aquafuse_data::evaluate::{EvaluateError, Listener, Lpips, Message, Report, Summary};
use aquafuse_data::image_file::shown;
use serde_json::json;

use super::{image, normal_deviation, normals_shown};
use crate::around::Around;
use crate::camera::Camera;
use crate::capture::Shown;
use crate::medium::Medium;
use crate::render::{Drawing, render};
use crate::splats::{MOST_DEGREE, Splats};

/// Splats and what they are seen through.
#[derive(Clone, Debug)]
pub struct Model {
    /// What was trained.
    pub splats: Splats<f32>,
    /// What it was trained through.
    pub medium: Medium<f32>,
}

/// A scene: images that were held back, and what was trained on the others.
#[derive(Clone, Debug)]
pub struct Side {
    /// What it is called.
    pub name: String,
    /// The images held back.
    pub held: Vec<Shown>,
    /// What was trained on the others.
    pub model: Model,
}

/// A scene and the same one fused, in one water or by one model or in several.
#[derive(Clone, Debug)]
pub struct Comparison {
    original: Side,
    /// What was trained on the original's images with another seed: how far two runs differ on the same images.
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
    /// There is nothing to compare by.
    #[error("no image of {scene} is compared; lower --hold")]
    NothingHeld {
        /// The original's name.
        scene: String,
    },
}

/// PSNR, SSIM, LPIPS, SND in percent, and the mean of 1 - cos; none where there is none.
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
    "Views that training was not shown: what was trained on the originals beside their images, and what was trained on \
     fused ones beside theirs. PSNR of all channels, SSIM of luma. Cells: the mean over views and, in brackets, where it \
     lies in 95 of 100 resamplings of them.",
    "SND is the mean angle between the normals of two surfaces, of 180 degrees, drawn from the distances that splats have \
     in each view, where both are opaque; 1 − cos the mean of that. The floor is what two runs on the originals with \
     other seeds differ by: what is no more than that is no fault of fusion.",
];

/// Seed of resampling: intervals are the same in every run.
const SEED: u64 = 0;
/// Views that are shown, the first and one from the middle.
const STRIPS: usize = 2;

impl Comparison {
    /// Scenes to be compared.
    ///
    /// # Errors
    ///
    /// [`CompareError`] when their cameras differ, or no image was held back.
    pub fn new(
        original: Side,
        floor: Option<Model>,
        fused: Vec<Side>,
        lpips: Option<Lpips>,
    ) -> Result<Self, CompareError> {
        if original.held.is_empty() {
            return Err(CompareError::NothingHeld { scene: original.name });
        }
        let alike = |side: &Side| {
            let cameras = side.held.iter().zip(&original.held);
            side.held.len() == original.held.len() && cameras.into_iter().all(|(a, b)| a.camera == b.camera)
        };
        if let Some(other) = fused.iter().find(|side| !alike(side)) {
            return Err(CompareError::OtherCameras {
                original: original.name.clone(),
                other: other.name.clone(),
            });
        }
        Ok(Self { original, floor, fused, lpips })
    }

    /// Draws and scores every view.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when the network of LPIPS cannot take a view.
    pub fn report(&self, listener: Listener<'_>) -> Result<Report, EvaluateError> {
        let sides = self.sides();
        listener(Message::Started { total: sides.len() * self.original.held.len() });
        // Of each side, view by view.
        let mut scores: Vec<Vec<Scores>> = vec![Vec::new(); sides.len()];
        let mut gallery = Vec::new();
        for (view, one) in self.original.held.iter().enumerate() {
            let drawn: Vec<Drawing<f32>> = sides.iter().map(|side| draw(side.model, &one.camera)).collect();
            for (place, side) in sides.iter().enumerate() {
                let taken = &side.held[view];
                let against = (place > 0).then(|| &drawn[0]);
                scores[place].push(self.scores(taken, &drawn[place], against)?);
                listener(Message::Done { name: &shown(&taken.name).to_string() });
            }
            if view.is_multiple_of(self.original.held.len().div_ceil(STRIPS)) {
                gallery.extend(strips(&sides, view, &drawn));
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
                "views": self.original.held.len(),
            }),
            tables: [Some(self.table(&sides, &scores)), self.ratios(&scores)].into_iter().flatten().collect(),
            items: self.items(&sides, &scores),
            failed: Vec::new(),
            gallery,
        })
    }

    /// The original, its floor and what was fused, in this order.
    fn sides(&self) -> Vec<Named<'_>> {
        let original = &self.original;
        let of = |label: String, held, model| Named { label, held, model };
        let first = of("original".into(), &original.held, &original.model);
        let floor = self.floor.iter().map(|model| of("original, another seed".into(), &original.held, model));
        let fused =
            self.fused.iter().map(|side| of(format!("fused: {}", side.name), &side.held, &side.model));
        [first].into_iter().chain(floor).chain(fused).collect()
    }

    fn scores(
        &self,
        taken: &Shown,
        drawn: &Drawing<f32>,
        against: Option<&Drawing<f32>>,
    ) -> Result<Scores, EvaluateError> {
        let seen = image(drawn);
        let lpips = match &self.lpips {
            Some(network) => Some(network.distance(&seen.convert(), &taken.image.convert())?),
            None => None,
        };
        let deviation = against.map(|original| normal_deviation(&taken.camera, original, drawn));
        let deviation = deviation.filter(|found| found.pixels > 0);
        Ok([
            psnr(&seen, &taken.image).ok(),
            ssim(&seen, &taken.image).ok().flatten(),
            lpips,
            deviation.map(|found| 100.0 * found.angle),
            deviation.map(|found| found.cosine),
        ])
    }

    /// Places of the scores that are taken: LPIPS where there is a network for it.
    fn taken(&self) -> impl Iterator<Item = usize> + '_ {
        (0..SCORES.len()).filter(|&place| place != LPIPS || self.lpips.is_some())
    }

    fn table(&self, sides: &[Named<'_>], scores: &[Vec<Scores>]) -> Table {
        let row = |(side, scores): (&Named<'_>, &Vec<Scores>)| Row {
            labels: vec![self.original.name.clone(), side.label.clone()],
            cells: self
                .taken()
                .map(|place| mean(scores, place).map_or(Cell::Nothing, Cell::Summary))
                .collect(),
        };
        Table {
            name: "reconstruction",
            title: "Views held back, and surfaces".into(),
            labels: vec!["scene", "pictures"],
            scores: self.taken().map(|place| SCORES[place]).collect(),
            rows: sides.iter().zip(scores).map(row).collect(),
        }
    }

    /// What was fused in shares of the original; the floor's own deviation is its unit. None without anything fused.
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
            side.held.iter().zip(scores).map(|(one, scores)| ItemsRow {
                labels: vec![self.original.name.clone(), side.label.clone(), shown(&one.name).to_string()],
                values: self.taken().map(|place| scores[place]).collect(),
            })
        });
        Items {
            labels: vec!["scene", "pictures", "view"],
            scores: self.taken().map(|place| SCORES[place]).collect(),
            rows: rows.collect(),
        }
    }

    /// Each scene from above.
    fn above(&self, sides: &[Named<'_>]) -> Option<Strip> {
        let cameras: Vec<&Camera> = self.original.held.iter().map(|one| &one.camera).collect();
        let camera = Around::new(&cameras, &self.original.model.splats)?.above();
        let images = sides
            .iter()
            .map(|side| {
                let seen = image(&draw(side.model, &camera));
                (side.label.clone(), thumbnail(&seen.convert()))
            })
            .collect();
        Some(Strip { caption: "from above, where no camera was".into(), images })
    }
}

/// A row of the table.
struct Named<'a> {
    label: String,
    held: &'a [Shown],
    model: &'a Model,
}

fn draw(model: &Model, camera: &Camera) -> Drawing<f32> {
    render(&model.splats, MOST_DEGREE, camera, &model.medium).drawing
}

/// A score's mean over views; none where no view has it.
fn mean(scores: &[Scores], place: usize) -> Option<Summary> {
    let values: Vec<Vec<f64>> = scores.iter().filter_map(|scores| scores[place]).map(|v| vec![v]).collect();
    Summary::of(&values, SEED, &[SCORES[place].key])
}

/// One view of every scene: what its camera took, what is drawn of its splats, and their surfaces.
fn strips(sides: &[Named<'_>], view: usize, drawn: &[Drawing<f32>]) -> [Strip; 3] {
    let name = |one: &Shown| shown(&one.name).to_string();
    let camera = &sides[0].held[view].camera;
    let strip = |what: &str, of: &dyn Fn(usize) -> aquafuse::image::Image<f32>| Strip {
        caption: format!("{}: {what}", name(&sides[0].held[view])),
        images: sides
            .iter()
            .enumerate()
            .map(|(place, side)| (side.label.clone(), thumbnail(&of(place).convert())))
            .collect(),
    };
    [
        strip("what the camera took", &|place| sides[place].held[view].image.clone()),
        strip("what the splats show", &|place| image(&drawn[place])),
        strip("their surfaces, coloured by the way they face", &|place| normals_shown(camera, &drawn[place])),
    ]
}

#[cfg(test)]
mod tests;
