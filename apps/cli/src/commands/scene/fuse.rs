//! `aquafuse scene fuse`: all images of a scene in another water, which they share.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse::depth::{DepthKind, DepthMap};
use aquafuse::image::Encoded;
use aquafuse::waterbody::{Estimate, pool};
use aquafuse_data::batch::{Item, RECORD, Recipe, Record, State};
use aquafuse_data::files::{FileError, display, make_folder, remove_stale_parts, write_bytes};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_data::pipeline::Operation;
use aquafuse_data::pipeline::{Analysis, DepthSource, analyse};
use aquafuse_data::water_file::Numbers;
use aquafuse_scene::capture::images_of;
use aquafuse_scene::files::{Cameras, read_cameras};
use aquafuse_scene::shared_water::{in_scene, median, unit_of, water_of};
use clap::Args;
use serde_json::json;

use crate::args::common::Common;
use crate::args::fusion::{Settings, SettingsArgs};
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;
use crate::report::water::veiling_light;

/// Put a scene into another water: every image by the one water that all of them tell.
///
/// Distances have one unit, which the scene's points tell, so that what is fused looks alike from every side. Names,
/// sizes and EXIF stay, and the cameras go along: the new folder is a scene like the old one. A run that was stopped goes on
/// where it was.
#[derive(Args)]
#[command(after_help = "\
Example:
  aquafuse scene fuse reef/ green.jpg -o reef_green/ --model physical")]
pub(crate) struct Fuse {
    /// A folder with cameras and images.
    scene: PathBuf,
    /// The water that is taken: an image, NAME.water.json or preset:NAME.
    water: PathBuf,
    /// Folder to write into; made if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    waters: WaterArguments,
    /// Write into a folder that is not empty, replacing images of the same names.
    #[arg(long)]
    overwrite: bool,
}

/// The files of a model.
const MODEL: [&str; 7] = [
    "cameras.bin",
    "images.bin",
    "points3D.bin",
    "cameras.txt",
    "images.txt",
    "points3D.txt",
    "transforms.json",
];

/// What the scene's images tell together.
struct Told {
    /// What relative depth 1 is in each, in units of the scene.
    units: Vec<f32>,
    /// The middle of those that points tell; none without points.
    middle: Option<f32>,
    /// The water that they share.
    water: Estimate<Encoded>,
}

impl Fuse {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let Settings { depth_model, options, smoothing, .. } = self.settings.get();
        let source = DepthSource::Estimated(depth_model);
        let water = WaterSource::parse(&self.water)?;
        let cameras = read_cameras(&self.scene)?;
        let images = images_of(&self.scene);
        let into = self.output.join(images.strip_prefix(&self.scene).unwrap_or(Path::new("")));
        let items: Vec<Item> = cameras
            .taken
            .iter()
            .map(|one| Item {
                input: images.join(&one.name),
                output: into.join(&one.name),
                depth: source.clone(),
            })
            .collect();
        self.check(&items)?;

