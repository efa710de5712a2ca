//! The scores of a pair, and their tables: a row for all contents and one for each group, method by method.

use aquafuse::depth::DepthModel;
use aquafuse::image::Image;
use aquafuse::metrics::{DepthRmse, depth_rmse, psnr, ssim};
use serde_json::json;

use super::way::Change;
use super::{Fusion, Scored};
use crate::evaluate::chance::Chance;
use crate::evaluate::report::{Cell, Items, ItemsRow, Report, Row, Score, Shown, Strip, Table};
use crate::evaluate::statistics::summarise;
use crate::evaluate::{Failed, Lpips, Method};
use crate::pipeline::DepthSupply;

/// The scores, in the order of [`Likeness::values`].
const SCORES: [Score; 9] = [
    Score { key: "psnr", title: "PSNR, dB", digits: 2, shown: Shown::MeanAndVariance },
    Score { key: "ssim", title: "SSIM", digits: 3, shown: Shown::MeanAndVariance },
    Score { key: "depth_rmse_percent", title: "depth RMSE, %", digits: 2, shown: Shown::MeanAndVariance },
    Score { key: "depth_rmse_levels", title: "depth RMSE, 0–255", digits: 2, shown: Shown::OtherScale },
    Score { key: "depth_consistency", title: "depth consistency, %", digits: 2, shown: Shown::OtherScale },
    Score { key: "way_percent", title: "way to the water, %", digits: 1, shown: Shown::MeanAndVariance },
    Score { key: "near_change", title: "near change, ΔE", digits: 2, shown: Shown::MeanAndVariance },
    Score { key: "sharpness_ratio", title: "sharpness ratio", digits: 3, shown: Shown::MeanAndVariance },
    Score { key: "lpips", title: "LPIPS", digits: 4, shown: Shown::MeanAndVariance },
];
const COUNTS: [Score; 2] = [
    Score { key: "contents", title: "contents", digits: 0, shown: Shown::Number },
    Score { key: "pairs", title: "pairs", digits: 0, shown: Shown::Number },
];

const ABOUT: &str = "Each content was fused with references, and each result compared with its content: PSNR of all \
    channels, SSIM of luma, and the RMSE of Eq. 3 depth estimated from both, in percent and in levels; depth consistency \
    is 100 % minus the percentage. A high score means that the content is preserved, not that the water is right: an \
    unchanged image has the highest. Cells: mean ± variance over all pairs of the row and, in brackets, the 95 % bootstrap \
    interval of the mean over contents. PSNR leaves out unchanged images.";
const ABOUT_WATER: &str = "Three more scores measure the water apart from everything else. Way to the water: how far the mean \
    colour of the content's far region went towards the mean colour of the reference's, in CIELab. An unchanged image \
    scores 0 %, the reference's colour 100 %, and a colour farther from it than the content's less than 0 %. Pairs whose \
    waters differ by less than ΔE 10 are left out. Near change: the mean ΔE (CIE76) between result and content over the \
    nearest 30 % of the content's pixels. Sharpness ratio: the standard deviation of the Laplacian of luma, result over \
    content; 1 is unchanged.";
/// Where the regions come from, for contents and for references.
const FAR_BY_ESTIMATE: &str = "the pixels from which the estimate read the veiling light";
const FAR_BY_DEPTH: &str = "the farthest fifth by the supplied depth maps";

/// How much an image looks like its content, by the paper's scores.
#[derive(Clone, Copy, Debug)]
pub(super) struct Likeness {
    /// Of all channels, in dB; infinite where nothing changed.
    pub(super) psnr: f64,
    /// Of luma.
    pub(super) ssim: f64,
    /// Of Eq. 3 depth estimated again.
    pub(super) depth: DepthRmse,
    /// What happened to the water, to near objects and to detail.
    pub(super) change: Change,
    /// LPIPS, where there is a network for it.
    pub(super) lpips: Option<f64>,
}

impl Likeness {
    /// Compares an image with its content, of the same size; none where they are too small for SSIM. `change` is called
    /// where they are not.
    pub(super) fn of(content: &Image<u8>, made: &Image<u8>, change: impl FnOnce() -> Change) -> Option<Self> {
        const SAME: &str = "results have the size of their content";
        Some(Self {
            psnr: psnr(content, made).expect(SAME),
            ssim: ssim(content, made).expect(SAME)?,
            depth: depth_rmse(content, made, DepthModel::default()).expect(SAME),
            change: change(),
            lpips: None,
        })
    }

    /// PSNR, SSIM, depth RMSE in percent and in levels, depth consistency, way in percent, near change, sharpness ratio and
    /// LPIPS: the columns of the tables, in the order of [`SCORES`]. A score that this pair cannot have is not a number;
    /// LPIPS is none where no pair has it.
    pub(super) fn values(&self) -> [Option<f64>; 9] {
        let Self { psnr, ssim, depth, change, lpips } = self;
        let way = change.way.map_or(f64::NAN, |way| 100.0 * way);
        [
            Some(*psnr),
            Some(*ssim),
            Some(depth.percent()),
            Some(depth.levels()),
            Some(depth.consistency()),
            Some(way),
            Some(change.near),
            Some(change.sharpness),
            *lpips,
        ]
    }
}

