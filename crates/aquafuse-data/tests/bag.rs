//! Logs of robots: images change, everything else stays.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

#[path = "bag/depth.rs"]
mod depth;
#[cfg(feature = "onnx")]
#[path = "bag/network.rs"]
mod network;
#[cfg(feature = "onnx")]
#[allow(dead_code, reason = "other tests use what is not used here")]
mod onnx;

use std::collections::BTreeMap;
use std::path::Path;

use aquafuse::image::Image;
use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::bag::{self, BagError, Request, Summary};
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use aquafuse_data::pipeline::Operation;
use aquafuse_data::video::Recipe;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, MessageStream, WriteOptions};

const SIZE: (u32, u32) = (64, 48);
const FRAMES: u64 = 4;

fn seen(seed: u64) -> Image<u8> {
    let size = Size { width: SIZE.0 as usize, height: SIZE.1 as usize };
    Scene::new(seed, size).seen_through(&waters()[0].water).convert()
}

/// Writes fields as ROS does.
struct Fields {
    bytes: Vec<u8>,
    is_aligned: bool,
}

impl Fields {
    fn header(is_aligned: bool) -> Self {
        Self::header_at(is_aligned, 5)
    }

    fn header_at(is_aligned: bool, nanoseconds: u32) -> Self {
        let mut fields = Self { bytes: if is_aligned { vec![0, 1, 0, 0] } else { Vec::new() }, is_aligned };
        if !is_aligned {
            fields.number(7);
        }
        fields.number(1_700_000_000);
        fields.number(nanoseconds);
        // Eight letters and a zero: what follows is not aligned by chance.
        fields.text("cam_left");
        fields
    }

    fn number(&mut self, number: u32) {
        while self.is_aligned && !(self.bytes.len() - 4).is_multiple_of(4) {
            self.bytes.push(0);
        }
        self.bytes.extend(number.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        let zero = usize::from(self.is_aligned);
        self.number((text.len() + zero) as u32);
        self.bytes.extend(text.bytes());
        self.bytes.extend(vec![0; zero]);
    }

    fn block(mut self, data: &[u8]) -> Vec<u8> {
        self.number(data.len() as u32);
        self.bytes.extend(data);
        self.bytes
    }
}

/// `sensor_msgs/Image` with three bytes beyond each row.
fn raw(image: &Image<u8>, encoding: &str, is_aligned: bool) -> Vec<u8> {
    let mut fields = Fields::header(is_aligned);
    fields.number(SIZE.1);
    fields.number(SIZE.0);
    fields.text(encoding);
    fields.bytes.push(0);
    let step = 3 * SIZE.0 + 3;
    fields.number(step);
    let mut data = Vec::new();
    for row in image.pixels().chunks(SIZE.0 as usize) {
        for [red, green, blue] in row {
            data.extend(if encoding == "bgr8" { [blue, green, red] } else { [red, green, blue] });
        }
        data.extend([9, 9, 9]);
    }
    fields.block(&data)
}

fn packed(image: &Image<u8>, name: &str) -> Vec<u8> {
    let mut fields = Fields::header(true);
    fields.text(name);
    fields.block(&ImageFile::new(image.clone()).encode(&Path::new("x").with_extension(name), 95).unwrap())
}

fn foxglove(image: &Image<u8>) -> Vec<u8> {
    let file = ImageFile::new(image.clone()).encode("x.png".as_ref(), 95).unwrap();
    let mut message = vec![0x0a, 2, 0x08, 3, 0x22, 3, b'c', b'a', b'm', 0x12];
    let mut length = file.len();
    while length >= 128 {
        message.push((length & 127) as u8 | 128);
        length >>= 7;
    }
    message.push(length as u8);
    message.extend(file);
    message.extend([0x1a, 3, b'p', b'n', b'g']);
    message
}

const TOPICS: [(&str, &str, &str); 7] = [
    ("/rgb", "sensor_msgs/msg/Image", "cdr"),
    ("/bgr", "sensor_msgs/Image", "ros1"),
    ("/jpeg", "sensor_msgs/msg/CompressedImage", "cdr"),
    ("/foxglove", "foxglove.CompressedImage", "protobuf"),
    ("/mono", "sensor_msgs/msg/Image", "cdr"),
    ("/imu", "sensor_msgs/msg/Imu", "cdr"),
    ("/broken", "sensor_msgs/msg/Image", "cdr"),
];

fn message(topic: &str, seed: u64) -> Vec<u8> {
    let image = seen(seed);
    match topic {
        "/rgb" => raw(&image, "rgb8", true),
        "/bgr" => raw(&image, "bgr8", false),
        "/jpeg" => packed(&image, "jpg"),
        "/foxglove" => foxglove(&image),
        "/mono" => raw(&image, "mono8", true),
        "/imu" => (0..200).map(|i| (i * seed) as u8).collect(),
        _ => raw(&image, "rgb8", true)[..900].to_vec(),
    }
}

fn write(path: &Path, topics: &[&str], compression: Option<Compression>) {
    let file = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
    let options = WriteOptions::new().profile("ros2").compression(compression).chunk_size(Some(40_000));
    let mut writer = options.create(file).unwrap();
    let mut channels = BTreeMap::new();
    for (number, (topic, schema, encoding)) in
        TOPICS.iter().enumerate().filter(|(_, (topic, ..))| topics.contains(topic))
    {
        let number = 11 + 3 * number as u16;
        writer.add_schema_with_id(number, schema, "ros2msg", b"uint8 x").unwrap();
        let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), "- history: 3".to_owned())]);
        channels.insert(
            *topic,
            writer.add_channel_with_id(number + 1, number, topic, encoding, &metadata).unwrap(),
        );
    }
    for frame in 0..FRAMES {
        for (topic, channel) in &channels {
            let time = 1_000_000 * frame;
            let header = MessageHeader {
                channel_id: *channel,
                sequence: frame as u32,
                log_time: time,
                publish_time: time + 3,
            };
            writer.write_to_known_channel(&header, &message(topic, frame + 1)).unwrap();
        }
    }
    let attachment = Attachment {
        log_time: 3,
        create_time: 4,
        name: "notes.txt".into(),
        media_type: "text/plain".into(),
        data: b"visibility 4 m".as_slice().into(),
    };
    writer.attach(&attachment).unwrap();
    let metadata =
        Metadata { name: "dive".into(), metadata: BTreeMap::from([("place".into(), "reef".into())]) };
    writer.write_metadata(&metadata).unwrap();
    writer.finish().unwrap();
}

