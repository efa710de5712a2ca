//! `lab flicker`: how much more a sequence changes from frame to frame than its source, frame by frame and with steady water.

mod sequences;

use anyhow::{Context, Result};
use aquafuse::fuser::Options;
use aquafuse::fusion::Model;
use aquafuse::image::{Image, ImageError};
use aquafuse::metrics::{Flicker, warping_error};
use aquafuse::stream::{EnhanceStream, RestoreStream, Steady, Stream};
use aquafuse::waterbody::{EstimateOptions, WaterMap};
use aquafuse::{Fuser, depth, waterbody};

use crate::pages::{RESULTS, show_section};
use sequences::Sequence;

const HEADING: &str = "\
| sequence | operation | water and levels | change of mean colour | warping error | largest change, levels of 255 (frame) | share of the true change |\n\
|---|---|---|---|---|---|---|\n";

/// How many frames are averaged, and what it is called.
const WAYS: [(&str, usize); 2] = [("frame by frame", 1), ("steady", Steady::FRAMES)];

pub(crate) fn run() -> Result<()> {
    let mut table = HEADING.to_owned();
    for sequence in sequences::all()? {
        table += &row(&sequence, "the source", "", &sequence.frames)?;
        for model in [Model::Physical, Model::Exchange, Model::Aquafuse] {
            for (name, made) in fused(&sequence, model)? {
                table += &row(&sequence, model.name(), name, &made)?;
            }
        }
        for (name, frames) in WAYS {
            let mut stream = RestoreStream::default().estimate(by_both()).steady_over(frames);
            let made = each(&sequence, |frame| stream.restore_mut(frame).map(|_| ()))?;
            table += &row(&sequence, "restore", name, &made)?;
        }
        for (name, frames) in WAYS {
            let mut stream = EnhanceStream::default().steady_over(frames);
            let made = each(&sequence, |frame| stream.enhance_mut(frame).map(|_| ()))?;
            table += &row(&sequence, "enhance", name, &made)?;
        }
        let made = each(&sequence, |frame| {
            stretch(frame);
            Ok(())
        })?;
        table += &row(&sequence, "stretch, 1 to 99 %", "frame by frame", &made)?;
    }
    show_section(RESULTS, "flicker", &table)
}

/// As the command estimates water.
fn by_both() -> EstimateOptions {
    EstimateOptions::default().with_water_map(WaterMap::Both)
}

/// What becomes of each frame.
fn each(
    sequence: &Sequence,
    mut change: impl FnMut(&mut Image<u8>) -> Result<(), ImageError>,
) -> Result<Vec<Image<u8>>> {
    let changed = |frame: &Image<u8>| {
        let mut frame = frame.clone();
        change(&mut frame)?;
        Ok(frame)
    };
    sequence.frames.iter().map(changed).collect()
}

/// What is made of a sequence, by the name of the way.
type Made = Vec<(&'static str, Vec<Image<u8>>)>;

/// A sequence fused frame by frame, with steady water, also of every eighth frame alone, and with one water for all frames.
fn fused(sequence: &Sequence, model: Model) -> Result<Made> {
    let options = Options::default().with_estimate(by_both());
    let fuser = Fuser::with_options(&sequence.reference, options)?.model(model);
    let estimates =
        sequence.frames.iter().map(|frame| waterbody::estimate(frame, &depth::estimate(frame), &by_both()));
    let estimates = estimates.collect::<Result<Vec<_>, _>>()?;
    let one = waterbody::pool(&estimates).context("a sequence has frames")?;
    let streams = WAYS.map(|(name, frames)| (name, Stream::new(fuser.clone()).steady_over(frames)));
    let eighth = ("steady, every eighth", Stream::new(fuser.clone()).every(8));
    let one = ("one water", Stream::new(fuser.clone()).content_water(one));
    let made = |(name, mut stream): (&'static str, Stream<'_>)| {
        Ok((name, each(sequence, |frame| stream.fuse_mut(frame).map(|_| ()))?))
    };
    streams.into_iter().chain([eighth, one]).map(made).collect()
}

/// The rival of every frame: each channel from its 1 % to its 99 % percentile.
fn stretch(frame: &mut Image<u8>) {
    let ends: [[u8; 2]; 3] = std::array::from_fn(|c| {
        let mut values: Vec<u8> = frame.pixels().iter().map(|pixel| pixel[c]).collect();
        values.sort_unstable();
        [values[values.len() / 100], values[values.len() - 1 - values.len() / 100]]
    });
    for pixel in frame.view_mut().rows_mut().flatten() {
        for (value, [black, white]) in pixel.iter_mut().zip(ends) {
            let unit = (f32::from(*value) - f32::from(black)) / f32::from(white.saturating_sub(black).max(1));
            *value = (255.0 * unit.clamp(0.0, 1.0)).round() as u8;
        }
    }
}

fn row(sequence: &Sequence, operation: &str, way: &str, made: &[Image<u8>]) -> Result<String> {
    let mut flicker = Flicker::default();
    for (frame, made) in sequence.frames.iter().zip(made) {
        flicker.add(frame, made)?;
    }
    let mut warped = [0.0; 2];
    for (i, flow) in sequence.flows.iter().enumerate() {
        for (sum, frames) in warped.iter_mut().zip([&sequence.frames[..], made]) {
            *sum += warping_error(&frames[i], &frames[i + 1], flow)?;
        }
    }
    let (frame, largest) = flicker.largest();
    let ratio = flicker.ratio().context("the source does not change")?;
    Ok(format!(
        "| {} | {operation} | {way} | {ratio:.2} | {:.2} | {:.1} ({}) | {} |\n",
        sequence.name,
        warped[1] / warped[0],
        255.0 * largest,
        frame + 1,
        sequence.share_of_truth(made).map_or_else(String::new, |share| format!("{share:.3}")),
    ))
}
