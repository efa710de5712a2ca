//! `aquafuse fit` and the models it makes, as a user runs them.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use aquafuse::depth::{DepthModel, Eq3};
use aquafuse_data::depth_file;
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::model_file::ModelFile;
use run::{Run, scene};

/// A folder of pairs whose depth a known model made, and one more image without depth.
fn pairs(run: &Run, known: Eq3) {
    for folder in ["pairs", "pairs/rgb", "pairs/depth"] {
        std::fs::create_dir(run.path(folder)).unwrap();
    }
    let pairs = [
        (1, "blue", "png"),
        (2, "green", "tiff"),
        (3, "clear", "exr"),
        (4, "turbid", "npy"),
        (5, "deep", "pfm"),
    ];
    for (seed, water, format) in pairs {
        let rgb = run.path(&format!("pairs/rgb/{water}.png"));
        scene(&rgb, seed, water);
        let depth = DepthModel::Eq3(known).estimate_unfiltered(&ImageFile::read(&rgb).unwrap().bytes());
        depth_file::write(&run.path(&format!("pairs/depth/{water}.{format}")), &depth, &Default::default())
            .unwrap();
    }
    scene(&run.path("pairs/rgb/alone.png"), 6, "blue");
}

#[test]
fn a_model_is_fitted_and_used_wherever_depth_is_estimated() {
    let run = Run::new();
    // .6 of the range by red, e^(-10 R), and .4 by max(G, B), e^(-3 M).
    let (mu1, mu3) = (0.6 / (1.0 - (-10_f64).exp()), -0.4 / (1.0 - (-3_f64).exp()));
    let known = Eq3 { mu: [-mu1 * (-10_f64).exp() - mu3, mu1, -10.0, mu3, -3.0] };
    pairs(&run, known);
    let fit = ["fit", "pairs", "-o", "out/mine.toml", "--depth-kind", "relative"];
    let said = run.ok(&fit);
    assert!(said.stdout.contains("fitted to 5 pairs") && said.stdout.contains("turbid"), "{}", said.stdout);
    assert!(said.stderr.contains("no partner with the same stem: alone"), "{}", said.stderr);
    let model = ModelFile::read(&run.path("out/mine.toml")).unwrap();
    let colours = [(0.1, 0.3), (0.3, 0.3), (0.2, 0.8), (0.05, 0.5), (0.5, 0.9)];
    assert!(
        colours.iter().all(|&(r, m)| (model.eq3.depth(r, m) - known.depth(r, m)).abs() < 0.05),
        "{model:?}"
    );
    let record = model.fit.unwrap();
    assert_eq!((record.data.as_str(), record.pairs, record.depth_kind.as_str()), ("pairs", 5, "relative"));

    // No thread changes a bit, and nothing is replaced unasked.
    let refused = run.fails(2, &fit);
    assert!(refused.stderr.contains("mine.toml exists") && refused.stderr.contains("--overwrite"));
    run.ok(&["--threads", "1", "fit", "pairs", "-o", "one.toml", "--depth-kind", "relative"]);
    assert_eq!(run.bytes("one.toml"), run.bytes("out/mine.toml"));

    let image = "pairs/rgb/blue.png";
    run.ok(&["depth", image, "-o", "z.png", "--depth-model", "one.toml"]);
    let fused =
        |out, model| run.ok(&["fuse", image, "pairs/rgb/green.png", "-o", out, "--depth-model", model]);
    fused("fitted.png", "one.toml");
    fused("eq3.png", "eq3");
    assert!(run.bytes("fitted.png") != run.bytes("eq3.png"));
    let json = run.ok(&["inspect", image, "--json", "--depth-model", "one.toml"]).stdout;
    assert!(json.contains("\"source\": \"fitted\""), "{json}");
}

#[test]
fn what_cannot_be_fitted_is_refused_by_cause() {
    let run = Run::new();
    pairs(&run, Eq3::OURS);
    std::fs::create_dir(run.path("empty")).unwrap();
    for folder in ["lone", "lone/rgb", "lone/depth"] {
        std::fs::create_dir(run.path(folder)).unwrap();
    }
    let cases: [(i32, &[&str], &str); 6] = [
        (2, &["fit", "pairs", "-o", "m.json", "--depth-kind", "relative"], "must end in .toml"),
        (2, &["fit", "pairs", "-o", "m.toml", "--depth-kind", "feet"], "millimetres"),
        (2, &["fit", "empty", "-o", "m.toml", "--depth-kind", "metres"], "empty/rgb"),
        (2, &["fit", "lone", "-o", "m.toml", "--depth-kind", "metres"], "holds no pair"),
        (
            2,
            &["fit", "pairs", "-o", "m.toml", "--depth-kind", "disparity", "--scale", "shared"],
            "needs depths in one unit",
        ),
        (1, &["fit", "pairs", "-o", "m.toml", "--depth-kind", "inverse"], "declare them as inverse"),
    ];
    for (code, arguments, expected) in cases {
        let refused = run.fails(code, arguments);
        assert!(refused.stderr.contains(expected), "{arguments:?}: {}", refused.stderr);
        assert!(!run.path("m.toml").exists());
    }
    // One bad pair is named and left out.
    std::fs::write(run.path("pairs/depth/alone.png"), "no image").unwrap();
    let ended = run.fails(1, &["fit", "pairs", "-o", "m.toml", "--depth-kind", "relative"]);
    assert!(
        ended.stderr.contains("alone.png") && ended.stderr.contains("1 of 6 pairs failed"),
        "{}",
        ended.stderr
    );
    assert_eq!(ModelFile::read(&run.path("m.toml")).unwrap().fit.unwrap().pairs, 5);
}

#[test]
fn a_model_that_cannot_be_used_is_refused_by_cause() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    std::fs::write(run.path("text.toml"), "this is no model").unwrap();
    std::fs::write(run.path("up.toml"), "schema = 1\nmodel = \"eq3\"\nmu = [0.5, -0.5, -6.0, -0.5, -2.0]\n")
        .unwrap();
    for (model, expected) in [
        (
            "guess",
            "ratio, ulap, udepth, layout, network, a FILE.toml from `aquafuse fit`, or a network FILE.onnx",
        ),
        ("missing.toml", "cannot read missing.toml"),
        ("text.toml", "text.toml is no depth model"),
        ("up.toml", "must not rise with red"),
    ] {
        let refused = run.fails(2, &["inspect", "content.png", "--depth-model", model]);
        assert!(refused.stderr.contains(expected), "{model}: {}", refused.stderr);
    }
}
