//! How much fused images look like their contents: the paper's Tables 1 and 3, on anybody's images.

mod gallery;
mod tables;
mod way;

use aquafuse::fusion::Options;
use aquafuse::image::Image;
use aquafuse::smooth::Smoothing;

use super::outputs::refuse_ambiguous;
use super::{
    EvaluateError, Failed, Listener, Lpips, Member, Outputs, Pairing, Palette, Report, Rival, lpips, outputs,
};
use crate::image_file::{Format, ImageFile, Pixels};
use crate::pipeline::{
    Analysis, DepthEstimator, DepthSource, DepthSupply, SUPPLIED, analyse_in_with_evidence, depth_of,
};
use crate::pipeline::{Operation, PixelEncoding, WaterEstimate};
use crate::run::{Budget, Event, RunOptions};
use tables::Likeness;
use way::{Change, Regions};

/// Contents fused with references by one or several methods, each result scored against its content.
#[derive(Clone, Debug)]
pub struct Fusion {
    /// The contents.
    pub contents: Vec<Member>,
    /// The references, whose water is used.
    pub references: Vec<Member>,
    /// Which contents and references are paired.
    pub pairing: Pairing,
    /// The settings of our method.
    pub settings: Settings,
    /// The methods, in the order of the tables.
    pub methods: Vec<Method>,
    /// Depth of the contents that says which pixels the scores take as far and near; none: what each content's estimate read.
    /// No method sees it.
    pub content_depth: Option<DepthSupply>,
    /// The same for the references.
    pub reference_depth: Option<DepthSupply>,
    /// The network of LPIPS, if it is to be scored too.
    pub lpips: Option<Lpips>,
    /// How to run.
    pub run_options: RunOptions,
}

/// The settings of our method.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// The depth model.
    pub depth_model: DepthEstimator,
    /// How to fuse.
    pub options: Options,
    /// How outputs are smoothed.
    pub smoothing: Smoothing,
    /// Which values to work on.
    pub encoding: PixelEncoding,
}

/// A method that makes an image from a content and a reference.
#[derive(Clone, Debug)]
pub enum Method {
    /// Our method, with its name in reports.
    Aquafuse(String),
    /// Colour transfer.
    Rival(Rival),
    /// Outputs of another tool, in files named `CONTENT__REFERENCE`.
    Outputs(Outputs),
}

impl Method {
    /// The name in reports.
    pub fn name(&self) -> &str {
        match self {
            Self::Aquafuse(name) => name,
            Self::Rival(rival) => rival.name(),
            Self::Outputs(outputs) => outputs.name(),
        }
    }
}

/// What is kept of a reference once it is read.
struct Reference {
    estimate: WaterEstimate,
    /// The mean colour of its far region in CIELab; none where it has none.
    water: Option<[f64; 3]>,
    palette: Option<Palette>,
}

/// A content in work.
struct Content {
    image: ImageFile,
    found: Analysis<WaterEstimate>,
    regions: Regions,
    palette: Option<Palette>,
}

/// A result: which pair, by which method, and how alike content and result are.
struct Scored {
    content: usize,
    reference: usize,
    method: usize,
    likeness: Likeness,
}

/// What scoring takes in bytes a pixel: two depth maps, each as steps, as levels and as floats.
const SCORED: u64 = 14;
/// What far and near regions take: distances, twice while a percentile is found, and whether each pixel is in either.
const REGIONS: u64 = 10;
/// What the rivals take: the colours they give, as floats and as bytes.
const RIVALS: u64 = 15;

impl Fusion {
    /// Runs the evaluation ; what failed is listed in the report.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when no content has a reference, or outputs of other tools cannot be matched.
    pub fn run(&self, listener: Listener<'_>) -> Result<Report, EvaluateError> {
        let pairs = self.pairs()?;
        let used = self.used(&pairs);
        let steps = pairs.iter().map(Vec::len).fold(used.len(), usize::saturating_add);
        listener(Event::Started { total: steps });
        let budget = self.run_options.budget();
        let mut failed = Vec::new();
        let mut references: Vec<Option<Reference>> = self.references.iter().map(|_| None).collect();
        let read = self.run_options.map(&used, |&place| {
            let member = self.references.get(place)?;
            Some(reported(listener, &member.name, self.read_reference(member, &budget)))
        })?;
        for (place, result) in used.iter().zip(read.into_iter().flatten()) {
            match (result, references.get_mut(*place)) {
                (Ok(reference), Some(kept)) => *kept = Some(reference),
                (Err(error), _) => failed.push(error),
                (Ok(_), None) => {}
            }
        }
        let contents: Vec<usize> = (0..self.contents.len()).collect();
        let scored = self
            .run_options
            .map(&contents, |&content| self.score_all(content, &pairs, &references, &budget, listener))?;
        let mut results = Vec::new();
        for (scored, errors) in scored {
            results.extend(scored);
            failed.extend(errors);
        }
        let gallery = self.gallery(&results, &references, &budget);
        Ok(self.report(&results, failed, gallery))
    }

