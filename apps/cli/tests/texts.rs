//! Texts of a few megabytes, made to take a hundred times that: annotations, records, manifests, cameras, models. The
//! command has four hundred megabytes of address space for them, and answers by a sentence.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::fs;
use std::process::Command;

use run::{Run, reef, scene};

/// Runs to the end within bounds, and gives what was said.
fn within_bounds(run: &Run, code: i32, arguments: &[&str]) -> String {
    let output = Command::new("sh")
        .args(["-c", "ulimit -v 400000; exec \"$0\" \"$@\" --threads 1", env!("CARGO_BIN_EXE_aquafuse")])
        .args(arguments)
        // Each thread's own share of the allocator's space is no memory that is used.
        .env("MALLOC_ARENA_MAX", "1")
        .current_dir(run.path("."))
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?} said: {said}");
    said
}

/// A value of JSON that takes several hundred times its length where it is kept.
fn heavy() -> String {
    format!("[{}]", vec!["{\"\":0}"; 1_300_000].join(","))
}

/// An image in `data/images`, and a water.
fn data() -> Run {
    let run = Run::new();
    fs::create_dir_all(run.path("data/images")).unwrap();
    scene(&run.path("data/images/a.png"), 1, "blue");
    scene(&run.path("water.png"), 2, "green");
    run
}

const BARE: [&str; 5] = ["augment", "data", "water.png", "-o", "more"];
const AUGMENT: [&str; 7] = ["augment", "data", "water.png", "-o", "more", "--keep-share", "0"];

#[test]
fn millions_of_wrong_annotations_are_counted() {
    let run = data();
    let json = |images: &str| format!("{{\"images\": [{images}], \"annotations\": []}}");
    fs::write(run.path("data/a.json"), json(&vec!["0"; 4_000_000].join(","))).unwrap();
    let said = within_bounds(&run, 2, &AUGMENT);
    assert!(
        said.contains("images[9]: it is not a JSON object") && said.contains("and 3999990 more"),
        "{said}"
    );
    fs::remove_file(run.path("data/a.json")).unwrap();

    fs::create_dir(run.path("data/labels")).unwrap();
    fs::write(run.path("data/labels/a.txt"), "x\n".repeat(4_000_000)).unwrap();
    let said = within_bounds(&run, 2, &AUGMENT);
    assert!(said.contains("a.txt:10: the class is \"x\"") && said.contains("and 3999990 more"), "{said}");
    within_bounds(&run, 2, &[&AUGMENT[..], &["--on-bad-annotation", "skip"]].concat());
    within_bounds(&run, 0, &[&AUGMENT[..], &["--on-bad-annotation", "keep"]].concat());
}

#[test]
fn annotations_are_written_entry_by_entry_and_have_a_quarter_of_memory() {
    let run = data();
    let long = "x".repeat(300);
    let annotations: Vec<String> = (0..100_000)
        .map(|id| format!("{{\"id\":{id},\"image_id\":1,\"bbox\":[1,2,3,4],\"caption\":\"{long}\"}}"))
        .collect();
    let images = "{\"id\":1,\"file_name\":\"images/a.png\",\"width\":96,\"height\":64}";
    let text = format!("{{\"images\":[{images}],\"annotations\":[{}]}}", annotations.join(","));
    fs::write(run.path("data/a.json"), &text).unwrap();
    let said = within_bounds(&run, 2, &[&AUGMENT[..], &["--max-memory", "64MiB"]].concat());
    let expected = format!("a.json: it has {} bytes; an annotation file or list may have", text.len());
    assert!(said.contains(&expected) && said.contains("a quarter of --max-memory"), "{said}");

    let often = [&BARE[..], &["--per-image", "10", "--with-replacement", "--keep-originals"]].concat();
    within_bounds(&run, 0, &often);
    let written = fs::read(run.path("more/a.json")).unwrap();
    assert!(written.len() > 11 * annotations.len() * 340);
    let lines = written.split(|letter| *letter == b'\n').filter(|line| line.starts_with(b"{\"id\""));
    assert_eq!(lines.count(), 11 * (annotations.len() + 1));
}

