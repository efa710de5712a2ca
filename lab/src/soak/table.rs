//! The table of the soak, read back so that its figures add up.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use xtask::shell::root;

use crate::pages::{RESULTS, section};

/// The figures of one target over all runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Row {
    pub(super) executions: u64,
    pub(super) seconds: u64,
    pub(super) crashes: u64,
    /// Seconds.
    pub(super) slowest: u64,
    /// MiB.
    pub(super) memory: u64,
}

const HEAD: &str = "| parser | executions | seconds | crashes, panics, time-outs | slowest input, s | most memory, MiB |\n\
    |---|---|---|---|---|---|\n";

impl Row {
    /// The figures of one run, from what the fuzzer says at its end.
    pub(super) fn of(said: &str, seconds: u64, success: bool) -> Self {
        let number = |name: &str| {
            let line = said.lines().find_map(|line| line.strip_prefix(name));
            line.and_then(|rest| rest.trim_start_matches(':').trim().parse().ok()).unwrap_or(0)
        };
        Self {
            executions: number("stat::number_of_executed_units"),
            seconds,
            crashes: u64::from(!success),
            slowest: number("stat::slowest_unit_time_sec"),
            memory: number("stat::peak_rss_mb"),
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.executions += other.executions;
        self.seconds += other.seconds;
        self.crashes += other.crashes;
        self.slowest = self.slowest.max(other.slowest);
        self.memory = self.memory.max(other.memory);
    }
}

/// The table as it stands.
pub(super) fn read() -> Result<BTreeMap<String, Row>> {
    let page = std::fs::read_to_string(root().join(RESULTS)).context("cannot read docs/results.md")?;
    Ok(parse(section(&page, "soak").context("docs/results.md has no section soak")?))
}

fn parse(table: &str) -> BTreeMap<String, Row> {
    let row = |line: &str| {
        let mut cells = line.trim_matches('|').split('|').map(str::trim);
        let name = cells.next()?.trim_matches('`').to_owned();
        let mut number = || cells.next()?.replace(',', "").parse().ok();
        let row = Row {
            executions: number()?,
            seconds: number()?,
            crashes: number()?,
            slowest: number()?,
            memory: number()?,
        };
        Some((name, row))
    };
    table.lines().filter_map(row).collect()
}

/// The table as text.
pub(super) fn rows(table: &BTreeMap<String, Row>) -> String {
    let row = |(name, row): (&String, &Row)| {
        let Row { executions, seconds, crashes, slowest, memory } = row;
        format!("| `{name}` | {executions} | {seconds} | {crashes} | {slowest} | {memory} |\n")
    };
    HEAD.to_owned() + &table.iter().map(row).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_read_back_and_add_up() {
        let said = "stat::number_of_executed_units: 1200\nstat::slowest_unit_time_sec:    1\nstat::peak_rss_mb: 88\n";
        let run = Row::of(said, 60, true);
        let mut table = parse(&rows(&BTreeMap::from([("png".to_owned(), run)])));
        assert_eq!(table["png"], run);
        table.get_mut("png").unwrap().add(&Row::of(said, 30, false));
        let twice = Row { executions: 2400, seconds: 90, crashes: 1, slowest: 1, memory: 88 };
        assert_eq!(parse(&rows(&table))["png"], twice);
    }
}
