//! `--json` and `--report`: a record of each image for programs.

use std::ffi::OsStr;
use std::path::Path;

use aquafuse::depth::SuppliedReport;
use aquafuse::fusion::Clipping;
use aquafuse::levels::Levels;
use aquafuse::waterbody::Quality;
use aquafuse_data::batch::{Item, Report};
use aquafuse_data::pipeline::Limited;
use aquafuse_data::pipeline::Scores;
use aquafuse_data::run::Event;
use aquafuse_data::water_file::Numbers;
use serde::Serialize;

use super::border::BorderRecord;
use serde_json::value::RawValue;

/// One image; `schema` changes when a field changes its meaning or goes.
#[derive(Serialize)]
struct Record<'a> {
    schema: u32,
    input: Name<'a>,
    output: Name<'a>,
    #[serde(flatten)]
    outcome: Outcome<'a>,
}

#[derive(Serialize)]
#[serde(tag = "status", rename_all = "lowercase")]
enum Outcome<'a> {
    Done(Box<Done<'a>>),
    Kept,
    Failed { error: String },
}

#[derive(Serialize)]
struct Done<'a> {
    clipping: Clipping,
    contrast_left: f64,
    change: f64,
    quality: Option<Quality>,
    waterbody: Option<Numbers>,
    levels: Option<Levels>,
    scores: Option<BeforeAfter>,
    held_back: HeldBack,
    supplied_depth: Option<Supplied>,
    /// What was left as it is; `null` if every pixel is scene.
    border: Option<BorderRecord>,
    damage: Option<&'a str>,
    left_out: &'a [&'static str],
}

/// A path: as text, or as bytes where it is no text.
#[derive(Serialize)]
#[serde(untagged)]
enum Name<'a> {
    Text(&'a str),
    Bytes(&'a [u8]),
}

impl<'a> Name<'a> {
    fn of(path: &'a Path) -> Self {
        let name: &OsStr = path.as_os_str();
        name.to_str().map_or(Self::Bytes(name.as_encoded_bytes()), Self::Text)
    }
}

#[derive(Serialize)]
struct BeforeAfter {
    before: Scores,
    after: Scores,
}

/// Which safety bounds acted.
#[derive(Serialize)]
struct HeldBack {
    glare: bool,
    red: bool,
    gain: bool,
    backscatter: bool,
    night: bool,
}

#[derive(Serialize)]
struct Supplied {
    invalid_share: f64,
    agreement: Option<f64>,
    looks_turned_round: bool,
}

/// The record of an event about an image.
pub(super) fn record(event: &Event<'_, Item, Box<Report>>) -> Option<Box<RawValue>> {
    let (item, outcome): (&Item, Outcome<'_>) = match event {
        Event::Done { item, result } => (item, done(result)),
        Event::Skipped { item } => (item, Outcome::Kept),
        Event::Failed { item, error } => (item, Outcome::Failed { error: error.to_string() }),
        _ => return None,
    };
    let record = Record { schema: 1, input: Name::of(&item.input), output: Name::of(&item.output), outcome };
    serde_json::value::to_raw_value(&record).ok()
}

fn done(report: &Report) -> Outcome<'_> {
    let Limited { fusion, restoration } = report.outcome.limited;
    let supplied = |supplied: SuppliedReport| Supplied {
        invalid_share: supplied.invalid_share(),
        agreement: supplied.agreement,
        looks_turned_round: supplied.looks_inverted(),
    };
    Outcome::Done(Box::new(Done {
        clipping: report.outcome.clipping,
        contrast_left: report.outcome.contrast_left,
        change: report.outcome.change,
        quality: report.quality,
        waterbody: report.water,
        levels: report.outcome.levels,
        scores: report.scores.map(|[before, after]| BeforeAfter { before, after }),
        held_back: HeldBack {
            glare: fusion.glare,
            red: fusion.red || restoration.red,
            gain: fusion.gain || restoration.gain,
            backscatter: restoration.backscatter,
            night: fusion.night,
        },
        supplied_depth: report.supplied.map(supplied),
        border: report.area.as_ref().map(BorderRecord::of),
        damage: report.damage.as_deref(),
        left_out: &report.left_out,
    }))
}
