//! How good images look before and after, by scores that need no other image.

use aquafuse::fusion::Options;
use aquafuse::image::Image;
use serde_json::{Value, json};

use super::chance::Chance;
use super::outputs::{self, Outputs, refuse_ambiguous};
use super::report::{Cell, Items, ItemsRow, Row, Score, Shown, Table};
use super::statistics::summarise;
use super::{EvaluateError, Failed, Listener, Member, Report};
use crate::image_file::{Format, ImageFile};
use crate::pipeline::Scores;
use crate::pipeline::{DepthSource, analyse_in};
use crate::pipeline::{Operation, WaterEstimate};
use crate::run::{Budget, Event, RunOptions};

/// Images scored before and after fusion with clear water, and after other tools.
#[derive(Clone, Debug)]
pub struct Enhancement {
    /// The images.
    pub images: Vec<Member>,
    /// Clear water, per unit of the depth of `source`.
    pub clear: WaterEstimate,
    /// How to fuse.
    pub options: Options,
    /// How depth is obtained.
    pub source: DepthSource,
    /// Outputs of other tools, in files with the images' stems.
    pub outputs: Vec<Outputs>,
    /// Random seed of the bootstrap.
    pub seed: u64,
    /// How to run.
    pub run_options: RunOptions,
    /// The name of the clear water, for the report.
    pub water: String,
}

/// The names of the original images and of our method.
const BEFORE: &str = "before";
const OURS: &str = "AquaFuse enhance";

const SCORES: [Score; 5] = [
    Score { key: "uciqe", title: "UCIQE", digits: 3, shown: Shown::Mean },
    Score { key: "uiqm", title: "UIQM", digits: 3, shown: Shown::Mean },
    Score { key: "colour", title: "colour", digits: 3, shown: Shown::Mean },
    Score { key: "contrast", title: "contrast", digits: 3, shown: Shown::Mean },
    Score { key: "sharpness", title: "sharpness", digits: 3, shown: Shown::Mean },
];
const COUNT: Score = Score { key: "pictures", title: "images", digits: 0, shown: Shown::Number };
/// What scoring takes in bytes a pixel: colours in CIELab, chroma and lightness by themselves.
const SCORED: u64 = 48;

const ABOUT: &str = "UCIQE and its parts colour (deviation of chroma) and contrast (of lightness), UIQM and its part \
    sharpness. Higher counts as better, but oversaturation and noise raise all of them: look at the images too. Brackets: \
    95 % bootstrap interval of the mean over images. The change is computed for each image: if its interval excludes 0, \
    it is significant.";

/// The scores of an image: as it is, and by each method that made something of it.
type Found = Vec<Option<[Option<f64>; 5]>>;

impl Enhancement {
    /// Runs the evaluation; what failed is listed in the report.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when outputs of other tools cannot be matched.
    pub fn run(&self, listener: Listener<'_>) -> Result<Report, EvaluateError> {
        if !self.outputs.is_empty() {
            refuse_ambiguous(&self.images)?;
        }
        listener(Event::Started { total: self.images.len() });
        let budget = self.run_options.budget();
        let scored = self.run_options.map(&self.images, |member| {
            let (found, failed) = match self.score(member, &budget) {
                Ok(scored) => scored,
                Err(error) => (Vec::new(), vec![Failed::new(&member.name, &error)]),
            };
            failed
                .iter()
                .for_each(|failed| listener(Event::Failed { item: &failed.name, error: failed.clone() }));
            listener(Event::Done { item: &member.name, result: () });
            (found, failed)
        })?;
        let (found, failed): (Vec<Found>, Vec<Vec<Failed>>) = scored.into_iter().unzip();
        let mut failed = failed.concat();
        failed.sort();
        Ok(Report {
            command: "evaluate enhancement",
            title: "Images before and after".into(),
            about: vec![ABOUT.into()],
            settings: self.described(),
            tables: vec![self.table(&found, None), self.table(&found, Some(0))],
            items: self.items(&found),
            failed,
            gallery: Vec::new(),
        })
    }

    fn described(&self) -> Value {
        json!({
            "encoding": self.clear.encoding().name(),
            "model": self.options.model.name(),
            "theta": self.options.incidence.degrees(),
            "alpha": self.options.gain.get(),
            "depth_model": self.source.name(),
            "water": self.water,
            "seed": self.seed,
            "pictures": self.images.len(),
        })
    }

