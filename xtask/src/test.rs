//! `cargo xtask test`: from a fresh clone to every test passed.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use xtask::clock::Steps;
use xtask::setup::{Tools, install_system_packages, lacks_gstreamer, set_up};
use xtask::shell::{GST_WORKSPACE, cargo, command, target};

/// What property tests draw their cases from: the same ones wherever this runs, so that what failed once fails again.
/// Other cases are for `cargo lab soak`, and for `cargo test`, which draws again each time.
const SEED: &str = "2411";

pub(crate) fn run(steps: &mut Steps) -> Result<()> {
    let tools = steps.time("Setting up what is missing", || {
        install_system_packages()?;
        set_up()
    })?;
    let mut total = Tally::default();
    for skipped in crate::check::run(&tools, steps)? {
        total.guarded(&format!("skipped: {skipped}"));
    }
    let parts: [(&str, &[&str]); 2] = [
        (
            "The core without its features",
            &["--package", "aquafuse", "--no-default-features", "--lib", "--tests"],
        ),
        ("All tests, and the examples in the documentation", &["--workspace", "--all-features"]),
    ];
    for (name, arguments) in parts {
        total.add(&steps.time(name, || test(&tools, arguments))?);
    }
    match lacks_gstreamer() {
        Some(why) => total.guarded(&format!("skipped: the GStreamer element: {why}")),
        None => total.add(&steps.time("The GStreamer element, in pipelines", || {
            test(&tools, &[&GST_WORKSPACE[..], &["--target-dir", &target().to_string_lossy()]].concat())
        })?),
    }
    let wheel = steps.time("Python wheel: built, installed and tested", || crate::wheel::test(&tools))?;
    total.add(&Tally {
        passed: wheel.passed,
        failed: wheel.failed,
        broken: wheel.failed > 0,
        ..Tally::default()
    });
    for skipped in wheel.skipped {
        total.guarded(&format!("skipped: {skipped}"));
    }
    for line in steps.time("Guards of the laboratory: 64-bit Arm, instructions", guards)?.lines() {
        total.guarded(line);
    }

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

/// What the laboratory, which the tests have built, says of its guards.
fn guards() -> Result<String> {
    let mut guards = command(target().join("debug/lab"), &["guards"]);
    let output = guards.stderr(Stdio::inherit()).output().context("cannot start the laboratory")?;
    if !output.status.success() {
        bail!("a guard of the laboratory failed; it says why above");
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
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

    /// A check beside cargo's tests, which passed or was skipped.
    fn guarded(&mut self, line: &str) {
        println!("{line}");
        self.skipped += usize::from(line.starts_with("skipped: "));
        self.passed += usize::from(line.starts_with("passed: "));
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
