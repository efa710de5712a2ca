//! Networks of depth of a few operators.

#[path = "../../../crates/aquafuse-data/tests/onnx/mod.rs"]
#[allow(dead_code, reason = "tests use what is not used here")]
mod onnx;

use std::path::Path;

use anyhow::Result;
use onnx::protobuf::{field, number};
use onnx::{FLOAT, INT64, Network};

/// A constant whose list of numbers holds one of more than ten bytes, at which the reader goes on for ever; the fuzzer found it.
fn endless_list() -> Vec<u8> {
    let numbers = [&[1][..], &[0xff; 12]].concat();
    [number(1, 8), field(7, &field(5, &field(7, &numbers)))].concat()
}

/// Adds one of each kind: any size and a fixed one, one output and several, constants of both types, a shape, an unending loop.
pub(super) fn add_all(corpus: &Path) -> Result<()> {
    let metres = Network {
        input: ("pixel_values", &[1, 3, 14, 28]),
        outputs: &["metric_depth", "mask"],
        nodes: &[
            ("ReduceMean", &["pixel_values", "channels"], "mean", &[("keepdims", 1)]),
            ("Slice", &["mean", "from", "to", "axes", "steps"], "half", &[]),
            ("Exp", &["half"], "metric_depth", &[]),
            ("Mul", &["mean", "two"], "mask", &[]),
        ],
        constants: &[
            ("channels", INT64, &[1], &[1.0]),
            ("from", INT64, &[2], &[0.0, 0.0]),
            ("to", INT64, &[2], &[1e6, 1e6]),
            ("axes", INT64, &[2], &[2.0, 3.0]),
            ("steps", INT64, &[2], &[2.0, 2.0]),
            ("two", FLOAT, &[1], &[2.0]),
        ],
        ..Network::MEAN
    };
    let convolved = Network {
        nodes: &[
            ("Conv", &["image", "weights"], "mean", &[]),
            ("Expand", &["mean", "size"], "wide", &[]),
            ("Softplus", &["wide"], "depth", &[]),
        ],
        constants: &[
            ("weights", FLOAT, &[1, 3, 3, 3], &[0.1; 27]),
            ("size", INT64, &[4], &[1.0, 1.0, 26.0, 26.0]),
        ],
        input: ("image", &[1, 3, 28, 28]),
        ..Network::MEAN
    };
    let unending = Network { nodes: &[("Loop", &["image"], "depth", &[])], constants: &[], ..Network::MEAN };
    let all = [("mean", Network::MEAN), ("metres", metres), ("convolved", convolved), ("unending", unending)];
    for (name, network) in all {
        super::add(corpus, "depth-network", &format!("{name}.onnx"), &network.file())?;
    }
    super::add(corpus, "depth-network", "endless-list.onnx", &endless_list())?;
    Ok(())
}
