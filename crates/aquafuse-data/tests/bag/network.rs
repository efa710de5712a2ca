//! Depth by a network: the images of a topic are changed as the frames of a sequence are, within the memory of the run.

use std::path::Path;

use aquafuse_data::bag::{self, Request, Topic};
use aquafuse_data::depth_network::{DepthNetwork, NetworkKind, NetworkOptions};
use aquafuse_data::image_file::ReadOptions;
use aquafuse_data::pipeline::{DepthEstimator, Operation, WaterEstimate};
use aquafuse_data::run::RunOptions;
use aquafuse_data::video::Recipe;

use super::onnx::Network;
use super::{FRAMES, SIZE, messages, seen, waters, write};

/// Fusion by the mean of the channels, as depth.
fn recipe() -> Recipe {
    let mut options = NetworkOptions::default();
    (options.kind, options.side) = (Some(NetworkKind::Inverse), Some(56));
    let network = DepthNetwork::from_bytes("net.onnx".as_ref(), Network::MEAN.file(), &options).unwrap();
    let reference = WaterEstimate::from(aquafuse::waterbody::Estimate::given(waters()[1].water));
    let operation = Operation::Fuse { reference, options: Default::default() };
    Recipe { depth_model: DepthEstimator::Network(network), ..Recipe::new(operation) }
}

fn change(input: &Path, output: &Path, options: &RunOptions) -> Topic {
    let request = Request { overwrite: true, ..Request::new(input, output) };
    let summary = bag::change(&request, &recipe(), options, &mut || ()).unwrap();
    summary.topics.into_iter().find(|topic| topic.name == "/rgb").unwrap()
}

#[test]
fn images_of_a_topic_are_the_frames_of_a_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.mcap"), folder.path().join("out.mcap"));
    write(&input, &["/rgb", "/imu"], None);
    let topic = change(&input, &output, &RunOptions::default());
    assert_eq!((topic.changed, topic.kept, topic.damaged), (FRAMES, 0, 0), "{topic:?}");

    let by_colour = Recipe { depth_model: DepthEstimator::default(), ..recipe() };
    let [mut frames, mut of_colour] = [recipe(), by_colour].map(|recipe| recipe.frames::<u8>().unwrap());
    let row = 3 * SIZE.0 as usize + 3;
    for (_, number, _, _, data) in messages(&output).into_iter().filter(|message| message.0 == "/rgb") {
        let [mut frame, mut other] = [seen(u64::from(number) + 1), seen(u64::from(number) + 1)];
        let _ = frames.change(frame.view_mut()).unwrap();
        let _ = of_colour.change(other.view_mut()).unwrap();
        let rows = data[data.len() - row * SIZE.1 as usize..].chunks(row);
        let pixels: Vec<u8> = rows.flat_map(|row| row[..row.len() - 3].to_vec()).collect();
        assert!(pixels == *frame.as_raw() && pixels != *other.as_raw(), "image {number}");
    }
}

#[test]
fn images_stay_where_the_network_needs_more_memory_than_the_run_has() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.mcap"), folder.path().join("out.mcap"));
    write(&input, &["/rgb"], None);
    let mut options = RunOptions::default();
    options.reading = ReadOptions { max_memory: 1 << 20, ..options.reading };
    let topic = change(&input, &output, &options);
    assert_eq!((topic.changed, topic.kept), (0, FRAMES));
    assert!(topic.kept_for.as_ref().unwrap().contains("--max-memory"), "{topic:?}");
    assert_eq!(messages(&input), messages(&output));
}
