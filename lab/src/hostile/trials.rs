//! What is tried: the forged files, and odd ones that are made where they are tried.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::forge::{self, Forged, Right, Role};

/// A file to try.
pub(super) struct Trial {
    pub(super) path: PathBuf,
    pub(super) kind: String,
    pub(super) given: Given,
    pub(super) right: Right,
}

/// What a file is given as.
pub(super) enum Given {
    As(Role),
    /// Annotations in the folder of a dataset.
    In(PathBuf),
}

impl Trial {
    /// What is shown of it: its name, and the name of its dataset.
    pub(super) fn shown(&self) -> String {
        match &self.given {
            Given::As(_) => self.name(),
            Given::In(dataset) => dataset.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }

    /// The file's name, without its folder.
    pub(super) fn name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// The forged files, written into a folder.
pub(super) fn forged(folder: &Path) -> Result<Vec<Trial>> {
    let files = forge::files()?;
    let paths = files.write(&folder.join("files"))?;
    let trial = |(path, file): (PathBuf, &Forged)| Trial {
        path,
        kind: file.kind.to_owned(),
        given: Given::As(file.role),
        right: file.right,
    };
    Ok(paths.into_iter().zip(files.iter()).map(trial).collect())
}

/// Datasets of one image, each with a file of annotations that was forged.
pub(super) fn labelled(folder: &Path, good: &Path) -> Result<Vec<Trial>> {
    let mut trials = Vec::new();
    for label in forge::labels() {
        let dataset = folder.join("labels").join(&label.name);
        let path = dataset.join(label.path);
        fs::create_dir_all(dataset.join("images"))?;
        fs::copy(good, dataset.join("images/a.png"))?;
        // A list is about images whose labels are right.
        if label.name.starts_with("list-") {
            fs::create_dir_all(dataset.join("labels"))?;
            fs::write(dataset.join("labels/a.txt"), "0 0.5 0.5 0.2 0.2\n")?;
        }
        fs::create_dir_all(path.parent().unwrap_or(&dataset))?;
        fs::write(&path, &label.bytes)?;
        let kind = match label.right {
            Right::Accept => "unusual but valid annotations",
            Right::Any | Right::Refuse => "bad annotations",
        };
        trials.push(Trial { path, kind: kind.to_owned(), given: Given::In(dataset), right: label.right });
    }
    Ok(trials)
}

/// Things of a file system that are no plain files, or not where they seem to be.
#[cfg(unix)]
pub(super) fn odd(folder: &Path, good: &Path) -> Result<Vec<Trial>> {
    use std::os::unix::fs::{PermissionsExt, symlink};
    use std::os::unix::net::UnixListener;

    use xtask::shell::{command, run};

    let odd = folder.join("odd");
    fs::create_dir_all(odd.join("folder.png"))?;
    let at = |name: &str| odd.join(name);
    let mut trials = Vec::new();
    let mut add = |right, name: &str| {
        trials.push((at(name), Role::Image, right));
        if right == Right::Refuse {
            trials.push((at(name), Role::Depth, right));
        }
    };
    // Nobody writes into it: who opens it as a file waits for ever.
    run(command("mkfifo", &[&at("pipe.png").to_string_lossy()]))?;
    symlink(at("nothing-here.png"), at("dangling-link.png"))?;
    symlink(at("link-loop-b.png"), at("link-loop-a.png"))?;
    symlink(at("link-loop-a.png"), at("link-loop-b.png"))?;
    symlink("/dev/zero", at("endless.png"))?;
    symlink("/dev/null", at("null.png"))?;
    symlink(good, at("link-to-a-good-one.png"))?;
    // It stays when its listener goes. Long paths cannot be bound to; the file is then only missing.
    drop(UnixListener::bind(at("socket.png")));
    // Four gigabytes of zeros that take no room.
    fs::File::create(at("sparse.png"))?.set_len(4 << 30)?;
    let long = format!("{}.png", "long-name-".repeat(25));
    for name in [&long[5..], "with space; and 'quotes' $HOME.png", "réf-水-\u{202e}gnp.png"] {
        fs::copy(good, at(name))?;
        add(Right::Accept, name);
    }
    add(Right::Accept, "link-to-a-good-one.png");
    for name in [
        "pipe.png",
        "dangling-link.png",
        "link-loop-a.png",
        "endless.png",
        "null.png",
        "socket.png",
        "sparse.png",
        "folder.png",
        "never-made.png",
    ] {
        add(Right::Refuse, name);
    }
    fs::copy(good, at("not-ours.png"))?;
    fs::set_permissions(at("not-ours.png"), fs::Permissions::from_mode(0o0))?;
    // The administrator may read everything.
    if fs::File::open(at("not-ours.png")).is_err() {
        add(Right::Refuse, "not-ours.png");
    }
    let trial =
        |(path, role, right)| Trial { path, kind: "odd file".to_owned(), given: Given::As(role), right };
    Ok(trials.into_iter().map(trial).collect())
}

/// Elsewhere there are none.
#[cfg(not(unix))]
pub(super) fn odd(_: &Path, _: &Path) -> Result<Vec<Trial>> {
    Ok(Vec::new())
}
