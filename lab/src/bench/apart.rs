//! What fusing costs beside the fusion, measured in processes of their own.

use std::path::Path;

use anyhow::{Context, Result, bail};
use aquafuse::stream::Stream;
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::{depth, waterbody};
use aquafuse_data::image_file::{ImageFile, Pixels, WriteOptions};

/// `lab copy FOLDER OUT`: decoding and encoding alone, without which no folder is fused.
pub(crate) fn copy(folder: &Path, out: &Path) -> Result<()> {
    std::fs::create_dir_all(out)?;
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        ImageFile::read(&entry.path())?.write(&out.join(entry.file_name()), &WriteOptions::default())?;
    }
    Ok(())
}

/// `lab frame-memory FILE`: MiB that a frame in place takes at most, above the image itself (Linux).
pub(crate) fn memory(file: &Path) -> Result<()> {
    // A small image's water: what is measured is the frame.
    let small = Scene::new(2, Size { width: 96, height: 64 }).seen_through(&waters()[1].water).convert();
    let reference = waterbody::estimate(&small, &depth::estimate(&small), &Default::default())?;
    let Pixels::Bytes(mut frame) = ImageFile::read(file)?.pixels else {
        bail!("give an image of bytes");
    };
    // The highest so far becomes what is held now.
    std::fs::write("/proc/self/clear_refs", "5")?;
    let before = kilobytes("VmRSS:")?;
    Stream::new(reference.into()).fuse_mut(&mut frame.image)?;
    println!("{:.1}", (kilobytes("VmHWM:")? - before) / 1024.0);
    Ok(())
}

/// What the system says of this process's memory.
pub(crate) fn kilobytes(line: &str) -> Result<f64> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let said = status.lines().find_map(|said| said.strip_prefix(line)).context("the system does not say")?;
    Ok(said.trim().trim_end_matches(" kB").parse()?)
}
