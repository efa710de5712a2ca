//! How the command's source is laid out, and what it is built from.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::path::{Path, PathBuf};

fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in folder.read_dir().unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// The command that a file below `commands/` belongs to.
fn command_of(file: &Path, commands: &Path) -> String {
    let inner = file.strip_prefix(commands).unwrap();
    let first = inner.components().next().unwrap().as_os_str().to_str().unwrap();
    first.trim_end_matches(".rs").to_owned()
}

#[test]
fn no_command_uses_another_command() {
    let commands = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/commands");
    let mut files = Vec::new();
    files_below(&commands, &mut files);
    assert!(files.len() > 20, "commands have moved: {files:?}");
    for file in files.iter().filter(|file| file.extension().is_some_and(|extension| extension == "rs")) {
        let own = command_of(file, &commands);
        let text = std::fs::read_to_string(file).unwrap();
        for (at, _) in text.match_indices("crate::commands::") {
            let after = &text[at + "crate::commands::".len()..];
            let other: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            assert_eq!(other, own, "{} uses the command {other:?}", file.display());
        }
        let depth = file.strip_prefix(&commands).unwrap().components().count();
        let climbs = "super::".repeat(depth);
        // Within a file, its tests climb to it.
        let code = text.split("#[cfg(test)]").next().unwrap();
        assert!(!code.contains(&climbs), "{} reaches the other commands by `{climbs}`", file.display());
    }
}

/// Crates that nobody maintains any more, and the only crates that may bring each of them, as deny.toml says.
const UNMAINTAINED: [(&str, &[&str]); 2] =
    [("paste", &["mcap", "pulp"]), ("ttf-parser", &["owned_ttf_parser"])];

#[test]
fn crates_that_nobody_maintains_come_no_other_way_than_deny_toml_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
    let (lock, deny) = (read("Cargo.lock"), read("deny.toml"));
    assert_eq!(
        deny.matches("id = \"RUSTSEC-").count(),
        UNMAINTAINED.len(),
        "an advisory is ignored that is not here"
    );
    for (unmaintained, by) in UNMAINTAINED {
        assert!(deny.contains(&format!("`{unmaintained}`")), "deny.toml says why {unmaintained} is there");
        let dependents = lock.split("[[package]]").filter(|package| {
            let mut lines = package.lines().map(str::trim);
            lines.any(|line| line.trim_matches(['"', ',']).split(' ').next() == Some(unmaintained))
        });
        let names: Vec<&str> =
            dependents.filter_map(|package| package.split("name = \"").nth(1)?.split('"').next()).collect();
        assert_eq!(names, by, "what depends on {unmaintained}");
    }
}
