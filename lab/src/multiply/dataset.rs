//! A dataset of many small images with labels, and the plain work that multiplying it is compared with.

use std::path::Path;

use anyhow::Result;
use aquafuse::image::Image;
use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::image_file;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use rayon::prelude::*;

const WIDTH: usize = 160;
const HEIGHT: usize = 120;
/// Ray-marched places; the images are windows of them, in water after water.
const PLACES: usize = 12;

/// Writes the dataset: `images/`, `labels/` and two waters beside it.
pub(super) fn make(folder: &Path, count: usize) -> Result<()> {
    let (images, labels, water) =
        (folder.join("set/images"), folder.join("set/labels"), folder.join("waters"));
    for folder in [&images, &labels, &water] {
        std::fs::create_dir_all(folder)?;
    }
    let seen: Vec<Image<u8>> = (0..PLACES)
        .flat_map(|seed| {
            let scene = Scene::new(seed as u64, Size { width: 2 * WIDTH, height: 2 * HEIGHT });
            waters().into_iter().map(move |known| scene.seen_through(&known.water).convert())
        })
        .collect();
    for (image, name) in seen.iter().zip(["a.jpg", "b.jpg"]) {
        ImageFile::new(image.clone())
            .write(&water.join(name), &WriteOptions { overwrite: true, quality: 95 })?;
    }
    (0..count).into_par_iter().try_for_each(|number| -> Result<()> {
        let from = &seen[number % seen.len()];
        let (left, top) = ((number * 37) % WIDTH, (number * 53) % HEIGHT);
        let rows = (top..top + HEIGHT).flat_map(|y| &from.pixels()[y * 2 * WIDTH + left..][..WIDTH]);
        let window = Image::from_raw(WIDTH, HEIGHT, rows.flatten().copied().collect());
        let path = images.join(format!("{number:05}.jpg"));
        ImageFile::new(window?).write(&path, &WriteOptions { overwrite: true, quality: 95 })?;
        let label = format!("0 0.5 0.5 0.{:03} 0.25\n", 1 + number % 900);
        Ok(std::fs::write(labels.join(format!("{number:05}.txt")), label)?)
    })
}

/// `lab recode FOLDER OUTPUT TIMES`, in a process of its own: reads every image once and writes it so many times, as
/// surely as the command does; nothing is done to it.
pub(crate) fn recode(folder: &Path, output: &Path, times: usize) -> Result<()> {
    std::fs::create_dir_all(output)?;
    let image_files = image_file::list(folder)?.images;
    image_files.par_iter().try_for_each(|path| {
        let image_file = ImageFile::read(path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        (0..times).try_for_each(|time| {
            image_file.write(&output.join(format!("{name}__{time}.jpg")), &WriteOptions::default())
        })
    })?;
    Ok(())
}
