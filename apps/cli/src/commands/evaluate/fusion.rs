//! `aquafuse evaluate fusion`: Tables 1 and 3 of the paper on any images.

use std::path::{Path, PathBuf};

use aquafuse::depth::SuppliedKind;
use aquafuse::fusion::Model;
use aquafuse_data::depth_file::DepthFolder;
use aquafuse_data::evaluate::{Fusion, GroupBy, Listener, Method, Pairing, Rival, Settings};
use aquafuse_data::files::FileError;
use aquafuse_data::pipeline::{DepthSupply, MapSize};
use clap::{ArgGroup, Args, ValueEnum};

use crate::args::border::BorderArgument;
use crate::args::common::{Common, encoding};
use crate::args::depth::kind;
use crate::args::evaluation::{LpipsArguments, Named, ReportArguments, named, outputs};
use crate::args::fusion::SettingsArgs;
use crate::failure::Failure;
use crate::report::published;

const HELP: &str = "\
Scores compare each fused image with its content, as in the paper: PSNR, SSIM of luma, the RMSE of
Eq. 3 depth estimated from both (percent of the range, and levels of 255), and depth consistency.
They measure how much of the content is preserved, and an unchanged image has the highest. Three more
scores measure the water apart from everything else:
  way to the water   how far the mean colour of the content's far region went towards the mean
                     colour of the reference's, in CIELab: 0 % is an unchanged image, 100 % is the reference's
                     colour. Pairs whose waters differ by less than ΔE 10 are left out.
  near change        mean ΔE over the nearest 30 % of the content's pixels
  sharpness ratio    standard deviation of the Laplacian of luma, result over content
On synthetic scenes with known water, `evaluate truth` measures whether the water is right.

Examples:
  aquafuse evaluate fusion --contents dives/ --references waters/ -o report.html
                                                     every image of dives/ in every water
  aquafuse evaluate fusion --contents dives/ --references dives/ --group-by prefix --pairs 8 -o out/
                                                     groups blue_*.jpg, green_*.jpg, ...; each image
                                                     with 8 of other groups; all report formats
  aquafuse evaluate fusion --contents dives/ --references waters/ --rivals --method my=my/ -o all.md
                                                     also scores colour transfer, and the outputs
                                                     my/CONTENT__REFERENCE.png of another tool
  aquafuse evaluate fusion --contents dives/ --references waters/ --depth maps/ --depth-kind inverse
                                                     the far and near regions of the scores come from
                                                     depth maps of a network";

/// Score fused images against their contents: the tables of the paper on your images.
#[derive(Args)]
#[command(after_help = HELP, group = ArgGroup::new("area").args(["border", "water_map"]).multiple(true).conflicts_with("as_published"))]
pub(crate) struct FusionArguments {
    /// A folder of content images.
    #[arg(long, value_name = "DIR")]
    contents: PathBuf,
    /// A folder of reference images; may be the same folder.
    #[arg(long, value_name = "DIR")]
    references: PathBuf,
    /// How images are grouped. The report has one row per group of contents, and each content is paired with the
    /// references of other groups. Without it, a content is paired with every reference except itself.
    #[arg(long, value_enum)]
    group_by: Option<By>,
    /// Sample N references for each content [default: all].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pairs: Option<u32>,
    /// Random seed of the pairs and of the bootstrap.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Also score colour transfer: Reinhard, Monge–Kantorovich, histogram matching, gray world.
    #[arg(long)]
    rivals: bool,
    /// Also score outputs of another tool: images in DIR named CONTENT__REFERENCE (stems). Missing ones are reported.
    /// May be repeated.
    #[arg(long, value_name = "NAME=DIR", value_parser = named)]
    method: Vec<Named>,
    /// Folder of depth maps of the contents, with the same stems. The scores then take the farthest fifth of the pixels
    /// of each map as far and the nearest 30 % as near; all methods fuse as without it [default: far are the pixels
    /// from which the veiling light was read, near is by depth from colour].
    #[arg(long, value_name = "DIR", requires = "depth_kind")]
    depth: Option<PathBuf>,
    /// Kind of the values in --depth, as in `fuse`.
    #[arg(long, value_name = "KIND", value_parser = kind(), requires = "depth")]
    depth_kind: Option<SuppliedKind>,
    /// Folder of depth maps of the references, with the same stems: the farthest fifth of the pixels of each is its
    /// water.
    #[arg(long, value_name = "DIR", requires = "water_depth_kind")]
    water_depth: Option<PathBuf>,
    /// Kind of the values in --water-depth.
    #[arg(long, value_name = "KIND", value_parser = kind(), requires = "water_depth")]
    water_depth_kind: Option<SuppliedKind>,
    #[command(flatten)]
    lpips: LpipsArguments,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    border: BorderArgument,
    /// Compute in linear light instead of encoded values.
    #[arg(long)]
    linear: bool,
    #[command(flatten)]
    report: ReportArguments,
}

#[derive(Clone, Copy, ValueEnum)]
enum By {
    /// By the subfolders of DIR.
    Folder,
    /// By the part of a name before the first `_`.
    Prefix,
}

impl FusionArguments {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.settings.cutting(&self.border, common);
        self.report.check()?;
        let by = match self.group_by {
            None => GroupBy::Nothing,
            Some(By::Folder) => GroupBy::Folder,
            Some(By::Prefix) => GroupBy::Prefix,
        };
        let settings = Settings { encoding: encoding(self.linear), ..self.settings.get()? };
        let own = match settings.options.model {
            _ if self.settings.is_as_published() => "AquaFuse as published".to_owned(),
            Model::Aquafuse => "AquaFuse".to_owned(),
            model => format!("AquaFuse {}", model.name()),
        };
        let fusion = Fusion {
            contents: by.list(&self.contents)?,
            references: by.list(&self.references)?,
            pairing: Pairing { references: self.pairs.map(|pairs| pairs as usize), seed: self.seed },
            settings,
            methods: self.methods(own)?,
            content_depth: supply(self.depth.as_deref(), self.depth_kind)?,
            reference_depth: supply(self.water_depth.as_deref(), self.water_depth_kind)?,
            lpips: self.lpips.network()?,
            run_options: common.run_options(),
        };
        let published = published::tables(self.rivals || !self.method.is_empty()).map_err(Failure::work)?;
        self.report.run(
            common,
            |listener: Listener<'_>| fusion.run(listener),
            |report| report.tables.extend(published),
        )
    }

    fn methods(&self, own: String) -> Result<Vec<Method>, Failure> {
        let mut methods = vec![Method::Aquafuse(own)];
        if self.rivals {
            methods.extend(Rival::ALL.map(Method::Rival));
        }
        let taken: Vec<&str> = methods.iter().map(Method::name).collect();
        let outputs = outputs(&self.method, &taken)?;
        methods.extend(outputs.into_iter().map(Method::Outputs));
        Ok(methods)
    }
}

/// The depth maps of a folder.
fn supply(folder: Option<&Path>, kind: Option<SuppliedKind>) -> Result<Option<DepthSupply>, FileError> {
    let Some((folder, kind)) = folder.zip(kind) else { return Ok(None) };
    Ok(Some(DepthSupply::Folder(DepthFolder::list(folder)?, kind, MapSize::Exact)))
}
