//! The run: three stages on threads of their own, with buffers that go round.

use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread;

use aquafuse::metrics::Flicker;
use aquafuse::waterbody::Reason;

use super::change::{Change, ContentWater, Recipe, Seen};
use super::decode::{Decoder, Place};
use super::encode::{Encoder, Target};
use super::plan::{BUFFERS, Input, Output, Plan, check_size};
use super::raw::{RawSink, RawSource};
use super::{Ffmpeg, Frame, Sink, Source, VideoError, one_water};
use crate::files::Staged;
use crate::run::{RunOptions, Stop, Stopped};

/// Frames that wait between two stages.
const WAITING: usize = 2;

/// One step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum VideoEvent {
    /// The first frame is decoded.
    Started {
        /// How many frames there are, about, if that is known.
        frames: Option<u64>,
    },
    /// A frame is written.
    Frame {
        /// Its number, from 0.
        index: u64,
        /// When it is shown, in seconds.
        seconds: f64,
    },
}

/// Whoever listens to a run; it is called from another thread.
pub type VideoListener<'a> = &'a (dyn Fn(VideoEvent) + Sync);

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// Frames that were written.
    pub frames: u64,
    /// Frames by the verdict on their water: good, doubtful, failed. All 0 for enhancement.
    pub verdicts: [u64; 3],
    /// The reasons of these verdicts, and of how many frames each is one; those of no frame are left out.
    pub reasons: Vec<(Reason, u64)>,
    /// The share of all values that were clipped.
    pub clipped: f64,
    /// How much the output flickers beside its source, if that was asked for.
    pub flicker: Option<Flicker>,
    /// What is wrong with the source, if anything is: the output has the frames that could be decoded.
    pub damage: Option<Damage>,
}

/// The damage of a source.
#[derive(Clone, Debug, PartialEq)]
pub struct Damage {
    /// When the last frame is shown, in seconds.
    pub last: f64,
    /// What was said about it.
    pub cause: String,
}

impl Plan {
    /// Makes the video. An output file is there whole, under its name, or not at all.
    ///
    /// # Errors
    ///
    /// [`VideoError`] when no frame can be decoded or the output cannot be written; there is no output then. A damaged source is
    /// no error: [`Summary::damage`] says it.
    pub fn run(
        self,
        recipe: &Recipe,
        options: &RunOptions,
        listener: VideoListener<'_>,
    ) -> Result<Summary, VideoError> {
        recipe.content_water.check(&recipe.depth_model)?;
        let pixels = (self.shape.width as u64).saturating_mul(self.shape.height as u64);
        check_size(&self.input, self.shape, &options.reading, recipe.network_memory(pixels))?;
        let pooled;
        let recipe = match (&recipe.content_water, &self.input, &self.ffmpeg) {
            (ContentWater::Pooled, Input::File(path), Some(ffmpeg)) => {
                let water = one_water::of(ffmpeg, path, &self.info, recipe, &options.stop)?;
                pooled = Recipe { content_water: ContentWater::Given(water), ..recipe.clone() };
                &pooled
            }
            (ContentWater::Pooled, ..) => {
                let why = "--one-water reads the video twice, which a stream does not allow; save it to a file first";
                return Err(VideoError::Request(why.into()));
            }
            _ => recipe,
        };
        let mut change = recipe.change(self.shape)?;
        let mut source = self.source()?;
        let mut first = Frame::default();
        if !source.next(&mut first)? {
            let said = source.end().unwrap_or_else(|| "it ends before the first one".into());
            return Err(VideoError::NoFrames { path: self.input.name(), said });
        }
        let staged = match &self.output {
            Output::File(path) => Some(Staged::empty(path, self.overwrite)?),
            Output::Stdout => None,
        };
        let sink = self.sink(staged.as_ref().map(Staged::part), recipe, first.time)?;
        listener(VideoEvent::Started { frames: self.info.frames() });
        let seconds = |time: i64| {
            #[allow(clippy::cast_precision_loss, reason = "a time in seconds needs no more")]
            (time as f64 * self.info.time_base.value().unwrap_or(0.0))
        };
        let stages = Stages { stop: &options.stop, listener, seconds: &seconds };
        let (frames, last, damage) = stages.run(first, source, change.as_mut(), sink)?;
        if let Some(staged) = staged {
            staged.persist()?;
        }
        let Seen { verdicts, reasons, clipped } = change.seen();
        let reasons = Reason::ALL.iter().copied().zip(reasons).filter(|&(_, frames)| frames > 0).collect();
        #[allow(clippy::cast_precision_loss, reason = "a mean needs no more")]
        let clipped = clipped / frames.max(1) as f64;
        let damage = damage.map(|cause| Damage { last: seconds(last), cause });
        Ok(Summary { frames, verdicts, reasons, clipped, flicker: change.flicker(), damage })
    }

