//! How much of the true change each method makes, on scenes of known truth.
//!
//! Share = 1 - RMSE(out, truth) / RMSE(content, truth) over all pixels and channels, before clipping: 1 is the truth,
//! 0 the content, below 0 farther from the truth than the content was. Truth A is the content's place with nothing
//! exchanged but B∞; truth B is the same place wholly in the other water.

mod ways;

use aquafuse::fusion::Model;
use aquafuse::image::Encoding;
use aquafuse::truth::{Exchange, Trials};
use serde_json::json;

use super::chance::Chance;
use super::report::{Cell, Items, ItemsRow, Row, Score, Shown, Table};
use super::statistics::{quantile, summarise};
use super::{EvaluateError, Listener, Palette, Report, Rival};
use crate::run::{Event, RunOptions};
use ways::{Found, ways};

/// Every method on exchanges of synthetic scenes: the three models with depth and water from each source, the rivals, and
/// the truths themselves.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Number of exchanges, each a content and a reference in another water.
    pub exchanges: usize,
    /// Form scenes, estimate and fuse in linear light.
    pub linear: bool,
    /// Random seed of the bootstrap.
    pub seed: u64,
    /// How to run.
    pub run_options: RunOptions,
}

const SHARE: Shown = Shown::Mean;
const SCORES: [Score; 9] = [
    Score { key: "share_a", title: "truth A, mean", digits: 2, shown: SHARE },
    Score { key: "share_a_median", title: "median", digits: 2, shown: Shown::Number },
    Score { key: "worse_percent", title: "worse than the content, %", digits: 0, shown: Shown::Number },
    Score { key: "share_a_open", title: "open water in both", digits: 2, shown: SHARE },
    Score { key: "share_b", title: "truth B, mean", digits: 2, shown: SHARE },
    Score { key: "share_b_median", title: "median", digits: 2, shown: Shown::Number },
    Score { key: "rmse_a", title: "RMSE to A, 0–255", digits: 1, shown: SHARE },
    Score { key: "rmse_b", title: "RMSE to B, 0–255", digits: 1, shown: SHARE },
    Score { key: "structure", title: "structure kept, SSIM", digits: 3, shown: SHARE },
];
/// What is known of one result.
const ITEM_SCORES: [Score; 5] = [SCORES[0], SCORES[4], SCORES[6], SCORES[7], SCORES[8]];

const ABOUT: &str = "Synthetic harbours in Jerlov's waters, half of the contents with open water in view; the reference is \
    another place in a water whose veil differs by at least .2 in some channel. Share of the true change: 1 is the truth, 0 \
    the content, below 0 farther from the truth than the content. Truth A is the scene with only B∞ exchanged, truth B \
    the scene with the whole water exchanged. Structure kept: SSIM of luma with the content; the last rows give it for \
    the truths, because a true change also changes contrast. Brackets: 95 % bootstrap interval of the mean over \
    exchanges. The rivals get the whole reference image.";

/// A row of the table: what is given or estimated, and the method.
struct Line {
    way: &'static str,
    method: String,
}

impl Truth {
    /// Runs the evaluation.
    ///
    /// # Errors
    ///
    /// [`EvaluateError::Stopped`] when it was stopped.
    pub fn run(&self, listener: Listener<'_>) -> Result<Report, EvaluateError> {
        match self.linear {
            true => self.run_in::<aquafuse::image::Linear>(listener),
            false => self.run_in::<aquafuse::image::Encoded>(listener),
        }
    }

    fn run_in<E: Encoding>(&self, listener: Listener<'_>) -> Result<Report, EvaluateError> {
        listener(Event::Started { total: self.exchanges });
        let trials = Trials::default();
        let numbers: Vec<usize> = (0..self.exchanges).collect();
        let found = self.run_options.map(&numbers, |&number| {
            let exchange = trials.exchange::<E>(number);
            let found = all(&exchange);
            listener(Event::Done { item: &format!("exchange {number}"), result: () });
            (exchange.open(), found)
        })?;
        Ok(Report {
            command: "evaluate truth",
            title: "Share of the true change".into(),
            about: vec![ABOUT.into()],
            settings: json!({
                "encoding": if self.linear { "linear" } else { "encoded" },
                "exchanges": self.exchanges,
                "seed": self.seed,
            }),
            tables: vec![self.table(&found)],
            items: items(&found),
            failed: Vec::new(),
            gallery: Vec::new(),
        })
    }

