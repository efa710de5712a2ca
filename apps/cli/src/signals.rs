//! Stopping when told: nothing half-written is left, and the exit code says who asked.

#[cfg(unix)]
mod unix {
    use std::io::{IsTerminal, Write};
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use aquafuse_data::picture::abandon_parts;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    pub(crate) fn heed() -> std::io::Result<()> {
        // A file that grows past the limit of its user should be an error with a name, not the end.
        signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
        let mut signals = Signals::new([SIGHUP, SIGINT, SIGTERM])?;
        std::thread::spawn(move || {
            if let Some(signal) = signals.forever().next() {
                stop(signal);
            }
        });
        Ok(())
    }

    /// What is in flight is dropped: it may take seconds, and its output is not there yet.
    fn stop(signal: i32) {
        abandon_parts();
        let mut stderr = std::io::stderr();
        // Over a progress bar, where there may be one.
        let clear = if stderr.is_terminal() { "\r\x1b[2K" } else { "" };
        let _ = writeln!(
            stderr,
            "{clear}aquafuse: stopped; every file it wrote is whole. The same command on a folder goes on from here"
        );
        std::process::exit(128 + signal);
    }
}

#[cfg(unix)]
pub(crate) use unix::heed;

/// Where there are no such signals, the system ends us; temporary files are removed by the next run.
#[cfg(not(unix))]
pub(crate) fn heed() -> std::io::Result<()> {
    Ok(())
}
