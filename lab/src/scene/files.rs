//! `lab scene-files`: splats of ours read by other programs, and theirs by us.

use std::path::Path;

use anyhow::{Context, Result};
use aquafuse_data::image_file::ReadOptions;
use aquafuse_scene::files::{read_splats, write_ply, write_spz};
use aquafuse_scene::splats::Splats;
use xtask::setup::python_environment;
use xtask::shell::{command, output, root};

use crate::pages::{RESULTS, show_section};

/// So many splats: two chunks of the compressed PLY.
const SPLATS: usize = 300;
const HEAD: &str = "| reader | file | position | log scale | 1 - cos of rotation | opacity | colour | harmonics |\n\
                    |---|---|---|---|---|---|---|---|\n";

pub(crate) fn run() -> Result<()> {
    let python = python_environment("scene-files", "lab/scene_files/requirements.txt")?;
    let work = root().join("target/scene-files-work");
    std::fs::create_dir_all(&work)?;
    let splats = some();
    write_ply(&work.join("ours.ply"), &splats, true)?;
    write_spz(&work.join("ours.spz"), &splats, true)?;
    let script = root().join("lab/scene_files/readers.py");
    let read = command(python.join("bin/python"), &[&script.to_string_lossy(), &work.to_string_lossy()]);
    let table = HEAD.to_owned()
        + &output(read)?
        + &row("aquafuse", ".spz", &splats, &work.join("ours.spz"))?
        + &row("aquafuse", ".ply, compressed by gsply", &splats, &work.join("compressed.ply"))?;
    show_section(RESULTS, "scene-files", &table)
}

/// Splats of all kinds, of degree 1.
fn some() -> Splats<f32> {
    let width = Splats::<f32>::new(1).width();
    let mut rows: Vec<f32> = (0..SPLATS * width).map(|i| 0.9 * (i as f32 * 1.7).sin()).collect();
    for row in rows.chunks_exact_mut(width) {
        row[3..6].iter_mut().for_each(|scale| *scale = 2.0 * *scale - 3.0);
    }
    Splats::from_rows(1, rows).expect("whole rows")
}

/// The largest difference of each property; splats may be in another order.
fn row(reader: &str, file: &str, ours: &Splats<f32>, path: &Path) -> Result<String> {
    let read = read_splats(path, &ReadOptions::default())?;
    let apart = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let mut worst = [0.0_f32; 6];
    for i in 0..ours.len() {
        let away = |j: &usize| apart(&ours.mean(i), &read.mean(*j));
        let same = (0..read.len()).min_by(|a, b| away(a).total_cmp(&away(b))).context("it has no splats")?;
        let (a, b) = (ours.row(i), read.row(same));
        let turn: f32 = ours.rotation(i).iter().zip(read.rotation(same)).map(|(a, b)| a * b).sum();
        let found = [
            away(&same),
            apart(&a[3..6], &b[3..6]),
            1.0 - turn.abs(),
            (ours.opacity(i) - read.opacity(same)).abs(),
            apart(&ours.colour(i), &read.colour(same)),
            apart(&a[14..], &b[14..]),
        ];
        worst.iter_mut().zip(found).for_each(|(worst, found)| *worst = worst.max(found));
    }
    let cells = worst.map(|value| format!("{value:.4}")).join(" | ");
    Ok(format!("| {reader} | {file} | {cells} |\n"))
}
