//! `lab soak`: every parser fuzzed for its share of the time, each law tried on cases drawn again, and a folder's
//! job killed again and again.
//!
//! Executions add up over runs in the table of `docs/results.md`; time goes to the parsers that lack most. The fuzzer is LLVM's, which counts on the compiler
//! to mark every branch; the flags for that are those cargo-fuzz uses, and a stable toolchain knows them.

mod resume;
mod table;

use std::collections::BTreeMap;
use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;
use std::process::Command;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use xtask::shell::{self, cargo, root, run as call, say};

use crate::pages::{RESULTS, write_section};
use table::{Row, read, rows};

pub(crate) const DEFAULT_MINUTES: u64 = 30;
/// Longer than this for one input, in seconds, is a fault.
const SLOWEST: &str = "2";
/// More than this, in MiB, is a fault: the limits of the targets are lower.
const MOST_MEMORY: &str = "512";
const KILLS: &str = "1000";
/// Of each law.
const CASES: &str = "100000";
/// Less time than this is not shared out any more.
const SHORT: Duration = Duration::from_secs(20);
/// Executions of each parser.
const PROMISED: u64 = 10_000_000;

/// What makes the compiler mark branches and comparisons for the fuzzer. Crates are cut into small units, for after each
/// input the fuzzer looks through all branches of the program, and whole units are linked: a program that held all parsers
/// would run a small one four times as long.
const FLAGS: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares -Cllvm-args=-simplifycfg-branch-fold-threshold=0 -Ccodegen-units=256";

/// Everything there is to soak, or the parsers that are named and nothing else.
pub(crate) fn run(minutes: u64, parsers: &[&str]) -> Result<()> {
    let mut targets = targets()?;
    if let Some(unknown) = parsers.iter().find(|parser| !targets.iter().any(|target| target == *parser)) {
        bail!("{unknown} is no parser; there are {}", targets.join(", "));
    }
    targets.retain(|target| parsers.is_empty() || parsers.contains(&target.as_str()));
    say(&format!("Building {} fuzz targets", targets.len()));
    let triple = host()?;
    let mut build = cargo(&["build", "--release", "--manifest-path", "fuzz/Cargo.toml", "--target", &triple]);
    // Named, so that programs which only help to build are not marked.
    build.env("RUSTFLAGS", FLAGS);
    call(build)?;
    let programs = root().join("fuzz/target").join(&triple).join("release");
    let (began, whole) = (Instant::now(), Duration::from_secs(60 * minutes));
    let (table, failed) = (Mutex::new(read()?), Mutex::new(Vec::new()));
    // In rounds: what one parser leaves of its share, because it is done sooner, the others have in the next.
    while let Some(left) = whole.checked_sub(began.elapsed()).filter(|left| *left > SHORT) {
        round(&targets, &programs, left.as_secs(), &table, &failed)?;
    }
    if parsers.is_empty() {
        laws()?;
        kills()?;
    }
    let failed = failed.into_inner().unwrap_or_default();
    if failed.is_empty() {
        return Ok(());
    }
    bail!("{} failed; the inputs lie in fuzz/artifacts", failed.join(", "))
}

/// Every parser that has a share of this time, as many at once as there are cores.
fn round(
    targets: &[String],
    programs: &Path,
    seconds: u64,
    table: &Mutex<BTreeMap<String, Row>>,
    failed: &Mutex<Vec<String>>,
) -> Result<()> {
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let mut queue = shares(targets, &taken(table), seconds * cores as u64, seconds);
    // The longest first, so that the cores end together.
    queue.sort_by_key(|(_, seconds)| *seconds);
    let queue = Mutex::new(queue);
    let work = || -> Result<()> {
        loop {
            // By itself: the lock must not be held while the target runs.
            let next = taken(&queue).pop();
            let Some((target, seconds)) = next else { return Ok(()) };
            let done = taken(table).get(&target).map_or(0, |row| row.executions);
            let row = fuzz(&target, programs, seconds, PROMISED.saturating_sub(done))?;
            if row.crashes > 0 {
                taken(failed).push(target.clone());
            }
            let mut table = taken(table);
            table.entry(target).or_default().add(&row);
            write_section(RESULTS, "soak", &rows(&table))?;
        }
    };
    std::thread::scope(|scope| {
        let crew: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        crew.into_iter().try_for_each(|one| one.join().expect("a fuzzing thread does not panic"))
    })
}

fn taken<T>(of_all: &Mutex<T>) -> MutexGuard<'_, T> {
    of_all.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The seconds of each target that still lacks executions, in proportion to the time that those will take but none more
/// than `most`; alike for all once none lacks any.
fn shares(targets: &[String], table: &BTreeMap<String, Row>, seconds: u64, most: u64) -> Vec<(String, u64)> {
    let rate = |row: &Row| row.executions as f64 / row.seconds.max(1) as f64;
    let slowest = table.values().map(rate).fold(f64::INFINITY, f64::min).min(PROMISED as f64);
    let lacks = |target: &String| {
        let row = table.get(target).copied().unwrap_or_default();
        // What was never run may be as slow as the slowest.
        let rate = if row.executions == 0 { slowest } else { rate(&row) };
        PROMISED.saturating_sub(row.executions) as f64 / rate.max(1.0)
    };
    let all: f64 = targets.iter().map(lacks).sum();
    let share = |target: &String| match all {
        0.0 => seconds / targets.len() as u64,
        // No longer than is needed, with something to spare for a rate that was measured at another time.
        _ => (seconds as f64 * (lacks(target) / all).min(1.0)).min(1.2 * lacks(target)).ceil() as u64,
    };
    let shares = targets.iter().map(|target| (target.clone(), share(target).min(most)));
    shares.filter(|(_, seconds)| *seconds > 0).collect()
}

