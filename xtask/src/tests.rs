//! `cargo xtask test`: from a fresh clone to every test passed.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::setup::{Tools, set_up};
use crate::shell::{cargo, say};

/// What property tests draw their cases from: the same ones wherever this runs, so that what failed once fails again.
/// Other cases are for [`crate::soak`], and for `cargo test`, which draws again each time.
const SEED: &str = "2411";

pub(crate) fn run() -> Result<()> {
    let tools = set_up()?;
    crate::checks::run(&tools)?;

    let mut total = Tally::default();
    say("Examples in the documentation");
    total.add(&test(&tools, &["--workspace", "--all-features", "--doc"])?);
    say("The core without its features");
    total.add(&test(&tools, &["--package", "aquafuse", "--no-default-features", "--lib", "--tests"])?);
    say("All tests");
    total.add(&test(&tools, &["--workspace", "--all-features", "--lib", "--bins", "--tests", "--examples"])?);
    total.add(&guarded("64-bit Arm", crate::arm64::run_if_possible()?));
    total.add(&guarded("instructions", crate::instructions::guard()?));

    if !total.failures.is_empty() {
        println!("\nWhat the failed tests said:\n{}", total.failures);
    }
    println!("\n{} passed, {} failed, {} skipped", total.passed, total.failed, total.skipped);
    match total {
        Tally { broken: true, .. } => bail!("tests failed; they are listed above"),
        Tally { passed: 0, .. } => bail!("no test ran"),
        _ => Ok(()),
    }
}

/// A check beside cargo's tests, which passed or was skipped.
fn guarded(name: &str, skipped: Option<String>) -> Tally {
    match skipped {
        Some(why) => {
            println!("skipped: {name}: {why}");
            Tally { skipped: 1, ..Tally::default() }
        }
        None => Tally { passed: 1, ..Tally::default() },
    }
}

/// Outcomes as the test runner reports them.
#[derive(Default)]
struct Tally {
    passed: usize,
    failed: usize,
    skipped: usize,
    /// The runner itself ended without success: a failed test, or one that does not compile.
    broken: bool,
    /// What it said of failed tests, to be shown once more at the end, where it is looked for.
    failures: String,
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
        self.broken |= other.broken;
        self.failures += &other.failures;
    }
}

/// Runs `cargo test`, showing its output and counting its summaries.
///
/// A test that skips itself prints `skipped: why` and passes for the runner; it is counted as skipped here.
fn test(tools: &Tools, arguments: &[&str]) -> Result<Tally> {
    let mut command: Command = cargo(&[&["test", "--locked", "--no-fail-fast"][..], arguments].concat());
    // What a passing test prints is hidden by default, and a reason to skip would be hidden with it.
    command.args(["--", "--show-output"]);
    command.env("AQUAFUSE_PYTHON", &tools.python).env("PROPTEST_RNG_SEED", SEED).stdout(Stdio::piped());
    // What would speed up the next build takes gigabytes, and whoever runs all tests seldom builds the same again.
    command.env("CARGO_INCREMENTAL", "0");
    let mut child = command.spawn().context("cannot start cargo test")?;
    let mut tally = Tally::default();
    let mut of_failures = false;
    if let Some(stdout) = child.stdout.take() {
        for line in BufReader::new(stdout).lines() {
            let line = line.context("cannot read what cargo test prints")?;
            println!("{line}");
            of_failures = (of_failures || line == "failures:") && !line.starts_with("test result: ");
            if of_failures {
                tally.failures += &line;
                tally.failures.push('\n');
            }
            if line.starts_with("skipped: ") {
                tally.skipped += 1;
                tally.passed = tally.passed.saturating_sub(1);
            } else if let Some(result) = line.strip_prefix("test result: ") {
                tally.passed += count(result, " passed");
                tally.failed += count(result, " failed");
                tally.skipped += count(result, " ignored");
            }
        }
    }
    tally.broken = !child.wait().context("cargo test vanished")?.success();
    Ok(tally)
}

/// The number before `word` in a summary such as `ok. 12 passed; 0 failed; ...`.
fn count(summary: &str, word: &str) -> usize {
    let before = summary.find(word).map_or("", |at| &summary[..at]);
    before.rsplit([' ', ';']).next().and_then(|number| number.parse().ok()).unwrap_or(0)
}
