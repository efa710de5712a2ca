//! How much of the true change each method makes, on scenes of known truth.
//!
//! Share = 1 - RMSE(out, truth) / RMSE(content, truth) over all pixels and channels, before clipping: 1 is the truth,
//! 0 the content, below 0 farther from the truth than the content was. Truth A is the content's place with nothing
//! exchanged but B∞; truth B is the same place wholly in the other water; truth C is the same place in the other water and in its
//! light, which is the truth of scenes that are lit by their own water.

mod ways;

use std::path::Path;

use aquafuse::fusion::Model;
use aquafuse::image::{Encoding, Image};
use aquafuse::scene_area::Border;
use aquafuse::truth::{LitCase, LitWaters, Site, Trials};
use serde_json::json;

use super::chance::Chance;
use super::report::{Cell, Items, ItemsRow, Row, Score, Shown, Table};
use super::statistics::{quantile, summarise};
use super::{EvaluateError, Listener, Palette, Report, Rival};
use crate::image_file::{ImageFile, Opened, ReadOptions};
use crate::run::{Event, RunOptions};
use ways::{Found, Pair, Way, ways};

/// Every method on exchanges of synthetic scenes: the models with depth and water from each source, the rivals, and
/// the truths themselves.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Number of exchanges, each a content and a reference in another water.
    pub exchanges: usize,
    /// The family of places.
    pub places: Site,
    /// Scenes that are lit by their own water, as a camera exposes and balances them: truth C. `None`: truths A and B.
    pub lit: Option<LitWaters>,
    /// Form scenes, estimate and fuse in linear light.
    pub linear: bool,
    /// Random seed of the bootstrap.
    pub seed: u64,
    /// How to run.
    pub run_options: RunOptions,
}

const SHARE: Shown = Shown::Mean;
const LIT_SCORES: [Score; 6] = [
    Score { key: "share_c", title: "truth C, mean", digits: 2, shown: SHARE },
    Score { key: "share_c_median", title: "median", digits: 2, shown: Shown::Number },
    Score { key: "worse_percent", title: "worse than the content, %", digits: 0, shown: Shown::Number },
    Score { key: "share_c_open", title: "open water in both", digits: 2, shown: SHARE },
    Score { key: "rmse_c", title: "RMSE to C, 0–255", digits: 1, shown: SHARE },
    Score { key: "structure", title: "structure kept, SSIM", digits: 3, shown: SHARE },
];
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
const LIT_ITEM_SCORES: [Score; 3] = [LIT_SCORES[0], LIT_SCORES[4], LIT_SCORES[5]];

/// What a family of places is.
fn about(places: Site) -> &'static str {
    match places {
        Site::Harbour => "Synthetic harbours, half of the contents with open water in view.",
        Site::Wall => {
            "Synthetic walls with an overhang, lit from above; half of the contents with open water in view. \
            No constant and no weight was ever fitted to them."
        }
        Site::OpenWater => {
            "A school of fish and divers in black in open water, without a floor. No constant and no weight was ever fitted \
            to such scenes."
        }
        _ => {
            "Synthetic reefs, half of the contents with open water in view: constants were chosen on such places."
        }
    }
}

const ABOUT: &str = "They are in Jerlov's waters; the reference is \
    another place in a water whose veil differs by at least .2 in some channel. Share of the true change: 1 is the truth, 0 \
    the content, below 0 farther from the truth than the content. Truth A is the scene with only B∞ exchanged, truth B \
    the scene with the whole water exchanged. Structure kept: SSIM of luma with the content; the last rows give it for \
    the truths, because a true change also changes contrast. Brackets: 95 % bootstrap interval of the mean over \
    exchanges. The rivals get the whole reference image.";

