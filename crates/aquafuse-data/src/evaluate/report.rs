//! What an evaluation has found, and the files it is written to.

mod csv;
mod files;
mod html;
mod image;
mod json;
mod markdown;

use aquafuse::image::Image;
use serde_json::Value;

use super::{Failed, Summary};

pub use csv::{items as csv_of_items, tables as csv_of_tables};
pub use files::{check_name, write};
pub use html::page as html;
pub use image::thumbnail;
pub use json::document as json;
pub use markdown::{document as markdown, table as markdown_of_table};

/// The figures of an evaluation, with its settings and results.
#[derive(Clone, Debug)]
pub struct Report {
    /// The command that makes it.
    pub command: &'static str,
    /// A heading.
    pub title: String,
    /// What was measured, a paragraph each.
    pub about: Vec<String>,
    /// Everything except the images that determines the figures.
    pub settings: Value,
    /// The figures.
    pub tables: Vec<Table>,
    /// The single scores that they summarise.
    pub items: Items,
    /// What failed, by name.
    pub failed: Vec<Failed>,
    /// Example images.
    pub gallery: Vec<Strip>,
}

/// Rows of scores.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its key for programs.
    pub name: &'static str,
    /// Its title.
    pub title: String,
    /// The headings of the labels.
    pub labels: Vec<&'static str>,
    /// The headings of the cells.
    pub scores: Vec<Score>,
    /// The rows.
    pub rows: Vec<Row>,
}

/// A column of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Score {
    /// Its key for programs.
    pub key: &'static str,
    /// Its title, with its unit.
    pub title: &'static str,
    /// Digits after the decimal point.
    pub digits: usize,
    /// Which part of a summary people see.
    pub shown: Shown,
}

/// Which part of a cell people see; programs get all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Mean ± variance, as the paper prints it, and the interval.
    MeanAndVariance,
    /// The same, for a score that another column gives on another scale.
    OtherScale,
    /// The mean and the interval.
    Mean,
    /// One number.
    Number,
}

/// One row.
#[derive(Clone, Debug)]
pub struct Row {
    /// What it is about, one for each of [`Table::labels`].
    pub labels: Vec<String>,
    /// Its figures, one for each of [`Table::scores`].
    pub cells: Vec<Cell>,
}

/// One figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// No figure.
    Nothing,
    /// A number.
    Number(f64),
    /// Mean, variance and interval of several.
    Summary(Summary),
}

/// The scores of each result.
#[derive(Clone, Debug)]
pub struct Items {
    /// What the labels are.
    pub labels: Vec<&'static str>,
    /// What the values are.
    pub scores: Vec<Score>,
    /// One for each result.
    pub rows: Vec<ItemsRow>,
}

/// The scores of one result.
#[derive(Clone, Debug, PartialEq)]
pub struct ItemsRow {
    /// What it is about.
    pub labels: Vec<String>,
    /// Its scores; `None` for a missing score.
    pub values: Vec<Option<f64>>,
}

/// Small images side by side.
#[derive(Clone, Debug)]
pub struct Strip {
    /// What they are.
    pub caption: String,
    /// Each with a caption of its own.
    pub images: Vec<(String, Image<u8>)>,
}

impl Cell {
    /// The figure as people see it; empty if there is none.
    pub(crate) fn text(&self, score: &Score) -> String {
        let digits = score.digits;
        match self {
            Self::Nothing => String::new(),
            Self::Number(number) => format!("{number:.digits$}"),
            Self::Summary(Summary { left_out, mean, variance, interval, .. }) => {
                let mut text = format!("{mean:.digits$}");
                if matches!(score.shown, Shown::MeanAndVariance | Shown::OtherScale) {
                    text.push_str(&format!(" ± {variance:.digits$}"));
                }
                if let Some([low, high]) = interval {
                    text.push_str(&format!(" ({low:.digits$} to {high:.digits$})"));
                }
                if *left_out > 0 {
                    text.push_str(&format!("; {left_out} left out"));
                }
                text
            }
        }
    }
}

#[cfg(test)]
mod tests;
