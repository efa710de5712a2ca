//! The element in real pipelines. Its frames are compared with those of the core's stream, byte for byte.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod common;

use aquafuse::image::{Image, ImageMut};
use aquafuse::stream::{EnhanceStream, RestoreStream, Stream};
use common::{Frame, Run, missing, reference_stream, scene_file, skip};
use gst::prelude::*;

/// A width whose rows GStreamer pads, and a height that chroma does not divide.
const ODD: (u32, u32) = (101, 67);

/// The core's stream over frames in red, green and blue.
fn fused(frames: &[Frame], mut stream: Stream<'static>) -> Vec<Image<u8>> {
    let each = frames.iter().map(|frame| {
        let mut image = frame.rgb();
        stream.fuse_mut(&mut image).unwrap();
        image
    });
    each.collect()
}

#[test]
fn packed_frames_are_those_of_the_cores_stream() {
    if let Some(why) = missing(&["filesrc", "rawvideoparse", "videoconvert"]) {
        return skip(&why);
    }
    for format in ["RGB", "BGR", "RGBx", "BGRx", "RGBA", "BGRA", "xRGB"] {
        let file = scene_file(ODD, 4);
        let run = Run::new(&file.source(format), "water=preset:jerlov-3C").run_to_end();
        assert_eq!(run.errors, [""; 0]);
        assert_eq!((run.before.len(), run.after.len()), (4, 4), "{format}");
        let expected = fused(&run.before, reference_stream("preset:jerlov-3C"));
        for ((before, after), expected) in run.before.iter().zip(&run.after).zip(&expected) {
            assert_eq!(&after.rgb(), expected, "{format}");
            assert_ne!(after.rgb(), before.rgb(), "{format}");
            assert_eq!(after.others(), before.others(), "{format}: padding and opacity stay");
        }
    }
}

#[test]
fn any_stride_of_a_buffer_is_kept() {
    if let Some(why) = missing(&["filesrc", "rawvideoparse"]) {
        return skip(&why);
    }
    let file = scene_file(ODD, 3);
    let run = Run::new(&file.source("RGB"), "water=preset:jerlov-3C").with_stride(3 * 101 + 29).run_to_end();
    let expected = fused(&run.before, reference_stream("preset:jerlov-3C"));
    assert_eq!(expected.len(), 3);
    for ((before, after), expected) in run.before.iter().zip(&run.after).zip(&expected) {
        assert_eq!(after.strides[0], 3 * 101 + 29);
        assert_eq!(&after.rgb(), expected);
        assert_eq!(after.others(), before.others());
    }
}

#[test]
fn luma_and_chroma_change_by_what_changes_of_the_colours() {
    if let Some(why) = missing(&["filesrc", "rawvideoparse", "videoconvert"]) {
        return skip(&why);
    }
    for (format, colorimetry) in [("NV12", "bt709"), ("I420", "bt601"), ("I420", "1:4:7:1")] {
        let file = scene_file(ODD, 3);
        let source = format!("{},colorimetry={colorimetry}", file.source(format));
        let run = Run::new(&source, "water=preset:jerlov-3C").run_to_end();
        let expected = fused(&run.before, reference_stream("preset:jerlov-3C"));
        assert_eq!(expected.len(), 3, "{:?}", run.errors);
        for ((before, after), expected) in run.before.iter().zip(&run.after).zip(&expected) {
            // What the frame would be if its colours, by the equations in floats, were those of the core.
            let (worst, mean) = after.distance(&before.with_colours(expected));
            assert!(worst <= 2 && mean < 0.4, "{format} {colorimetry}: {worst} at worst, {mean} on average");
            assert!(after.distance(before).1 > 2.0, "{format} {colorimetry}: it changes");
        }
        // At 90 degrees nothing changes, not even by rounding.
        let run = Run::new(&source, "water=preset:jerlov-3C theta=90").run_to_end();
        assert_eq!(run.after, run.before, "{format} {colorimetry}");
    }
}