const ABOUT_LIT: &str = "They are in Jerlov's waters, 1 to 20 m below the surface, each lit by what its own water \
    leaves of daylight, formed in linear light; a camera exposes, balances in part, encodes and adds noise. The reference is \
    another place in a water whose veil differs by at least .2 in some channel of the image. Share of the true change: 1 is \
    the truth, 0 the content, below 0 farther from the truth than the content. Truth C is the content's place in the \
    reference's water and its light, by the reference's camera. Structure kept: SSIM of luma with the content; the last row \
    shows it for the truth. Brackets: 95 % bootstrap interval of the mean over exchanges. The rivals get the whole reference \
    image.";

const ABOUT_SEA: &str = "Here waters are drawn as `sea:NUMBER` is, by numbers that nothing else uses, and the camera stores its \
    images as JPEG of a quality from 60 to 95. Truth C is not compressed.";

/// The waters of lit scenes by name.
fn name(waters: LitWaters) -> &'static str {
    match waters {
        LitWaters::Sea => "sea",
        _ => "jerlov",
    }
}

/// Stores the image of a case as its camera does.
fn stored(case: &mut LitCase) {
    if let Some(quality) = case.jpeg_quality {
        let name = Path::new("camera.jpg");
        let bytes =
            ImageFile::new(case.image.clone()).encode(name, quality).expect("bytes are stored as JPEG");
        let options = ReadOptions { border: Border::None, ..ReadOptions::default() };
        let decoded = ImageFile::open_bytes(name, bytes, &options).and_then(Opened::decode);
        case.image = decoded.expect("what was encoded is decoded").bytes().into_owned();
    }
}

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
        let trials = Trials::at(self.places);
        let numbers: Vec<usize> = (0..self.exchanges).collect();
        let found = self.run_options.map(&numbers, |&number| {
            let found = if let Some(waters) = self.lit {
                let mut exchange = trials.lit_exchange_in(waters, number);
                stored(&mut exchange.content);
                stored(&mut exchange.reference);
                let truth = in_encoding::<E>(&exchange.truth);
                (exchange.open(), all(&Pair::lit(&exchange, &truth), &self.ways()))
            } else {
                let exchange = trials.exchange::<E>(number);
                (exchange.open(), all(&Pair::new(&exchange), &self.ways()))
            };
            listener(Event::Done { item: &format!("exchange {number}"), result: () });
            found
        })?;
        Ok(Report {
            command: "evaluate truth",
            title: "Share of the true change".into(),
            about: match self.lit {
                Some(LitWaters::Sea) => vec![about(self.places).into(), ABOUT_LIT.into(), ABOUT_SEA.into()],
                Some(_) => vec![about(self.places).into(), ABOUT_LIT.into()],
                None => vec![about(self.places).into(), ABOUT.into()],
            },
            settings: json!({
                "encoding": if self.linear { "linear" } else { "encoded" },
                "exchanges": self.exchanges,
                "lit": self.lit.map(name),
                "places": self.places.name(),
                "seed": self.seed,
            }),
            tables: vec![self.table(&found)],
            items: self.items(&found),
            failed: Vec::new(),
            gallery: Vec::new(),
        })
    }

    fn table(&self, found: &[(bool, Vec<Found>)]) -> Table {
        let rows = self.lines().into_iter().enumerate().map(|(place, line)| {
            let column = || found.iter().filter_map(move |(open, all)| Some((*open, all.get(place)?)));
            let key = [line.way, &line.method];
            let mean = |values: Vec<f64>| {
                let lists: Vec<Vec<f64>> = values.into_iter().map(|value| vec![value]).collect();
                summarise(&lists, Chance::keyed(self.seed, &key)).map_or(Cell::Nothing, Cell::Summary)
            };
            let all = |of: fn(&Found) -> f64| column().map(|(_, found)| of(found)).collect::<Vec<f64>>();
            let open = column().filter(|(open, _)| *open).map(|(_, found)| found.share[0]).collect();
            let first = all(|found| found.share[0]);
            let worse = first.iter().filter(|share| **share < 0.0).count() as f64 / first.len().max(1) as f64;
            let middle = Cell::Number(quantile(&first, 0.5));
            let mut cells = vec![mean(first), middle, Cell::Number(100.0 * worse), mean(open)];
            if self.lit.is_none() {
                let second = all(|found| found.share[1]);
                let middle = Cell::Number(quantile(&second, 0.5));
                cells.extend([mean(second), middle, mean(all(|found| found.rmse[0]))]);
            }
            cells.push(mean(all(|found| *found.rmse.last().expect("a truth"))));
            cells.push(mean(all(|found| found.structure)));
            Row { labels: vec![line.way.to_owned(), line.method], cells }
        });
        Table {
            name: "truth",
            title: "How much of the true change is made".into(),
            labels: vec!["way", "method"],
            scores: self.scores().to_vec(),
            rows: rows.collect(),
        }
    }

    fn scores(&self) -> &'static [Score] {
        if self.lit.is_some() { &LIT_SCORES } else { &SCORES }
    }

    /// How depth and water are obtained; of a lit scene's water no numbers are known that the models could take.
    fn ways(&self) -> Vec<Way> {
        ways().into_iter().filter(|way| self.lit.is_none() || way.estimates()).collect()
    }

    fn lines(&self) -> Vec<Line> {
        let model = |model: Model| format!("`{}`", model.name());
        let of_way = |way: Way| Model::ALL.iter().map(move |of| Line { way: way.name, method: model(*of) });
        let rivals = Rival::ALL.map(|rival| Line { way: "colours alone", method: rival.name().to_owned() });
        let truths: &[&str] = if self.lit.is_some() { &["C"] } else { &["A", "B"] };
        let truths = truths.iter().map(|truth| Line { way: "the truth itself", method: (*truth).to_owned() });
        self.ways().into_iter().flat_map(of_way).chain(rivals).chain(truths).collect()
    }

    fn items(&self, found: &[(bool, Vec<Found>)]) -> Items {
        let lines = self.lines();
        let row = |number: usize, open: bool, line: &Line, found: &Found| {
            let values = found.share.iter().chain(&found.rmse).chain([&found.structure]);
            ItemsRow {
                labels: vec![number.to_string(), open.to_string(), line.way.to_owned(), line.method.clone()],
                values: values.copied().map(Some).collect(),
            }
        };
        let of_exchange = |(number, (open, all)): (usize, &(bool, Vec<Found>))| {
            lines.iter().zip(all).map(|(line, found)| row(number, *open, line, found)).collect::<Vec<_>>()
        };
        let scores = if self.lit.is_some() { LIT_ITEM_SCORES.to_vec() } else { ITEM_SCORES.to_vec() };
        Items {
            labels: vec!["exchange", "open_water_in_both", "way", "method"],
            scores,
            rows: found.iter().enumerate().flat_map(of_exchange).collect(),
        }
    }
}

/// What each line makes of a pair, in the order of [`Truth::lines`].
fn all<E: Encoding>(pair: &Pair<'_, E>, ways: &[Way]) -> Vec<Found> {
    let mut found: Vec<Found> = ways.iter().flat_map(|way| way.all_models(pair)).collect();
    let [content, reference] = pair.images();
    let (own, other) = (Palette::of(content), Palette::of(reference));
    for rival in Rival::ALL {
        let made = rival.transfer(content, &own, &other);
        found.push(Found::of(pair, |i, _| made[i].map(E::from_encoded)));
    }
    for truth in pair.truths() {
        found.push(Found::of(pair, |i, _| truth.pixels()[i]));
    }
    found
}

fn in_encoding<E: Encoding>(image: &Image<f32>) -> Image<f32, E> {
    let samples = image.as_raw().iter().map(|&value| E::from_encoded(value)).collect();
    Image::from_raw(image.width(), image.height(), samples).expect("of the same size")
}

#[cfg(test)]
mod tests;
