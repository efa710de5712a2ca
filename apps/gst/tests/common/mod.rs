//! Pipelines with the element, and what goes in and comes out of it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use aquafuse::Fuser;
use aquafuse::depth::{DepthKind, RelativeScale};
use aquafuse::image::Image;
use aquafuse::stream::Stream;
use aquafuse::truth::{Pose, Scene, Size, waters};
use aquafuse::waterbody::presets::Conditions;
use aquafuse_data::pipeline::{PixelEncoding, WaterEstimate};
use aquafuse_data::water_file::WaterFile;
use gst::prelude::*;
use gst_video::prelude::*;

/// Says why a test is not run, as the runner of all tests counts it.
pub(crate) fn skip(why: &str) {
    println!("skipped: {why}");
}

/// What is not installed of these elements, if anything; makes ours known.
pub(crate) fn missing(elements: &[&str]) -> Option<String> {
    gst::init().unwrap();
    gstaquafuse::plugin_register_static().unwrap();
    let lacking: Vec<&str> =
        elements.iter().copied().filter(|name| gst::ElementFactory::find(name).is_none()).collect();
    (!lacking.is_empty()).then(|| format!("GStreamer has no {}", lacking.join(", ")))
}

/// The core's stream into a water of this name.
pub(crate) fn reference_stream(name: &str) -> Stream<'static> {
    let file = match name.strip_prefix("sea:") {
        Some(number) => WaterFile::sea(number.parse().unwrap(), PixelEncoding::Encoded),
        None => WaterFile {
            from: Vec::new(),
            depth_kind: DepthKind::Metres,
            estimate: WaterEstimate::preset(
                name.strip_prefix("preset:").unwrap().parse().unwrap(),
                &Conditions::default(),
                PixelEncoding::Encoded,
            ),
        },
    };
    match file.per(DepthKind::Relative, RelativeScale::default()).unwrap() {
        WaterEstimate::Encoded(water) => Stream::new(Fuser::from(water)),
        WaterEstimate::Linear(_) => unreachable!("it was read as encoded"),
    }
}

/// A file that goes with its value.
pub(crate) struct Temporary(PathBuf);

impl Temporary {
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The name of a file that is not there.
pub(crate) fn temporary(name: &str) -> Temporary {
    static COUNT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
    let number = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    Temporary(std::env::temp_dir().join(format!("aquafuse-gst-{}-{number}-{name}", std::process::id())))
}

/// Frames of a camera that moves, as raw red, green and blue in a file.
pub(crate) struct SceneFile {
    file: Temporary,
    size: (u32, u32),
}

pub(crate) fn scene_file(size: (u32, u32), frames: usize) -> SceneFile {
    let area = Size { width: size.0 as usize, height: size.1 as usize };
    let mut bytes = Vec::new();
    for step in 0..frames {
        let pose = Pose { yaw: 0.01 * step as f32, ..Pose::default() };
        let scene = Scene::from(Default::default(), 1, &pose, area);
        let image: Image<u8> = scene.seen_through(&waters()[0].water).convert();
        for row in image.view().rows() {
            bytes.extend_from_slice(row.as_flattened());
            // GStreamer's rows of three bytes a pixel begin at multiples of four.
            bytes.resize(bytes.len().next_multiple_of(4), 77);
        }
    }
    let file = temporary("frames.rgb");
    std::fs::write(file.path(), bytes).unwrap();
    SceneFile { file, size }
}

impl SceneFile {
    /// A pipeline that reads it, in this format.
    pub(crate) fn source(&self, format: &str) -> String {
        let (width, height) = self.size;
        let place = self.file.path().display();
        let convert = if format == "RGB" { "" } else { "videoconvert ! " };
        format!(
            "filesrc location={place} ! rawvideoparse format=rgb width={width} height={height} framerate=30/1 ! {convert}video/x-raw,format={format}"
        )
    }
}

/// A frame as it lies in memory.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frame {
    info: gst_video::VideoInfo,
    pub(crate) strides: Vec<usize>,
    planes: Vec<Vec<u8>>,
}

