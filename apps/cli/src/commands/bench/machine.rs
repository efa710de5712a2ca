//! What was measured on.

use std::fmt;

use serde::Serialize;

/// The machine and the program.
#[derive(Serialize)]
pub(super) struct Machine {
    processor: String,
    pub(super) cores: usize,
    system: String,
    /// Vector instructions in use.
    vectors: &'static str,
    aquafuse: &'static str,
}

impl Machine {
    pub(super) fn this() -> Self {
        // Only Linux has a file with it; elsewhere the architecture is used.
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let processor = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        Self {
            processor: processor.map_or(std::env::consts::ARCH, |(_, name)| name).to_owned(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            vectors: vectors(),
            aquafuse: env!("CARGO_PKG_VERSION"),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { processor, cores, system, vectors, aquafuse } = self;
        write!(f, "aquafuse {aquafuse} on {processor}, {cores} cores, {system}, vectors: {vectors}")
    }
}

#[cfg(target_arch = "x86_64")]
fn vectors() -> &'static str {
    if std::arch::is_x86_feature_detected!("avx2") { "avx2" } else { "plain" }
}

#[cfg(target_arch = "aarch64")]
fn vectors() -> &'static str {
    "neon"
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn vectors() -> &'static str {
    "plain"
}
