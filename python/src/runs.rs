//! Runs of the libraries beside the thread of Python, which passes events on and may stop them.

use std::fmt::Display;
use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use aquafuse_data::image_file::ReadOptions;
use aquafuse_data::run::{Event, RunOptions, Stop};
use pyo3::prelude::*;

use crate::error::{Fault, in_python};
use crate::settings::optional;
use crate::threads;

/// What a run reports: `started` with a total, then `done`, `skipped` or `failed` with an item and a message.
type Reported = (&'static str, String, String, usize);

/// What a run may take.
#[derive(Clone, Copy, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Limits {
    threads: Option<i64>,
    max_memory: Option<i64>,
}

impl Limits {
    /// How a run works that reads images so.
    pub(crate) fn options(self, reading: ReadOptions) -> Result<RunOptions, Fault> {
        let threads: Option<usize> = optional("threads", self.threads, 1..=threads::MOST as i64)?;
        let max_memory = optional("max_memory", self.max_memory, 1..=i64::MAX)?.unwrap_or(reading.max_memory);
        Ok(RunOptions {
            threads: threads.and_then(NonZeroUsize::new),
            reading: ReadOptions { max_memory, ..reading },
            ..RunOptions::default()
        })
    }
}

/// How many threads a run was given, or else how many one call uses.
pub(crate) fn threads_of(options: &RunOptions) -> usize {
    options.threads.map_or_else(threads::get_threads, NonZeroUsize::get)
}

/// Refuses a process that was forked, for it has none of the threads that a run needs.
pub(crate) fn refuse_fork(command: &str) -> Result<(), Fault> {
    match threads::is_forked() {
        false => Ok(()),
        true => Err(Fault::run(format!(
            "this process was forked from one that uses aquafuse, whose threads it does not have; start it by the method \
             spawn, or run the command `aquafuse {command}`"
        ))),
    }
}

/// Where a run reports what happens.
#[derive(Clone)]
pub(crate) struct Reporter(Sender<Reported>);

impl Reporter {
    /// Passes an event on, its item by its name.
    pub(crate) fn report<I: ?Sized, R, E: Display>(
        &self,
        event: &Event<'_, I, R, E>,
        name: impl Fn(&I) -> String,
    ) {
        self.report_with(event, name, |_| String::new());
    }

    /// The same, with a message about what was done.
    pub(crate) fn report_with<I: ?Sized, R, E: Display>(
        &self,
        event: &Event<'_, I, R, E>,
        name: impl Fn(&I) -> String,
        about: impl Fn(&R) -> String,
    ) {
        let reported = match event {
            Event::Started { total } => ("started", String::new(), String::new(), *total),
            Event::Done { item, result } => ("done", name(item), about(result), 0),
            Event::Skipped { item } => ("skipped", name(item), String::new(), 0),
            Event::Failed { item, error } => ("failed", name(item), in_python(&error.to_string()), 0),
            _ => return,
        };
        // Whoever listened is gone if the run is stopped.
        let _ = self.0.send(reported);
    }
}

/// Runs beside this thread, which passes events on and looks for signals. An exception of either stops the run.
pub(crate) fn run<R: Send>(
    py: Python<'_>,
    stop: &Stop,
    listener: &Bound<'_, PyAny>,
    work: impl FnOnce(&Reporter) -> Result<R, Fault> + Send,
) -> PyResult<R> {
    let (send, reports) = channel::<Reported>();
    std::thread::scope(|scope| {
        let worker = scope.spawn(move || work(&Reporter(send)));
        let listened = listen(py, &Mutex::new(reports), listener);
        if listened.is_err() {
            stop.stop();
        }
        let ended = py.detach(|| worker.join());
        let ended = ended.map_err(|cause| Fault::panic(&*cause));
        listened?;
        Ok(ended??)
    })
}

/// Passes events on until the run has ended.
fn listen(py: Python<'_>, reports: &Mutex<Receiver<Reported>>, listener: &Bound<'_, PyAny>) -> PyResult<()> {
    const OFTEN: Duration = Duration::from_millis(50);
    loop {
        match py.detach(|| {
            reports.lock().map_or(Err(RecvTimeoutError::Disconnected), |reports| reports.recv_timeout(OFTEN))
        }) {
            Ok(event) => listener.call1(event).map(drop)?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        py.check_signals()?;
    }
}
