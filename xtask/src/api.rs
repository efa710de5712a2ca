//! `cargo xtask api`: the public items of each library, one a line, in its `api.txt`.

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use anyhow::{Context, Result, bail};
use xtask::shell::{cargo, root, run as call, target};

/// The libraries that are published.
pub(crate) const CRATES: [&str; 3] = ["aquafuse", "aquafuse-data", "aquafuse-scene"];
/// Set where this program is called in the place of rustdoc.
const AS_RUSTDOC: &str = "XTASK_AS_RUSTDOC";
/// What `api-text` ends with if it does not know the JSON of this rustdoc.
const UNKNOWN_FORMAT: i32 = 3;

/// Documentation without warnings, and beside it, in the same run, what rustdoc knows as JSON.
pub(crate) fn document() -> Result<()> {
    let mut doc = cargo(&["doc", "--workspace", "--no-deps", "--all-features", "--locked"]);
    let ourselves = std::env::current_exe().context("the system does not say where this program is")?;
    doc.env("RUSTDOCFLAGS", "-D warnings").env("RUSTDOC", ourselves).env(AS_RUSTDOC, "1");
    call(doc)
}

/// This program in the place of rustdoc, if it is called so: documents a crate, and once more as JSON if it is one of
/// [`CRATES`].
pub(crate) fn as_rustdoc() -> Option<ExitCode> {
    std::env::var_os(AS_RUSTDOC)?;
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let named = arguments.iter().skip_while(|word| *word != "--crate-name").nth(1);
    let is_library = named.is_some_and(|name| CRATES.iter().any(|library| *name == *file_name(library)));
    let mut json = Command::new("rustdoc");
    // JSON is not stable yet. Only rustdoc is told to bear that: cargo would build every dependency again.
    json.args(&arguments)
        .args(["-Z", "unstable-options", "--output-format", "json"])
        .env("RUSTC_BOOTSTRAP", "1");
    let mut html = Command::new("rustdoc");
    html.args(&arguments);
    let runs = [Some(html), is_library.then_some(json)];
    let done = runs.into_iter().flatten().all(|mut run| run.status().is_ok_and(|status| status.success()));
    Some(if done { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Whether the files are as the sources are; why not, if this cannot be said.
pub(crate) fn compare() -> Result<Option<String>> {
    for name in CRATES {
        let new = match text(name)? {
            Ok(text) => text,
            Err(why) => return Ok(Some(format!("public items: {why}"))),
        };
        let old = std::fs::read_to_string(path(name)).unwrap_or_default();
        if new != old {
            let only_in = |a: &str, b: &str, sign| {
                let lines = a.lines().filter(|line| !b.lines().any(|other| other == *line));
                lines.map(|line| format!("{sign} {line}\n")).collect::<String>()
            };
            bail!(
                "the public items of {name} are not those of its api.txt:\n{}{}If that is meant, `cargo xtask api` writes \
                 them; a line that is gone or changed breaks whoever uses it, so CHANGELOG.md should say so.",
                only_in(&old, &new, '-'),
                only_in(&new, &old, '+')
            );
        }
    }
    Ok(None)
}

/// Writes the files.
pub(crate) fn renew() -> Result<()> {
    document()?;
    for name in CRATES {
        match text(name)? {
            Ok(text) => std::fs::write(path(name), text).context("cannot write api.txt")?,
            Err(why) => bail!("{why}"),
        }
    }
    Ok(())
}

fn path(name: &str) -> PathBuf {
    root().join("crates").join(name).join("api.txt")
}

/// The name of a crate as rustdoc has it.
fn file_name(name: &str) -> String {
    name.replace('-', "_")
}

/// The public items of a crate, or why they cannot be listed.
fn text(name: &str) -> Result<Result<String, String>> {
    let json = target().join("doc").join(file_name(name)).with_extension("json");
    let mut list = cargo(&["run", "--quiet", "--locked", "--package", "api-text", "--"]);
    let output = list.arg(json).output().context("cannot start cargo")?;
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    match output.status.code() {
        Some(0) => Ok(Ok(String::from_utf8_lossy(&output.stdout).into_owned())),
        Some(UNKNOWN_FORMAT) => Ok(Err(said)),
        _ => bail!("the public items of {name} cannot be listed: {said}"),
    }
}