#[test]
fn a_list_names_the_variants_as_often_as_the_image() {
    let run = data();
    fs::create_dir(run.path("data/labels")).unwrap();
    fs::write(run.path("data/labels/a.txt"), "0 0.5 0.5 0.1 0.1\n").unwrap();
    fs::write(run.path("data/train.txt"), "images/a.png\n\n".repeat(100_000)).unwrap();
    within_bounds(&run, 0, &[&AUGMENT[..], &["--per-image", "1"]].concat());
    let list = fs::read_to_string(run.path("more/train.txt")).unwrap();
    assert_eq!(list.lines().filter(|line| line.contains("a__water__0.png")).count(), 100_000);
}

#[test]
fn what_else_stands_in_a_manifest_is_passed_over() {
    let run = data();
    within_bounds(&run, 0, &AUGMENT);
    let whole = fs::read_to_string(run.path("more/manifest.jsonl")).unwrap();
    for (from, to) in [
        ("{\"line\":\"job\",", "{\"line\":\"job\",\"more\":HEAVY,"),
        ("\"water\":{", "\"water\":{\"more\":HEAVY,"),
        ("\"line\":\"variant\",", "\"line\":\"variant\",\"more\":HEAVY,"),
    ] {
        let changed = whole.replacen(from, &to.replace("HEAVY", &heavy()), 1);
        assert!(changed.len() > whole.len() + 1_000_000);
        fs::write(run.path("more/manifest.jsonl"), changed).unwrap();
        let said = within_bounds(&run, 1, &["verify", "more"]);
        assert!(said.contains("its digest does not match"), "{said}");
    }
}

#[test]
fn settings_longer_than_any_are_none() {
    let run = data();
    let fuse = ["fuse", "data/images", "water.png", "-o", "fused"];
    within_bounds(&run, 0, &fuse);
    let record = run.path("fused/aquafuse-job.jsonl");
    let whole = fs::read_to_string(&record).unwrap();
    fs::write(&record, whole.replacen("\"settings\":{", &format!("\"settings\":{{\"more\":{},", heavy()), 1))
        .unwrap();
    let said = within_bounds(&run, 2, &fuse);
    assert!(said.contains("aquafuse-job.jsonl") && said.contains("line 1"), "{said}");
}

#[test]
fn what_else_stands_among_cameras_is_passed_over() {
    let run = Run::new();
    reef(&run);
    fs::remove_dir_all(run.path("reef/sparse")).unwrap();
    for (shared, own) in [(heavy(), "0".to_owned()), ("0".to_owned(), heavy())] {
        let pose = "[[1,0,0,2],[0,1,0,3],[0,0,1,4],[0,0,0,1]]";
        let text = format!(
            "{{\"camera_angle_x\": 1.5, \"w\": 64, \"h\": 48, \"more\": {shared}, \"frames\": \
             [{{\"file_path\": \"images/no.png\", \"more\": {own}, \"transform_matrix\": {pose}}}]}}"
        );
        fs::write(run.path("reef/transforms.json"), text).unwrap();
        let said = within_bounds(&run, 2, &["scene", "train", "reef", "-o", "reef.ply"]);
        assert!(said.contains("no.png"), "{said}");
    }
}

#[test]
fn two_cameras_of_one_image_are_refused() {
    let run = Run::new();
    reef(&run);
    fs::remove_dir_all(run.path("reef/sparse")).unwrap();
    let frame =
        "{\"file_path\": \"images/a.png\", \"transform_matrix\": [[1,0,0,2],[0,1,0,3],[0,0,1,4],[0,0,0,1]]}";
    let frames = vec![frame; 100_000].join(",");
    let text = format!("{{\"camera_angle_x\": 1.5, \"w\": 64, \"h\": 48, \"frames\": [{frames}]}}");
    fs::write(run.path("reef/transforms.json"), text).unwrap();
    let said = within_bounds(&run, 1, &["scene", "train", "reef", "-o", "reef.ply"]);
    assert!(said.contains("transforms.json: it has two cameras of images/a.png"), "{said}");
}

#[test]
fn a_depth_model_longer_than_any_is_none() {
    let run = data();
    let text = format!("schema = 1\nx=[{}]\n", "{a=0},".repeat(650_000));
    fs::write(run.path("m.toml"), text).unwrap();
    let said = within_bounds(&run, 2, &["depth", "water.png", "-o", "z.png", "--depth-model", "m.toml"]);
    assert!(said.contains("m.toml is no depth model"), "{said}");
}
