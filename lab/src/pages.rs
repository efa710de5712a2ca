//! The tables in `docs/` and `BENCHMARKS.md` that commands write.

use anyhow::{Context, Result};
use xtask::shell::root;

/// The page of what was measured.
pub(crate) const RESULTS: &str = "docs/results.md";

/// The folder of real images.
pub(crate) fn real_images() -> Result<String> {
    std::env::var("AQUAFUSE_TEST_DATA").context("AQUAFUSE_TEST_DATA must name the folder of real images")
}

/// Shows a section and writes it.
pub(crate) fn show_section(page: &str, name: &str, text: &str) -> Result<()> {
    println!("{text}");
    write_section(page, name, text)
}

/// Replaces what stands between `<!-- name -->` and `<!-- /name -->` in a page.
pub(crate) fn write_section(page: &str, name: &str, text: &str) -> Result<()> {
    let path = root().join(page);
    let page = std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let replaced = replaced(&page, name, text);
    let replaced = replaced.with_context(|| format!("{} has no section {name}", path.display()))?;
    std::fs::write(&path, replaced).with_context(|| format!("cannot write {}", path.display()))
}

/// The text of a section.
pub(crate) fn section<'a>(page: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = page.split_once(&format!("<!-- {name} -->\n"))?;
    Some(rest.split_once(&format!("<!-- /{name} -->"))?.0)
}

fn replaced(page: &str, name: &str, text: &str) -> Option<String> {
    let old = section(page, name)?;
    let open = format!("<!-- {name} -->\n");
    let (before, rest) = page.split_once(&open)?;
    Some(format!("{before}{open}{text}{}", &rest[old.len()..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_is_replaced_and_the_rest_of_the_page_is_left_alone() {
        let page = "a\n<!-- t -->\nold\n<!-- /t -->\nb\n<!-- t-2 -->\n<!-- /t-2 -->\n";
        let new = replaced(page, "t", "| 1 |\n").unwrap();
        assert_eq!(new, page.replace("old\n", "| 1 |\n"));
        assert_eq!((section(&new, "t"), section(&new, "t-2")), (Some("| 1 |\n"), Some("")));
        assert_eq!(replaced(page, "missing", ""), None);
    }
}
