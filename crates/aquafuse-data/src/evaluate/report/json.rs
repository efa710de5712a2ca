//! JSON: everything, for programs.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{Cell, Items, Report, Score, Table};
use crate::evaluate::Failed;

/// `schema` changes when a field changes its meaning or goes.
#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    version: &'static str,
    command: &'a str,
    settings: &'a Value,
    tables: Vec<Value>,
    items: Vec<Value>,
    failed: &'a [Failed],
}

/// The whole report but its images. A number that is infinite is null.
pub fn document(report: &Report) -> String {
    let document = Document {
        schema: 1,
        version: env!("CARGO_PKG_VERSION"),
        command: report.command,
        settings: &report.settings,
        tables: report.tables.iter().map(table).collect(),
        items: items(&report.items),
        failed: &report.failed,
    };
    // Numbers, strings and lists of them: JSON can hold them all.
    serde_json::to_string_pretty(&document).unwrap_or_default() + "\n"
}

fn table(table: &Table) -> Value {
    let rows: Vec<Value> = table
        .rows
        .iter()
        .map(|row| {
            let labels = labelled(&table.labels, &row.labels);
            let cells = table.scores.iter().zip(&row.cells).map(|(Score { key, .. }, cell)| {
                let value = match cell {
                    Cell::Nothing => Value::Null,
                    Cell::Number(number) => json!(number),
                    Cell::Summary(summary) => json!(summary),
                };
                ((*key).to_owned(), value)
            });
            Value::Object(labels.chain(cells).collect())
        })
        .collect();
    json!({ "name": table.name, "title": table.title, "rows": rows })
}

fn items(items: &Items) -> Vec<Value> {
    let row = |row: &super::ItemsRow| {
        let labels = labelled(&items.labels, &row.labels);
        let values =
            items.scores.iter().zip(&row.values).map(|(score, value)| (score.key.to_owned(), json!(value)));
        Value::Object(labels.chain(values).collect::<Map<_, _>>())
    };
    items.rows.iter().map(row).collect()
}

fn labelled<'a>(names: &'a [&str], labels: &'a [String]) -> impl Iterator<Item = (String, Value)> + 'a {
    names.iter().zip(labels).map(|(name, label)| ((*name).to_owned(), json!(label)))
}
