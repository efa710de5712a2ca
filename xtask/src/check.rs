//! `cargo xtask check`: everything that can be said about the project without running it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use xtask::clock::Steps;
use xtask::setup::{Tools, lacks_gstreamer};
use xtask::shell::{GST_WORKSPACE, cargo, command, root, run as call, target};

use crate::api;

const STRICT: [&str; 3] = ["--", "-D", "warnings"];
/// Tests and examples ask for no feature but `serde`: with the others they are what they are without.
const FEATURES: [&[&str]; 6] = [
    &["--all-targets"],
    &["--features", "simd"],
    &["--features", "threads"],
    &["--features", "serde", "--all-targets"],
    &["--features", "image,ndarray"],
    &["--features", "network", "--all-targets"],
];

/// What was skipped, a line each.
pub(crate) fn run(tools: &Tools, steps: &mut Steps) -> Result<Vec<String>> {
    steps.time("Format", || {
        call(cargo(&["fmt", "--all", "--check"]))?;
        call(cargo(&[&["fmt"], &GST_WORKSPACE[..], &["--check"]].concat()))
    })?;
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
    let mut skipped = Vec::new();
    match lacks_gstreamer() {
        Some(why) => skipped.push(format!("lints of the GStreamer element: {why}")),
        None => steps.time("Lints of the GStreamer element", || {
            let target = target().to_string_lossy().into_owned();
            let element = ["--all-targets", "--locked", "--target-dir", &target];
            call(cargo(&[&["clippy"], &GST_WORKSPACE[..], &element, &STRICT].concat()))
        })?,
    }
    steps.time("Documentation", api::document)?;
    skipped.extend(steps.time("Public items, compared with api.txt", api::compare)?);
    steps.time("Licences, bans and sources of every dependency", || {
        let asked = ["check", "licenses", "bans", "sources"];
        call(command(&tools.cargo_deny, &asked))?;
        call(command(&tools.cargo_deny, &[&GST_WORKSPACE[..], &asked].concat()))
    })?;
    steps.time("Packages, each built from its own tarball", || {
        let target = root().join("target/packages");
        forget_packages(&target)?;
        let libraries = api::CRATES.iter().flat_map(|name| ["--package", name]);
        let package: Vec<&str> =
            ["package", "--quiet", "--locked", "--allow-dirty"].into_iter().chain(libraries).collect();
        // As whoever depends on them builds them, who has none of our profiles; nobody debugs this build.
        let mut package = cargo(&package);
        package.env("CARGO_PROFILE_DEV_DEBUG", "0").env("CARGO_TARGET_DIR", target);
        call(package)
    })?;
    Ok(skipped)
}

/// Removes what cargo has unpacked and built of our packages before: it keeps both by name and version, and ours change
/// while the version stays.
fn forget_packages(target: &Path) -> Result<()> {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| std::env::var_os("HOME").map(|home| Path::new(&home).join(".cargo")));
    let registries = home.map(|home| folders(&home.join("registry/src"))).unwrap_or_default();
    // Packages that wait for a release lie in a registry without a host's name.
    let unnamed = registries.into_iter().filter(|folder| name(folder).starts_with('-'));
    let builds = [target.join("debug/.fingerprint")];
    for folder in unnamed.chain(builds).flat_map(|folder| folders(&folder)) {
        if name(&folder).starts_with("aquafuse-") {
            std::fs::remove_dir_all(&folder)
                .with_context(|| format!("cannot remove {}", folder.display()))?;
        }
    }
    Ok(())
}

/// The folders in a folder; none where it is missing.
fn folders(folder: &Path) -> Vec<PathBuf> {
    let entries = folder.read_dir().into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect()
}

fn name(folder: &Path) -> std::borrow::Cow<'_, str> {
    folder.file_name().unwrap_or_default().to_string_lossy()
}
