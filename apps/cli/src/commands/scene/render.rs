//! `aquafuse scene render`: a trained scene as its cameras see it, or from an orbit, through any water.

use std::path::PathBuf;

use aquafuse_data::files::display;
use aquafuse_scene::views::{Plan, Request, ViewsError};
use clap::Args;

use super::looked_through::LookedThrough;
use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;

/// Render a trained scene from its cameras, or from an orbit around it.
///
/// The cameras of the views are written beside them, transforms.json: the folder is a scene, for other programs too.
#[derive(Args)]
#[command(after_help = "\
Renders through the learned water unless --water names another. A unit of the scene counts as a metre unless
--metres-per-unit says more. To continue a run that was stopped, repeat the command.

Examples:
  aquafuse scene render reef.ply reef/ -o views/
  aquafuse scene render reef.ply reef/ -o dewatered/ --water none            stills for other programs
  aquafuse scene render reef.ply reef/ -o coast/ --water preset:jerlov-3C --depth
  aquafuse scene render reef.ply reef/ -o murky/ --water preset:jerlov-5C --visibility 4 --metres-per-unit 0.2
  aquafuse scene render reef.ply reef/ -o orbit/ --orbit 120       orbit/orbit_000.png, ...; frames of a film")]
pub(crate) struct Render {
    /// A trained scene.
    splats: PathBuf,
    /// The folder with its cameras.
    scene: PathBuf,
    /// Folder to write into, NAME.png for each camera; made if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    medium: LookedThrough,
    /// Render this many views of an orbit instead of the cameras' own: a full circle if the cameras surround the scene,
    /// otherwise an arc along them. The last view precedes the first.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    orbit: Option<u32>,
    /// Also write distances, NAME.depth.tiff, in units of the scene; 0 where nothing is opaque.
    #[arg(long)]
    depth: bool,
    /// Render at this many pixels on the longer side.
    #[arg(long, value_name = "PIXELS", default_value_t = 400, value_parser = clap::value_parser!(u32).range(16..=16384))]
    longest: u32,
    /// Replace images that exist.
    #[arg(long)]
    overwrite: bool,
}

impl Render {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        super::say_model(&self.scene, common);
        let options = common.run_options();
        let plan = Plan::new(self.request(), &options.reading)?;
        let medium = self.medium.medium(plan.medium().clone(), common)?;
        let plan = plan.through(medium);
        let progress = Progress::new(common.quiet);
        let rendered = plan.run(&options, &|event| progress.show(&event, |path| display(path).to_string()));
        progress.finish();
        let skipped = match rendered?.skipped {
            0 => String::new(),
            skipped => format!("; {skipped} were rendered by an earlier run"),
        };
        let (views, splats) = (plan.views(), plan.splats());
        let text = format!("{}: {views} views of {splats} splats{skipped}\n", display(&self.output));
        if common.quiet { Ok(()) } else { output::print(&text) }
    }

    fn request(&self) -> Request {
        Request {
            splats: self.splats.clone(),
            scene: self.scene.clone(),
            output: self.output.clone(),
            orbit: self.orbit,
            distances: self.depth,
            longest: self.longest as usize,
            overwrite: self.overwrite,
        }
    }
}

impl From<ViewsError> for Failure {
    fn from(error: ViewsError) -> Self {
        match error {
            ViewsError::File(error) => error.into(),
            ViewsError::Cameras(error) => error.into(),
            ViewsError::Model(error) => error.into(),
            ViewsError::SameNames { .. } | ViewsError::NoOrbit { .. } => Self::usage(error),
            error => Self::work(error),
        }
    }
}
