//! CSV: a line for each figure of the tables, or for each result.

use super::{Cell, Items, Report};
use crate::evaluate::Summary;

/// The tables as one: a line for each figure, with all that is known of it.
pub fn tables(report: &Report) -> String {
    let mut labels: Vec<&str> = Vec::new();
    for label in report.tables.iter().flat_map(|table| &table.labels) {
        if !labels.contains(label) {
            labels.push(label);
        }
    }
    let figures = ["score", "count", "left_out", "mean", "variance", "low", "high"];
    let header = ["table"].into_iter().chain(labels.iter().copied()).chain(figures);
    let mut text = line(header.map(str::to_owned));
    for table in &report.tables {
        for row in &table.rows {
            let of = |label: &&str| {
                let place = table.labels.iter().position(|other| other == label)?;
                row.labels.get(place).cloned()
            };
            let about: Vec<String> = labels.iter().map(|label| of(label).unwrap_or_default()).collect();
            for (cell, score) in row.cells.iter().zip(&table.scores) {
                let Some(figures) = figures_of(cell) else { continue };
                let start = [table.name.to_owned()].into_iter().chain(about.iter().cloned());
                text.push_str(&line(start.chain([score.key.to_owned()]).chain(figures)));
            }
        }
    }
    text
}

/// The results one by one.
pub fn items(items: &Items) -> String {
    let header = items.labels.iter().copied().chain(items.scores.iter().map(|score| score.key));
    let mut text = line(header.map(str::to_owned));
    for row in &items.rows {
        let values = row.values.iter().map(|value| value.map(|value| value.to_string()).unwrap_or_default());
        text.push_str(&line(row.labels.iter().cloned().chain(values)));
    }
    text
}

fn figures_of(cell: &Cell) -> Option<[String; 6]> {
    let none = String::new;
    match cell {
        Cell::Nothing => None,
        Cell::Number(number) => Some([none(), none(), number.to_string(), none(), none(), none()]),
        Cell::Summary(Summary { count, left_out, mean, variance, interval }) => {
            let [low, high] = interval.map_or([none(), none()], |ends| ends.map(|end| end.to_string()));
            Some([count.to_string(), left_out.to_string(), mean.to_string(), variance.to_string(), low, high])
        }
    }
}

/// One line; what holds a comma, a quote or an end of line is quoted (RFC 4180). A name that a spreadsheet would compute has
/// an apostrophe before it.
fn line(fields: impl Iterator<Item = String>) -> String {
    let is_formula =
        |field: &str| field.starts_with(['=', '+', '-', '@', '\t', '\r']) && field.parse::<f64>().is_err();
    let fields = fields.map(|field| if is_formula(&field) { format!("'{field}") } else { field });
    let quoted = |field: String| match field.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field,
    };
    fields.map(quoted).collect::<Vec<_>>().join(",") + "\n"
}