impl Frame {
    fn new(buffer: &gst::BufferRef, info: &gst_video::VideoInfo) -> Self {
        let frame = gst_video::VideoFrameRef::from_buffer_ref_readable(buffer, info).unwrap();
        let planes = (0..frame.n_planes()).map(|plane| frame.plane_data(plane).unwrap().to_vec()).collect();
        let strides = frame.plane_stride().iter().map(|&stride| stride as usize).collect();
        Self { info: info.clone(), strides, planes }
    }

    fn size(&self) -> (usize, usize) {
        (self.info.width() as usize, self.info.height() as usize)
    }

    /// Where a component of a pixel lies in its plane.
    fn place(&self, component: u8, x: usize, y: usize) -> (usize, usize) {
        let format = self.info.format_info();
        let (at, plane) = (usize::from(component), format.plane()[usize::from(component)] as usize);
        let (x, y) = (x >> format.w_sub()[at], y >> format.h_sub()[at]);
        let offset = format.poffset()[at] as usize;
        (plane, y * self.strides[plane] + x * format.pixel_stride()[at] as usize + offset)
    }

    fn get(&self, component: u8, x: usize, y: usize) -> u8 {
        let (plane, at) = self.place(component, x, y);
        self.planes[plane][at]
    }

    fn is_yuv(&self) -> bool {
        self.info.is_yuv()
    }

    /// Kr and Kb; luma of black; steps of luma and of chroma.
    fn matrix(&self) -> ([f64; 3], f64, [f64; 2]) {
        let colorimetry = self.info.colorimetry();
        let (kr, kb) = colorimetry.matrix().kr_kb().unwrap();
        let is_full = colorimetry.range() == gst_video::VideoColorRange::Range0_255;
        let (black, steps) = if is_full { (0.0, [255.0, 255.0]) } else { (16.0, [219.0, 224.0]) };
        ([kr, 1.0 - kr - kb, kb], black, steps)
    }

    /// The frame in red, green and blue, chroma taken for each of its pixels.
    pub(crate) fn rgb(&self) -> Image<u8> {
        let (width, height) = self.size();
        let mut samples = Vec::with_capacity(3 * width * height);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let own: [u8; 3] = [0, 1, 2].map(|component| self.get(component, x, y));
            samples.extend(if self.is_yuv() { self.colour(own) } else { own });
        }
        Image::from_raw(width, height, samples).unwrap()
    }

    fn colour(&self, [y, u, v]: [u8; 3]) -> [u8; 3] {
        let ([kr, kg, kb], black, [luma, chroma]) = self.matrix();
        let y = (f64::from(y) - black) * 255.0 / luma;
        let [u, v] = [u, v].map(|value| (f64::from(value) - 128.0) * 255.0 / chroma);
        let (red, blue) = (y + 2.0 * (1.0 - kr) * v, y + 2.0 * (1.0 - kb) * u);
        [red, (y - kr * red - kb * blue) / kg, blue].map(|value| value.round().clamp(0.0, 255.0) as u8)
    }

    /// The frame with the difference of these colours from its own added, in floats.
    pub(crate) fn with_colours(&self, image: &Image<u8>) -> Self {
        let ([kr, kg, kb], _, [luma, chroma]) = self.matrix();
        let own = self.rgb();
        let (width, height) = self.size();
        let difference = |x: usize, y: usize| -> [f64; 3] {
            let step: [f64; 3] =
                std::array::from_fn(|c| f64::from(image.row(y)[x][c]) - f64::from(own.row(y)[x][c]));
            let y = kr * step[0] + kg * step[1] + kb * step[2];
            [y, (step[2] - y) / (2.0 * (1.0 - kb)), (step[0] - y) / (2.0 * (1.0 - kr))]
        };
        let mut frame = self.clone();
        let mut add = |component: u8, x: usize, y: usize, step: f64| {
            let (plane, at) = self.place(component, x, y);
            frame.planes[plane][at] =
                (f64::from(self.planes[plane][at]) + step).round().clamp(0.0, 255.0) as u8;
        };
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            add(0, x, y, difference(x, y)[0] * luma / 255.0);
            if x % 2 == 0 && y % 2 == 0 {
                let block: Vec<[f64; 3]> = (y..(y + 2).min(height))
                    .flat_map(|y| (x..(x + 2).min(width)).map(move |x| (x, y)))
                    .map(|(x, y)| difference(x, y))
                    .collect();
                for component in [1, 2] {
                    let sum: f64 = block.iter().map(|step| step[usize::from(component)]).sum();
                    add(component, x, y, sum / block.len() as f64 * chroma / 255.0);
                }
            }
        }
        frame
    }

    /// The largest and the mean difference of components.
    pub(crate) fn distance(&self, other: &Self) -> (u8, f64) {
        let (width, height) = self.size();
        let (mut worst, mut sum) = (0, 0.0);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            for component in 0..3 {
                let step = self.get(component, x, y).abs_diff(other.get(component, x, y));
                (worst, sum) = (worst.max(step), sum + f64::from(step));
            }
        }
        (worst, sum / (3 * width * height) as f64)
    }

    /// The bytes that are neither red, green nor blue of a pixel.
    pub(crate) fn others(&self) -> Vec<u8> {
        let (width, height) = self.size();
        let mut is_colour = vec![false; self.planes[0].len()];
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            (0..3).for_each(|component| is_colour[self.place(component, x, y).1] = true);
        }
        self.planes[0].iter().zip(is_colour).filter(|(_, is)| !is).map(|(byte, _)| *byte).collect()
    }
}