#[test]
fn restoration_and_enhancement_are_those_of_the_core() {
    if let Some(why) = missing(&["filesrc", "rawvideoparse"]) {
        return skip(&why);
    }
    let file = scene_file((96, 64), 4);
    let restored = Run::new(&file.source("RGB"), "effect=restore steady-over=3").run_to_end();
    let mut stream = RestoreStream::default().steady_over(3);
    for (before, after) in restored.before.iter().zip(&restored.after) {
        let mut image = before.rgb();
        stream.restore_mut(&mut image).unwrap();
        assert_eq!(after.rgb(), image);
    }
    let enhanced = Run::new(&file.source("RGB"), "effect=enhance strength=0.5").run_to_end();
    let mut stream =
        EnhanceStream::default().levels(aquafuse::levels::LevelsOptions::default().with_strength(0.5));
    for (before, after) in enhanced.before.iter().zip(&enhanced.after) {
        let mut image = before.rgb();
        stream.enhance_mut(&mut image).unwrap();
        assert_eq!(after.rgb(), image);
        assert_ne!(after, before);
    }
    assert_eq!((restored.after.len(), enhanced.after.len()), (4, 4));
}

#[test]
fn properties_change_while_frames_come() {
    if let Some(why) = missing(&["videotestsrc"]) {
        return skip(&why);
    }
    let source = "videotestsrc num-buffers=50 pattern=smpte ! video/x-raw,format=RGB,width=64,height=48";
    let run = Run::new(source, "water=preset:jerlov-3C")
        .at_frame(10, |element| element.set_property("theta", 90.0_f32))
        .at_frame(20, |element| element.set_property_from_str("effect", "none"))
        .at_frame(30, |element| element.set_property_from_str("effect", "enhance"))
        .at_frame(40, |element| {
            element.set_property_from_str("effect", "fuse");
            element.set_property("theta", 0.0_f32);
        })
        .run_to_end();
    assert_eq!(run.after.len(), 50, "{:?}", run.errors);
    let changed: Vec<bool> =
        run.before.iter().zip(&run.after).map(|(before, after)| before != after).collect();
    let expected: Vec<bool> = (0..50).map(|frame| !(10..30).contains(&frame)).collect();
    assert_eq!(changed, expected);
}

#[test]
fn a_water_that_is_missing_is_an_error_with_its_remedy() {
    if let Some(why) = missing(&["videotestsrc"]) {
        return skip(&why);
    }
    let source = "videotestsrc num-buffers=5 ! video/x-raw,format=RGB,width=64,height=48";
    for (properties, said) in [
        ("", "no water is set; set the property water"),
        ("water=nowhere.water.json", "nowhere.water.json"),
        ("water=nowhere.jpg", "nowhere.jpg"),
        ("water=preset:tea", "the presets are"),
        ("water=sea:x", "write sea:NUMBER"),
        ("water=sea:1 content-water=frame.png", "water extract"),
        ("water=sea:1 content-water=sea:2 one-water=true", "leave one of them out"),
    ] {
        let run = Run::new(source, properties).run_to_end();
        assert!(run.errors.iter().any(|error| error.contains(said)), "{properties}: {:?}", run.errors);
        assert!(run.after.is_empty());
    }
}

#[test]
fn a_wrong_water_while_playing_is_a_warning_and_frames_go_on() {
    if let Some(why) = missing(&["videotestsrc"]) {
        return skip(&why);
    }
    let source = "videotestsrc num-buffers=8 ! video/x-raw,format=RGB,width=64,height=48";
    let run = Run::new(source, "water=preset:jerlov-3C")
        .at_frame(4, |element| element.set_property("water", "nowhere.water.json"))
        .run_to_end();
    assert_eq!(run.errors, [""; 0]);
    assert!(run.warnings.iter().any(|warning| warning.contains("nowhere.water.json")), "{:?}", run.warnings);
    let expected = fused(&run.before, reference_stream("preset:jerlov-3C"));
    assert_eq!(run.after.iter().map(Frame::rgb).collect::<Vec<_>>(), expected);
    assert_eq!(expected.len(), 8);
}

