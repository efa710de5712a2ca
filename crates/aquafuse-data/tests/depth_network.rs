//! Networks of depth of one or two operators: what each gives is right, or refused by name.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod onnx;

use aquafuse::depth::{DepthKind, Supplied, SuppliedKind};
use aquafuse::image::{Image, TopEdge};
use aquafuse_data::depth_network::{DepthNetwork, NetworkKind, NetworkOptions};
use onnx::{FLOAT, INT64, Network, protobuf};

const WIDTH: usize = 56;
const HEIGHT: usize = 42;
/// Images keep their size: the root of 56 x 42, to the next patch.
const SIDE: u32 = 49;

/// Red and near at the bottom, blue and far at the top.
fn image() -> Image<u8> {
    let pixel = |i: usize| {
        let (x, y) = (i % WIDTH, i / WIDTH);
        [(40 + 4 * y + x % 3) as u8, (60 + 2 * y) as u8, (90 + y) as u8]
    };
    Image::from_raw(WIDTH, HEIGHT, (0..WIDTH * HEIGHT).flat_map(pixel).collect()).unwrap()
}

fn options(kind: Option<NetworkKind>) -> NetworkOptions {
    let mut options = NetworkOptions::default();
    (options.kind, options.side) = (kind, Some(SIDE));
    options
}

fn read(file: Vec<u8>, options: &NetworkOptions) -> Result<DepthNetwork, String> {
    DepthNetwork::from_bytes("net.onnx".as_ref(), file, options).map_err(|error| error.to_string())
}

/// What is said of the network or of its output.
fn refused(network: &Network<'_>, options: &NetworkOptions) -> String {
    let said = match read(network.file(), options) {
        Err(said) => said,
        Ok(network) => network.depth(&image(), TopEdge::First).expect_err("it is refused").to_string(),
    };
    assert!(said.starts_with("cannot use net.onnx as a depth model: "), "{said}");
    said
}

/// What a network should give: the mean over channels of the colours by ImageNet's mean and deviation.
fn mean_of_colours(image: &Image<u8>) -> Vec<f32> {
    let (mean, deviation) = ([0.485, 0.456, 0.406], [0.229, 0.224, 0.225]);
    let of = |pixel: &[u8; 3]| {
        (0..3).map(|c| (f32::from(pixel[c]) / 255.0 - mean[c]) / deviation[c]).fold(0.0, |a, b| a + b) / 3.0
    };
    image.pixels().iter().map(of).collect()
}

#[test]
fn the_output_is_used_as_the_same_map_supplied() {
    let network = read(Network::MEAN.file(), &options(None)).unwrap();
    assert_eq!(network.kind(), NetworkKind::Inverse);
    let found = network.depth(&image(), TopEdge::First).unwrap();
    let values = mean_of_colours(&image());
    let least = values.iter().copied().fold(f32::INFINITY, f32::min);
    let values = values.iter().map(|value| value - least).collect();
    let supplied = Supplied::new(WIDTH, HEIGHT, values, SuppliedKind::Inverse).unwrap();
    let expected = supplied.seen_with(&image(), TopEdge::First).unwrap();
    assert!(found.depth.is_inverse());
    for (found, expected) in found.depth.distances().iter().zip(expected.depth.distances()) {
        assert!((found - expected).abs() < 1e-4, "{found} is not {expected}");
    }
}

#[test]
fn a_network_sees_an_image_upright_whichever_edge_is_up() {
    // The height of a place in the image as the network sees it: a slope that does not turn with the colours.
    let slope: Vec<f64> = (0..14).flat_map(|y| [f64::from(y) + 1.0; 14]).collect();
    let constants = [
        ("slope", FLOAT, &[1, 1, 14, 14][..], &slope[..]),
        ("none", FLOAT, &[1], &[0.0]),
        ("axis", INT64, &[1], &[1.0]),
    ];
    let network = Network {
        input: ("image", &[1, 3, 14, 14]),
        nodes: &[
            ("Mul", &["image", "none"], "nothing", &[]),
            ("Add", &["nothing", "slope"], "sloping", &[]),
            ("ReduceMean", &["sloping", "axis"], "depth", &[]),
        ],
        constants: &constants,
        ..Network::MEAN
    };
    let network = read(network.file(), &NetworkOptions::default()).unwrap();
    for (top, near) in [
        (TopEdge::First, [WIDTH / 2, HEIGHT - 1]),
        (TopEdge::Last, [WIDTH / 2, 0]),
        (TopEdge::Left, [WIDTH - 1, HEIGHT / 2]),
        (TopEdge::Right, [0, HEIGHT / 2]),
    ] {
        let depth = network.depth(&image(), top).unwrap().depth;
        let far = [WIDTH - 1 - near[0], HEIGHT - 1 - near[1]];
        let (near, far) = (depth.at(near[0], near[1]), depth.at(far[0], far[1]));
        assert!(near < 0.2 && far > 0.8, "{top:?}: {near} {far}");
    }
}

