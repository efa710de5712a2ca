//! Fuses every content with every reference and lays all of it out on one sheet, as the paper's figure of
//! six references and four contents does.
//!
//! cargo run --release -p aquafuse-data --example contact_sheet -- \
//!     MODEL OUT.jpg CONTENT... -- REFERENCE...

use std::path::{Path, PathBuf};

use aquafuse::fusion::{Bounded, Model, Options, fuse};
use aquafuse_data::drawing::{self, Cell};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_data::pipeline::{DepthSource, analyse};

type Error = Box<dyn std::error::Error>;

fn main() -> Result<(), Error> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = "give MODEL OUT.jpg CONTENT... -- REFERENCE...";
    let [model, output, image_files @ ..] = &arguments[..] else { return Err(usage.into()) };
    let model = model.parse::<Model>().ok().ok_or("no such model")?;
    let dashes = image_files.iter().position(|word| word == "--").ok_or(usage)?;
    let references = read_all(&image_files[dashes + 1..])?;

    let blank = Cell { caption: format!("model {}", model.name()), image: None };
    let heading = references.iter().map(|(name, image_file)| cell(name, image_file));
    let mut rows: Vec<Vec<Cell>> = vec![std::iter::once(blank).chain(heading).collect()];
    for (name, content) in read_all(&image_files[..dashes])? {
        let found = analyse(&content, &DepthSource::default())?;
        let mut row = vec![cell(&name, &content)];
        for (reference_name, reference) in &references {
            let water = analyse(reference, &DepthSource::default())?.estimate;
            let bounded = Bounded::new(&found.estimate, &water, Options::for_model(model));
            let waters = bounded.waters().with_share(&found.share);
            let fused = fuse(&content.bytes(), &found.depth, waters, &bounded.options)?;
            let clipped = 100.0 * fused.clipping.share();
            let limited = if bounded.bounds.any() { ", limited" } else { "" };
            let caption = format!("{reference_name}, {clipped:.1} % clipped{limited}");
            row.push(cell(&caption, &ImageFile::new(fused.image)));
        }
        rows.push(row);
    }
    let sheet = ImageFile::new(drawing::contact_sheet(&rows, 300, 200)?);
    sheet.write(Path::new(output), &WriteOptions { overwrite: true, quality: 92 })?;
    Ok(())
}

fn read_all(paths: &[String]) -> Result<Vec<(String, ImageFile)>, Error> {
    let read = |path: &String| {
        let path = PathBuf::from(path);
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok((name, ImageFile::read(&path)?))
    };
    paths.iter().map(read).collect()
}

fn cell(caption: &str, image_file: &ImageFile) -> Cell {
    Cell { caption: caption.into(), image: Some(image_file.bytes().into_owned()) }
}