#[test]
fn one_water_is_pooled_of_the_first_frames_and_kept() {
    if let Some(why) = missing(&["filesrc", "rawvideoparse"]) {
        return skip(&why);
    }
    let frames = gstaquafuse::effect::POOLED + 4;
    let file = scene_file((64, 48), frames);
    let run = Run::new(&file.source("RGB"), "water=sea:7 one-water=true").run_to_end();
    let mut stream = reference_stream("sea:7");
    let mut waters = Vec::new();
    for (i, (before, after)) in run.before.iter().zip(&run.after).enumerate() {
        if i == gstaquafuse::effect::POOLED {
            stream = stream.content_water(aquafuse::waterbody::pool(&waters).unwrap());
        }
        let mut image = before.rgb();
        waters.push(stream.fuse_mut(&mut image).unwrap().content);
        assert_eq!(after.rgb(), image, "frame {i}");
    }
    assert_eq!(run.after.len(), frames);
}

#[test]
fn frames_are_dropped_only_where_a_sink_says_that_they_are_late() {
    if let Some(why) = missing(&["videotestsrc"]) {
        return skip(&why);
    }
    let source = "videotestsrc num-buffers=10 ! video/x-raw,format=RGB,width=64,height=48,framerate=30/1";
    let late = |element: &gst::Element| {
        let day = 86_400_000_000_000;
        let event = gst::event::Qos::builder(gst::QOSType::Underflow, 2.0, day)
            .timestamp(gst::ClockTime::ZERO)
            .build();
        assert!(element.static_pad("src").unwrap().send_event(event));
    };
    let run = Run::new(source, "water=sea:1").at_frame(5, late).run_to_end();
    assert_eq!(run.after.len(), 5);
    let run = Run::new(source, "water=sea:1 qos=false").at_frame(5, late).run_to_end();
    assert_eq!(run.after.len(), 10);
}

#[test]
fn a_camera_over_rtp_is_changed_live() {
    let needed = ["videotestsrc", "jpegenc", "rtpjpegpay", "udpsink", "udpsrc", "rtpjpegdepay", "jpegdec"];
    if let Some(why) = missing(&needed) {
        return skip(&why);
    }
    let run = common::over_rtp("water=preset:jerlov-3C", 12);
    assert_eq!(run.errors, [""; 0]);
    assert!(run.after.len() >= 12, "{} frames", run.after.len());
    assert!(run.before.iter().zip(&run.after).all(|(before, after)| before != after));
}

#[test]
fn the_plug_in_is_found_by_the_tools_of_gstreamer() {
    let inspect = std::process::Command::new("gst-inspect-1.0").arg("--version").output();
    if inspect.is_err() {
        return skip("gst-inspect-1.0 is not installed");
    }
    let exe = std::env::current_exe().unwrap();
    // Tests link the library where it was built; `cargo build` also lays it one folder up.
    let folder = exe.parent().unwrap();
    let registry = common::temporary("registry");
    let output = std::process::Command::new("gst-inspect-1.0")
        .env("GST_PLUGIN_PATH", folder)
        .env("GST_REGISTRY", registry.path())
        .arg("aquafuse")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for word in ["content-water", "one-water", "NV12", "BGRx", "jerlov", "preset:NAME"] {
        assert!(word == "jerlov" || said.contains(word), "{word} is not in {said}");
    }
}

#[test]
fn a_short_buffer_is_an_error_and_no_panic() {
    gst::init().unwrap();
    let info = gst_video::VideoInfo::builder(gst_video::VideoFormat::Rgb, 8, 8).build().unwrap();
    let mut pixels = gstaquafuse::pixels::Pixels::new(&info).unwrap();
    let mut buffer = gst::Buffer::with_size(info.size()).unwrap();
    let mut frame =
        gst_video::VideoFrameRef::from_buffer_ref_writable(buffer.get_mut().unwrap(), &info).unwrap();
    let larger = gst_video::VideoInfo::builder(gst_video::VideoFormat::Rgb, 8, 9).build().unwrap();
    assert_eq!(pixels.change(&mut frame, |image| Ok(image.height())), Ok(8));
    let mut pixels = gstaquafuse::pixels::Pixels::new(&larger).unwrap();
    assert!(pixels.change(&mut frame, |_: ImageMut<'_, u8>| Ok(())).is_err());
}
