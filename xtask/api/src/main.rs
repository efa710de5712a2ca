//! Prints what a crate makes public, one item a line: `api-text FILE.json`, a file that rustdoc wrote.
//!
//! Ends with 3 if the file is of a version of Rust that the library behind this does not know.

use std::process::ExitCode;

use public_api::Builder;

fn main() -> ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!("usage: api-text FILE.json");
        return ExitCode::from(2);
    };
    // What follows from the rest, and what nobody writes by hand, would hide the rest.
    let list = Builder::from_rustdoc_json(path).omit_blanket_impls(true).omit_auto_trait_impls(true).build();
    match list {
        Ok(list) => {
            print!("{list}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(3)
        }
    }
}