    fn pairs(&self) -> Result<Vec<Vec<usize>>, EvaluateError> {
        if self.methods.iter().any(|method| matches!(method, Method::Outputs(_))) {
            refuse_ambiguous(&self.contents)?;
            refuse_ambiguous(&self.references)?;
        }
        let pairs = self.pairing.pairs(&self.contents, &self.references);
        if pairs.iter().all(Vec::is_empty) {
            let group = self.contents.first().map(|member| member.group.clone()).unwrap_or_default();
            let (contents, references) = (self.contents.len(), self.references.len());
            return Err(EvaluateError::NoPairs { contents, references, group });
        }
        Ok(pairs)
    }

    /// The references that any content meets.
    fn used(&self, pairs: &[Vec<usize>]) -> Vec<usize> {
        let mut used = pairs.concat();
        used.sort_unstable();
        used.dedup();
        used
    }

    fn has_rivals(&self) -> bool {
        self.methods.iter().any(|method| matches!(method, Method::Rival(_)))
    }

    fn read_reference(&self, member: &Member, budget: &Budget) -> Result<Reference, EvaluateError> {
        let opened = ImageFile::open(&member.path, &self.run_options.reading)?;
        let beside = opened.pixels().saturating_mul(of_regions(&self.reference_depth));
        let _room = budget.reserve(opened.memory_until_written(Format::Png, beside)?);
        let image = opened.decode()?;
        let (found, regions) = self.analysed(member, &image, &self.reference_depth)?;
        let water = regions.water(&image.bytes());
        Ok(Reference { estimate: found.estimate, water, palette: self.palette(&image) })
    }

    fn palette(&self, image: &ImageFile) -> Option<Palette> {
        self.has_rivals().then(|| Palette::of(&image.bytes()))
    }

    /// Estimates depth and water, and finds the regions of the scores, by `depth` if there is any.
    fn analysed(
        &self,
        member: &Member,
        image: &ImageFile,
        depth: &Option<DepthSupply>,
    ) -> Result<(Analysis<WaterEstimate>, Regions), EvaluateError> {
        let source = DepthSource::Estimated(self.settings.depth_model.clone());
        let (found, evidence) = analyse_in_with_evidence(self.settings.encoding, image, &source)?;
        let regions = match depth {
            None => Regions::of_estimate(evidence.read_from, &found.depth),
            Some(supply) => {
                let (depth, _) = depth_of(image, &image.bytes(), &supply.of(&member.path)?)?;
                Regions::of_depth(&depth)
            }
        };
        Ok((found, regions))
    }

    /// Makes and scores everything of one content, which is read once.
    fn score_all(
        &self,
        content: usize,
        pairs: &[Vec<usize>],
        references: &[Option<Reference>],
        budget: &Budget,
        listener: Listener<'_>,
    ) -> (Vec<Scored>, Vec<Failed>) {
        let (mut results, mut failed) = (Vec::new(), Vec::new());
        let (Some(member), Some(meets)) = (self.contents.get(content), pairs.get(content)) else {
            return (results, failed);
        };
        if meets.is_empty() {
            return (results, failed);
        }
        let opened = ImageFile::open(&member.path, &self.run_options.reading).map_err(EvaluateError::from);
        let room = opened.and_then(|opened| {
            let beside = opened.pixels().saturating_mul(self.bytes_a_pixel());
            Ok((budget.reserve(opened.memory_until_written(Format::Png, beside)?), opened))
        });
        let read = room.and_then(|(room, opened)| Ok((room, self.read_content(member, opened.decode()?)?)));
        let (_room, read) = match read {
            Ok((room, read)) => (room, read),
            Err(error) => {
                let error = Failed::new(&member.name, &error);
                listener(Event::Failed { item: &error.name, error: error.clone() });
                meets.iter().for_each(|_| listener(Event::Done { item: &member.name, result: () }));
                return (results, vec![error]);
            }
        };
        for &place in meets {
            let (Some(other), Some(Some(reference))) = (self.references.get(place), references.get(place))
            else {
                // Its own failure was reported.
                listener(Event::Done { item: &member.name, result: () });
                continue;
            };
            let name = format!("{} in {}", member.name, other.name);
            for (method, way) in self.methods.iter().enumerate() {
                let made = self.make(way, member, other, &read, reference);
                let likeness = made.and_then(|made| self.compare(member, &read, &made, reference));
                match likeness {
                    Ok(likeness) => results.push(Scored { content, reference: place, method, likeness }),
                    Err(error) => {
                        let error = Failed::new(&format!("{name} by {}", way.name()), &error);
                        listener(Event::Failed { item: &error.name, error: error.clone() });
                        failed.push(error);
                    }
                }
            }
            listener(Event::Done { item: &name, result: () });
        }
        (results, failed)
    }

