//! Sections of `docs/results.md` that `aquafuse evaluate` prints.

use std::path::Path;

use anyhow::Result;
use serde::Deserialize;
use xtask::shell::{command, output, root, run, say, target};

use crate::pages::{RESULTS, real_images, show_section};

/// Writes a section with what `aquafuse evaluate` prints.
pub(crate) fn write(aquafuse: &Path, section: &str, arguments: &[&str]) -> Result<()> {
    let evaluate = command(aquafuse, &[&["evaluate"], arguments].concat());
    show_section(RESULTS, section, &output(evaluate)?)
}

/// Sets of raw images and of references that people chose, each with its section.
const SETS: [(&str, &str); 2] = [("uieb", "pairs-uieb"), ("lsui", "pairs-lsui")];

/// `lab pairs`: how near restoration and enhancement come to the references of two sets, beside rivals.
pub(crate) fn pairs() -> Result<()> {
    let data = real_images()?;
    let aquafuse = crate::programs::aquafuse()?;
    let python = xtask::setup::python()?;
    for (set, section) in SETS {
        let [raw, reference] =
            ["raw", "reference"].map(|part| format!("{data}/restoration_pairs/{set}/{part}"));
        say(&format!("Restoring and enhancing the images of {set}"));
        let made = target().join("pairs").join(set);
        let folder = made.to_string_lossy();
        run(command(&python, &["benches/enhancement_rivals.py", &raw, &reference, &folder]))?;
        let rivals = [
            ("CLAHE", "clahe"),
            ("Reinhard, to the other references", "reinhard"),
            ("Ancuti fusion", "fusion"),
        ];
        let [clahe, reinhard, fusion] = rivals.map(|(name, part)| format!("{name}={folder}/{part}"));
        let arguments = [
            &["enhancement", &raw, "--reference", &reference][..],
            &["--clear", "preset:jerlov-I", "--method", &clahe, "--method", &reinhard, "--method", &fusion],
        ];
        write(&aquafuse, section, &arguments.concat())?;
    }
    show_section(RESULTS, "pairs-published", &published_pairs()?)
}

/// What others print for these sets, from `testdata/published.toml`.
#[derive(Deserialize)]
struct Published {
    restoration: Restoration,
}

#[derive(Deserialize)]
struct Restoration {
    table: String,
    sets: [String; 2],
    method: Vec<Method>,
}

#[derive(Deserialize)]
struct Method {
    name: String,
    psnr: [f64; 2],
}

fn published_pairs() -> Result<String> {
    let text = std::fs::read_to_string(root().join("testdata/published.toml"))?;
    let Published { restoration: Restoration { table, sets: [one, other], method } } = toml::from_str(&text)?;
    let mut page = format!("| published ({table}) | {one}, dB | {other}, dB |\n|---|---|---|\n");
    for Method { name, psnr: [one, other] } in method {
        page += &format!("| {name} | {one:.2} | {other:.2} |\n");
    }
    Ok(page)
}

/// `lab published`: real images scored, beside what the paper prints, what others make of them, and before and after
/// enhancement.
pub(crate) fn published() -> Result<()> {
    let scenes = format!("{}/scenes", real_images()?);
    let aquafuse = crate::programs::aquafuse()?;
    say("Fusing real images, each with eight others (minutes)");
    let fusion =
        ["fusion", "--contents", &scenes, "--references", &scenes, "--group-by", "prefix", "--pairs", "8"];
    write(&aquafuse, "published", &[&fusion[..], &["--as-published"]].concat())?;
    write(&aquafuse, "methods", &[&fusion[..], &["--rivals"]].concat())?;
    write(&aquafuse, "enhancement", &["enhancement", &scenes])
}