type Act = (usize, Box<dyn Fn(&gst::Element) + Send + Sync>);

/// A pipeline with the element between a source and a sink.
pub(crate) struct Run {
    pipeline: gst::Pipeline,
    element: gst::Element,
    acts: Vec<Act>,
    stride: Option<usize>,
}

/// What went in, what came out, and what was said.
#[derive(Default)]
pub(crate) struct Ran {
    pub(crate) before: Vec<Frame>,
    pub(crate) after: Vec<Frame>,
    pub(crate) errors: Vec<String>,
    pub(crate) warnings: Vec<String>,
}

impl Run {
    pub(crate) fn new(source: &str, properties: &str) -> Self {
        let text = format!("{source} ! aquafuse name=ours {properties} ! fakesink sync=false");
        let pipeline = gst::parse::launch(&text).unwrap().downcast::<gst::Pipeline>().unwrap();
        let element = pipeline.by_name("ours").unwrap();
        Self { pipeline, element, acts: Vec::new(), stride: None }
    }

    /// Does something just before this frame enters.
    pub(crate) fn at_frame(
        mut self,
        frame: usize,
        act: impl Fn(&gst::Element) + Send + Sync + 'static,
    ) -> Self {
        self.acts.push((frame, Box::new(act)));
        self
    }

    /// Lays the rows of each frame so many bytes apart, with what an in-place change should leave in between.
    pub(crate) fn with_stride(mut self, stride: usize) -> Self {
        self.stride = Some(stride);
        self
    }

    pub(crate) fn run_to_end(self) -> Ran {
        self.until(|_| false)
    }

