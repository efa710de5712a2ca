//! `aquafuse video`: the frames of a video, fused, restored or enhanced.

mod summary;

use std::path::PathBuf;

use aquafuse::stream::Steady;
use aquafuse_data::pipeline::{DepthEstimator, Operation, PixelEncoding, WaterEstimate};
use aquafuse_data::video::{
    Codec, ContentWater, Input, Output, Plan, RawFrames, Recipe, Request, VideoEvent,
};
use aquafuse_data::water_file::WaterFile;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};

use crate::args::border::BorderArgument;
use crate::args::common::Common;
use crate::args::fusion::{Settings, SettingsArgs};
use crate::args::levels::LevelsArguments;
use crate::args::max_gain::MaxGain;
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::progress::Progress;
use crate::report::water::veiling_light;
use crate::report::{network, output};

const HELP: &str = "\
The program ffmpeg reads and writes video. It is looked for on the search path, or named by the
environment variable AQUAFUSE_FFMPEG. Each frame keeps its time, so a variable rate stays as it is.
Sound, subtitles, chapters and metadata are copied. Rotation is applied and its tag dropped. Colour
matrix, range and resolution stay; of 10 bits all are used.

A damaged video is written as far as it can be decoded, and the exit code is 1 (0 with --lenient).

`-` is a stream of YUV4MPEG2 on standard input and output, or of raw frames with --raw.

Depth is estimated from colour, or by a network, FILE.onnx, which takes from a second to a minute a
frame: the time that is left is printed after the first. Nothing is kept of its maps; `fuse FRAMES
WATER -o DIR --sequence` keeps them. Depth maps, --linear and fusion with a clear image (`enhance
IMAGE CLEAR`) are for images.

Examples:
  aquafuse video dive.mp4 green.jpg -o green_dive.mp4
  aquafuse video dive.mp4 --restore -o clear_dive.mp4
  aquafuse video dive.mp4 --enhance --strength 0.7 -o clear_dive.mp4 --flicker
  aquafuse video dive.mov preset:jerlov-3C -o dive.mkv --codec ffv1
  ffmpeg -i rtsp://camera -f yuv4mpegpipe - | aquafuse video - --restore -o - | ffplay -";

/// Put a video into another water, restore or enhance it.
#[derive(Args)]
#[command(
    after_help = HELP,
    group = ArgGroup::new("clear").args(["restore", "enhance"]),
    group = ArgGroup::new("fusion")
        .args(["water", "model", "theta", "alpha", "smooth", "as_published", "one_water", "content_water"])
        .multiple(true)
        .conflicts_with("clear"),
    group = ArgGroup::new("levels").args(["white", "exposure", "strength"]).multiple(true).requires("clear"),
    group = ArgGroup::new("area").args(["border", "water_map"]).multiple(true).conflicts_with("as_published"),
)]
pub(crate) struct Video {
    /// The video: any file that ffmpeg reads, or - for standard input.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The reference water: an image (best with open water in view), NAME.water.json from `water extract`,
    /// preset:NAME from `water list`, or sea:NUMBER, a drawn water.
    #[arg(required_unless_present_any = ["restore", "enhance"])]
    water: Option<PathBuf>,
    /// Output file, .mp4, .m4v, .mov, .mkv or .webm; or - for standard output.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Remove the water, as `restore` does, instead of exchanging it.
    #[arg(long)]
    restore: bool,
    /// Set the levels, as `enhance` does, instead of exchanging the water.
    #[arg(long)]
    enhance: bool,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    levels: LevelsArguments,
    #[command(flatten)]
    max_gain: MaxGain,
    #[command(flatten)]
    waters: WaterArguments,
    #[command(flatten)]
    border: BorderArgument,
    /// Water and levels are means over about so many frames, so that the output does not flicker. A scene cut begins again. 1: each
    /// frame by itself.
    #[arg(long, value_name = "FRAMES", default_value_t = STEADY_OVER, value_parser = clap::value_parser!(u16).range(1..))]
    steady_over: u16,
    /// Estimate one water for the whole video first, from 24 of its frames, and use it for every frame.
    #[arg(long, conflicts_with = "content_water")]
    one_water: bool,
    /// The water of the video itself, NAME.water.json from `water extract`, instead of an estimate.
    #[arg(long, value_name = "FILE")]
    content_water: Option<PathBuf>,
    /// Print how much more the output changes from frame to frame than the video: 1 is as much.
    #[arg(long)]
    flicker: bool,
    /// How frames are compressed: `h264` every player shows, `h265` is smaller and slower, `vp9` is for .webm, `ffv1` keeps every pixel
    /// as it was computed, in .mkv [default: h264; vp9 for .webm].
    #[arg(long, value_name = "CODEC", value_parser = codec())]
    codec: Option<Codec>,
    /// Constant rate factor of the encoder: lower is better and larger [default: 18 for h264, 20 for h265, 24 for vp9].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=63))]
    crf: Option<u8>,
    /// Standard input holds raw frames of this size, 8 bits of red, green and blue for each pixel; standard output too. RATE, in frames a
    /// second, is needed for an output file.
    #[arg(long, value_name = "WIDTHxHEIGHT[@RATE]")]
    raw: Option<RawFrames>,
    /// Replace an existing output.
    #[arg(long)]
    overwrite: bool,
    /// Print one JSON object instead of the summary.
    #[arg(long)]
    json: bool,
}