fn enhance(input: &Path, output: &Path) -> Result<Summary, BagError> {
    let recipe = Recipe::new(Operation::Enhance { levels: Default::default() });
    bag::change(&Request::new(input, output), &recipe, &Default::default(), &mut || ())
}

/// Topic, times and data of each message.
fn messages(path: &Path) -> Vec<(String, u32, u64, u64, Vec<u8>)> {
    let bytes = std::fs::read(path).unwrap();
    let each = MessageStream::new(&bytes).unwrap().map(|message| {
        let message = message.unwrap();
        let data = message.data.to_vec();
        (message.channel.topic.clone(), message.sequence, message.log_time, message.publish_time, data)
    });
    each.collect()
}

/// Number, schema and channel of each channel, as text.
fn declared(summary: &mcap::Summary) -> BTreeMap<u16, String> {
    let text = |channel: &mcap::Channel<'_>| {
        let schema =
            channel.schema.as_ref().map(|schema| (schema.id, &schema.name, &schema.encoding, &schema.data));
        format!("{schema:?} {} {} {:?}", channel.topic, channel.message_encoding, channel.metadata)
    };
    summary.channels.iter().map(|(number, channel)| (*number, text(channel))).collect()
}

#[test]
fn images_change_and_everything_else_stays() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.mcap"), folder.path().join("out.mcap"));
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let _ = std::fs::remove_file(&output);
        write(&input, &TOPICS.map(|(topic, ..)| topic), compression);
        let summary = enhance(&input, &output).unwrap();
        assert_eq!(summary.messages, FRAMES * TOPICS.len() as u64);
        let counts: BTreeMap<&str, [u64; 3]> = summary
            .topics
            .iter()
            .map(|topic| (topic.name.as_str(), [topic.changed, topic.kept, topic.damaged]))
            .collect();
        assert_eq!(counts["/mono"], [0, FRAMES, 0]);
        assert_eq!(counts["/broken"], [0, 0, FRAMES]);
        assert!(["/rgb", "/bgr", "/jpeg", "/foxglove"].iter().all(|topic| counts[topic] == [FRAMES, 0, 0]));
        assert!(!counts.contains_key("/imu") && summary.cut.is_none());

        let (before, after) = (messages(&input), messages(&output));
        assert_eq!(before.len(), after.len());
        for (before, after) in before.iter().zip(&after) {
            assert_eq!((&before.0, before.1, before.2, before.3), (&after.0, after.1, after.2, after.3));
            let is_image = counts.get(before.0.as_str()).is_some_and(|[changed, ..]| *changed > 0);
            assert_eq!(before.4 != after.4, is_image, "{}", before.0);
        }
        let [a, b] = [&input, &output].map(|path| std::fs::read(path).unwrap());
        let [a, b] = [&a, &b].map(|bytes| mcap::Summary::read(bytes).unwrap().unwrap());
        assert_eq!(declared(&a), declared(&b));
        assert_eq!(a.attachment_indexes[0].name, b.attachment_indexes[0].name);
        assert_eq!((a.metadata_indexes.len(), b.metadata_indexes.len()), (1, 1));
    }
}

