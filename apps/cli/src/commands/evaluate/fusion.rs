//! `aquafuse evaluate fusion`: the paper's Tables 1 and 3, on anybody's images.

use std::path::PathBuf;

use aquafuse::fusion::Model;
use aquafuse_data::evaluate::{Fusion, GroupBy, Listener, Method, Pairing, Rival, Settings};
use clap::{Args, ValueEnum};

use crate::args::common::{Common, encoding};
use crate::args::evaluation::{LpipsArguments, Named, ReportArguments, named, outputs};
use crate::args::fusion::SettingsArgs;
use crate::failure::Failure;
use crate::report::published;

const HELP: &str = "\
Scores compare each fused image with its content, as the paper does: PSNR, SSIM of luma, the RMSE of
Eq. 3 depth estimated again (percent of the range, and levels of 255), and depth consistency. They say
how little was lost, not whether the water is right; `evaluate truth` asks for that.

Examples:
  aquafuse evaluate fusion --contents dives/ --references waters/ -o report.html
                                                     every image of dives/ in every water
  aquafuse evaluate fusion --contents dives/ --references dives/ --group-by prefix --pairs 8 -o report/
                                                     blue_1.jpg, green_1.jpg, ...: each with eight of another
                                                     group; report/ gets all formats
  aquafuse evaluate fusion --contents dives/ --references waters/ --rivals --method mine=out/ -o methods.md
                                                     beside colour transfer, and beside what another tool wrote
                                                     as out/CONTENT__REFERENCE.png";

/// Score fused images against their contents: the paper's tables, on your images.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct FusionArguments {
    /// A folder of images that keep their objects.
    #[arg(long, value_name = "DIR")]
    contents: PathBuf,
    /// A folder of images that give their water; may be the same.
    #[arg(long, value_name = "DIR")]
    references: PathBuf,
    /// What makes images a group: the folders in DIR, or the names before the first `_`. The report has a row for each
    /// group of contents, and each content meets the references of other groups. Without it all are one group, and a
    /// content meets all but itself.
    #[arg(long, value_enum)]
    group_by: Option<By>,
    /// Draw this many references for each content, instead of taking all.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pairs: Option<u32>,
    /// What pairs and resamplings are drawn by.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Also score what colour transfer makes: Reinhard, Monge–Kantorovich, histogram matching, gray world.
    #[arg(long)]
    rivals: bool,
    /// Also score what another tool has made: images in DIR named CONTENT__REFERENCE, both without extension. May be
    /// given several times. What is missing is named.
    #[arg(long, value_name = "NAME=DIR", value_parser = named)]
    method: Vec<Named>,
    #[command(flatten)]
    lpips: LpipsArguments,
    #[command(flatten)]
    settings: SettingsArgs,
    /// Fuse in linear light.
    #[arg(long)]
    linear: bool,
    #[command(flatten)]
    report: ReportArguments,
}

#[derive(Clone, Copy, ValueEnum)]
enum By {
    /// The folders in DIR.
    Folder,
    /// What stands before the first `_` of a name.
    Prefix,
}

impl FusionArguments {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        self.report.check()?;
        let by = match self.group_by {
            None => GroupBy::Nothing,
            Some(By::Folder) => GroupBy::Folder,
            Some(By::Prefix) => GroupBy::Prefix,
        };
        let settings = Settings { encoding: encoding(self.linear), ..self.settings.get() };
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
