//! A network that takes too long.

use super::*;
use crate::onnx;

#[test]
fn a_network_that_takes_too_long_is_refused_by_name_and_not_asked_again() {
    // So large that it cannot be done when the wait begins.
    let options = NetworkOptions { side: Some(1400), ..NetworkOptions::default() };
    let file = onnx::Network::MEAN.file();
    let mut network = DepthNetwork::from_bytes("net.onnx".as_ref(), file, &options).unwrap();
    Arc::get_mut(&mut network.0).unwrap().options.seconds = Some(0);
    let image = Image::<u8>::from_raw(64, 64, (0..64 * 64 * 3).map(|i| (i % 251) as u8).collect()).unwrap();
    let said = || network.depth(&image, TopEdge::First).unwrap_err().to_string();
    let first = said();
    assert!(first.contains("one image took longer than 0 s"), "{first}");
    assert!(first.contains("net.onnx") && first.contains("--depth-model-seconds"), "{first}");
    let second = said();
    assert!(second.contains("an image before this one took longer"), "{second}");
}
