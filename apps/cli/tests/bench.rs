//! `aquafuse bench`: what it says, not how fast it is.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use run::Run;
use serde_json::Value;

#[test]
fn every_case_is_measured_and_its_figures_agree() {
    let arguments =
        ["bench", "--json", "--size", "48x32", "--size", "33x17", "--frames", "1", "--threads", "1"];
    let report: Value = serde_json::from_str(&Run::new().ok(&arguments).stdout).unwrap();
    assert_eq!(report["schema"], 1);
    assert!(report["machine"]["cores"].as_u64() >= Some(1));
    let results = report["results"].as_array().unwrap();
    let mut cases: Vec<String> = results
        .iter()
        .map(|case| format!("{}x{} {} {}", case["width"], case["height"], case["reference"], case["smooth"]))
        .collect();
    cases.dedup();
    // Two sizes, three ways to estimate, with smoothing and without.
    assert_eq!(cases.len(), 12, "{cases:?}");
    for case in results {
        let number = |value: &Value| value.as_f64().filter(|number| *number > 0.0).unwrap();
        let milliseconds = number(&case["ms_per_frame"]);
        let pixels = number(&case["width"]) * number(&case["height"]);
        assert!((number(&case["fps"]) * milliseconds / 1e3 - 1.0).abs() < 1e-9);
        assert!((number(&case["ns_per_pixel"]) * pixels / 1e6 / milliseconds - 1.0).abs() < 1e-9);
        let stages =
            ["depth", "waterbody", "fusion", "bilateral"].map(|stage| number(&case["stages"][stage]));
        assert!(stages.iter().all(|stage| stage.is_finite()));
        assert_eq!((&case["threads"], &case["model"]), (&Value::from(1), &Value::from("aquafuse")));
    }
    assert_eq!(report["restorations"].as_array().unwrap().len(), 2);
}

#[test]
fn a_size_that_is_none_is_wrong_usage() {
    for size in ["256", "0x10", "99999x2", "axb"] {
        let refused = Run::new().fails(2, &["bench", "--size", size]);
        assert!(refused.stderr.contains("give WIDTHxHEIGHT, such as 1920x1080"), "{}", refused.stderr);
    }
}
