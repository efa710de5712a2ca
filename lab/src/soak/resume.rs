//! How long a job of very many images takes to see that it is done.

use std::fs;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use xtask::shell::{command, output, root, say};

const PICTURES: usize = 100_000;

/// Makes a folder of small images, fuses it, and fuses it again: a line on the second time.
pub(super) fn figure() -> Result<String> {
    let program = crate::programs::aquafuse()?;
    say(&format!("Fusing {PICTURES} small images twice; the second time they are there"));
    let folder = root().join("target/resume");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let photos = folder.join("photos");
    fs::create_dir_all(&photos)?;
    let small = fs::read(root().join("fuzz/corpus/png/single-pixel.png"))
        .context("no corpus; run `cargo run --release -p lab --features parquet -- corpus`")?;
    for i in 0..PICTURES {
        fs::write(photos.join(format!("{i:06}.png")), &small)?;
    }
    let fuse = || {
        let began = Instant::now();
        let mut fuse = command(&program, &["fuse"]);
        fuse.arg(&photos).arg(photos.join("000000.png")).arg("-o").arg(folder.join("fused"));
        output(fuse).map(|said| (said, began.elapsed()))
    };
    fuse()?;
    let (said, took) = fuse()?;
    if !said.contains(&format!("{PICTURES} images skipped")) {
        bail!("the second run did not find the first one's images: {said}");
    }
    fs::remove_dir_all(&folder)?;
    Ok(format!("- resumed: {PICTURES} finished images passed over in {:.1} s\n", took.as_secs_f64()))
}
