//! How good images look before and after: by scores that need no other image, and by references if there are any.

use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim};
use serde_json::{Map, Value, json};

use super::chance::Chance;
use super::outputs::{self, Outputs, refuse_ambiguous};
use super::report::{Cell, Items, ItemsRow, Row, Score, Shown, Table};
use super::statistics::summarise;
use super::{Alone, EvaluateError, Failed, Listener, Member, Report};
use crate::image_file::{Format, ImageFile};
use crate::pipeline::Operation;
use crate::pipeline::Scores;
use crate::pipeline::{DepthSource, analyse_in};
use crate::run::{Budget, Event, RunOptions};

/// Images scored as they are, and after restoration, enhancement, the simplest rivals, and other tools.
#[derive(Clone, Debug)]
pub struct Enhancement {
    /// The images.
    pub images: Vec<Member>,
    /// What is done to them, by its name in the report. What needs depth and water gets them in its own encoding.
    pub methods: Vec<(String, Operation)>,
    /// References with the images' stems and sizes: each method is scored by how near it comes.
    pub references: Option<Outputs>,
    /// How depth is obtained.
    pub source: DepthSource,
    /// Outputs of other tools, in files with the images' stems.
    pub outputs: Vec<Outputs>,
    /// Random seed of the bootstrap.
    pub seed: u64,
    /// How to run.
    pub run_options: RunOptions,
    /// The settings of the methods, for the report.
    pub settings: Map<String, Value>,
}

/// The name of the original images.
const BEFORE: &str = "before";

const SCORES: [Score; 7] = [
    Score { key: "psnr", title: "PSNR, dB", digits: 2, shown: Shown::Mean },
    Score { key: "ssim", title: "SSIM", digits: 3, shown: Shown::Mean },
    Score { key: "uciqe", title: "UCIQE", digits: 3, shown: Shown::Mean },
    Score { key: "uiqm", title: "UIQM", digits: 3, shown: Shown::Mean },
    Score { key: "colour", title: "colour", digits: 3, shown: Shown::Mean },
    Score { key: "contrast", title: "contrast", digits: 3, shown: Shown::Mean },
    Score { key: "sharpness", title: "sharpness", digits: 3, shown: Shown::Mean },
];
/// Scores that need a reference; they stand first.
const OF_REFERENCE: usize = 2;
const COUNT: Score = Score { key: "pictures", title: "images", digits: 0, shown: Shown::Number };
/// What scoring takes in bytes a pixel: colours in CIELab, chroma and lightness by themselves.
const SCORED: u64 = 48;

const ABOUT: &str = "UCIQE and its parts colour (deviation of chroma) and contrast (of lightness), UIQM and its part \
    sharpness. Higher counts as better, but oversaturation and noise raise all of them: look at the images too. Brackets: \
    95 % bootstrap interval of the mean over images. The change is computed for each image: if its interval excludes 0, \
    it is significant.";
const ABOUT_REFERENCES: &str = "PSNR (RGB) and SSIM (BT.601 luma) compare with the reference of each image. Such references are \
    mostly the outputs of other programs that people preferred, not the truth.";

/// The scores of an image: as it is, and by each method that made something of it.
type Found = Vec<Option<[Option<f64>; SCORES.len()]>>;

