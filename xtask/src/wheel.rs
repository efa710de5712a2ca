//! The Python package: built, installed and tested as its users have it.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use xtask::setup::Tools;
use xtask::shell::{command, root, run, succeeds, target};

/// What the tests of the package said.
#[derive(Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) passed: usize,
    pub(crate) failed: usize,
    /// A line each, with the reason.
    pub(crate) skipped: Vec<String>,
}

/// The first lines of the package's README, as somebody runs them who has just installed it.
const FIRST_EXAMPLE: &str = "\
import aquafuse
reef = aquafuse.example.reef()
assert aquafuse.fuse(reef, 'preset:jerlov-3C').shape == reef.shape
";

/// Builds the wheel, tests it beside the tools of the other tests, then in an environment that holds nothing else.
///
/// It is built with the profile of the tests, whose optimised dependencies it shares; a release is built by
/// `maturin build --release`.
pub(crate) fn test(tools: &Tools) -> Result<Outcome> {
    let python = &tools.python;
    let wheel = build(python)?;
    let file = wheel.to_string_lossy();
    run(command(
        python,
        &["-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--force-reinstall", &file],
    ))?;
    types(python)?;
    let mut outcome = pytest(python)?;
    match bare(&wheel)? {
        None => outcome.passed += 1,
        Some(why) => outcome.skipped.push(why),
    }
    Ok(outcome)
}

/// Prints the outcome; failed tests are an error.
pub(crate) fn show(outcome: &Outcome) -> Result<()> {
    for skipped in &outcome.skipped {
        println!("skipped: {skipped}");
    }
    match outcome.failed {
        0 => Ok(()),
        failed => bail!("{failed} tests of the Python package failed; they are listed above"),
    }
}

fn build(python: &Path) -> Result<PathBuf> {
    let folder = target().join("wheels");
    // Only one wheel is there afterwards.
    let _ = std::fs::remove_dir_all(&folder);
    let place = folder.to_string_lossy();
    let arguments =
        ["build", "--profile", "dev", "--quiet", "--manifest-path", "python/Cargo.toml", "--out", &place];
    let mut maturin = command(python.with_file_name("maturin"), &arguments);
    maturin.env("CARGO_INCREMENTAL", "0");
    run(maturin)?;
    let entries = folder.read_dir().context("maturin wrote no folder of wheels")?;
    let wheel = entries.flatten().map(|entry| entry.path()).next();
    wheel.context("maturin wrote no wheel")
}

/// The stubs are what the compiled part is, and the package agrees with its types.
fn types(python: &Path) -> Result<()> {
    let checks: [&[&str]; 2] = [
        &["-m", "mypy.stubtest", "aquafuse._native"],
        &["-m", "mypy", "--config-file", "pyproject.toml", "-p", "aquafuse"],
    ];
    checks.into_iter().try_for_each(|check| {
        let mut check = command(python, check);
        check.current_dir(root().join("python"));
        run(check)
    })
}

/// Runs the tests, shows what they print, and counts.
fn pytest(python: &Path) -> Result<Outcome> {
    let arguments = ["-m", "pytest", "-q", "-rs", "--tb=short", "-p", "no:cacheprovider", "tests"];
    let mut tests: Command = command(python, &arguments);
    tests.current_dir(root().join("python")).stdout(Stdio::piped());
    let mut child = tests.spawn().context("cannot start pytest")?;
    let mut outcome = Outcome::default();
    if let Some(stdout) = child.stdout.take() {
        for line in BufReader::new(stdout).lines() {
            let line = line.context("cannot read what pytest prints")?;
            println!("{line}");
            outcome.read(&line);
        }
    }
    let ended = child.wait().context("pytest vanished")?;
    if !ended.success() && outcome.failed == 0 {
        bail!("pytest could not run the tests of the Python package; it says why above");
    }
    Ok(outcome)
}

impl Outcome {
    /// Takes in a line of the summary: `SKIPPED [2] file: why`, or `73 passed, 2 skipped in 91.38s`.
    fn read(&mut self, line: &str) {
        if let Some(skipped) = line.strip_prefix("SKIPPED [") {
            let (count, why) = skipped.split_once("] ").unwrap_or(("1", skipped));
            self.skipped.extend(std::iter::repeat_n(why.to_owned(), count.parse().unwrap_or(1)));
        }
        let Some((counts, _)) = line.split_once(" in ") else { return };
        for part in counts.split(", ") {
            match part.split_once(' ') {
                Some((count, "passed")) => self.passed = count.parse().unwrap_or(0),
                Some((count, "failed" | "error" | "errors")) => {
                    self.failed = self.failed.saturating_add(count.parse().unwrap_or(0));
                }
                _ => {}
            }
        }
    }
}

/// Installs the wheel where nothing else is, and runs the first example and the command; why not, if the index of
/// packages cannot be reached.
fn bare(wheel: &Path) -> Result<Option<String>> {
    let folder = target().join("python-bare");
    run(command("python3", &["-m", "venv", "--clear", &folder.to_string_lossy()]))?;
    let (python, file) = (folder.join("bin/python"), wheel.to_string_lossy());
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "numpy"];
    if !succeeds(command(&python, &pip)) {
        return Ok(Some(
            "the wheel in a bare environment: numpy cannot be installed; is the index of packages reachable?"
                .into(),
        ));
    }
    run(command(&python, &["-m", "pip", "install", "--quiet", "--no-index", &file]))?;
    run(command(&python, &["-c", FIRST_EXAMPLE]))?;
    run(command(folder.join("bin/aquafuse"), &["--version"]))?;
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_of_pytest_is_read() {
        let mut outcome = Outcome::default();
        for line in [
            "....s..F                   [100%]",
            "SKIPPED [2] tests/test_torchvision.py:14: could not import 'torch'",
            "1 failed, 73 passed, 2 skipped, 3 warnings in 91.38s (0:01:31)",
        ] {
            outcome.read(line);
        }
        assert_eq!((outcome.passed, outcome.failed, outcome.skipped.len()), (73, 1, 2));
        assert!(outcome.skipped[0].contains("torch"));
    }
}
