//! `cargo xtask check`: everything that can be said about the project without running it.

use anyhow::Result;
use xtask::clock::Steps;
use xtask::setup::Tools;
use xtask::shell::{cargo, command, run as call};

use crate::api;

const STRICT: [&str; 3] = ["--", "-D", "warnings"];
/// Tests and examples ask for no feature but `serde`: with the others they are what they are without.
const FEATURES: [&[&str]; 5] = [
    &["--all-targets"],
    &["--features", "simd"],
    &["--features", "threads"],
    &["--features", "serde", "--all-targets"],
    &["--features", "image,ndarray"],
];

/// What was skipped, a line each.
pub(crate) fn run(tools: &Tools, steps: &mut Steps) -> Result<Vec<String>> {
    steps.time("Format", || call(cargo(&["fmt", "--all", "--check"])))?;
    steps.time("Spelling", || call(command(&tools.typos, &[])))?;
    steps.time("Lints", || {
        let everything = ["clippy", "--workspace", "--all-targets", "--all-features", "--locked"];
        call(cargo(&[&everything[..], &STRICT].concat()))
    })?;
    steps.time("Lints, each feature of the core alone", || {
        FEATURES.iter().try_for_each(|features| {
            let core = ["--locked", "--package", "aquafuse", "--no-default-features"];
            call(cargo(&[&["clippy"], &core[..], features, &STRICT].concat()))
        })
    })?;
    steps.time("Documentation", api::document)?;
    let skipped = steps.time("Public items, compared with api.txt", api::compare)?;
    steps.time("Licences, bans and sources of every dependency", || {
        call(command(&tools.cargo_deny, &["check", "licenses", "bans", "sources"]))
    })?;
    steps.time("Packages, each built from its own tarball", || {
        let libraries = api::CRATES.iter().flat_map(|name| ["--package", name]);
        let package: Vec<&str> =
            ["package", "--quiet", "--locked", "--allow-dirty"].into_iter().chain(libraries).collect();
        // As whoever depends on them builds them, who has none of our profiles; nobody debugs this build.
        let mut package = cargo(&package);
        package.env("CARGO_PROFILE_DEV_DEBUG", "0");
        call(package)
    })?;
    Ok(skipped.into_iter().collect())
}
