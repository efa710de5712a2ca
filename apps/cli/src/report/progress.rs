//! A progress bar on standard error, if that is a terminal.

use std::fmt::Write;

use aquafuse_data::files::one_line;
use aquafuse_data::run::Event;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::output;

/// Shows the progress of a run: count, speed, remaining time, and each failure on its own line.
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    pub(crate) fn new(quiet: bool) -> Self {
        // Indicatif itself stays silent where standard error is no terminal.
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style = ProgressStyle::with_template("{bar:32} {pos}/{len}  {rate}  {eta} left  {wide_msg:.dim}");
        let bar = ProgressBar::with_draw_target(None, target);
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        // Its own rate has four decimals.
        let rate = |state: &ProgressState, out: &mut dyn Write| {
            let _ = write!(out, "{:.1} per second", state.per_sec());
        };
        Self { bar: bar.with_style(style.with_key("rate", rate)) }
    }

    /// Shows an event of a run; `name` gives the name of an item.
    pub(crate) fn show<I: ?Sized, R, E: std::fmt::Display>(
        &self,
        event: &Event<'_, I, R, E>,
        name: impl Fn(&I) -> String,
    ) {
        match event {
            Event::Started { total } => self.start(*total),
            Event::Done { item, .. } | Event::Skipped { item } => self.done(&name(item)),
            Event::Failed { error, .. } => self.failed(error),
            _ => {}
        }
    }

    pub(crate) fn start(&self, total: usize) {
        self.bar.set_length(total as u64);
    }

    pub(crate) fn done(&self, what: &str) {
        self.bar.set_message(one_line(what));
        self.bar.inc(1);
    }

    pub(crate) fn failed(&self, error: &impl std::fmt::Display) {
        self.complain(error);
        self.bar.inc(1);
    }

    /// Prints a message on its own line.
    pub(crate) fn complain(&self, what: &impl std::fmt::Display) {
        // `println` of the bar would swallow the line where there is no terminal.
        self.bar.suspend(|| output::complain(what));
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
