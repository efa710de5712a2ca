//! `fuse --json`: a record of each picture for programs, one a line.

use std::ffi::OsStr;
use std::path::Path;

use aquafuse::depth::SuppliedReport;
use aquafuse::fusion::{Bounds, Clipping};
use aquafuse::waterbody::Quality;
use aquafuse_data::job::{Item, Message, Report};
use serde::Serialize;

/// One picture; `schema` changes when a field changes its meaning or goes.
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
    Done {
        clipping: Clipping,
        quality: Quality,
        held_back: HeldBack,
        supplied_depth: Option<Supplied>,
        damage: Option<&'a str>,
        left_out: &'a [&'static str],
    },
    Kept,
    Failed {
        error: String,
    },
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

/// Which safety bounds acted.
#[derive(Serialize)]
struct HeldBack {
    glare: bool,
    red: bool,
    gain: bool,
}

#[derive(Serialize)]
struct Supplied {
    invalid_share: f64,
    agreement: Option<f64>,
    looks_turned_round: bool,
}

/// The line of a message that is about a picture.
pub(super) fn line(message: &Message<'_>) -> Option<String> {
    let (item, outcome): (&Item, Outcome<'_>) = match message {
        Message::Done { item, report } => (item, done(report)),
        Message::Kept { item } => (item, Outcome::Kept),
        Message::Failed { item, error } => (item, Outcome::Failed { error: error.to_string() }),
        _ => return None,
    };
    let record = Record { schema: 1, input: Name::of(&item.input), output: Name::of(&item.output), outcome };
    serde_json::to_string(&record).ok().map(|line| line + "\n")
}

fn done(report: &Report) -> Outcome<'_> {
    let Bounds { glare, red, gain, .. } = report.bounds;
    let supplied = |supplied: SuppliedReport| Supplied {
        invalid_share: supplied.invalid_share(),
        agreement: supplied.agreement,
        looks_turned_round: supplied.looks_turned_round(),
    };
    Outcome::Done {
        clipping: report.clipping,
        quality: report.quality,
        held_back: HeldBack { glare, red, gain },
        supplied_depth: report.supplied.map(supplied),
        damage: report.damage.as_deref(),
        left_out: &report.left_out,
    }
}
