//! Programs in processes of their own, with a limit of time and memory.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context, Result, bail};

/// After this long a program is taken to hang.
const SECONDS: u32 = 20;
/// Address space, in KiB: a program that asks for more is refused it, and mostly ends by that.
const ADDRESS_SPACE: u32 = 2 << 20;

/// What became of a run.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) end: End,
    pub(super) milliseconds: f64,
    /// The most memory it held, in MiB.
    pub(super) peak: f64,
    /// What it said on standard error.
    pub(super) said: String,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Exit(i32),
    /// By a signal, which is what an abort is too.
    Signal,
    /// By us, for it took too long.
    Late,
}

/// Runs commands one after the other.
pub(super) struct Runner {
    child: Child,
    ask: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Runner {
    pub(super) fn new() -> Result<Self> {
        let mut command = Command::new("python3");
        command.args(["-c", include_str!("run_one.py"), &SECONDS.to_string(), &ADDRESS_SPACE.to_string()]);
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().context("cannot start python3")?;
        let ask = child.stdin.take().context("no way to ask")?;
        let answers = BufReader::new(child.stdout.take().context("no way to answer")?);
        Ok(Self { child, ask, answers })
    }

    /// Runs a program with its arguments, none of which may hold a tab or a line feed.
    pub(super) fn run(&mut self, program: &Path, arguments: &[&Path]) -> Result<Outcome> {
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
