//! A live camera of 1920 x 1080 at 30 frames a second through the element: what it costs, as one line of JSON.
//!
//! `live FORMAT SECONDS PROPERTIES...`; for instance `live NV12 10 water=preset:jerlov-3C`.

use std::error::Error;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use aquafuse::image::Image;
use aquafuse::truth::{Scene, Size, waters};
use gst::prelude::*;
use gst_video::{VideoFormat, VideoInfo};

const SIZE: (usize, usize) = (1920, 1080);
const RATE: u32 = 30;
/// Frames that differ; the camera then goes the same way again.
const FRAMES: usize = 24;
/// Before figures count: the pipeline fills, and memory for a frame is taken.
const WARM_UP: u32 = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [format, seconds, properties @ ..] = &arguments[..] else {
        return Err("live FORMAT SECONDS PROPERTIES...".into());
    };
    gst::init()?;
    gstaquafuse::plugin_register_static()?;
    let format: VideoFormat = format.parse()?;
    let (width, height) = (u32::try_from(SIZE.0)?, u32::try_from(SIZE.1)?);
    let info = VideoInfo::builder(format, width, height).fps((i32::try_from(RATE)?, 1)).build()?;
    let frames = frames(&info)?;
    let measured = measure(&frames, &info, seconds.parse()?, &properties.join(" "))?;
    println!("{measured}");
    Ok(())
}

/// A camera that moves along a synthetic place, in the format of the pipeline.
fn frames(info: &VideoInfo) -> Result<Vec<gst::Buffer>, Box<dyn Error>> {
    let (width, height) = SIZE;
    // Rendered at half the size, which takes a quarter of the time; each pixel of it is four.
    let size = Size { width: width / 2 + 4 * FRAMES, height: height / 2 };
    let place: Image<u8> = Scene::new(3, size).seen_through(&waters()[0].water).convert();
    let rgb = VideoInfo::builder(VideoFormat::Rgb, info.width(), info.height()).fps(info.fps()).build()?;
    let convert = gst_video::VideoConverter::new(&rgb, info, None)?;
    let frame = |step: usize| {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let colours = pixels.flat_map(|(x, y)| place.row(y / 2)[4 * step + x / 2]);
        let mut source = gst::Buffer::from_mut_slice(colours.collect::<Vec<u8>>());
        let mut made = gst::Buffer::with_size(info.size())?;
        let (source, target) = (source.make_mut(), made.make_mut());
        let source = gst_video::VideoFrameRef::from_buffer_ref_readable(source, &rgb)?;
        let mut target = gst_video::VideoFrameRef::from_buffer_ref_writable(target, info)?;
        convert.frame_ref(&source, &mut target);
        drop(target);
        Ok(made)
    };
    (0..FRAMES).map(frame).collect()
}

fn measure(
    frames: &[gst::Buffer],
    info: &VideoInfo,
    seconds: u32,
    properties: &str,
) -> Result<String, Box<dyn Error>> {
    // One frame may wait, as in a camera: of what comes while it does, the oldest is lost.
    let text = format!(
        "appsrc name=camera is-live=true format=time do-timestamp=true max-buffers=1 max-bytes=0 leaky-type=downstream \
         ! aquafuse name=ours {properties} ! fakesink name=screen sync=true qos=true"
    );
    let pipeline = gst::parse::launch(&text)?.downcast::<gst::Pipeline>().map_err(|_| "no pipeline")?;
    let by_name = |name| pipeline.by_name(name).ok_or("it is in the pipeline");
    let (camera, ours, screen) = (by_name("camera")?, by_name("ours")?, by_name("screen")?);
    camera.set_property("caps", info.to_caps()?);
    let pad = |element: &gst::Element, name| element.static_pad(name).ok_or("an element has pads");
    let entered = Arc::new(Mutex::new(Instant::now()));
    let times = Arc::new(Mutex::new(Vec::new()));
    let shown = Arc::new(AtomicU64::new(0));
    let enters = entered.clone();
    pad(&ours, "sink")?.add_probe(gst::PadProbeType::BUFFER, move |_, _| {
        *enters.lock().expect("no thread panics") = Instant::now();
        gst::PadProbeReturn::Ok
    });
    let taken = times.clone();
    pad(&ours, "src")?.add_probe(gst::PadProbeType::BUFFER, move |_, _| {
        let took = entered.lock().expect("no thread panics").elapsed();
        taken.lock().expect("no thread panics").push(took);
        gst::PadProbeReturn::Ok
    });
    let shows = shown.clone();
    screen.set_property("signal-handoffs", true);
    screen.connect("handoff", false, move |_| {
        shows.fetch_add(1, Ordering::Relaxed);
        None
    });
    pipeline.set_state(gst::State::Playing)?;
    let began = Instant::now();
    let (mut cpu, mut wall, mut before) = (0.0, Instant::now(), 0);
    for number in 0..WARM_UP + seconds * RATE {
        let due = began + Duration::from_secs(1) * number / RATE;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        if number == WARM_UP {
            times.lock().expect("no thread panics").clear();
            (cpu, wall, before) = (cpu_seconds()?, Instant::now(), shown.load(Ordering::Relaxed));
        }
        // A camera fills a buffer of its own each time.
        let buffer = frames[usize::try_from(number)? % frames.len()].copy_deep()?;
        camera.emit_by_name::<gst::FlowReturn>("push-buffer", &[&buffer]).into_result()?;
    }
    // The last frame needs no longer than that.
    std::thread::sleep(Duration::from_secs(1) / RATE);
    let (cpu, wall) = (cpu_seconds()? - cpu, wall.elapsed().as_secs_f64());
    let shown = shown.load(Ordering::Relaxed) - before;
    let mut times = std::mem::take(&mut *times.lock().expect("no thread panics"));
    if let Some(error) = pipeline.bus().and_then(|bus| bus.pop_filtered(&[gst::MessageType::Error])) {
        return Err(format!("{error:?}").into());
    }
    pipeline.set_state(gst::State::Null)?;
    times.sort();
    let at = |share: f64| {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a place in a list"
        )]
        let at = ((times.len().saturating_sub(1)) as f64 * share).round() as usize;
        times.get(at).map_or(0.0, |time| time.as_secs_f64() * 1e3)
    };
    let (sent, share) = (seconds * RATE, cpu / wall);
    Ok(format!(
        "{{\"sent\":{sent},\"shown\":{shown},\"cpu\":{share:.4},\"median_ms\":{:.3},\"p95_ms\":{:.3},\"max_ms\":{:.3}}}",
        at(0.5),
        at(0.95),
        at(1.0)
    ))
}

/// Processor time of this process so far, over all its threads.
fn cpu_seconds() -> Result<f64, Box<dyn Error>> {
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    // Names may have spaces; the twelfth and thirteenth field after them are ticks, a hundred a second.
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks =
        |at: usize| fields.get(at).and_then(|field| field.parse::<f64>().ok()).ok_or("no times in /proc");
    Ok((ticks(11)? + ticks(12)?) / 100.0)
}