        let progress = Progress::new(common.quiet);
        progress.start(2 * items.len());
        let told = told(&cameras, &items, common, &progress)?;
        let file = self.waters.read::<Encoded>(&water, depth_model, &common.reading)?;
        let reference = self.waters.per(DepthKind::Metres, &file)?;
        let recipe = Recipe {
            operation: Operation::Fuse { reference, options },
            smoothing,
            upright: false,
            quality: WriteOptions::default().quality,
        };
        let records = self.records(&items, &recipe, &told, common)?;
        for (item, unit) in items.iter().zip(&told.units) {
            let record = records.get(folder_of(item)).expect("each folder has one");
            record.make(item, self.overwrite, |overwrite| -> Result<(), Failure> {
                let (mut image, found) = looked(item, common)?;
                let found = Analysis { depth: in_scene(&found.depth, *unit), estimate: told.water, ..found };
                recipe.operation.apply(&mut image.pixels, &found).map_err(Failure::work)?;
                image.pixels = image.pixels.smoothed(smoothing);
                Ok(image.write(&item.output, &WriteOptions { overwrite, quality: recipe.quality })?)
            })?;
            progress.done(display(&item.output).to_string());
        }
        progress.finish();
        self.copy_model(&cameras.model)?;
        if common.quiet {
            return Ok(());
        }
        output::print(&format!(
            "{}: {} images in {}'s water\n  {}\n  {}\n",
            display(&self.output),
            items.len(),
            water.name(),
            veiling_light(&told.water),
            match told.middle {
                Some(unit) => format!("relative depth 1 is {unit:.2} units of the scene"),
                None => "the scene has no points, so that depth has no unit".into(),
            }
        ))
    }

    /// Refuses a folder that is somebody else's.
    fn check(&self, items: &[Item]) -> Result<(), Failure> {
        let is_recorded = items.iter().any(|item| folder_of(item).join(RECORD).is_file());
        if self.overwrite || is_recorded { Ok(()) } else { output::refuse_filled(&self.output, &[]) }
    }

    /// What is done already, folder by folder; images that are not ours are refused.
    fn records(
        &self,
        items: &[Item],
        recipe: &Recipe<Encoded>,
        told: &Told,
        common: &Common,
    ) -> Result<BTreeMap<PathBuf, Record>, Failure> {
        let made_with = json!({
            "recipe": recipe.fingerprint(common.reading.options().lenient),
            "water": Numbers::from(&told.water.water),
            "units": told.units,
        });
        let mut records = BTreeMap::new();
        for item in items {
            let folder = folder_of(item);
            if !records.contains_key(folder) {
                make_folder(folder)?;
                remove_stale_parts(folder);
                records.insert(folder.to_owned(), Record::open(folder, &made_with, self.overwrite)?);
            }
            if records.get(folder).is_some_and(|record| record.state(item, self.overwrite) == State::Foreign)
            {
                return Err(FileError::Exists { path: item.output.clone() }.into());
            }
        }
        Ok(records)
    }

    /// The cameras go along as they are.
    fn copy_model(&self, model: &Path) -> Result<(), Failure> {
        let (from, to) = (self.scene.join(model), self.output.join(model));
        make_folder(&to)?;
        remove_stale_parts(&to);
        for name in MODEL.iter().filter(|name| from.join(name).is_file()) {
            let path = from.join(name);
            let bytes = std::fs::read(&path).map_err(|error| FileError::Read { path, error })?;
            write_bytes(&to.join(name), &bytes, true)?;
        }
        Ok(())
    }
}

fn folder_of(item: &Item) -> &Path {
    item.output.parent().unwrap_or(Path::new(""))
}

fn looked(item: &Item, common: &Common) -> Result<(ImageFile, Analysis<Encoded>), Failure> {
    let image = common.reading.read(&item.input)?;
    let found = analyse(&image, &item.depth)?;
    Ok((image, found))
}

/// Looks at every image for its unit and its water, and pools these.
fn told(cameras: &Cameras, items: &[Item], common: &Common, progress: &Progress) -> Result<Told, Failure> {
    let estimate = |image: &ImageFile, depth: &DepthMap, unit: f32| {
        water_of(image, &in_scene(depth, unit)).map_err(Failure::work)
    };
    let mut found = Vec::with_capacity(items.len());
    for (one, item) in cameras.taken.iter().zip(items) {
        let (image, Analysis { depth, .. }) = looked(item, common)?;
        let unit = unit_of(&depth, &one.lens, &cameras.points);
        found.push(match unit {
            Some(unit) => Some((unit, estimate(&image, &depth, unit)?)),
            None => None,
        });
        progress.done(display(&one.name).to_string());
    }
    // Images with too few points in view take the others' unit; without points at all, depth has none.
    let middle = median(&mut found.iter().flatten().map(|(unit, _)| *unit).collect::<Vec<_>>());
    let (mut units, mut estimates) = (Vec::with_capacity(items.len()), Vec::with_capacity(items.len()));
    for (item, found) in items.iter().zip(found) {
        let (unit, estimated) = match found {
            Some(found) => found,
            None => {
                let unit = middle.unwrap_or(1.0);
                let (image, Analysis { depth, .. }) = looked(item, common)?;
                (unit, estimate(&image, &depth, unit)?)
            }
        };
        units.push(unit);
        estimates.push(estimated);
    }
    let water = pool(&estimates).ok_or_else(|| Failure::usage(anyhow!("the scene has no image")))?;
    Ok(Told { units, middle, water })
}
