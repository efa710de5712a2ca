//! The tables of `docs/` that commands write.

use anyhow::{Context, Result};

use crate::shell::{cargo, output, root, say};

/// The page of what was measured.
pub(crate) const RESULTS: &str = "docs/results.md";
/// The page of how the paper is read.
const METHOD: &str = "docs/method.md";

/// `cargo xtask truth`: how right the estimates are, and how much of the true change is made.
pub(crate) fn truth() -> Result<()> {
    say("Trying estimates and fusion on truth scenes (about three minutes)");
    let example = ["run", "--release", "--quiet", "--package", "aquafuse", "--example", "estimates_table"];
    write_shown("estimates", &output(cargo(&example))?)?;
    evaluated("truth", &["truth"])?;
    evaluated("truth-linear", &["truth", "--linear"])
}

/// `cargo xtask depth`: how well depth from colour agrees with measured depth.
pub(crate) fn depth() -> Result<()> {
    say("Comparing depth from colour with measured depth");
    let data = real_images()?;
    let example = ["run", "--release", "--quiet", "--package", "aquafuse-data", "--example", "depth_table"];
    write_shown("depth", &output(cargo(&[&example[..], &["--", &data]].concat()))?)?;
    evaluated("depth-scores", &["depth", &format!("{data}/depth_pairs"), "--depth-kind", "metres"])
}

/// `cargo xtask published`: real images scored, beside what the paper prints, what others make of them, and before
/// and after enhancement.
pub(crate) fn published() -> Result<()> {
    say("Fusing real images, each with eight others (minutes)");
    let scenes = format!("{}/scenes", real_images()?);
    let fusion =
        ["fusion", "--contents", &scenes, "--references", &scenes, "--group-by", "prefix", "--pairs", "8"];
    evaluated("published", &[&fusion[..], &["--as-published"]].concat())?;
    evaluated("methods", &[&fusion[..], &["--rivals"]].concat())?;
    evaluated("enhancement", &["enhancement", &scenes])
}

/// `cargo xtask readings`: what each way to read the paper does to the scores.
pub(crate) fn readings() -> Result<()> {
    say("Reading the paper each way, on truth scenes (two minutes)");
    let text =
        output(cargo(&["run", "--release", "--quiet", "--package", "aquafuse", "--example", "readings"]))?;
    println!("{text}");
    for (name, table) in sections(&text)? {
        write_section(METHOD, name, table)?;
    }
    Ok(())
}

/// What an example prints between marks, by the names of the marks.
pub(crate) fn sections(text: &str) -> Result<Vec<(&str, &str)>> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some((_, after)) = rest.split_once("<!-- ") {
        let (name, after) = after.split_once(" -->\n").context("a mark without an end")?;
        let close = format!("<!-- /{name} -->");
        let (table, after) = after.split_once(&close).with_context(|| format!("{name} is not closed"))?;
        found.push((name, table));
        rest = after;
    }
    Ok(found)
}

/// The folder of real images.
pub(crate) fn real_images() -> Result<String> {
    std::env::var("AQUAFUSE_TEST_DATA").context("AQUAFUSE_TEST_DATA must name the folder of real images")
}

/// Writes a section that `aquafuse evaluate` makes: the tables that it prints.
fn evaluated(section: &str, arguments: &[&str]) -> Result<()> {
    let run = ["run", "--release", "--quiet", "--package", "aquafuse-cli", "--", "evaluate"];
    write_shown(section, &output(cargo(&[&run[..], arguments].concat()))?)
}

/// Shows a section and writes it.
fn write_shown(section: &str, text: &str) -> Result<()> {
    println!("{text}");
    write_section(RESULTS, section, text)
}

/// Replaces what stands between `<!-- name -->` and `<!-- /name -->` in a page.
pub(crate) fn write_section(page: &str, name: &str, text: &str) -> Result<()> {
    let path = root().join(page);
    let page = std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let (open, close) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let around = page.split_once(&open).and_then(|(before, rest)| Some((before, rest.split_once(&close)?.1)));
    let (before, after) = around.with_context(|| format!("{} has no place for {name}", path.display()))?;
    std::fs::write(&path, format!("{before}{open}{text}{close}{after}"))
        .with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_between_marks_is_found_by_their_names() {
        let text = "<!-- a -->\n| 1 |\n<!-- /a -->\nnot a table\n<!-- a-b -->\n<!-- /a-b -->\n";
        assert_eq!(sections(text).unwrap(), [("a", "| 1 |\n"), ("a-b", "")]);
        assert!(sections("<!-- a -->\n| 1 |\n").is_err());
    }
}