/// The targets, by their folders of examples.
fn targets() -> Result<Vec<String>> {
    let folders = fs::read_dir(root().join("fuzz/corpus"))
        .context("there is no fuzz/corpus; run `cargo run --release -p lab --features parquet -- corpus`")?;
    let mut names: Vec<String> = folders
        .map(|folder| Ok(folder?.file_name().to_string_lossy().into_owned()))
        .collect::<Result<_>>()?;
    names.sort();
    Ok(names)
}

fn host() -> Result<String> {
    let version = shell::output(shell::command("rustc", &["-vV"]))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc does not say what it builds for")?.to_owned())
}

/// Runs one target until the time is over, or until it has had what it lacks where it lacks any; what it learns is kept under
/// target/, so that the next run goes on from there.
fn fuzz(target: &str, programs: &Path, seconds: u64, lacking: u64) -> Result<Row> {
    say(&format!("Fuzzing {target} for {seconds} s"));
    let began = Instant::now();
    let (learnt, faults) =
        (root().join("target/fuzz").join(target), root().join("fuzz/artifacts").join(target));
    fs::create_dir_all(&learnt)?;
    fs::create_dir_all(&faults)?;
    let program = programs.join(target);
    let mut command = limited(&program);
    command
        .arg(&learnt)
        .arg(root().join("fuzz/corpus").join(target))
        .arg(format!("-artifact_prefix={}/", faults.display()))
        .arg(format!("-max_total_time={seconds}"))
        .arg(format!("-runs={}", if lacking == 0 { -1 } else { lacking.cast_signed() }))
        .args(["-print_final_stats=1", "-max_len=4096"]);
    let output = command.output().with_context(|| format!("cannot run {target}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let mut row = Row::of(&said, began.elapsed().as_secs(), output.status.success());
    // The fuzzer's clock goes on while other programs have the processor: only what is slow again by itself is slow.
    if let Some(slow) = too_slow(&said) {
        let again = limited(&program).arg(slow).output().with_context(|| format!("cannot run {target}"))?;
        if again.status.success() {
            eprintln!("   {target}: {slow} took too long on a busy machine, and not by itself: no fault");
            fs::remove_file(slow).with_context(|| format!("cannot remove {slow}"))?;
            row.crashes = 0;
        }
    }
    if row.crashes > 0 {
        eprintln!(
            "{}",
            said.lines().rev().take(40).collect::<Vec<_>>().into_iter().rev().collect::<Vec<_>>().join("\n")
        );
    }
    eprintln!("   {target}: {} executions, slowest {} s, {} MiB", row.executions, row.slowest, row.memory);
    Ok(row)
}

/// A target within its limits.
fn limited(program: &Path) -> Command {
    let mut command = Command::new(program);
    command
        .arg("-detect_leaks=0")
        .arg(format!("-timeout={SLOWEST}"))
        .arg(format!("-rss_limit_mb={MOST_MEMORY}"));
    command
}

/// The file with the input that took too long, if that is what the fuzzer ended with.
fn too_slow(said: &str) -> Option<&str> {
    said.contains("ERROR: libFuzzer: timeout").then_some(())?;
    said.lines().find_map(|line| line.split_once("Test unit written to ").map(|(_, path)| path.trim()))
}

/// The laws of the method on cases drawn again, many more than the tests try.
fn laws() -> Result<()> {
    say(&format!("Trying each law on {CASES} cases"));
    let mut command = cargo(&["test", "--release", "--package", "aquafuse", "--test", "laws"]);
    command.env("PROPTEST_CASES", CASES);
    call(command)
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
    let said = shell::output(command)?;
    let figures = |name: &str| {
        let line = said.lines().find_map(|line| line.find(name).map(|at| &line[at..]));
        line.map(|line| format!("- {line}\n")).with_context(|| format!("the test said no {name}"))
    };
    write_section(RESULTS, "kills", &(figures("kills: ")? + &figures("signals: ")? + &resume::figure()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(executions: u64, seconds: u64) -> Row {
        Row { executions, seconds, ..Row::default() }
    }

    #[test]
    fn time_goes_to_what_lacks_executions_and_the_slow_get_more() {
        let names = ["done", "fast", "slow"].map(str::to_owned);
        let rows = [row(PROMISED, 10), row(PROMISED / 2, 100), row(PROMISED / 2, 300)];
        let table = names.iter().cloned().zip(rows).collect();
        let given = |seconds, most| shares(&names, &table, seconds, most).into_iter().map(|(_, share)| share);
        assert!(given(400, 400).eq([100, 300]));
        assert!(given(400, 250).eq([100, 250]), "no target has more than the time there is");
        assert!(given(4000, 4000).eq([120, 360]), "nor much more than it lacks");
    }

    #[test]
    fn only_a_time_out_has_an_input_that_is_tried_again() {
        let said = |what: &str| {
            format!("ALARM\nartifact_prefix='a/'; Test unit written to a/b-0\n== ERROR: libFuzzer: {what}\n")
        };
        assert_eq!(too_slow(&said("timeout after 2 seconds")), Some("a/b-0"));
        assert_eq!(too_slow(&said("deadly signal")), None);
    }

    #[test]
    fn once_nothing_lacks_all_have_the_same() {
        let names = ["a", "b"].map(str::to_owned);
        let table = names.iter().cloned().map(|name| (name, row(PROMISED, 1))).collect();
        assert_eq!(
            shares(&names, &table, 60, 60).iter().map(|(_, share)| *share).collect::<Vec<_>>(),
            [30, 30]
        );
    }
}
