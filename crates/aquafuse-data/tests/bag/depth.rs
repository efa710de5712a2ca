//! Depth of another topic: matched by time, and used as a map from a file is.

use std::path::Path;
use std::time::Duration;

use aquafuse::depth::{Supplied, SuppliedKind};
use aquafuse::image::Image;
use aquafuse::stream::Steady;
use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::bag::{self, BagError, DepthTopic, Request, Summary};
use aquafuse_data::image_file::{ImageFile, Pixels};
use aquafuse_data::pipeline::{Operation, PixelEncoding, WaterEstimate, analyse_supplied};
use aquafuse_data::video::Recipe;
use mcap::WriteOptions;
use mcap::records::MessageHeader;

use super::{Fields, SIZE, messages};

const MILLISECOND: u32 = 1_000_000;
/// Images are this far apart; their depth is 4 ms older than they are, and is logged after them.
const APART: u32 = 100 * MILLISECOND;
const FRAMES: u32 = 4;
/// The image that has no depth.
const LONELY: u32 = 2;

fn scene(frame: u32) -> (Image<u8>, Vec<u32>) {
    let scene = Scene::new(u64::from(frame) + 1, Size { width: SIZE.0 as usize, height: SIZE.1 as usize });
    let millimetres =
        scene.depth.distances().iter().map(|z| (z * 1000.0).round().min(60_000.0) as u32).collect();
    (scene.seen_through(&waters()[0].water).convert(), millimetres)
}

fn image_at(frame: u32, encoding: &str, bytes: usize, data: &[u8]) -> Vec<u8> {
    let stamp = match encoding {
        "rgb8" => frame * APART + 10 * MILLISECOND,
        _ => frame * APART + 6 * MILLISECOND,
    };
    let mut fields = Fields::header_at(true, stamp);
    fields.number(SIZE.1);
    fields.number(SIZE.0);
    fields.text(encoding);
    // Words of depth begin with their largest digits, colours are bytes.
    fields.bytes.push(u8::from(encoding != "rgb8"));
    fields.number(SIZE.0 * bytes as u32);
    fields.block(data)
}

/// The head of `compressedDepth`, and a PNG of 16 bits.
fn compressed(frame: u32, millimetres: &[u32]) -> Vec<u8> {
    let words: Vec<u16> = millimetres.iter().map(|&z| z as u16).collect();
    let mut file = Vec::new();
    let grey = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(SIZE.0, SIZE.1, words).unwrap();
    grey.write_to(&mut std::io::Cursor::new(&mut file), image::ImageFormat::Png).unwrap();
    let mut fields = Fields::header_at(true, frame * APART + 6 * MILLISECOND);
    fields.text("16UC1; compressedDepth png");
    fields.block(&[&[0; 12][..], &file].concat())
}

fn write(path: &Path) {
    let mut writer = WriteOptions::new().create(std::fs::File::create(path).unwrap()).unwrap();
    let mut channel = |number: u16, topic: &str, schema: &str| {
        writer.add_schema_with_id(number, schema, "ros2msg", b"uint8 x").unwrap();
        writer.add_channel_with_id(number, number, topic, "cdr", &Default::default()).unwrap()
    };
    let channels = [
        channel(1, "/rgb", "sensor_msgs/msg/Image"),
        channel(2, "/millimetres", "sensor_msgs/msg/Image"),
        channel(3, "/metres", "sensor_msgs/msg/Image"),
        channel(4, "/compressed", "sensor_msgs/msg/CompressedImage"),
    ];
    for frame in 0..FRAMES {
        let (image, millimetres) = scene(frame);
        let words = |z: &u32| (*z as u16).to_be_bytes();
        let floats = |z: &u32| (*z as f32 / 1000.0).to_be_bytes();
        let all = [
            image_at(frame, "rgb8", 3, image.as_raw()),
            image_at(frame, "16UC1", 2, &millimetres.iter().flat_map(words).collect::<Vec<_>>()),
            image_at(frame, "32FC1", 4, &millimetres.iter().flat_map(floats).collect::<Vec<_>>()),
            compressed(frame, &millimetres),
        ];
        let with_depth = if frame == LONELY { 1 } else { all.len() };
        for (at, (data, channel_id)) in all.iter().zip(channels).take(with_depth).enumerate() {
            let time = u64::from(frame * APART) + 1_000 * at as u64;
            let header = MessageHeader { channel_id, sequence: frame, log_time: time, publish_time: time };
            writer.write_to_known_channel(&header, data).unwrap();
        }
    }
    writer.finish().unwrap();
}

