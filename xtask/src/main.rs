//! The project's habits: `cargo xtask COMMAND`.

mod api;
mod check;
mod test;
mod wheel;

use std::process::ExitCode;

use anyhow::Result;
use xtask::clock::Steps;
use xtask::setup::{Missing, install_system_packages, set_up};
use xtask::shell::{cargo, run as call};

const USAGE: &str = "\
cargo xtask COMMAND

  setup   installs what the other commands need: Python's venv module, ffmpeg and GStreamer from the system's packages if they are
          missing and we are root, a Python environment under target/, cargo-deny
  check   format, spelling, lints, documentation, public items, licences, packages: what a reviewer would say first
  test    `setup`, `check` and every test: what CI runs
  wheel   builds, installs and tests the Python package alone
  api     writes the public items of each library into its api.txt
  bench   [PART...] speed beside OpenCV and others, into BENCHMARKS.md; the same as `cargo lab bench`

`cargo lab help` lists what measures and forges. Tests on real images look for them in the folder AQUAFUSE_TEST_DATA and
say so when they skip. Tools are kept in AQUAFUSE_CACHE (default ~/.cache/aquafuse).
";

fn main() -> ExitCode {
    if let Some(code) = api::as_rustdoc() {
        return code;
    }
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut steps = Steps::default();
    let result = match words[..] {
        ["setup"] => install_system_packages().and_then(|()| set_up()).map(drop),
        ["check"] => check(&mut steps),
        ["test"] => test::run(&mut steps),
        ["wheel"] => set_up()
            .and_then(|tools| steps.time("Python wheel", || wheel::test(&tools)))
            .and_then(|outcome| wheel::show(&outcome)),
        ["api"] => api::renew(),
        ["bench", ref parts @ ..] => {
            let lab = ["run", "--quiet", "--release", "--package", "lab", "--", "bench"];
            call(cargo(&[&lab[..], parts].concat()))
        }
        ["help" | "--help" | "-h"] => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    if matches!(words[..], ["check" | "test" | "wheel"]) {
        eprint!("\n{}", steps.table());
    }
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            let cannot_set_up = error.downcast_ref::<Missing>().is_some();
            ExitCode::from(if cannot_set_up { 2 } else { 1 })
        }
    }
}

fn check(steps: &mut Steps) -> Result<()> {
    let tools = set_up()?;
    for skipped in check::run(&tools, steps)? {
        println!("skipped: {skipped}");
    }
    Ok(())
}
