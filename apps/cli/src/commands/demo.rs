//! `aquafuse demo`: fusion of synthetic images, with their depth and a labelled dataset to try the other commands on.

use std::path::PathBuf;
use std::time::Instant;

use aquafuse::depth::{DepthKind, DepthMap};
use aquafuse::fusion::{Bounded, Model, Options, fuse};
use aquafuse::image::Image;
use aquafuse::truth::{Kind, NamedWater, OPEN_WATER, Scene, Size, waters};
use aquafuse::waterbody::WaterMap;
use aquafuse_data::depth_file;
use aquafuse_data::drawing::{Cell, contact_sheet};
use aquafuse_data::files::{display, make_folder, make_folder_of};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_data::pipeline::{Analysis, DepthSource, analyse};
use clap::Args;

use crate::failure::Failure;
use crate::report::output;

/// Try fusion on synthetic images.
///
/// Renders scenes of a sea floor in different waters and fuses each with each. The estimators get only the
/// images. Beside them it writes `depth/`, the true depth of the two contents in millimetres, and `fish/`, a dataset of
/// the two contents with a mask of the fish.
#[derive(Args)]
pub(crate) struct Demo {
    /// Output folder.
    #[arg(short, long, value_name = "DIR", default_value = "aquafuse-demo")]
    output: PathBuf,
    /// Seed of the scenes.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write to a folder that is not empty and replace images of the same names.
    #[arg(long)]
    overwrite: bool,
}

const CONTENT: Size = Size { width: 480, height: 320 };
/// References are only looked at for their water.
const REFERENCE: Size = Size { width: 240, height: 160 };

impl Demo {
    pub(crate) fn run(&self, quiet: bool) -> Result<(), Failure> {
        let say = |text: &str| if quiet { Ok(()) } else { output::print(text) };
        if !self.overwrite {
            output::refuse_filled(&self.output, &[])?;
        }
        make_folder(&self.output)?;
        let began = Instant::now();
        let [blue, green, turbid, clear, deep] = waters();
        say(&format!("Making images and fusing them, into {}:\n", display(&self.output)))?;

        let mut references = Vec::new();
        for (i, water) in [green, clear, deep].into_iter().enumerate() {
            let scene = Scene::new(self.seed.wrapping_add(10 + i as u64), REFERENCE);
            let made = Made::new(&scene, water)?;
            let path = self.write(&format!("reference_{}.png", water.name), &made.image_file)?;
            say(&format!("  {}   after {:.1} s\n", display(&path), began.elapsed().as_secs_f32()))?;
            references.push(made);
        }
        let mut rows = vec![heading(&references)];
        for (i, water) in [blue, turbid].into_iter().enumerate() {
            let scene = Scene::new(self.seed.wrapping_add(i as u64), CONTENT);
            let content = Made::new(&scene, water)?;
            let name = format!("content_{}", water.name);
            let path = self.write(&format!("{name}.png"), &content.image_file)?;
            say(&format!("  {}   after {:.1} s\n", display(&path), began.elapsed().as_secs_f32()))?;
            say(&content.veils())?;
            self.write_truth(&name, &scene, &content.image_file)?;
            for model in [Model::Physical, Model::Aquafuse] {
                let mut row = vec![cell(&format!("content, {} water", water.name), &content.image_file)];
                for reference in &references {
                    let fused = content.fused(reference, model);
                    let file = format!("{name}__{}__{}.png", reference.water.name, model.name());
                    self.write(&file, &fused)?;
                    row.push(cell(&format!("in {} water, {}", reference.water.name, model.name()), &fused));
                }
                rows.push(row);
            }
        }
        let sheet = ImageFile::new(contact_sheet(&rows, 320, 214).map_err(Failure::work)?);
        let path = self.write("sheet.jpg", &sheet)?;
        say(&format!(
            "  {}   true depth of the contents\n  {}   a dataset: the contents with masks of their fish\n  \
             {}   all side by side, after {:.1} s\n\n\
             Look at that sheet first. Then try your own images:\n  \
             aquafuse fuse YOUR.jpg {} -o fused.jpg\n",
            display(&self.output.join("depth")),
            display(&self.output.join("fish")),
            display(&path),
            began.elapsed().as_secs_f32(),
            display(&self.output.join("reference_green.png"))
        ))
    }

    /// What is known of a content: its depth, and as a dataset where its fish are.
    fn write_truth(&self, name: &str, scene: &Scene, content: &ImageFile) -> Result<(), Failure> {
        let (width, height) = scene.clear.size();
        // Open water has no depth, as where depth is measured: 0 is unknown.
        let seen = |z: f32| if z < OPEN_WATER { z } else { 0.0 };
        let metres = scene.depth.distances().into_iter().map(seen).collect();
        let metres =
            DepthMap::from_distances(width, height, DepthKind::Metres, metres).map_err(Failure::work)?;
        let path = self.output.join(format!("depth/{name}.png"));
        make_folder_of(&path)?;
        depth_file::write(&path, &metres, &self.options())?;

        let fish = |kind: &Kind| [if *kind == Kind::Fish { u8::MAX } else { 0 }; 3];
        let mask = Image::from_raw(width, height, scene.kinds.iter().flat_map(fish).collect());
        self.write(&format!("fish/images/{name}.png"), content)?;
        self.write(&format!("fish/masks/{name}.png"), &ImageFile::new(mask.map_err(Failure::work)?))?;
        Ok(())
    }

    fn write(&self, name: &str, image_file: &ImageFile) -> Result<PathBuf, Failure> {
        let path = self.output.join(name);
        make_folder_of(&path)?;
        image_file.write(&path, &self.options())?;
        Ok(path)
    }

    fn options(&self) -> WriteOptions {
        WriteOptions { overwrite: self.overwrite, quality: 90 }
    }
}

/// A synthetic image, its true water, and the water estimated from it.
struct Made {
    image_file: ImageFile,
    water: NamedWater,
    found: Analysis,
}

impl Made {
    fn new(scene: &Scene, water: NamedWater) -> Result<Self, Failure> {
        let image = scene.seen_through(&water.water).convert::<u8>();
        let image_file = ImageFile::new(image).with_water_map(WaterMap::BEST);
        let found = analyse(&image_file, &DepthSource::default())?;
        Ok(Self { image_file, water, found })
    }

    fn fused(&self, reference: &Made, model: Model) -> ImageFile {
        let (content, reference) = (&self.found.estimate, &reference.found.estimate);
        let bounded = Bounded::new(content, reference, Options::for_model(model));
        let waters = bounded.waters().with_share(&self.found.share);
        let fused = fuse(&self.image_file.bytes(), &self.found.depth, waters, &bounded.options);
        ImageFile::new(fused.expect("the depth map was made from this image").image)
    }

    fn veils(&self) -> String {
        let [r, g, b] = self.found.estimate.water.veiling_light.rgb();
        let [true_r, true_g, true_b] = self.water.water.veiling_light.rgb();
        format!(
            "    its water: veiling light {r:.2} {g:.2} {b:.2} estimated, {true_r:.2} {true_g:.2} {true_b:.2} true\n"
        )
    }
}

fn heading(references: &[Made]) -> Vec<Cell> {
    let title = Cell { caption: "the waters to fuse with:".into(), image: None };
    let named = references
        .iter()
        .map(|made| cell(&format!("reference, {} water", made.water.name), &made.image_file));
    std::iter::once(title).chain(named).collect()
}

fn cell(caption: &str, image_file: &ImageFile) -> Cell {
    Cell { caption: caption.into(), image: Some(image_file.bytes().into_owned()) }
}
