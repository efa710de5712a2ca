//! The `aquafuse` command: moves the waterbody of one underwater image into another.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(aquafuse_cli::run(std::env::args_os()))
}