    fn source(&self) -> Result<Box<dyn Source>, VideoError> {
        let decoder = |place| match &self.ffmpeg {
            Some(ffmpeg) => {
                Ok(Box::new(Decoder::start(ffmpeg, place, &self.info, self.shape)?) as Box<dyn Source>)
            }
            None => Err(no_ffmpeg()),
        };
        match &self.input {
            Input::File(path) => decoder(Place::File(path)),
            Input::Y4m => decoder(Place::Y4m(self.begun.clone())),
            Input::Raw(_) => Ok(Box::new(RawSource::new(self.shape))),
        }
    }

    fn sink(&self, part: Option<&Path>, recipe: &Recipe, first: i64) -> Result<Box<dyn Sink>, VideoError> {
        match (&self.output, part, self.file, &self.ffmpeg) {
            (Output::File(path), Some(part), Some((container, codec)), Some(ffmpeg)) => {
                let target =
                    Target { part, path, source: self.input.path(), container, codec, crf: recipe.crf };
                Ok(Box::new(Encoder::to_file(ffmpeg, &target, &self.info, self.shape, first)?))
            }
            (Output::Stdout, _, _, _) if matches!(self.input, Input::Raw(_)) => {
                Ok(Box::new(RawSink::default()))
            }
            (_, _, _, Some(ffmpeg)) => Ok(Box::new(Encoder::to_y4m(ffmpeg, &self.info, self.shape)?)),
            _ => Err(no_ffmpeg()),
        }
    }
}

/// A plan with files always has one.
fn no_ffmpeg() -> VideoError {
    VideoError::NoFfmpeg { program: Ffmpeg::NAME.into() }
}

/// The stages of a run: decode, change, encode.
struct Stages<'a> {
    stop: &'a Stop,
    listener: VideoListener<'a>,
    seconds: &'a (dyn Fn(i64) -> f64 + Sync),
}

impl Stages<'_> {
    /// Runs to the end; how many frames were written, the time of the last one, and the damage of the source.
    fn run(
        &self,
        first: Frame,
        source: Box<dyn Source>,
        change: &mut dyn Change,
        sink: Box<dyn Sink>,
    ) -> Result<(u64, i64, Option<String>), VideoError> {
        let (free, taken) = channel();
        let (to_change, decoded) = sync_channel(WAITING);
        let (to_encode, changed) = sync_channel(WAITING);
        (1..BUFFERS).for_each(|_| {
            let _ = free.send(Frame::default());
        });
        thread::scope(|scope| {
            let no_thread =
                |error: std::io::Error| VideoError::Request(format!("the system gives no thread: {error}"));
            let decode = move || self.decode(first, source, &taken, &to_change);
            let decode = thread::Builder::new().spawn_scoped(scope, decode).map_err(no_thread)?;
            let encode = move || self.encode(&changed, &free, sink);
            let encode = thread::Builder::new().spawn_scoped(scope, encode).map_err(no_thread)?;
            let is_changed = self.change(&decoded, &to_encode, change);
            // Whoever waits for this stage sees that it is over.
            drop((decoded, to_encode));
            let decoded = decode.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            let encoded = encode.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            is_changed?;
            let (mut sink, frames, last) = encoded?;
            if self.stop.is_stopped() {
                return Err(Stopped.into());
            }
            let damage = decoded?;
            sink.finish()?;
            Ok((frames, last, damage))
        })
    }

    fn decode(
        &self,
        first: Frame,
        mut source: Box<dyn Source>,
        free: &Receiver<Frame>,
        decoded: &SyncSender<Frame>,
    ) -> Result<Option<String>, VideoError> {
        if decoded.send(first).is_err() {
            return Ok(None);
        }
        while let Ok(mut frame) = free.recv() {
            if self.stop.is_stopped() {
                return Ok(None);
            }
            if !source.next(&mut frame)? {
                return Ok(source.end());
            }
            if decoded.send(frame).is_err() {
                break;
            }
        }
        Ok(None)
    }

    fn change(
        &self,
        decoded: &Receiver<Frame>,
        changed: &SyncSender<Frame>,
        change: &mut dyn Change,
    ) -> Result<(), VideoError> {
        while let Ok(mut frame) = decoded.recv() {
            if self.stop.is_stopped() {
                return Ok(());
            }
            change.change(&mut frame)?;
            if changed.send(frame).is_err() {
                break;
            }
        }
        Ok(())
    }

    fn encode(
        &self,
        changed: &Receiver<Frame>,
        free: &Sender<Frame>,
        mut sink: Box<dyn Sink>,
    ) -> Result<(Box<dyn Sink>, u64, i64), VideoError> {
        let (mut frames, mut last) = (0_u64, 0);
        while let Ok(frame) = changed.recv() {
            sink.write(&frame)?;
            last = frame.time;
            (self.listener)(VideoEvent::Frame { index: frames, seconds: (self.seconds)(last) });
            frames = frames.saturating_add(1);
            let _ = free.send(frame);
        }
        Ok((sink, frames, last))
    }
}
