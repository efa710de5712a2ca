//! Programs in processes of their own, with a limit of time and memory.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context, Result, bail};

/// What a program may take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// After so many seconds it is taken to hang.
    pub(crate) seconds: u32,
    /// Address space, in KiB: a program that asks for more is refused it, and mostly ends by that.
    pub(crate) address_space: u32,
}

/// What became of a run.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    pub(crate) end: End,
    pub(crate) milliseconds: f64,
    /// The most memory it held, in MiB.
    pub(crate) peak: f64,
    /// What it said on standard error.
    pub(crate) said: String,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Exit(i32),
    /// By a signal, which is what an abort is too.
    Signal,
    /// By us, for it took too long.
    Late,
}

/// Runs commands one after the other.
pub(crate) struct Runner {
    child: Child,
    ask: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Runner {
    pub(crate) fn new(limits: Limits) -> Result<Self> {
        let mut command = Command::new("python3");
        let Limits { seconds, address_space } = limits;
        command.args([
            "-c",
            include_str!("runner/run_one.py"),
            &seconds.to_string(),
            &address_space.to_string(),
        ]);
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().context("cannot start python3")?;
        let ask = child.stdin.take().context("no way to ask")?;
        let answers = BufReader::new(child.stdout.take().context("no way to answer")?);
        Ok(Self { child, ask, answers })
    }

    /// Runs a program with its arguments, none of which may hold a tab or a line feed.
    pub(crate) fn run(&mut self, program: &Path, arguments: &[&Path]) -> Result<Outcome> {
        let words = [&[program], arguments].concat();
        let words: Option<Vec<&str>> = words.iter().map(|word| word.to_str()).collect();
        writeln!(self.ask, "{}", words.context("a name that is no text")?.join("\t"))?;
        let mut line = String::new();
        if self.answers.read_line(&mut line)? == 0 {
            bail!("python3 ended with {}", self.child.wait()?);
        }
        parse(line.trim_end_matches('\n')).with_context(|| format!("python3 answered {line:?}"))
    }
}

fn parse(line: &str) -> Option<Outcome> {
    let mut fields = line.splitn(4, '\t');
    let end = match fields.next()?.split_once(' ') {
        Some(("exit", code)) => End::Exit(code.parse().ok()?),
        Some(("signal", _)) => End::Signal,
        _ => End::Late,
    };
    let milliseconds = fields.next()?.parse().ok()?;
    let peak = fields.next()?.parse::<f64>().ok()? / 1024.0;
    Some(Outcome { end, milliseconds, peak, said: fields.next()?.to_owned() })
}