#[test]
fn an_output_of_four_sides_and_of_another_size_is_scaled_from_its_own() {
    let four = Network {
        nodes: &[("ReduceMean", &["image", "channels"], "depth", &[("keepdims", 1)])],
        ..Network::MEAN
    };
    let pooled = Network {
        nodes: &[
            ("ReduceMean", &["image", "channels"], "mean", &[("keepdims", 1)]),
            ("Slice", &["mean", "from", "to", "axes", "steps"], "depth", &[]),
        ],
        constants: &[
            ("channels", INT64, &[1], &[1.0]),
            ("from", INT64, &[2], &[0.0, 0.0]),
            ("to", INT64, &[2], &[1e6, 1e6]),
            ("axes", INT64, &[2], &[2.0, 3.0]),
            ("steps", INT64, &[2], &[2.0, 3.0]),
        ],
        ..Network::MEAN
    };
    let whole =
        read(Network::MEAN.file(), &options(None)).unwrap().depth(&image(), TopEdge::First).unwrap().depth;
    for (network, within) in [(four, 1e-6), (pooled, 0.1)] {
        let found =
            read(network.file(), &options(None)).unwrap().depth(&image(), TopEdge::First).unwrap().depth;
        assert_eq!(found.size(), (WIDTH, HEIGHT));
        let pairs = found.distances().into_iter().zip(whole.distances());
        let sum = pairs.map(|(found, whole)| (found - whole).abs()).fold(0.0, |a, b| a + b);
        let mean = sum / (WIDTH * HEIGHT) as f32;
        assert!(mean < within, "{mean}");
    }
}

#[test]
fn metric_depth_is_in_metres() {
    let network = Network {
        nodes: &[
            ("ReduceMean", &["image", "channels"], "mean", &[("keepdims", 0)]),
            ("Exp", &["mean"], "metric_depth", &[]),
        ],
        outputs: &["metric_depth"],
        ..Network::MEAN
    };
    let network = read(network.file(), &options(None)).unwrap();
    assert_eq!(network.kind(), NetworkKind::Metric);
    let depth = network.depth(&image(), TopEdge::First).unwrap().depth;
    assert_eq!(depth.kind(), DepthKind::Metres);
    for (found, mean) in depth.distances().iter().zip(mean_of_colours(&image())) {
        assert!((found - mean.exp()).abs() < 1e-4, "{found}");
    }
}

#[test]
fn a_map_inverted_is_reported() {
    let report = |kind| {
        read(Network::MEAN.file(), &options(kind)).unwrap().depth(&image(), TopEdge::First).unwrap().report
    };
    assert!(!report(None).looks_inverted());
    let far = Network {
        nodes: &[
            ("ReduceMean", &["image", "channels"], "mean", &[("keepdims", 0)]),
            ("Neg", &["mean"], "depth", &[]),
        ],
        ..Network::MEAN
    };
    let report = read(far.file(), &options(None)).unwrap().depth(&image(), TopEdge::First).unwrap().report;
    assert!(report.looks_inverted(), "{report:?}");
}

#[test]
fn a_bad_output_is_refused_by_name() {
    let constant = |operator: &'static str| -> String {
        let nodes = [
            ("ReduceMean", &["image", "channels"][..], "mean", &[("keepdims", 0)][..]),
            (operator, &["mean", "zero"], "depth", &[]),
        ];
        let constants = [("channels", INT64, &[1][..], &[1.0][..]), ("zero", FLOAT, &[1], &[0.0])];
        refused(&Network { nodes: &nodes, constants: &constants, ..Network::MEAN }, &options(None))
    };
    assert!(constant("Mul").contains("every number of its output is"), "{}", constant("Mul"));
    assert!(constant("Div").contains("not finite"), "{}", constant("Div"));
    let said = refused(&Network::MEAN, &options(Some(NetworkKind::Metric)));
    assert!(said.contains("distances are negative") && said.contains("--depth-model-kind inverse"), "{said}");

    let identity =
        Network { nodes: &[("Identity", &["image"], "depth", &[])], constants: &[], ..Network::MEAN };
    let said = refused(&identity, &options(None));
    assert!(said.contains("its output is 1 x 3 x 42 x 56"), "{said}");
    let whole = Network {
        nodes: &[
            ("ReduceMean", &["image", "channels"], "mean", &[("keepdims", 0)]),
            ("Cast", &["mean"], "depth", &[("to", 6)]),
        ],
        ..Network::MEAN
    };
    let said = refused(&whole, &options(None));
    assert!(said.contains("instead of 32-bit floats"), "{said}");
}