impl Enhancement {
    /// Runs the evaluation; what failed is listed in the report.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when outputs of other tools cannot be matched.
    pub fn run(&self, listener: Listener<'_>) -> Result<Report, EvaluateError> {
        if !self.outputs.is_empty() || self.references.is_some() {
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
            about: self.references.iter().map(|_| ABOUT_REFERENCES.into()).chain([ABOUT.into()]).collect(),
            settings: self.described(),
            tables: vec![self.table(&found, None), self.table(&found, Some(0))],
            items: self.items(&found),
            failed,
            gallery: Vec::new(),
        })
    }

    fn described(&self) -> Value {
        let mut settings = self.settings.clone();
        settings.insert("depth_model".into(), json!(self.source.name()));
        settings.insert("seed".into(), json!(self.seed));
        settings.insert("pictures".into(), json!(self.images.len()));
        Value::Object(settings)
    }

    /// Before, ours, the simplest rivals, then the others.
    fn names(&self) -> Vec<&str> {
        let ours = self.methods.iter().map(|(name, _)| name.as_str());
        let rivals = Alone::ALL.iter().map(|rival| rival.name());
        let others = self.outputs.iter().map(Outputs::name);
        [BEFORE].into_iter().chain(ours).chain(rivals).chain(others).collect()
    }

    /// How many of the scores are left out: those with a reference where there is none.
    fn left_out(&self) -> usize {
        if self.references.is_some() { 0 } else { OF_REFERENCE }
    }

    fn score(&self, member: &Member, budget: &Budget) -> Result<(Found, Vec<Failed>), EvaluateError> {
        let reading = &self.run_options.reading;
        let opened = ImageFile::open(&member.path, reading)?;
        let of_files = if self.outputs.is_empty() { 0 } else { outputs::BYTES_A_PIXEL };
        let of_reference = if self.references.is_some() { outputs::BYTES_A_PIXEL } else { 0 };
        let of_methods = self.methods.iter().map(|(_, operation)| operation.encoding().bytes_a_pixel()).max();
        let a_pixel = of_files
            .max(of_methods.unwrap_or(0))
            .saturating_add(of_reference)
            .saturating_add(SCORED)
            .saturating_add(16);
        let beside = opened.pixels().saturating_mul(a_pixel);
        let _room = budget.reserve_for(&opened, Format::Png, beside)?;
        let image_file = opened.decode()?;
        let read = |outputs: &Outputs| outputs.read(&member.stem(), member, &image_file, reading);
        let reference = self.references.as_ref().map(read).transpose()?;
        let values = |image: &Image<u8>| values(image, reference.as_ref());
        let before = image_file.bytes();
        let (mut found, mut failed) = (vec![Some(values(&before))], Vec::new());
        for (_, operation) in &self.methods {
            let analyse = || analyse_in(operation.encoding(), &image_file, &self.source);
            let analysis = operation.needs_analysis().then(analyse).transpose()?;
            let mut pixels = image_file.pixels.clone();
            operation.apply(&mut pixels, analysis.as_ref()).expect("the depth map is this image's");
            found.push(Some(values(&pixels.into_bytes())));
        }
        found.extend(Alone::ALL.iter().map(|rival| Some(values(&rival.image(&before)))));
        for outputs in &self.outputs {
            match read(outputs) {
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
                let kept: Vec<[Option<f64>; SCORES.len()]> = found.iter().filter_map(of).collect();
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
                    cells: [count].into_iter().chain((self.left_out()..SCORES.len()).map(score)).collect(),
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
            scores: [COUNT].into_iter().chain(SCORES.into_iter().skip(self.left_out())).collect(),
            rows: rows.collect(),
        }
    }

    fn items(&self, found: &[Found]) -> Items {
        let of_image = |(member, all): (&Member, &Found)| {
            let row = |(name, values): (&&str, &Option<[Option<f64>; SCORES.len()]>)| {
                let labels = vec![member.name.clone(), (*name).to_owned()];
                values.map(|values| ItemsRow {
                    labels,
                    values: values.into_iter().skip(self.left_out()).collect(),
                })
            };
            self.names().iter().zip(all).filter_map(row).collect::<Vec<_>>()
        };
        Items {
            labels: vec!["picture", "method"],
            scores: SCORES.into_iter().skip(self.left_out()).collect(),
            rows: self.images.iter().zip(found).flat_map(of_image).collect(),
        }
    }
}

fn values(image: &Image<u8>, reference: Option<&Image<u8>>) -> [Option<f64>; SCORES.len()] {
    let Scores { uciqe, uiqm, colour, contrast, sharpness, .. } = Scores::of(image);
    let psnr = reference.and_then(|reference| psnr(image, reference).ok());
    let ssim = reference.and_then(|reference| ssim(image, reference).ok().flatten());
    [psnr, ssim, Some(uciqe), uiqm, Some(colour), Some(contrast), sharpness]
}