    fn table(&self, found: &[(bool, Vec<Found>)]) -> Table {
        let rows = lines().into_iter().enumerate().map(|(place, line)| {
            let column = || found.iter().filter_map(move |(open, all)| Some((*open, all.get(place)?)));
            let key = [line.way, &line.method];
            let mean = |values: Vec<f64>| {
                let lists: Vec<Vec<f64>> = values.into_iter().map(|value| vec![value]).collect();
                summarise(&lists, Chance::keyed(self.seed, &key)).map_or(Cell::Nothing, Cell::Summary)
            };
            let all = |of: fn(&Found) -> f64| column().map(|(_, found)| of(found)).collect::<Vec<f64>>();
            let open = column().filter(|(open, _)| *open).map(|(_, found)| found.share[0]).collect();
            let [a, b] = [all(|found| found.share[0]), all(|found| found.share[1])];
            let worse = a.iter().filter(|share| **share < 0.0).count() as f64 / a.len().max(1) as f64;
            let (middle_a, middle_b) = (quantile(&a, 0.5), quantile(&b, 0.5));
            let cells = vec![
                mean(a),
                Cell::Number(middle_a),
                Cell::Number(100.0 * worse),
                mean(open),
                mean(b),
                Cell::Number(middle_b),
                mean(all(|found| found.rmse[0])),
                mean(all(|found| found.rmse[1])),
                mean(all(|found| found.structure)),
            ];
            Row { labels: vec![line.way.to_owned(), line.method], cells }
        });
        Table {
            name: "truth",
            title: "How much of the true change is made".into(),
            labels: vec!["way", "method"],
            scores: SCORES.to_vec(),
            rows: rows.collect(),
        }
    }
}

/// What each line makes of an exchange, in the order of [`lines`].
fn all<E: Encoding>(exchange: &Exchange<E>) -> Vec<Found> {
    let mut found: Vec<Found> = ways().iter().flat_map(|way| way.all_models(exchange)).collect();
    let (content, reference) = (&exchange.content.image, &exchange.reference.image);
    let (own, other) = (Palette::of(content), Palette::of(reference));
    for rival in Rival::ALL {
        let made = rival.transfer(content, &own, &other);
        found.push(Found::of(exchange, |i, _| made[i].map(E::from_encoded)));
    }
    for truth in &exchange.truths {
        found.push(Found::of(exchange, |i, _| truth.pixels()[i]));
    }
    found
}

fn lines() -> Vec<Line> {
    let model = |model: Model| format!("`{}`", model.name());
    let of_way = |way: ways::Way| Model::ALL.iter().map(move |of| Line { way: way.name, method: model(*of) });
    let rivals = Rival::ALL.map(|rival| Line { way: "colours alone", method: rival.name().to_owned() });
    let truths = ["A", "B"].map(|truth| Line { way: "the truth itself", method: truth.to_owned() });
    ways().into_iter().flat_map(of_way).chain(rivals).chain(truths).collect()
}

fn items(found: &[(bool, Vec<Found>)]) -> Items {
    let lines = lines();
    let row = |number: usize, open: bool, line: &Line, found: &Found| ItemsRow {
        labels: vec![number.to_string(), open.to_string(), line.way.to_owned(), line.method.clone()],
        values: [found.share[0], found.share[1], found.rmse[0], found.rmse[1], found.structure]
            .map(Some)
            .to_vec(),
    };
    let of_exchange = |(number, (open, all)): (usize, &(bool, Vec<Found>))| {
        lines.iter().zip(all).map(|(line, found)| row(number, *open, line, found)).collect::<Vec<_>>()
    };
    Items {
        labels: vec!["exchange", "open_water_in_both", "way", "method"],
        scores: ITEM_SCORES.to_vec(),
        rows: found.iter().enumerate().flat_map(of_exchange).collect(),
    }
}

#[cfg(test)]
mod tests;
