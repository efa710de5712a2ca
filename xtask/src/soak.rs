//! `cargo xtask soak`: every parser fuzzed for its share of the time, and a folder's job killed again and again.
//!
//! Executions add up over runs in the table of `docs/results.md`. The fuzzer is LLVM's, which counts on the compiler
//! to mark every branch; the flags for that are those cargo-fuzz uses, and a stable toolchain knows them.

mod resume;
mod table;

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::results::{RESULTS, write_section};
use crate::shell::{cargo, root, run, say};
use table::{Row, read, rows};

pub(crate) const DEFAULT_MINUTES: u64 = 30;
/// Longer than this for one input, in seconds, is a fault.
const SLOWEST: &str = "2";
/// More than this, in MiB, is a fault: the limits of the targets are lower.
const MOST_MEMORY: &str = "512";
const KILLS: &str = "1000";

/// What makes the compiler mark branches and comparisons for the fuzzer.
const FLAGS: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares -Cllvm-args=-simplifycfg-branch-fold-threshold=0 -Ccodegen-units=1";

pub(crate) fn run_for(minutes: u64) -> Result<()> {
    let targets = targets()?;
    let seconds = (60 * minutes / targets.len() as u64).max(1);
    say(&format!("Building {} fuzz targets", targets.len()));
    let triple = host()?;
    let mut build = cargo(&["build", "--release", "--manifest-path", "fuzz/Cargo.toml", "--target", &triple]);
    // Named, so that programs which only help to build are not marked.
    build.env("RUSTFLAGS", FLAGS);
    run(build)?;
    let programs = root().join("fuzz/target").join(&triple).join("release");
    let mut table = read()?;
    let mut failed = Vec::new();
    for target in &targets {
        say(&format!("Fuzzing {target} for {seconds} s"));
        let row = fuzz(target, &programs, seconds)?;
        if row.crashes > 0 {
            failed.push(target.as_str());
        }
        table.entry(target.clone()).or_default().add(&row);
        write_section(RESULTS, "soak", &rows(&table))?;
    }
    kills()?;
    if failed.is_empty() {
        return Ok(());
    }
    bail!("{} failed; the inputs lie in fuzz/artifacts", failed.join(", "))
}

/// The targets, by their folders of examples.
fn targets() -> Result<Vec<String>> {
    let folders = fs::read_dir(root().join("fuzz/corpus"))
        .context("there is no fuzz/corpus; run `cargo xtask corpus`")?;
    let mut names: Vec<String> = folders
        .map(|folder| Ok(folder?.file_name().to_string_lossy().into_owned()))
        .collect::<Result<_>>()?;
    names.sort();
    Ok(names)
}

fn host() -> Result<String> {
    let version = crate::shell::output(crate::shell::command("rustc", &["-vV"]))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc does not say what it builds for")?.to_owned())
}

/// Runs one target; what it learns is kept under target/, so that the next run goes on from there.
fn fuzz(target: &str, programs: &Path, seconds: u64) -> Result<Row> {
    let (learnt, faults) =
        (root().join("target/fuzz").join(target), root().join("fuzz/artifacts").join(target));
    fs::create_dir_all(&learnt)?;
    fs::create_dir_all(&faults)?;
    let mut command = Command::new(programs.join(target));
    command
        .arg(&learnt)
        .arg(root().join("fuzz/corpus").join(target))
        .arg(format!("-artifact_prefix={}/", faults.display()))
        .arg(format!("-max_total_time={seconds}"))
        .args(["-print_final_stats=1", "-max_len=4096", "-detect_leaks=0"])
        .arg(format!("-timeout={SLOWEST}"))
        .arg(format!("-rss_limit_mb={MOST_MEMORY}"));
    let output = command.output().with_context(|| format!("cannot run {target}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let row = Row::of(&said, seconds, output.status.success());
    if row.crashes > 0 {
        eprintln!(
            "{}",
            said.lines().rev().take(40).collect::<Vec<_>>().into_iter().rev().collect::<Vec<_>>().join("\n")
        );
    }
    eprintln!("   {} executions, slowest {} s, {} MiB", row.executions, row.slowest, row.memory);
    Ok(row)
}

/// The tests that kill and stop a folder's job.
fn kills() -> Result<()> {
    say(&format!("Killing a folder's job {KILLS} times"));
    let tests = [
        "test",
        "--package",
        "aquafuse-cli",
        "--test",
        "folder_jobs",
        "--",
        "--nocapture",
        "--test-threads",
        "1",
    ];
    let mut command = cargo(&[&tests[..], &["killed", "signals"]].concat());
    command.env("AQUAFUSE_KILLS", KILLS);
    let said = crate::shell::output(command)?;
    let figures = |name: &str| {
        let line = said.lines().find_map(|line| line.find(name).map(|at| &line[at..]));
        line.map(|line| format!("- {line}\n")).with_context(|| format!("the test said no {name}"))
    };
    write_section(RESULTS, "kills", &(figures("kills: ")? + &figures("signals: ")? + &resume::figure()?))
}