#[test]
fn each_kind_of_message_shows_the_same_image() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.mcap"), folder.path().join("out.mcap"));
    write(&input, &["/rgb", "/bgr", "/foxglove"], None);
    enhance(&input, &output).unwrap();
    let of = |topic: &str| -> Vec<Vec<u8>> {
        messages(&output).into_iter().filter(|(name, ..)| name == topic).map(|(.., data)| data).collect()
    };
    let (rgb, bgr, files) = (of("/rgb"), of("/bgr"), of("/foxglove"));
    for ((rgb, bgr), file) in rgb.iter().zip(&bgr).zip(&files) {
        let row = 3 * SIZE.0 as usize + 3;
        let rows = |data: &[u8]| data[data.len() - row * SIZE.1 as usize..].to_vec();
        let (rgb, bgr) = (rows(rgb), rows(bgr));
        for (one, other) in rgb.chunks(row).zip(bgr.chunks(row)) {
            assert_eq!(one[row - 3..], [9, 9, 9], "what lies beyond a row is no image");
            let turned: Vec<u8> =
                other[..row - 3].chunks(3).flat_map(|bgr| [bgr[2], bgr[1], bgr[0]]).collect();
            assert_eq!(one[..row - 3], turned);
        }
        let start = file.windows(4).position(|four| four == b"\x89PNG").unwrap();
        let decoded =
            ImageFile::from_bytes("m".as_ref(), &file[start..file.len() - 5], &ReadOptions::default())
                .unwrap();
        let plain: Vec<u8> = rgb.chunks(row).flat_map(|line| line[..row - 3].to_vec()).collect();
        assert_eq!(decoded.bytes().as_raw(), plain);
    }
}

#[test]
fn a_log_that_is_cut_keeps_its_whole_messages_and_a_damaged_one_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.mcap"), folder.path().join("out.mcap"));
    write(&input, &["/rgb", "/imu"], Some(Compression::Zstd));
    let whole = std::fs::read(&input).unwrap();
    for share in [40, 60, 80] {
        std::fs::write(&input, &whole[..whole.len() * share / 100]).unwrap();
        let _ = std::fs::remove_file(&output);
        match enhance(&input, &output) {
            Ok(summary) => {
                assert!(summary.cut.is_some());
                assert_eq!(messages(&output).len() as u64, summary.messages);
            }
            // Nothing with an image was whole.
            Err(error) => assert!(matches!(error, BagError::NoImages { .. }), "{error}"),
        }
    }
    let mut flipped = whole.clone();
    flipped[whole.len() / 3] ^= 0x40;
    std::fs::write(&input, &flipped).unwrap();
    let _ = std::fs::remove_file(&output);
    let error = enhance(&input, &output).unwrap_err();
    assert!(matches!(error, BagError::Damaged { .. }) && error.to_string().contains("in.mcap"), "{error}");
    assert!(!output.exists());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "a temporary file is left");
}

#[test]
fn what_is_no_log_or_has_no_images_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.mcap"), folder.path().join("out.mcap"));
    std::fs::write(&input, b"#ROSBAG V2.0\n and more").unwrap();
    assert!(matches!(enhance(&input, &output).unwrap_err(), BagError::Foreign { .. }));
    write(&input, &["/imu"], None);
    assert!(matches!(enhance(&input, &output).unwrap_err(), BagError::NoImages { .. }));
    write(&input, &["/imu", "/rgb"], None);
    let recipe = Recipe::new(Operation::Enhance { levels: Default::default() });
    let request = Request { topics: vec!["/rgbd".into()], ..Request::new(&input, &output) };
    let error = bag::change(&request, &recipe, &Default::default(), &mut || ()).unwrap_err();
    assert!(error.to_string().contains("/rgb"), "{error}");
    assert!(!output.exists());
    assert!(enhance(&input, &input).unwrap_err().to_string().contains("in.mcap"));
    assert_eq!(messages(&input).len() as u64, 2 * FRAMES);
}

/// A log that `rosbags` wrote is read back by `rosbags` and by `mcap`.
#[test]
fn other_readers_see_the_same_but_for_the_images() {
    const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bags.py");
    let Some(python) = std::env::var_os("AQUAFUSE_PYTHON") else {
        return eprintln!("skipped: AQUAFUSE_PYTHON names no Python");
    };
    let call = |arguments: &[&std::ffi::OsStr]| {
        let ended = std::process::Command::new(&python).args(arguments).output().unwrap();
        (ended.status.success(), String::from_utf8_lossy(&ended.stderr).into_owned())
    };
    if !call(&["-c".as_ref(), "import mcap, rosbags, PIL".as_ref()]).0 {
        return eprintln!("skipped: this Python has no mcap, rosbags or PIL");
    }
    let folder = tempfile::tempdir().unwrap();
    let [before, after] = ["before", "after"].map(|name| folder.path().join(name));
    let (is_written, said) = call(&[SCRIPT.as_ref(), "write".as_ref(), before.as_os_str()]);
    assert!(is_written, "{said}");
    std::fs::create_dir(&after).unwrap();
    std::fs::copy(before.join("metadata.yaml"), after.join("metadata.yaml")).unwrap();
    let [input, output] = [&before, &after].map(|folder| folder.join("before.mcap"));
    let summary = enhance(&input, &output).unwrap();
    assert!(
        summary.topics.len() == 2 && summary.topics.iter().all(|topic| topic.changed == 3),
        "{summary:?}"
    );
    let (is_same, said) = call(&[SCRIPT.as_ref(), "read".as_ref(), before.as_os_str(), after.as_os_str()]);
    assert!(is_same, "{said}");
}
