//! Prints what a crate makes public, one item a line: `api-text FILE.json`, a file that rustdoc wrote.
//!
//! Ends with 3 if the file is of a version of Rust that the library behind this does not know.

use std::collections::HashSet;
use std::process::ExitCode;

use public_api::{Builder, Error};

fn main() -> ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!("usage: api-text FILE.json");
        return ExitCode::from(2);
    };
    // What follows from the rest would hide the rest.
    let list = Builder::from_rustdoc_json(path).omit_blanket_impls(true).omit_auto_trait_impls(true);
    match text(&list) {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(if matches!(error, Error::SerdeJsonError(_)) { 3 } else { 1 })
        }
    }
}

/// A trait of the compiler's own, which follows from `PartialEq`.
const OF_THE_COMPILER: &str = "impl core::marker::StructuralPartialEq";

/// All items, but of a derived implementation the first line alone: its functions are those of the trait.
fn text(list: &Builder) -> Result<String, Error> {
    let lines = |list: Builder| -> Result<Vec<String>, Error> {
        Ok(list.build()?.items().map(|item| format!("{item}\n")).collect())
    };
    let written: HashSet<String> = lines(list.clone().omit_auto_derived_impls(true))?.into_iter().collect();
    let is_shown = |line: &String| {
        (line.starts_with("impl") || written.contains(line)) && !line.starts_with(OF_THE_COMPILER)
    };
    Ok(lines(list.clone())?.into_iter().filter(is_shown).collect())
}