/// [`Steady::FRAMES`], as an option.
const STEADY_OVER: u16 = 8;
const _: () = assert!(Steady::FRAMES == STEADY_OVER as usize, "the same default everywhere");

impl Video {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.settings.cutting(&self.border, common);
        let options = common.run_options();
        let water = self.water.as_deref().map(WaterSource::parse).transpose()?;
        let request = self.request(water.as_ref())?;
        let mut settings = self.settings.get()?;
        let depth_model = std::mem::take(&mut settings.depth_model);
        // Whether the output may be written is known before an image is read.
        let plan = Plan::new(&request, &options)?;
        let (recipe, heading) = self.recipe(water.as_ref(), &settings, depth_model, common)?;
        let notes = plan.notes();
        if !common.quiet {
            notes.iter().for_each(output::complain);
        }
        let progress = Progress::new(common.quiet);
        let begun = std::time::Instant::now();
        let long = network::Long::new();
        let ended = plan.run(&recipe, &options, &|event| match event {
            VideoEvent::Started { frames } => {
                long.begins(frames);
                if let Some(frames) = frames {
                    progress.start(usize::try_from(frames).unwrap_or(usize::MAX));
                }
            }
            VideoEvent::Frame { seconds, .. } => {
                if let Some(said) = long.said(recipe.network()).filter(|_| !common.quiet) {
                    progress.complain(&said);
                }
                progress.done(&summary::clock(seconds));
            }
            _ => {}
        });
        progress.finish();
        let ended = ended?;
        let report = summary::Report {
            input: &self.input,
            output: &self.output,
            summary: &ended,
            seconds: begun.elapsed().as_secs_f64(),
            notes: &notes,
            is_lenient: options.reading.lenient,
        };
        match (self.json, common.quiet) {
            (true, _) => self.print(&report.json()?)?,
            (false, true) => {}
            (false, false) => self.print(&(heading + &report.text()))?,
        }
        match &ended.damage {
            Some(damage) if !options.reading.lenient => Err(Failure::work(report.damage(damage))),
            _ => Ok(()),
        }
    }

    /// Prints the outcome; where standard output is the video, to standard error.
    fn print(&self, text: &str) -> Result<(), Failure> {
        if matches!(self.output_place(), Output::Stdout) {
            output::remark(&text.trim_end());
            return Ok(());
        }
        if self.json { output::print_json(text) } else { output::print(text) }
    }

    fn output_place(&self) -> Output {
        Request::new("", &self.output).output
    }

    fn request(&self, water: Option<&WaterSource>) -> Result<Request, Failure> {
        let mut request = Request::new(&self.input, &self.output);
        if let Some(raw) = self.raw {
            if request.input != Input::Y4m {
                return Err(Failure::usage(anyhow::anyhow!(
                    "--raw is about standard input; give - for IN, or leave it out"
                )));
            }
            request.input = Input::Raw(raw);
        }
        let read = water.and_then(WaterSource::path).into_iter().chain(self.content_water.as_deref());
        request.inputs = read.map(PathBuf::from).collect();
        request.overwrite = self.overwrite;
        request.codec = self.codec;
        Ok(request)
    }

    /// What is done to each frame, and a line about the reference.
    fn recipe(
        &self,
        water: Option<&WaterSource>,
        settings: &Settings,
        depth_model: DepthEstimator,
        common: &Common,
    ) -> Result<(Recipe, String), Failure> {
        let content_water = self.content_water(&depth_model)?;
        // Before a network has read the reference.
        content_water.check(&depth_model).map_err(Failure::usage)?;
        let mut heading = String::new();
        let operation = match water {
            None if self.restore => Operation::Restore {
                options: self.max_gain.options(),
                levels: self.levels.options(),
                encoding: PixelEncoding::Encoded,
            },
            None => Operation::Enhance { levels: self.levels.options() },
            Some(water) => {
                self.waters.refuse_unread(settings.options.model)?;
                let file = self.waters.read(water, &depth_model, PixelEncoding::Encoded, &common.reading)?;
                let reference = self.waters.per(depth_model.kind(), &file)?;
                heading = format!("{}: {}\n", water.name(), veiling_light(&reference));
                Operation::Fuse { reference, options: settings.options }
            }
        };
        let recipe = Recipe {
            depth_model,
            smoothing: settings.smoothing,
            border: common.reading.border,
            water_map: common.reading.water_map,
            steady_over: self.steady_over.into(),
            content_water,
            flicker: self.flicker,
            codec: self.codec,
            crf: self.crf,
            ..Recipe::new(operation)
        };
        Ok((recipe, heading))
    }

    fn content_water(&self, depth_model: &DepthEstimator) -> Result<ContentWater, Failure> {
        let Some(path) = &self.content_water else {
            return Ok(if self.one_water { ContentWater::Pooled } else { ContentWater::Estimated });
        };
        let file = WaterFile::read(path, PixelEncoding::Encoded)?;
        match file.per(depth_model.kind(), self.waters.scale()?).map_err(Failure::work)? {
            WaterEstimate::Encoded(water) => Ok(ContentWater::Given(water)),
            WaterEstimate::Linear(_) => Ok(ContentWater::Estimated),
        }
    }
}

fn codec() -> impl TypedValueParser<Value = Codec> {
    PossibleValuesParser::new(Codec::ALL.iter().map(|codec| codec.name()))
        .map(|name| Codec::ALL.iter().copied().find(|codec| codec.name() == name).unwrap_or(Codec::H264))
}
