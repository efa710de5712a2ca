//! The tables of `docs/results.md` that commands write.

use anyhow::{Context, Result};

use crate::shell::{cargo, output, root, say};

/// `cargo xtask truth`: how right the estimates are, and how much of the true change they make.
pub(crate) fn truth() -> Result<()> {
    say("Trying estimates and fusion on truth scenes (about three minutes)");
    for (section, table) in
        [("estimates", "estimates"), ("truth", "shares"), ("truth-linear", "shares-linear")]
    {
        let example =
            ["run", "--release", "--quiet", "--package", "aquafuse", "--example", "truth_table", "--"];
        let text = output(cargo(&[&example[..], &[table]].concat()))?;
        println!("{text}");
        write_section(section, &text)?;
    }
    Ok(())
}

/// `cargo xtask depth`: how well each way from colour orders measured depth.
pub(crate) fn depth() -> Result<()> {
    say("Comparing depth from colour with measured depth");
    of_real_pictures("depth", "depth_table")
}

/// `cargo xtask published`: scores on real pictures beside those the paper prints.
pub(crate) fn published() -> Result<()> {
    say("Fusing real pictures, each with eight others (minutes)");
    of_real_pictures("published", "published_table")
}

/// Writes a section that an example makes from the folder of real pictures.
fn of_real_pictures(section: &str, example: &str) -> Result<()> {
    let data = std::env::var("AQUAFUSE_TEST_DATA")
        .context("AQUAFUSE_TEST_DATA must name the folder of real pictures")?;
    let run =
        ["run", "--release", "--quiet", "--package", "aquafuse-data", "--example", example, "--", &data];
    let table = output(cargo(&run))?;
    println!("{table}");
    write_section(section, &table)
}

/// Replaces what stands between `<!-- name -->` and `<!-- /name -->` in `docs/results.md`.
pub(crate) fn write_section(name: &str, text: &str) -> Result<()> {
    let path = root().join("docs/results.md");
    let page = std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let (open, close) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let around = page.split_once(&open).and_then(|(before, rest)| Some((before, rest.split_once(&close)?.1)));
    let (before, after) = around.with_context(|| format!("{} has no place for {name}", path.display()))?;
    std::fs::write(&path, format!("{before}{open}{text}{close}{after}"))
        .with_context(|| format!("cannot write {}", path.display()))
}
