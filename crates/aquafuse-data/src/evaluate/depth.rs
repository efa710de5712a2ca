//! How right depth is: of each model from colour, of networks, and in maps from elsewhere, beside depth that is known.

mod agreement;

use aquafuse::depth::SuppliedKind;
use aquafuse::image::TopEdge;
use serde_json::json;

use super::chance::Chance;
use super::report::{Cell, Items, ItemsRow, Row, Score, Shown, Table};
use super::statistics::summarise;
use super::{EvaluateError, Failed, Listener, Report};
use crate::depth_file::{self, DepthFolder};
use crate::depth_network::NetworkKind;
use crate::files::FileError;
use crate::image_file::{Format, ImageFile};
use crate::pairs::Pair;
use crate::pipeline::DepthEstimator;
use crate::run::{Budget, Event, RunOptions};
use agreement::{Agreement, Unit};

/// Images with known depth, and the models and maps to compare with it.
#[derive(Clone, Debug)]
pub struct Depth {
    /// Images with known depth.
    pub pairs: Vec<Pair>,
    /// The kind of the known depth.
    pub kind: SuppliedKind,
    /// Depth models of colours, and networks, by name.
    pub models: Vec<(String, DepthEstimator)>,
    /// Other depth maps.
    pub maps: Vec<Maps>,
    /// Random seed of the bootstrap.
    pub seed: u64,
    /// How to run.
    pub run_options: RunOptions,
}

/// A folder of depth maps, one for each image, with the same stem.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Their name in the report.
    pub name: String,
    /// The kind of their values.
    pub kind: SuppliedKind,
    /// The files.
    pub folder: DepthFolder,
}

const SCORES: [Score; 4] = [
    Score { key: "spearman", title: "Spearman", digits: 2, shown: Shown::Mean },
    Score { key: "rmse_metres", title: "RMSE, m", digits: 2, shown: Shown::Mean },
    Score { key: "rmse_percent", title: "RMSE, % of the mean", digits: 1, shown: Shown::Mean },
    Score { key: "delta_percent", title: "δ < 1.25, %", digits: 1, shown: Shown::Mean },
];
const COUNT: Score = Score { key: "pictures", title: "images", digits: 0, shown: Shown::Number };
/// What it takes in bytes a pixel: known and estimated distances, as floats and by rank, and the order of both.
const COMPARED: u64 = 80;
/// The prior that the top of an image is far.
const ROW: &str = "image row";

const ABOUT: &str = "Scores use the pixels with known depth: Spearman's rank correlation (1 is the right order everywhere), and, \
    after fitting scale and shift to each image without inverting it, the RMSE and the share of pixels within a factor \
    of 1.25. Maps of kind `inverse` (networks) are fitted as 1 / z. Image row: a baseline that assumes higher pixels are \
    farther. Brackets: 95 % bootstrap interval of the mean over images.";

/// The scores of one image, by each model and each folder of maps.
type Found = Vec<Option<Agreement>>;

impl Depth {
    /// Runs the evaluation; what failed is listed in the report.
    ///
    /// # Errors
    ///
    /// [`EvaluateError::Stopped`] when it was stopped.
    pub fn run(&self, listener: Listener<'_>) -> Result<Report, EvaluateError> {
        listener(Event::Started { total: self.pairs.len() });
        let budget = self.run_options.budget();
        let compared = self.run_options.map(&self.pairs, |pair| {
            let (found, failed) = self
                .compare(pair, &budget)
                .unwrap_or_else(|error| (Vec::new(), vec![Failed::new(&pair.name, &error)]));
            failed
                .iter()
                .for_each(|failed| listener(Event::Failed { item: &failed.name, error: failed.clone() }));
            listener(Event::Done { item: &pair.name, result: () });
            (found, failed)
        })?;
        let (found, failed): (Vec<Found>, Vec<Vec<Failed>>) = compared.into_iter().unzip();
        let mut failed = failed.concat();
        failed.sort();
        Ok(Report {
            command: "evaluate depth",
            title: "Depth beside depth that is known".into(),
            about: vec![ABOUT.into()],
            settings: json!({
                "depth_kind": self.kind.name(),
                "pairs": self.pairs.len(),
                "maps": self.maps.iter().map(|maps| format!("{} ({})", maps.name, maps.kind.name())).collect::<Vec<_>>(),
                "seed": self.seed,
            }),
            tables: vec![self.table(&found)],
            items: self.items(&found),
            failed,
            gallery: Vec::new(),
        })
    }

    fn names(&self) -> Vec<String> {
        let models = self.models.iter().map(|(name, _)| name.clone());
        models.chain([ROW.to_owned()]).chain(self.maps.iter().map(|maps| maps.name.clone())).collect()
    }