    /// Runs to the end of the source, to an error, or until enough has come out.
    fn until(self, is_enough: impl Fn(usize) -> bool) -> Ran {
        let Self { pipeline, element, acts, stride } = self;
        let seen = Arc::new(Mutex::new([Vec::new(), Vec::new()]));
        let (into, out) = (seen.clone(), seen.clone());
        let weak = element.downgrade();
        element.static_pad("sink").unwrap().add_probe(gst::PadProbeType::BUFFER, move |pad, probe| {
            let info = info_of(pad);
            if let (Some(stride), Some(gst::PadProbeData::Buffer(buffer))) = (stride, &mut probe.data) {
                *buffer = laid_out(buffer, &info, stride);
            }
            let count = into.lock().unwrap()[0].len();
            if let Some(element) = weak.upgrade() {
                acts.iter().filter(|(frame, _)| *frame == count).for_each(|(_, act)| act(&element));
            }
            if let Some(gst::PadProbeData::Buffer(buffer)) = &probe.data {
                into.lock().unwrap()[0].push(Frame::new(buffer, &info));
            }
            gst::PadProbeReturn::Ok
        });
        element.static_pad("src").unwrap().add_probe(gst::PadProbeType::BUFFER, move |pad, probe| {
            if let Some(gst::PadProbeData::Buffer(buffer)) = &probe.data {
                out.lock().unwrap()[1].push(Frame::new(buffer, &info_of(pad)));
            }
            gst::PadProbeReturn::Ok
        });
        let mut ran = Ran::default();
        let bus = pipeline.bus().unwrap();
        let _ = pipeline.set_state(gst::State::Playing);
        // Half a minute without a message is a pipeline that hangs.
        let mut patience = 300;
        while patience > 0 {
            if is_enough(seen.lock().unwrap()[1].len()) {
                break;
            }
            let Some(message) = bus.timed_pop(gst::ClockTime::from_mseconds(100)) else {
                patience -= 1;
                continue;
            };
            match message.view() {
                gst::MessageView::Eos(_) => break,
                gst::MessageView::Error(error) => {
                    ran.errors.push(error.error().to_string() + &error.debug().unwrap_or_default());
                    break;
                }
                gst::MessageView::Warning(warning) => {
                    ran.warnings.push(warning.error().to_string() + &warning.debug().unwrap_or_default());
                }
                _ => {}
            }
        }
        pipeline.set_state(gst::State::Null).unwrap();
        assert!(patience > 0, "the pipeline hangs");
        [ran.before, ran.after] = std::mem::take(&mut *seen.lock().unwrap());
        ran
    }
}

fn info_of(pad: &gst::Pad) -> gst_video::VideoInfo {
    gst_video::VideoInfo::from_caps(&pad.current_caps().unwrap()).unwrap()
}

/// The same frame in rows so many bytes apart, which the buffer says by its meta.
fn laid_out(buffer: &gst::Buffer, info: &gst_video::VideoInfo, stride: usize) -> gst::Buffer {
    let frame = Frame::new(buffer, info);
    let (width, height) = frame.size();
    let mut bytes: Vec<u8> = (0..stride * height).map(|at| (at % 251) as u8).collect();
    let own = frame.planes[0].chunks(frame.strides[0]);
    bytes
        .chunks_mut(stride)
        .zip(own)
        .for_each(|(row, own)| row[..3 * width].copy_from_slice(&own[..3 * width]));
    let mut laid = gst::Buffer::from_mut_slice(bytes);
    let meta = laid.get_mut().unwrap();
    meta.set_pts(buffer.pts());
    let (flags, format) = (gst_video::VideoFrameFlags::empty(), info.format());
    gst_video::VideoMeta::add_full(meta, flags, format, info.width(), info.height(), &[0], &[stride as i32])
        .unwrap();
    laid
}

/// A camera that sends JPEG by RTP to this machine, received and changed until so many frames have come out.
pub(crate) fn over_rtp(properties: &str, frames: usize) -> Ran {
    let caps = "application/x-rtp,media=video,encoding-name=JPEG,payload=26,clock-rate=90000";
    let source =
        format!("udpsrc name=receiver port=0 address=127.0.0.1 caps={caps} ! rtpjpegdepay ! jpegdec");
    let run = Run::new(&source, properties);
    // Once it is ready it has a port.
    run.pipeline.set_state(gst::State::Ready).unwrap();
    let port: i32 = run.pipeline.by_name("receiver").unwrap().property("port");
    let camera = gst::parse::launch(&format!(
        "videotestsrc is-live=true pattern=ball ! video/x-raw,format=I420,width=320,height=240,framerate=30/1 ! jpegenc ! rtpjpegpay ! udpsink host=127.0.0.1 port={port}"
    ));
    let camera = camera.unwrap();
    camera.set_state(gst::State::Playing).unwrap();
    let ran = run.until(|count| count >= frames);
    camera.set_state(gst::State::Null).unwrap();
    ran
}
