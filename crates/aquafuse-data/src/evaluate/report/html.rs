//! HTML: one page that needs nothing else, with plots, and images to look at.

use std::fmt::Write;

use super::image::data_uri;
use super::{Cell, Report, Score, Shown, Strip, Table, markdown};
use crate::drawing::{Mean, means};
use crate::evaluate::Summary;

const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1d2429; --paper: #fbfbf9; --faint: #d9dcda; --pale: #f0f2f0 }
@media (prefers-color-scheme: dark) { :root { --ink: #e3e7e6; --paper: #15191b; --faint: #3b4346; --pale: #1f2527 } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 72rem; margin: 2rem auto; padding: 0 1rem }
h1 { font-size: 1.7rem } h2 { font-size: 1.25rem; margin-top: 2.5rem }
p { max-width: 46rem } code { font-size: .92em }
.wide { overflow-x: auto }
table { border-collapse: collapse; font-size: .86rem; font-variant-numeric: tabular-nums }
th, td { text-align: left; padding: .25rem .7rem; border-bottom: 1px solid var(--faint); white-space: nowrap }
th { border-bottom: 2px solid var(--ink) } tbody tr:nth-child(even) { background: var(--pale) }
.plots { display: flex; flex-wrap: wrap; gap: 1.5rem } figure { margin: 0 }
figcaption { font-size: .82rem; max-width: 216px; overflow-wrap: anywhere }
svg text { fill: var(--ink); font-family: system-ui, sans-serif } svg [stroke=\"#D9DCDA\"] { stroke: var(--faint) }
.strip { display: flex; flex-wrap: wrap; gap: .6rem; margin-bottom: 1.6rem } .strip img { display: block; border-radius: 3px }
.failed li { overflow-wrap: anywhere }
";

/// The whole report as a page.
pub fn page(report: &Report) -> String {
    let title = escaped(&report.title);
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );
    for paragraph in &report.about {
        let _ = writeln!(text, "<p>{}</p>", marked(paragraph));
    }
    let _ = writeln!(
        text,
        "<p><code>aquafuse {}</code>, version {}: {}</p>",
        report.command,
        env!("CARGO_PKG_VERSION"),
        marked(&markdown::settings(report))
    );
    for (place, table) in report.tables.iter().enumerate() {
        let _ = writeln!(text, "<h2>{}</h2>", escaped(&table.title));
        table_of(&mut text, table);
        plots(&mut text, table);
        if place == 0 {
            strips(&mut text, &report.gallery);
        }
    }
    if !report.failed.is_empty() {
        text.push_str("<h2>What failed</h2>\n<ul class=\"failed\">\n");
        for failed in &report.failed {
            let _ = writeln!(text, "<li>{}: {}</li>", escaped(&failed.name), escaped(&failed.error));
        }
        text.push_str("</ul>\n");
    }
    text + "</body>\n</html>\n"
}

fn table_of(text: &mut String, table: &Table) {
    text.push_str("<div class=\"wide\"><table>\n<thead><tr>");
    for title in table.labels.iter().copied().chain(table.scores.iter().map(|score| score.title)) {
        let _ = write!(text, "<th>{}</th>", escaped(title));
    }
    text.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        text.push_str("<tr>");
        let cells = row.cells.iter().zip(&table.scores).map(|(cell, score)| cell.text(score));
        for cell in row.labels.iter().cloned().chain(cells) {
            let _ = write!(text, "<td>{}</td>", marked(&cell));
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</tbody></table></div>\n");
}

/// A plot for each score that has a mean of its own.
fn plots(text: &mut String, table: &Table) {
    let drawn: Vec<String> = table
        .scores
        .iter()
        .enumerate()
        .filter(|(_, score)| matches!(score.shown, Shown::MeanAndVariance | Shown::Mean))
        .filter_map(|(place, score)| plot(table, place, score))
        .collect();
    if !drawn.is_empty() {
        let _ = writeln!(
            text,
            "<p>Means, with the interval where there is one:</p>\n<div class=\"plots\">{}</div>",
            drawn.concat()
        );
    }
}

/// Draws one score of a table; none where fewer than two rows have it, or none an interval.
fn plot(table: &Table, place: usize, score: &Score) -> Option<String> {
    let mut methods: Vec<&str> = Vec::new();
    let (mut points, mut any_interval) = (Vec::new(), false);
    for row in &table.rows {
        let Cell::Summary(Summary { mean, interval, .. }) = row.cells.get(place)? else { continue };
        any_interval |= interval.is_some();
        let method = row.labels.first().map(String::as_str).unwrap_or_default();
        let known = methods.iter().position(|other| *other == method);
        let group = known.unwrap_or_else(|| {
            methods.push(method);
            methods.len().saturating_sub(1)
        });
        let label = row.labels.join(", ").replace('`', "");
        points.push(Mean { label, group, mean: *mean, interval: interval.unwrap_or([*mean; 2]) });
    }
    points.retain(|point| point.interval.iter().all(|end| end.is_finite()) && point.mean.is_finite());
    if points.len() < 2 || !any_interval {
        return None;
    }
    let svg =
        means(score.title, &points).expect("a string takes all that is drawn, and the font is built in");
    Some(format!("<figure>{svg}</figure>\n"))
}

fn strips(text: &mut String, gallery: &[Strip]) {
    if gallery.is_empty() {
        return;
    }
    text.push_str("<h2>Images</h2>\n");
    for strip in gallery {
        let _ = writeln!(text, "<p>{}</p>\n<div class=\"strip\">", escaped(&strip.caption));
        for (caption, image) in &strip.images {
            let (width, height) = image.size();
            let caption = escaped(caption);
            let _ = writeln!(
                text,
                "<figure><img src=\"{}\" alt=\"{caption}\" width=\"{width}\" height=\"{height}\"><figcaption>{caption}</figcaption></figure>",
                data_uri(image)
            );
        }
        text.push_str("</div>\n");
    }
}

/// A text with what stands between backticks as code.
fn marked(text: &str) -> String {
    let parts = text.split('`').enumerate().map(|(place, part)| match place.is_multiple_of(2) {
        true => escaped(part),
        false => format!("<code>{}</code>", escaped(part)),
    });
    parts.collect()
}

/// A text whose signs mean nothing to HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