#[test]
fn a_bad_input_is_refused_by_name() {
    let cases: [(&[u64], &str); 4] = [
        (&[1, 4, 0, 0], "its input is 1 x 4 x side 2 x side 3"),
        (&[1, 518, 518, 3], "its input is 1 x 518 x 518 x 3"),
        (&[3, 0, 0], "its input is 3 x side 1 x side 2"),
        (&[1, 3, 100_000, 100_000], "sides must be from 14 to 4096"),
    ];
    for (shape, expected) in cases {
        let said = refused(&Network { input: ("image", shape), ..Network::MEAN }, &options(None));
        assert!(said.contains(expected), "{said}");
    }
    let said = refused(&Network::of_bytes(), &options(None));
    assert!(said.contains("instead of 32-bit floats"), "{said}");
    let fixed = Network { input: ("image", &[1, 3, 42, 56]), ..Network::MEAN };
    let said = refused(&fixed, &options(None));
    assert!(said.contains("it takes images of 56x42 only"), "{said}");
}

#[test]
fn names_that_say_nothing_need_the_kind() {
    let unknown = Network {
        outputs: &["out"],
        nodes: &[("ReduceMean", &["image", "channels"], "out", &[("keepdims", 0)])],
        ..Network::MEAN
    };
    let said = refused(&unknown, &options(None));
    assert!(said.contains("`out`") && said.contains("--depth-model-kind"), "{said}");
    let network = read(unknown.file(), &options(Some(NetworkKind::Inverse))).unwrap();
    network.depth(&image(), TopEdge::First).unwrap();
}

#[test]
fn what_is_no_network_is_refused_by_name() {
    let whole = Network::MEAN.file();
    let foreign =
        Network { nodes: &[("Teleport", &["image"], "depth", &[])], constants: &[], ..Network::MEAN };
    let cases = [
        b"no network at all".to_vec(),
        whole[..whole.len() / 2].to_vec(),
        vec![0x0a, 0xff, 0xff, 0xff, 0xff, 0x7f],
        foreign.file(),
        b"\x89PNG\r\n\x1a\n".to_vec(),
    ];
    for file in cases {
        let said = read(file, &NetworkOptions::default()).unwrap_err();
        assert!(said.contains("net.onnx") && said.contains("ONNX"), "{said}");
    }
}

#[test]
fn what_nothing_bounds_is_refused_before_it_is_read() {
    let unending = Network { nodes: &[("Loop", &["image"], "depth", &[])], constants: &[], ..Network::MEAN };
    let said = refused(&unending, &options(None));
    assert!(said.contains("the operator Loop, which may never end"), "{said}");

    let side = 1e5;
    for (operator, place) in [("Expand", 1), ("Tile", 1), ("ConstantOfShape", 0)] {
        let inputs = ["mean", "size"];
        let nodes = [
            ("ReduceMean", &["image", "channels"][..], "mean", &[("keepdims", 1)][..]),
            (operator, &inputs[1 - place..], "depth", &[]),
        ];
        let constants =
            [("channels", INT64, &[1][..], &[1.0][..]), ("size", INT64, &[4], &[1.0, 1.0, side, side])];
        let said =
            refused(&Network { nodes: &nodes, constants: &constants, ..Network::MEAN }, &options(None));
        assert!(said.contains(&format!("its operator {operator} makes 10000000000 numbers")), "{said}");
    }

    let few = [("channels", INT64, &[1 << 40][..], &[1.0][..])];
    let said = refused(&Network { constants: &few, ..Network::MEAN }, &options(None));
    assert!(said.contains("its constant `channels` has 1099511627776 values in 8 bytes"), "{said}");

    let elsewhere = protobuf::field(7, &protobuf::field(5, &protobuf::field(13, b"weights.bin")));
    let nested = (0..20)
        .fold(Vec::new(), |inside, _| protobuf::field(1, &protobuf::field(5, &protobuf::field(6, &inside))));
    let file = Network::MEAN.file();
    let cut = file[..file.len() - 9].to_vec();
    for (file, expected) in [
        (elsewhere, "its weights are in another file"),
        (protobuf::field(7, &nested), "lie in one another more than 8 deep"),
        (cut, "it is cut short"),
        (Vec::new(), "it holds no graph"),
    ] {
        let said = read(file, &options(None)).unwrap_err();
        assert!(said.contains(expected) && said.contains("ONNX"), "{said}");
    }
}
