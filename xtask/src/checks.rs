//! Everything that can be said about the project without running it.

use anyhow::Result;

use crate::setup::Tools;
use crate::shell::{cargo, command, run as call, say};

pub(crate) fn run(tools: &Tools) -> Result<()> {
    say("Format");
    call(cargo(&["fmt", "--all", "--check"]))?;

    say("Spelling");
    call(command(&tools.typos, &[]))?;

    say("Lints");
    let strict = ["--", "-D", "warnings"];
    let everything = ["clippy", "--workspace", "--all-targets", "--all-features", "--locked"];
    call(cargo(&[&everything[..], &strict].concat()))?;

    say("Each feature of the core alone");
    for features in [&[][..], &["--features", "simd"], &["--features", "threads"], &["--features", "serde"]] {
        let core = ["clippy", "--package", "aquafuse", "--all-targets", "--locked", "--no-default-features"];
        call(cargo(&[&core[..], features, &strict].concat()))?;
    }

    say("Documentation");
    let mut doc = cargo(&["doc", "--workspace", "--no-deps", "--all-features", "--locked"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    call(doc)?;

    say("Licences, bans and sources of every dependency");
    call(command(&tools.cargo_deny, &["check", "licenses", "bans", "sources"]))
}