    fn compare(&self, pair: &Pair, budget: &Budget) -> Result<(Found, Vec<Failed>), EvaluateError> {
        let opened = ImageFile::open(&pair.rgb, &self.run_options.reading)?;
        let estimators = self.models.iter().map(|(_, model)| model.memory(opened.pixels()));
        let beside = opened.pixels().saturating_mul(COMPARED).saturating_add(estimators.max().unwrap_or(0));
        let _room = budget.reserve_for(&opened, Format::Png, beside)?;
        let image = opened.decode()?;
        let (top, size) = (image.top_edge(), image.pixels.size());
        let turned = image.metadata.orientation() > 4;
        let bytes = image.bytes();
        let read = |path: &std::path::Path, kind| -> Result<Vec<f32>, EvaluateError> {
            let unfit = |error| FileError::UnfitDepth { path: path.to_owned(), error, turned };
            Ok(depth_file::read_for(path, kind, size)?.labels(&bytes).map_err(unfit)?)
        };
        let known = read(&pair.depth, self.kind)?;
        let unit = Unit::of(self.kind);
        let mut failed = Vec::new();
        let mut found = Found::new();
        for (name, model) in &self.models {
            match model.depth(&image, &bytes) {
                Ok((depth, _)) => {
                    found.push(Agreement::of(&depth.distances(), unit_of(model), &known, unit));
                }
                Err(error) => {
                    found.push(None);
                    failed
                        .push(Failed::new(&format!("{} by {name}", pair.name), &EvaluateError::from(error)));
                }
            }
        }
        found.push(Agreement::of(&rows(size, top), Unit::Shifted, &known, unit));
        for maps in &self.maps {
            let values = maps
                .folder
                .map_of(&pair.rgb)
                .map_err(EvaluateError::from)
                .and_then(|path| read(path, maps.kind));
            match values {
                Ok(values) => found.push(Agreement::of(&values, Unit::of(maps.kind), &known, unit)),
                Err(error) => {
                    found.push(None);
                    failed.push(Failed::new(&format!("{} by {}", pair.name, maps.name), &error));
                }
            }
        }
        Ok((found, failed))
    }

    fn table(&self, found: &[Found]) -> Table {
        let rows = self.names().into_iter().enumerate().map(|(place, name)| {
            let of: Vec<Agreement> =
                found.iter().filter_map(|all| all.get(place).copied().flatten()).collect();
            let score = |value: fn(&Agreement) -> Option<f64>| {
                let lists: Vec<Vec<f64>> = of.iter().map(|one| value(one).into_iter().collect()).collect();
                summarise(&lists, Chance::keyed(self.seed, &[&name])).map_or(Cell::Nothing, Cell::Summary)
            };
            let cells = [
                Cell::Number(of.len() as f64),
                score(|one| one.spearman),
                score(|one| one.rmse_metres),
                score(|one| one.rmse_percent),
                score(|one| one.delta_percent),
            ];
            Row { labels: vec![name], cells: cells.to_vec() }
        });
        Table {
            name: "depth",
            title: "Agreement with known depth".into(),
            labels: vec!["depth"],
            rows: rows.collect(),
            scores: [COUNT].into_iter().chain(SCORES).collect(),
        }
    }

    fn items(&self, found: &[Found]) -> Items {
        let names = self.names();
        let of_pair = |(pair, all): (&Pair, &Found)| {
            let row = |(name, one): (&String, &Option<Agreement>)| {
                let Agreement { spearman, rmse_metres, rmse_percent, delta_percent } = (*one)?;
                let values = vec![spearman, rmse_metres, rmse_percent, delta_percent];
                Some(ItemsRow { labels: vec![pair.name.clone(), name.clone()], values })
            };
            names.iter().zip(all).filter_map(row).collect::<Vec<_>>()
        };
        Items {
            labels: vec!["picture", "depth"],
            scores: SCORES.to_vec(),
            rows: self.pairs.iter().zip(found).flat_map(of_pair).collect(),
        }
    }
}

/// What is left open in the distances that a model gives.
fn unit_of(model: &DepthEstimator) -> Unit {
    let DepthEstimator::Network(network) = model else { return Unit::Shifted };
    Unit::of(match network.kind() {
        NetworkKind::Inverse => SuppliedKind::Inverse,
        NetworkKind::Metric => SuppliedKind::Metres,
        NetworkKind::Relative => SuppliedKind::Relative,
    })
}

/// The height of each pixel in the upright image.
fn rows((width, height): (usize, usize), top: TopEdge) -> Vec<f32> {
    let height_of = |x: usize, y: usize| match top {
        TopEdge::First => height.saturating_sub(y),
        TopEdge::Last => y,
        TopEdge::Left => width.saturating_sub(x),
        TopEdge::Right => x,
    };
    (0..height).flat_map(|y| (0..width).map(move |x| height_of(x, y) as f32)).collect()
}
