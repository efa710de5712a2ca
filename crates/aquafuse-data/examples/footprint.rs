//! What fusing costs beside the fusion; `cargo xtask bench` runs it.
//!
//!     footprint make FILE WIDTH HEIGHT    a synthetic place as an image
//!     footprint copy FOLDER OUT           decoding and encoding alone: what a folder's run cannot do without
//!     footprint memory FILE               MiB that a frame in place takes at most, above the image itself (Linux)

use std::error::Error;
use std::path::Path;

use aquafuse::stream::Stream;
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::{depth, waterbody};
use aquafuse_data::image_file::{ImageFile, Pixels, WriteOptions};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["make", file, width, height] => {
            let scene = Scene::new(1, Size { width: width.parse()?, height: height.parse()? });
            let seen = scene.seen_through(&waters()[0].water).convert::<u8>();
            Ok(ImageFile::new(seen).write(Path::new(file), &WriteOptions::default())?)
        }
        ["copy", folder, out] => copy(Path::new(folder), Path::new(out)),
        ["memory", file] => memory(Path::new(file)),
        _ => Err("give make FILE WIDTH HEIGHT, copy FOLDER OUT or memory FILE".into()),
    }
}

fn copy(folder: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(out)?;
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        ImageFile::read(&entry.path())?.write(&out.join(entry.file_name()), &WriteOptions::default())?;
    }
    Ok(())
}

fn memory(file: &Path) -> Result<(), Box<dyn Error>> {
    // A small image's water: what is measured is the frame.
    let small = Scene::new(2, Size { width: 96, height: 64 }).seen_through(&waters()[1].water).convert();
    let reference = waterbody::estimate(&small, &depth::estimate(&small), &Default::default())?;
    let Pixels::Bytes(mut frame) = ImageFile::read(file)?.pixels else {
        return Err("give an image of bytes".into());
    };
    // The highest so far becomes what is held now.
    std::fs::write("/proc/self/clear_refs", "5")?;
    let before = kilobytes("VmRSS:")?;
    Stream::new(reference.into()).fuse_mut(&mut frame.image)?;
    println!("{:.1}", (kilobytes("VmHWM:")? - before) / 1024.0);
    Ok(())
}

/// What the system says of this process's memory.
fn kilobytes(line: &str) -> Result<f64, Box<dyn Error>> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let said = status.lines().find_map(|said| said.strip_prefix(line)).ok_or("the system does not say")?;
    Ok(said.trim().trim_end_matches(" kB").parse()?)
}
