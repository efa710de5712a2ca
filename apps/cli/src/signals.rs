//! Stopping on a signal: no partly written file is left, and the exit code names the signal.

#[cfg(unix)]
mod unix {
    use std::io::{Error, IsTerminal, Write};
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use aquafuse_data::files::abandon_parts;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    pub(crate) fn heed() -> std::io::Result<()> {
        // A file that grows past the user's limit should be an error that names it, not the end of the process.
        signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
        // Signals that the parent process set to be ignored (`nohup`) stay ignored.
        let ignored = ignored();
        let heeded =
            [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| ignored & (1 << (signal - 1)) == 0);
        let mut signals = Signals::new(heeded)?;
        let heed = move || {
            let mut received = signals.forever();
            if let Some(signal) = received.next() {
                // If the removal hangs on a disk that hangs, a second signal ends the process without it.
                if thread(move || stop(signal)).is_err() {
                    stop(signal);
                }
            }
            if let Some(signal) = received.next() {
                std::process::exit(128 + signal);
            }
        };
        thread(heed)
            .map_err(|error| Error::new(error.kind(), "the system gives no more threads; end other programs"))
    }

    fn thread(work: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
        std::thread::Builder::new().spawn(work).map(|_| ())
    }

    /// The signals that were ignored when we started, as bits; none where the system does not say.
    fn ignored() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
    }

    /// Drops the images in work: they may take seconds more, and their outputs do not exist yet.
    fn stop(signal: i32) {
        aquafuse_data::run::end_programs();
        abandon_parts();
        let mut stderr = std::io::stderr();
        // Over a progress bar, where there may be one.
        let clear = if stderr.is_terminal() { "\r\x1b[2K" } else { "" };
        let _ = writeln!(
            stderr,
            "{clear}aquafuse: stopped; all written files are complete. To continue a run over a folder, repeat the command"
        );
        std::process::exit(128 + signal);
    }
}

#[cfg(unix)]
pub(crate) use unix::heed;

/// Without such signals the system ends the process; the next run removes its temporary files.
#[cfg(not(unix))]
pub(crate) fn heed() -> std::io::Result<()> {
    Ok(())
}