fn recipe() -> Recipe {
    let reference = WaterEstimate::from(aquafuse::waterbody::Estimate::given(waters()[1].water));
    // As images are that come from no file.
    let border = aquafuse::scene_area::Border::None;
    Recipe { border, ..Recipe::new(Operation::Fuse { reference, options: Default::default() }) }
}

fn fuse(input: &Path, output: &Path, topic: &str, within: u64) -> Result<Summary, BagError> {
    let depth = DepthTopic { name: topic.into(), within: Duration::from_millis(within) };
    let request = Request { depth: Some(depth), overwrite: true, ..Request::new(input, output) };
    bag::change(&request, &recipe(), &Default::default(), &mut || ())
}

#[test]
fn images_are_fused_with_the_depth_that_is_nearest_in_time() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.mcap"), folder.path().join("out.mcap"));
    write(&input);
    let recipe = recipe();
    let mut steady = Steady::over(recipe.steady_over);
    let expected: Vec<Vec<u8>> = (0..FRAMES)
        .map(|frame| {
            let (image, millimetres) = scene(frame);
            if frame == LONELY {
                return image.into_raw();
            }
            let values = millimetres.iter().map(|&z| z as f32).collect();
            let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
            let map = Supplied::new(width, height, values, SuppliedKind::Millimetres).unwrap();
            let mut file = ImageFile::new(image);
            let found = analyse_supplied(PixelEncoding::Encoded, &file, map).unwrap();
            recipe.operation.apply_next(&mut file.pixels, Some(&found), &mut steady).unwrap();
            match file.pixels {
                Pixels::Bytes(layers) => layers.image.into_raw(),
                _ => unreachable!("it was made of bytes"),
            }
        })
        .collect();
    for topic in ["/millimetres", "/metres", "/compressed"] {
        let summary = fuse(&input, &output, topic, 5).unwrap();
        let rgb = summary.topics.iter().find(|topic| topic.name == "/rgb").unwrap();
        assert_eq!((rgb.changed, rgb.kept, rgb.damaged), (3, 1, 0), "{topic}: {rgb:?}");
        assert!(rgb.kept_for.as_ref().unwrap().contains("no depth within 5 ms"), "{rgb:?}");
        let (before, after) = (messages(&input), messages(&output));
        assert_eq!(before.len(), after.len());
        let mut frames = expected.iter();
        for (before, after) in before.iter().zip(&after) {
            if before.0 == "/rgb" {
                let expected = frames.next().unwrap();
                let data = &after.4[after.4.len() - expected.len()..];
                // A thousandth of a float is not a whole millimetre to the last bit.
                let worst = data.iter().zip(expected).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
                assert!(worst <= u8::from(topic == "/metres"), "{topic}, image {}: {worst}", before.1);
            } else {
                assert_eq!(before, after, "depth itself stays");
            }
        }
    }
}

#[test]
fn depth_that_is_missing_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.mcap"), folder.path().join("out.mcap"));
    write(&input);
    // The depth of each image is 4 ms away.
    let summary = fuse(&input, &output, "/metres", 3).unwrap();
    assert!(summary.topics.iter().all(|topic| topic.changed == 0), "{summary:?}");
    std::fs::remove_file(&output).unwrap();
    let error = fuse(&input, &output, "/sonar", 50).unwrap_err();
    assert!(matches!(error, BagError::NoDepth { .. }) && error.to_string().contains("/sonar"), "{error}");
    assert!(!output.exists());
    let error = fuse(&input, &output, "/rgb", 50).unwrap();
    let others = error.topics.iter().filter(|topic| topic.name != "/rgb");
    assert!(others.clone().count() == 3 && others.clone().all(|topic| topic.changed == 0));
}
