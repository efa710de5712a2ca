//! How the command's source is laid out.

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
