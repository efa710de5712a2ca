//! Other programs: run to their end, and ended with this process.

use std::fs::File;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use aquafuse_data::files::{display, one_line};
use aquafuse_data::run::Program;

/// Lines of its output that a message repeats.
const LAST_LINES: usize = 4;

/// A program failed.
#[derive(Debug)]
pub(crate) enum ToolError {
    /// It cannot be started.
    Start { program: String, cause: std::io::Error },
    /// It ended with an error.
    Failed { program: String, status: String, last: String, log: String },
    /// Its output cannot be logged.
    Log { log: String, cause: std::io::Error },
}

impl std::error::Error for ToolError {}

impl std::fmt::Display for ToolError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Start { program, cause } => write!(f, "cannot start {program}: {cause}"),
            Self::Failed { program, status, last, log } => {
                write!(f, "{program} failed ({status}); its output is in {log} and ends with: {last}")
            }
            Self::Log { log, cause } => write!(f, "cannot write {log}: {cause}"),
        }
    }
}

/// Runs a program and appends its output to `log`.
pub(crate) fn run(command: &mut Command, log: &Path) -> Result<(), ToolError> {
    let no_log = |cause| ToolError::Log { log: display(log).to_string(), cause };
    let both =
        File::options().create(true).append(true).open(log).and_then(|file| Ok((file.try_clone()?, file)));
    let (out, err) = both.map_err(no_log)?;
    let program = command.get_program().to_string_lossy().into_owned();
    let started = Program::start(command.stdin(Stdio::null()).stdout(out).stderr(err));
    match started.and_then(|running| running.wait()) {
        Ok(status) if !status.success() => Err(failed(program, &status, log)),
        Ok(_) => Ok(()),
        Err(cause) => Err(ToolError::Start { program, cause }),
    }
}

fn failed(program: String, status: &ExitStatus, log: &Path) -> ToolError {
    let said = std::fs::read(log).unwrap_or_default();
    let said = String::from_utf8_lossy(&said);
    let lines: Vec<&str> = said.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let last = one_line(&lines[lines.len().saturating_sub(LAST_LINES)..].join(" / "));
    ToolError::Failed { program, status: status.to_string(), last, log: display(log).to_string() }
}
