//! `lab hostile`: bad files of every kind, given to the command and to what most people would write.

pub(crate) mod rival;
mod tally;
mod trials;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::forge::{self, Role};
use crate::pages::{RESULTS, write_section};
use crate::runner::{End, Limits, Outcome, Runner};
use tally::{FAULTS, Tally};
use trials::{Given, Trial};
use xtask::shell::{root, say};

/// The kinds that ask for much time or memory.
const BOMBS: [&str; 2] = ["header too large", "inflates too far"];

const LIMITS: Limits = Limits { seconds: 20, address_space: 2 << 20 };

pub(crate) fn run() -> Result<()> {
    let ours = crate::programs::aquafuse()?;
    let folder = root().join("target/hostile");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let [good, water] = forge::write_good(&folder)?;
    let stage = Stage { ours, rival: crate::programs::lab()?, good, water, out: folder.join("out") };
    let mut trials = trials::forged(&folder)?;
    trials.extend(trials::labelled(&folder, &stage.good)?);
    trials.extend(trials::odd(&folder, &stage.good)?);
    say(&format!("Trying {} files; what went wrong:", trials.len()));
    let seen = stage.all(&trials)?;
    let text = report(&seen);
    println!("{text}");
    write_section(RESULTS, "hostile", &text)
}

/// Where things are.
struct Stage {
    ours: PathBuf,
    rival: PathBuf,
    good: PathBuf,
    water: PathBuf,
    out: PathBuf,
}

/// One run of one of the two programs.
struct Seen {
    file: String,
    kind: String,
    is_rival: bool,
    outcome: Outcome,
    tally: Tally,
}

impl Stage {
    fn all(&self, trials: &[Trial]) -> Result<Vec<Seen>> {
        let mut runner = Runner::new(LIMITS)?;
        let mut seen = Vec::new();
        for trial in trials {
            let rivals =
                if matches!(trial.given, Given::As(Role::Image)) { &[false, true][..] } else { &[false] };
            for &is_rival in rivals {
                let (outcome, tally) = self.one(&mut runner, trial, is_rival)?;
                if tally.faults.iter().any(|count| *count > 0) {
                    complain(trial, is_rival, &outcome, &tally);
                }
                let (file, kind) = (trial.shown(), trial.kind.clone());
                seen.push(Seen { file, kind, is_rival, outcome, tally });
            }
        }
        Ok(seen)
    }

    /// Gives a file to one of the two, whose output has a folder of its own.
    fn one(&self, runner: &mut Runner, trial: &Trial, is_rival: bool) -> Result<(Outcome, Tally)> {
        let cannot_make = || format!("cannot make {}", self.out.display());
        fs::create_dir_all(&self.out).with_context(cannot_make)?;
        let (file, output) = (trial.path.as_path(), self.out.join("out.png"));
        let set = self.out.join(tally::DATASET);
        let [fuse, to, threads, one, model, physical, depth, depth_kind, metres] =
            ["fuse", "-o", "--threads", "1", "--model", "physical", "--depth", "--depth-kind", "metres"]
                .map(Path::new);
        let ours = |content| [fuse, content, &self.water, to, &output, threads, one, model, physical];
        let outcome = match (is_rival, &trial.given) {
            (true, _) => runner.run(&self.rival, &[Path::new("rival"), file, &output])?,
            (false, Given::As(Role::Image)) => runner.run(&self.ours, &ours(file))?,
            (false, Given::As(Role::Depth)) => runner
                .run(&self.ours, &[&ours(&self.good)[..], &[depth, file, depth_kind, metres]].concat())?,
            (false, Given::In(dataset)) => {
                let augment = [Path::new("augment"), dataset, &self.water, to, &set, threads, one];
                runner.run(&self.ours, &augment)?
            }
        };
        let tally = tally::judge(trial, &outcome, &self.out);
        fs::remove_dir_all(&self.out).with_context(|| format!("cannot empty {}", self.out.display()))?;
        Ok((outcome, tally))
    }
}

fn complain(trial: &Trial, is_rival: bool, outcome: &Outcome, tally: &Tally) {
    let who = if is_rival { "rival" } else { "aquafuse" };
    let said: String = outcome.said.chars().take(200).collect();
    let (faults, Outcome { end, milliseconds, peak, .. }) = (tally::names(tally), outcome);
    eprintln!(
        "   {who}: {} {} ({:?} is right): {faults}; {end:?} after {milliseconds:.0} ms, {peak:.0} MiB: {said}",
        trial.kind,
        trial.shown(),
        trial.right
    );
}

/// Both tables.
fn report(seen: &[Seen]) -> String {
    let mut kinds: BTreeMap<&str, [Tally; 2]> = BTreeMap::new();
    let mut total = [Tally::default(); 2];
    for Seen { kind, is_rival, tally, .. } in seen {
        kinds.entry(kind).or_default()[usize::from(*is_rival)].add(tally);
        total[usize::from(*is_rival)].add(tally);
    }
    let mut text = format!("| kind of file | tried | {} |\n|---|---|", FAULTS.join(" | "));
    text += &"---|".repeat(FAULTS.len());
    text += "\n";
    for (kind, tallies) in &kinds {
        text += &tally::row(kind, tallies);
    }
    text += &tally::row("all", &total);
    text += &format!(
        "\n| {} | files | slowest, ms | largest peak memory, MiB |\n|---|---|---|---|\n",
        BOMBS.join("; ")
    );
    for (program, is_rival) in [("`aquafuse`", false), ("the rival", true)] {
        for (did, taken) in [("refused", false), ("taken", true)] {
            let of_this = |seen: &&Seen| {
                let ended = matches!(seen.outcome.end, End::Exit(code) if (code == 0) == taken);
                ended && seen.is_rival == is_rival && BOMBS.contains(&&*seen.kind)
            };
            text += &worst(&format!("{did} by {program}"), &seen.iter().filter(of_this).collect::<Vec<_>>());
        }
    }
    text
}

/// The slowest and the largest of some runs; the files it was are said, not written.
fn worst(name: &str, seen: &[&Seen]) -> String {
    let worst = |value: fn(&Outcome) -> f64| {
        let worst = seen.iter().max_by(|a, b| value(&a.outcome).total_cmp(&value(&b.outcome)));
        worst.map_or((0.0, "none"), |seen| (value(&seen.outcome), &seen.file))
    };
    let (slowest, peak) = (worst(|outcome| outcome.milliseconds), worst(|outcome| outcome.peak));
    eprintln!("   {name}: slowest {}, most memory {}", slowest.1, peak.1);
    format!("| {name} | {} | {:.0} | {:.0} |\n", seen.len(), slowest.0, peak.0)
}