    /// Before, ours, then the others.
    fn names(&self) -> Vec<&str> {
        [BEFORE, OURS].into_iter().chain(self.outputs.iter().map(Outputs::name)).collect()
    }

    fn score(&self, member: &Member, budget: &Budget) -> Result<(Found, Vec<Failed>), EvaluateError> {
        let opened = ImageFile::open(&member.path, &self.run_options.reading)?;
        let of_others = if self.outputs.is_empty() { 0 } else { outputs::BYTES_A_PIXEL };
        let a_pixel =
            self.clear.encoding().bytes_a_pixel().max(of_others).saturating_add(SCORED).saturating_add(16);
        let beside = opened.pixels().saturating_mul(a_pixel);
        let _room = budget.reserve(opened.memory_until_written(Format::Png, beside)?);
        let image_file = opened.decode()?;
        let (mut found, mut failed) = (vec![Some(values(&image_file.bytes()))], Vec::new());
        let analysis = analyse_in(self.clear.encoding(), &image_file, &self.source)?;
        let operation = Operation::Fuse { reference: self.clear, options: self.options };
        let mut pixels = image_file.pixels.clone();
        operation.apply(&mut pixels, &analysis).expect("the depth map is this image's");
        found.push(Some(values(&pixels.into_bytes())));
        for outputs in &self.outputs {
            match outputs.read(&member.stem(), member, image_file.pixels.size(), &self.run_options.reading) {
                Ok(made) => found.push(Some(values(&made))),
                Err(error) => {
                    found.push(None);
                    failed.push(Failed::new(&format!("{} by {}", member.name, outputs.name()), &error));
                }
            }
        }
        Ok((found, failed))
    }

    /// The scores of each method, or what they are more than those of method `beside`.
    fn table(&self, found: &[Found], beside: Option<usize>) -> Table {
        let names = self.names();
        let rows =
            names.iter().enumerate().filter(|(place, _)| Some(*place) != beside).map(|(place, name)| {
                let of = |all: &Found| {
                    let own = (*all.get(place)?)?;
                    let other = beside.map(|beside| all.get(beside).copied().flatten());
                    match other {
                        None => Some(own),
                        Some(other) => {
                            let other = other?;
                            let less = |c: usize| Some((*own.get(c)?)? - (*other.get(c)?)?);
                            Some(std::array::from_fn(less))
                        }
                    }
                };
                let kept: Vec<[Option<f64>; 5]> = found.iter().filter_map(of).collect();
                let key = [*name, if beside.is_some() { "change" } else { "scores" }];
                let score = |c: usize| {
                    let lists: Vec<Vec<f64>> = kept
                        .iter()
                        .map(|values| values.get(c).copied().flatten().into_iter().collect())
                        .collect();
                    summarise(&lists, Chance::keyed(self.seed, &key)).map_or(Cell::Nothing, Cell::Summary)
                };
                let count = Cell::Number(kept.len() as f64);
                Row {
                    labels: vec![(*name).to_owned()],
                    cells: [count].into_iter().chain((0..SCORES.len()).map(score)).collect(),
                }
            });
        let (name, title) = match beside {
            None => ("scores", "Scores"),
            Some(_) => ("change", "Change, image by image"),
        };
        Table {
            name,
            title: title.into(),
            labels: vec!["method"],
            scores: [COUNT].into_iter().chain(SCORES).collect(),
            rows: rows.collect(),
        }
    }

    fn items(&self, found: &[Found]) -> Items {
        let of_image = |(member, all): (&Member, &Found)| {
            let row = |(name, values): (&&str, &Option<[Option<f64>; 5]>)| {
                let labels = vec![member.name.clone(), (*name).to_owned()];
                values.map(|values| ItemsRow { labels, values: values.to_vec() })
            };
            self.names().iter().zip(all).filter_map(row).collect::<Vec<_>>()
        };
        Items {
            labels: vec!["picture", "method"],
            scores: SCORES.to_vec(),
            rows: self.images.iter().zip(found).flat_map(of_image).collect(),
        }
    }
}

fn values(image: &Image<u8>) -> [Option<f64>; 5] {
    let Scores { uciqe, uiqm, colour, contrast, sharpness, .. } = Scores::of(image);
    [Some(uciqe), uiqm, Some(colour), Some(contrast), sharpness]
}
