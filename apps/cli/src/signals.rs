//! Stopping when told: nothing half-written is left, and the exit code says who asked.

#[cfg(unix)]
mod unix {
    use std::io::{IsTerminal, Write};
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use aquafuse_data::files::abandon_parts;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    pub(crate) fn heed() -> std::io::Result<()> {
        // A file that grows past the limit of its user should be an error with a name, not the end.
        signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
        // What whoever started us has set to be ignored (`nohup`) stays ignored.
        let ignored = ignored();
        let heeded =
            [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| ignored & (1 << (signal - 1)) == 0);
        let mut signals = Signals::new(heeded)?;
        std::thread::spawn(move || {
            let mut told = signals.forever();
            if let Some(signal) = told.next() {
                // Should the removal hang on a disk that does, the second one ends us without.
                std::thread::spawn(move || stop(signal));
            }
            if let Some(signal) = told.next() {
                std::process::exit(128 + signal);
            }
        });
        Ok(())
    }

    /// The signals that were ignored when we started, as bits; none where the system does not say.
    fn ignored() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
    }

    /// What is in flight is dropped: it may take seconds, and its output is not there yet.
    fn stop(signal: i32) {
        crate::tool::stop();
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
