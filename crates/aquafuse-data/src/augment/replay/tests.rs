//! A network of depth, read again from a manifest.

use super::*;
use crate::onnx;

#[test]
fn the_network_of_a_manifest_has_the_time_that_it_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("net.onnx");
    std::fs::write(&path, onnx::Network::MEAN.file()).unwrap();
    let file = path.display().to_string();
    let stored = StoredDepth::Network {
        file,
        sha256: sha256(&onnx::Network::MEAN.file()),
        kind: NetworkKind::Inverse.name().into(),
        side: None,
    };
    let seconds = |given| match stored.plan(given).unwrap() {
        Some(DepthPlan::Estimated(DepthEstimator::Network(network))) => network.origin().2.seconds,
        _ => panic!("it is a network"),
    };
    assert_eq!((seconds(None), seconds(Some(7))), (None, Some(7)));
    let said = stored.plan(Some(0)).unwrap_err().to_string();
    assert!(said.contains("--depth-model-seconds"), "{said}");
}