impl Fusion {
    pub(super) fn report(&self, results: &[Scored], mut failed: Vec<Failed>, gallery: Vec<Strip>) -> Report {
        failed.sort();
        // An image that is both content and reference fails as both.
        failed.dedup();
        Report {
            command: "evaluate fusion",
            title: "Fused images beside their contents".into(),
            about: vec![ABOUT.into(), self.about_water()],
            settings: self.described(),
            tables: vec![self.table(results)],
            items: self.items(results),
            failed,
            gallery,
        }
    }

    fn about_water(&self) -> String {
        let far = |supplied: bool| if supplied { FAR_BY_DEPTH } else { FAR_BY_ESTIMATE };
        let [contents, references] =
            [&self.content_depth, &self.reference_depth].map(|depth| far(depth.is_some()));
        match contents == references {
            true => format!("{ABOUT_WATER} Far regions: {contents}."),
            false => {
                format!("{ABOUT_WATER} Far regions: of contents {contents}; of references {references}.")
            }
        }
    }

    fn described(&self) -> serde_json::Value {
        let Self { settings, pairing, .. } = self;
        json!({
            "encoding": self.settings.encoding.name(),
            "model": settings.options.model.name(),
            "theta": settings.options.incidence.degrees(),
            "alpha": settings.options.gain.get(),
            "smooth": settings.smoothing.name(),
            "depth_model": settings.depth_model.name(),
            "content_depth": self.content_depth.as_ref().map(DepthSupply::name),
            "reference_depth": self.reference_depth.as_ref().map(DepthSupply::name),
            "lpips": self.lpips.as_ref().map(Lpips::described),
            "references_of_each": pairing.references,
            "seed": pairing.seed,
            "methods": self.methods.iter().map(Method::name).collect::<Vec<_>>(),
            "contents": self.contents.len(),
            "references": self.references.len(),
        })
    }

    /// The scores that are taken: LPIPS where there is a network for it.
    fn scores(&self) -> Vec<Score> {
        let taken = if self.lpips.is_some() { SCORES.len() } else { SCORES.len().saturating_sub(1) };
        SCORES.into_iter().take(taken).collect()
    }

    fn table(&self, results: &[Scored]) -> Table {
        let mut groups: Vec<&str> = self.contents.iter().map(|member| member.group.as_str()).collect();
        groups.sort_unstable();
        groups.dedup();
        let mut rows = Vec::new();
        for (place, method) in self.methods.iter().enumerate() {
            let mut add = |label: &str, group: Option<&str>| {
                let is_of = |one: &&Scored| {
                    let of_group = self.contents.get(one.content).map(|member| member.group.as_str());
                    one.method == place && (group.is_none() || of_group == group)
                };
                let cells = self.cells(results.iter().filter(is_of), &[method.name(), label]);
                rows.push(Row { labels: vec![method.name().to_owned(), label.to_owned()], cells });
            };
            add("all", None);
            if groups.len() > 1 {
                groups.iter().for_each(|group| add(group, Some(group)));
            }
        }
        Table {
            name: "likeness",
            title: "Scores against the content".into(),
            labels: vec!["method", "group"],
            scores: COUNTS.into_iter().chain(self.scores()).collect(),
            rows,
        }
    }

    /// The cells of a row: how many, and each score summarised by content.
    fn cells<'a>(&self, results: impl Iterator<Item = &'a Scored>, key: &[&str]) -> Vec<Cell> {
        let mut by_content: Vec<(usize, [Vec<f64>; 9])> = Vec::new();
        let mut pairs: u32 = 0;
        for one in results {
            pairs = pairs.saturating_add(1);
            // Results stand content by content.
            if by_content.last().is_none_or(|(content, _)| *content != one.content) {
                by_content.push((one.content, Default::default()));
            }
            if let Some((_, lists)) = by_content.last_mut() {
                lists.iter_mut().zip(one.likeness.values()).for_each(|(list, value)| list.extend(value));
            }
        }
        let counts = [Cell::Number(by_content.len() as f64), Cell::Number(f64::from(pairs))];
        let score = |place: usize| {
            let lists: Vec<Vec<f64>> =
                by_content.iter().filter_map(|(_, lists)| lists.get(place).cloned()).collect();
            summarise(&lists, Chance::keyed(self.pairing.seed, key)).map_or(Cell::Nothing, Cell::Summary)
        };
        counts.into_iter().chain((0..self.scores().len()).map(score)).collect()
    }

    fn items(&self, results: &[Scored]) -> Items {
        let number = |value: Option<f64>| value.filter(|value| !value.is_nan());
        let row = |one: &Scored| {
            let content = self.contents.get(one.content)?;
            let reference = self.references.get(one.reference)?;
            let method = self.methods.get(one.method)?.name();
            let labels = [&content.name, &content.group, &reference.name, &reference.group].map(Clone::clone);
            let labels = labels.into_iter().chain([method.to_owned()]).collect();
            Some(ItemsRow {
                labels,
                values: one.likeness.values().into_iter().take(self.scores().len()).map(number).collect(),
            })
        };
        Items {
            labels: vec!["content", "group", "reference", "reference_group", "method"],
            scores: self.scores(),
            rows: results.iter().filter_map(row).collect(),
        }
    }
}
