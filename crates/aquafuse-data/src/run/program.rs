//! Other programs that a run starts: they end with it, and with this process.

use std::io;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// The programs that run.
static RUNNING: Mutex<Running> = Mutex::new(Running { programs: Vec::new(), is_over: false });
/// How often the end of a program is checked.
const LOOK: Duration = Duration::from_millis(5);

struct Running {
    programs: Vec<Arc<Mutex<Child>>>,
    is_over: bool,
}

/// A program that was started; it is killed if it still runs when this is dropped.
///
/// # Examples
///
/// ```
/// use std::process::Command;
/// use aquafuse_data::run::Program;
///
/// # #[cfg(unix)] {
/// let program = Program::start(&mut Command::new("true"))?;
/// assert!(program.wait()?.success());
/// # }
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct Program(Arc<Mutex<Child>>);

impl Program {
    /// Starts a program. Ctrl-C in a terminal reaches this process alone, which then ends the program.
    ///
    /// # Errors
    ///
    /// Whatever the system says.
    pub fn start(command: &mut Command) -> io::Result<Self> {
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        let mut running = running();
        let child = Arc::new(Mutex::new(command.spawn()?));
        running.programs.push(Arc::clone(&child));
        Ok(Self(child))
    }

    /// Its standard input, if that is a pipe and was not taken before.
    pub fn stdin(&self) -> Option<ChildStdin> {
        child(&self.0).stdin.take()
    }

    /// Its standard output, likewise.
    pub fn stdout(&self) -> Option<ChildStdout> {
        child(&self.0).stdout.take()
    }

    /// Its standard error, likewise.
    pub fn stderr(&self) -> Option<ChildStderr> {
        child(&self.0).stderr.take()
    }

    /// Waits for its end.
    ///
    /// # Errors
    ///
    /// Whatever the system says.
    pub fn wait(&self) -> io::Result<ExitStatus> {
        loop {
            // Once programs are ended by a signal, this process is about to end: what they say is of no use.
            drop(running());
            if let Some(status) = child(&self.0).try_wait()? {
                return Ok(status);
            }
            thread::sleep(LOOK);
        }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        end(&self.0);
        running().programs.retain(|other| !Arc::ptr_eq(other, &self.0));
    }
}

/// Ends all programs; whoever would start another, or wait for one, waits for ever.
///
/// For a program that received a signal, right before it ends.
pub fn end_programs() {
    let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    running.is_over = true;
    running.programs.drain(..).for_each(|program| end(&program));
}

fn end(program: &Mutex<Child>) {
    let mut child = child(program);
    if matches!(child.try_wait(), Ok(None)) {
        let _ = child.kill();
        let _ = child.wait();
    }
}

fn child(program: &Mutex<Child>) -> MutexGuard<'_, Child> {
    program.lock().unwrap_or_else(PoisonError::into_inner)
}

fn running() -> MutexGuard<'static, Running> {
    let running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    if running.is_over {
        drop(running);
        loop {
            thread::park();
        }
    }
    running
}
