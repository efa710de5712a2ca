//! Depth from colour against measured depth.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

#[path = "../examples/depth_table/pairs.rs"]
mod pairs;

use aquafuse::depth::DepthModel;
use pairs::{by_place, read_all};

#[test]
fn the_default_orders_measured_depth_well() {
    let Some(data) = std::env::var_os("AQUAFUSE_TEST_DATA") else {
        eprintln!("skipped: AQUAFUSE_TEST_DATA does not name the folder of real pictures");
        return;
    };
    let pairs = read_all(data.as_ref()).unwrap();
    assert!(!pairs.is_empty());
    let scores: Vec<f64> = pairs.iter().map(|pair| pair.score(DepthModel::default()).unwrap()).collect();
    let mean = by_place(&pairs, &scores);
    assert!(mean >= 0.75, "{mean}: {scores:?}");
    // Rows are read by the table only.
    assert!(pairs.iter().all(|pair| pair.rows.len() == pair.metres.len()));
}
