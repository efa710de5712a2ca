//! `aquafuse scene fuse`: all pictures of a scene in another water, which they share.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse::depth::DepthKind;
use aquafuse::image::Encoded;
use aquafuse::waterbody::pool;
use aquafuse_data::analysis::{Analysis, DepthSource, analyse};
use aquafuse_data::picture::{Picture, WriteOptions, remove_stale_parts, shown};
use aquafuse_data::treatment::Treatment;
use aquafuse_scene::capture::pictures_of;
use aquafuse_scene::files::{Taken, read_cameras};
use aquafuse_scene::shared_water::{in_scene, median, unit_of, water_of};
use clap::Args;

use crate::common::Common;
use crate::failure::Failure;
use crate::fuse::settings::{Settings, SettingsArgs};
use crate::inspect::veiling_light;
use crate::output;
use crate::progress::Progress;
use crate::water_argument::{WaterArguments, WaterSource};

/// Put a scene into another water: every picture by the one water that all of them tell.
///
/// Distances have one unit, which the scene's points tell, so that what is fused looks alike from every side. Names,
/// sizes and EXIF stay, and the cameras go along: the new folder is a scene like the old one.
#[derive(Args)]
#[command(after_help = "\
Example:
  aquafuse scene fuse reef/ green.jpg -o reef_green/ --model physical")]
pub(crate) struct Fuse {
    /// A folder with cameras and pictures.
    scene: PathBuf,
    /// The water that is taken: a picture, NAME.water.json or preset:NAME.
    water: PathBuf,
    /// Folder to write into; made if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    waters: WaterArguments,
    /// Write into a folder that is not empty, replacing pictures of the same names.
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

impl Fuse {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        if !self.overwrite && self.output.read_dir().is_ok_and(|mut entries| entries.next().is_some()) {
            return Err(Failure::usage(anyhow!(
                "{} is not empty; name another folder with -o, or add --overwrite",
                shown(&self.output)
            )));
        }
        let Settings { depth_model, options, smoothing } = self.settings.get();
        let source = DepthSource::Estimated(depth_model);
        let water = WaterSource::parse(&self.water)?;
        let cameras = read_cameras(&self.scene)?;
        let pictures = pictures_of(&self.scene);
        let looked = |one: &Taken| -> Result<(Picture, Analysis<Encoded>), Failure> {
            let picture = common.reading.read(&pictures.join(&one.name))?;
            let found = analyse(&picture, &source)?;
            Ok((picture, found))
        };

        let progress = Progress::new(common.quiet);
        progress.start(3 * cameras.taken.len());
        let mut units = Vec::with_capacity(cameras.taken.len());
        for one in &cameras.taken {
            units.push(unit_of(&looked(one)?.1.depth, &one.lens, &cameras.points));
            progress.done(shown(&one.name).to_string());
        }
        // Pictures with too few points in view take the others' unit; without points at all, depth has none.
        let middle = median(&mut units.iter().flatten().copied().collect::<Vec<_>>());
        let unit = |of: &Option<f32>| of.or(middle).unwrap_or(1.0);
        let mut estimates = Vec::with_capacity(units.len());
        for (one, of) in cameras.taken.iter().zip(&units) {
            let (picture, found) = looked(one)?;
            estimates.push(water_of(&picture, &in_scene(&found.depth, unit(of))).map_err(Failure::work)?);
            progress.done(shown(&one.name).to_string());
        }
        let shared = pool(&estimates).ok_or_else(|| Failure::usage(anyhow!("the scene has no picture")))?;
        let file = self.waters.read::<Encoded>(&water, depth_model, &common.reading)?;
        let reference = self.waters.per(DepthKind::Metres, &file)?;
        let treatment = Treatment::Fuse { reference, options };

        let into = self.output.join(pictures.strip_prefix(&self.scene).unwrap_or(Path::new("")));
        for (one, of) in cameras.taken.iter().zip(&units) {
            let (mut picture, found) = looked(one)?;
            let depth = in_scene(&found.depth, unit(of));
            let found = Analysis { depth, estimate: shared, ..found };
            treatment.apply(&mut picture.pixels, &found).map_err(Failure::work)?;
            picture.pixels = picture.pixels.smoothed(smoothing);
            let path = into.join(&one.name);
            remove_stale_parts(output::make_folder_of(&path)?);
            picture.write(&path, &WriteOptions { overwrite: self.overwrite, ..WriteOptions::default() })?;
            progress.done(shown(&one.name).to_string());
        }
        progress.finish();
        self.copy_model(&cameras.model)?;
        if common.quiet {
            return Ok(());
        }
        output::print(&format!(
            "{}: {} pictures in {}'s water\n  {}\n  {}\n",
            shown(&self.output),
            cameras.taken.len(),
            water.name(),
            veiling_light(&shared),
            match middle {
                Some(unit) => format!("relative depth 1 is {unit:.2} units of the scene"),
                None => "the scene has no points, so that depth has no unit".into(),
            }
        ))
    }

    /// The cameras go along as they are.
    fn copy_model(&self, model: &Path) -> Result<(), Failure> {
        let (from, to) = (self.scene.join(model), self.output.join(model));
        output::make_folder(&to)?;
        for name in MODEL.iter().filter(|name| from.join(name).is_file()) {
            std::fs::copy(from.join(name), to.join(name)).map_err(|error| {
                Failure::work(anyhow!(
                    "cannot copy {} to {}: {error}",
                    shown(&from.join(name)),
                    shown(&to.join(name))
                ))
            })?;
        }
        Ok(())
    }
}
