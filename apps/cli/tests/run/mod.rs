//! Runs the real binary in a folder of its own.

#![allow(dead_code, reason = "each test file uses its own part of this")]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_scene::truth;
use tempfile::TempDir;

pub(crate) struct Run {
    folder: TempDir,
}

/// What a run said before it ended.
pub(crate) struct Ended {
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_aquafuse"));
        command.current_dir(self.folder.path()).args(arguments).stdin(Stdio::null());
        command
    }

    /// Runs to the end and expects success.
    pub(crate) fn ok(&self, arguments: &[&str]) -> Ended {
        self.fails(0, arguments)
    }

    /// Runs to the end and expects this exit code.
    pub(crate) fn fails(&self, code: i32, arguments: &[&str]) -> Ended {
        let output = self.command(arguments).output().unwrap();
        let ended = Ended {
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        };
        assert_eq!(output.status.code(), Some(code), "{arguments:?} said: {}", ended.stderr);
        ended
    }
}

/// How many kills a run has to bear; `cargo lab soak` and `multiply` ask for more.
pub(crate) fn kills() -> usize {
    std::env::var("AQUAFUSE_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(20)
}

/// Numbers from 0 to 1, the same in every run of the tests.
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1 << 24)
    }
}

/// Starts a command and kills it after so long; whether it was killed, and not done before.
pub(crate) fn killed_after(mut command: Command, wait: std::time::Duration) -> bool {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(wait);
    let is_killed = child.try_wait().unwrap().is_none();
    if is_killed {
        child.kill().unwrap();
    }
    let ended = child.wait().unwrap();
    assert!(ended.success() || ended.code().is_none(), "it ended by itself with {ended}");
    !ended.success()
}

/// Writes the image of a truth scene in a water known by its name.
pub(crate) fn scene(path: &Path, seed: u64, water: &str) {
    let water = waters().into_iter().find(|known| known.name == water).unwrap().water;
    let image = Scene::new(seed, Size { width: 96, height: 64 }).seen_through(&water).convert::<u8>();
    ImageFile::new(image).write(path, &WriteOptions::default()).unwrap();
}

/// A folder of three images and a file that is none.
pub(crate) fn scenes_folder(folder: &Path) {
    std::fs::create_dir(folder).unwrap();
    for (seed, (name, water)) in
        [("a.png", "blue"), ("b.png", "green"), ("c.jpg", "clear")].iter().enumerate()
    {
        scene(&folder.join(name), seed as u64, water);
    }
    std::fs::write(folder.join("notes.txt"), "not an image").unwrap();
}

/// A truth scene in blue water as a folder of COLMAP: nine images in `reef/images`, cameras and points in `reef/sparse/0`.
pub(crate) fn reef(run: &Run) {
    let (views, blue) = (truth::views(1, Size { width: 64, height: 48 }, 9, 1), waters()[0].water);
    let image_files: Vec<_> = views.iter().map(|view| view.seen_through(&blue)).collect();
    truth::write(&run.path("reef"), &views, &image_files, truth::points(&views, &image_files, 16)).unwrap();
}

/// A program of our own in the run's folder: what a shell does with these lines.
#[cfg(unix)]
pub(crate) fn program(run: &Run, name: &str, lines: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let path = run.path(name);
    std::fs::write(&path, format!("#!/bin/sh\n{lines}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path.to_str().unwrap().to_owned()
}
