//! Images of a synthetic place, for programs that are timed or counted.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use aquafuse::image::Image;
use aquafuse::truth::{Scene, Size, waters};
use xtask::shell::target;

/// A folder with `blue.ppm` and `green.ppm`: one place in two waters. Made again, for the scene's code may have changed.
pub(crate) fn images((width, height): (usize, usize)) -> Result<PathBuf> {
    let folder = target().join(format!("bench/{width}x{height}"));
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let scene = Scene::new(1, Size { width, height });
    for named in waters().iter().filter(|named| ["blue", "green"].contains(&named.name)) {
        write_ppm(
            &folder.join(named.name).with_extension("ppm"),
            &scene.seen_through(&named.water).convert(),
        )?;
    }
    Ok(folder)
}

fn write_ppm(path: &Path, image: &Image<u8>) -> Result<()> {
    let header = format!("P6 {} {} 255\n", image.width(), image.height());
    std::fs::write(path, [header.as_bytes(), image.as_raw()].concat())
        .with_context(|| format!("cannot write {}", path.display()))
}
