//! One water for all frames: the estimates of some of them, pooled.

use std::io::Read;
use std::path::Path;
use std::process::Stdio;

use aquafuse::image::{Encoded, ImageRef};
use aquafuse::waterbody::{Estimate, pool};

use super::change::Recipe;
use super::decode::filters;
use super::ffmpeg::{Ffmpeg, input};
use super::{Shape, VideoError, VideoInfo};
use crate::run::Stop;

/// Frames that are looked at, evenly over the video: more change the median little.
const FRAMES: u32 = 24;

/// The water of a video, of some of its frames.
pub(super) fn of(
    ffmpeg: &Ffmpeg,
    path: &Path,
    info: &VideoInfo,
    recipe: &Recipe,
    stop: &Stop,
) -> Result<Estimate<Encoded>, VideoError> {
    let no = |why: &str| {
        VideoError::Request(format!("{why}; leave out --one-water, or give the water with --content-water"))
    };
    let mut stream =
        recipe.fusion::<u8>().ok_or_else(|| no("the water of all frames is pooled for fusion alone"))?;
    let duration = info.duration.ok_or_else(|| no("the video does not say how long it is"))?;
    let shape = Shape { width: info.width, height: info.height, is_deep: false };
    let mut bytes = vec![0; shape.bytes()];
    let mut found = Vec::new();
    for i in 0..FRAMES {
        if stop.is_stopped() {
            return Err(crate::run::Stopped.into());
        }
        let time = duration * (f64::from(i) + 0.5) / f64::from(FRAMES);
        if read(ffmpeg, path, info, shape, time, &mut bytes)?
            && let Ok(image) = ImageRef::new(shape.width, shape.height, &bytes)
        {
            found.push(stream.estimate(image));
        }
    }
    pool(&found).ok_or_else(|| no("no frame of the video can be read by its time"))
}

/// Reads the frame at a time in seconds; false if there is none.
fn read(
    ffmpeg: &Ffmpeg,
    path: &Path,
    info: &VideoInfo,
    shape: Shape,
    time: f64,
    bytes: &mut [u8],
) -> Result<bool, VideoError> {
    let mut command = ffmpeg.command();
    command.args(["-ss", &format!("{time:.3}")]).args(input(path));
    command.args([
        "-map",
        "0:V:0",
        "-frames:v",
        "1",
        "-vf",
        &filters(info, shape),
        "-f",
        "rawvideo",
        "pipe:1",
    ]);
    let mut running = ffmpeg.start(command.stdin(Stdio::null()).stdout(Stdio::piped()))?;
    let read = running.program.stdout().is_some_and(|mut pixels| pixels.read_exact(bytes).is_ok());
    running.end();
    Ok(read)
}