    fn read_content(&self, member: &Member, image: ImageFile) -> Result<Content, EvaluateError> {
        let (found, regions) = self.analysed(member, &image, &self.content_depth)?;
        let palette = self.palette(&image);
        Ok(Content { image, found, regions, palette })
    }

    fn compare(
        &self,
        member: &Member,
        content: &Content,
        made: &Image<u8>,
        reference: &Reference,
    ) -> Result<Likeness, EvaluateError> {
        let before = content.image.bytes();
        let change = || Change::of(&before, made, &content.regions, reference.water);
        let found = Likeness::of(&before, made, change);
        let found = found.ok_or_else(|| EvaluateError::TooSmall { path: member.path.clone() })?;
        let lpips = self.lpips.as_ref().map(|lpips| lpips.distance(&before, made)).transpose()?;
        Ok(Likeness { lpips, ..found })
    }

    /// The image that a method makes of a pair.
    fn make(
        &self,
        way: &Method,
        member: &Member,
        other: &Member,
        content: &Content,
        reference: &Reference,
    ) -> Result<Image<u8>, EvaluateError> {
        Ok(match way {
            Method::Aquafuse(_) => {
                let operation =
                    Operation::Fuse { reference: reference.estimate, options: self.settings.options };
                let mut pixels: Pixels = content.image.pixels.clone();
                operation.apply(&mut pixels, Some(&content.found)).expect("the depth map is this image's");
                pixels.smoothed(self.settings.smoothing).into_bytes()
            }
            Method::Rival(rival) => {
                let palettes = content.palette.as_ref().zip(reference.palette.as_ref());
                let (own, other) = palettes.expect("palettes are read where there are rivals");
                rival.image(&content.image.bytes(), own, other)
            }
            Method::Outputs(outputs) => {
                let stem = format!("{}__{}", member.stem(), other.stem());
                outputs.read(&stem, member, &content.image, &self.run_options.reading)?
            }
        })
    }

    /// Bytes a pixel that work on a content takes beside its image.
    fn bytes_a_pixel(&self) -> u64 {
        let of_method = |method: &Method| match method {
            // The fused image, and what linear light takes.
            Method::Aquafuse(_) => self.settings.encoding.bytes_a_pixel().saturating_add(16),
            Method::Rival(_) => RIVALS,
            Method::Outputs(_) => outputs::BYTES_A_PIXEL,
        };
        let network = if self.lpips.is_some() { lpips::BYTES_A_PIXEL } else { 0 };
        let methods = self.methods.iter().map(of_method).max().unwrap_or(0);
        methods.saturating_add(SCORED.max(network)).saturating_add(of_regions(&self.content_depth))
    }
}

/// Bytes a pixel that the regions of an image take.
fn of_regions(depth: &Option<DepthSupply>) -> u64 {
    match depth {
        None | Some(DepthSupply::Estimated(_)) => REGIONS,
        Some(DepthSupply::File(..) | DepthSupply::Folder(..)) => REGIONS.saturating_add(SUPPLIED),
    }
}

/// Reports a step that ended, well or not, and gives its result.
fn reported<R>(listener: Listener<'_>, name: &str, result: Result<R, EvaluateError>) -> Result<R, Failed> {
    let result = result.map_err(|error| Failed::new(name, &error));
    if let Err(error) = &result {
        listener(Event::Failed { item: &error.name, error: error.clone() });
    }
    listener(Event::Done { item: name, result: () });
    result
}
