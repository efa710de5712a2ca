//! Markdown: tables as people read them.

use std::fmt::Write;

use super::{Report, Table};
use crate::files::one_line;

/// The whole report.
pub fn document(report: &Report) -> String {
    let mut text = format!("# {}\n", report.title);
    for paragraph in &report.about {
        let _ = writeln!(text, "\n{paragraph}");
    }
    let _ = writeln!(
        text,
        "\n`aquafuse {}`, version {}: {}",
        report.command,
        env!("CARGO_PKG_VERSION"),
        settings(report)
    );
    for table in &report.tables {
        let _ = write!(text, "\n## {}\n\n{}", table.title, self::table(table));
    }
    if !report.failed.is_empty() {
        let _ = writeln!(text, "\n## What failed\n");
        for failed in &report.failed {
            let _ = writeln!(text, "- {}: {}", plain(&failed.name), plain(&failed.error));
        }
    }
    text
}

/// One table.
pub fn table(table: &Table) -> String {
    let titles = table.labels.iter().copied().chain(table.scores.iter().map(|score| score.title));
    let mut text = row(titles.map(str::to_owned));
    text.push_str(&row(table
        .labels
        .iter()
        .map(|_| "---".into())
        .chain(table.scores.iter().map(|_| "---".into()))));
    for one in &table.rows {
        let cells = one.cells.iter().zip(&table.scores).map(|(cell, score)| cell.text(score));
        text.push_str(&row(one.labels.iter().map(|label| plain(label)).chain(cells)));
    }
    text
}

fn row(cells: impl Iterator<Item = String>) -> String {
    format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
}

/// A name as Markdown shows it: on one line, and no markup but for code between backticks.
fn plain(name: &str) -> String {
    let name = one_line(name);
    let parts: Vec<&str> = name.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return escaped(&name);
    }
    let shown = |(place, part): (usize, &&str)| match place % 2 {
        0 => escaped(part),
        _ => format!("`{}`", part.replace('|', "\\|")),
    };
    parts.iter().enumerate().map(shown).collect()
}

fn escaped(text: &str) -> String {
    let mut shown = String::new();
    for character in text.chars() {
        if matches!(character, '\\' | '|' | '<' | '>' | '[' | ']' | '`' | '*' | '_' | '#' | '!' | '&') {
            shown.push('\\');
        }
        shown.push(character);
    }
    shown
}

/// The settings on one line.
pub(super) fn settings(report: &Report) -> String {
    let said = |(name, value): (&String, &serde_json::Value)| match value {
        serde_json::Value::Null => None,
        serde_json::Value::String(text) => Some(format!("{name} {text}")),
        serde_json::Value::Array(of) => {
            let strings: Vec<String> = of
                .iter()
                .map(|value| value.as_str().map_or_else(|| value.to_string(), str::to_owned))
                .collect();
            Some(format!("{name} {}", strings.join(", ")))
        }
        other => Some(format!("{name} {other}")),
    };
    let all = report.settings.as_object().into_iter().flatten().filter_map(said);
    all.collect::<Vec<_>>().join("; ")
}
