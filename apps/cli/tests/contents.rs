//! Several contents, and folders within folders.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use run::{Run, scene};

/// Images at these paths, and a water.
fn with(names: &[&str]) -> Run {
    let run = Run::new();
    for (seed, name) in (0..).zip(names) {
        std::fs::create_dir_all(run.path(name).parent().unwrap()).unwrap();
        scene(&run.path(name), seed, "blue");
    }
    scene(&run.path("green.png"), 9, "green");
    run
}

#[test]
fn several_images_go_to_one_folder_and_the_last_is_the_water() {
    let run = with(&["a.png", "b.jpg", "more/c.png"]);
    run.ok(&["fuse", "a.png", "green.png", "-o", "one/a.png"]);
    let fuse = ["fuse", "a.png", "b.jpg", "more", "green.png", "-o", "out"];
    let said = run.ok(&fuse).stdout;
    assert!(said.starts_with("green.png: "), "{said}");
    for name in ["a.png", "b.jpg", "c.png"] {
        assert!(run.path("out").join(name).exists(), "{name}");
    }
    assert_eq!(run.bytes("out/a.png"), run.bytes("one/a.png"));
    // It goes on as a folder does.
    std::fs::remove_file(run.path("out/c.png")).unwrap();
    let said = run.ok(&fuse).stdout;
    assert!(said.contains("2 skipped") || said.contains("2 images skipped"), "{said}");
    run.ok(&["restore", "a.png", "b.jpg", "-o", "clear/"]);
    assert!(run.path("clear/b.jpg").exists());
}

#[test]
fn contents_that_cannot_be_together_are_refused_by_name() {
    let run = with(&["a.png", "more/a.png", "b.png"]);
    let said = run.fails(2, &["fuse", "a.png", "more/a.png", "green.png", "-o", "out"]).stderr;
    assert!(said.contains("more/a.png and a.png would have the same output"), "{said}");
    let said = run.fails(2, &["fuse", "a.png", "b.png", "green.png", "-o", "out.png"]).stderr;
    assert!(said.contains("several images go to one folder; out.png is a file name"), "{said}");
    let said = run.fails(2, &["fuse", "a.png", "b.png", "green.png", "-o", "."]).stderr;
    assert!(said.contains("a.png is an input"), "{said}");
    let said = run.fails(2, &["fuse", "a.png", "c.png", "green.png", "-o", "out"]).stderr;
    assert!(said.contains("cannot read c.png"), "{said}");
    let said = run.fails(2, &["fuse", "green.png", "-o", "out"]).stderr;
    assert!(said.contains("<WATER>") || said.contains("<CONTENT>"), "{said}");
    assert!(!run.path("out").exists());
}

#[test]
fn folders_within_folders_are_entered_on_request_and_keep_their_names() {
    let run = with(&[
        "dives/a.png",
        "dives/june/a.png",
        "dives/june/deep/b.png",
        "dives/.hidden/c.png",
        "elsewhere/d.png",
    ]);
    #[cfg(unix)]
    std::os::unix::fs::symlink(run.path("elsewhere"), run.path("dives/link")).unwrap();
    let fuse = ["fuse", "dives", "green.png", "-o", "dives/out"];
    let ended = run.ok(&fuse);
    assert!(ended.stderr.contains("left out: 1 folders in the content; --recursive"), "{}", ended.stderr);
    let recursive = [&fuse[..], &["--recursive"]].concat();
    run.ok(&recursive);
    for name in ["a.png", "june/a.png", "june/deep/b.png"] {
        assert!(run.path("dives/out").join(name).exists(), "{name}");
    }
    assert!(!run.path("dives/out/.hidden").exists() && !run.path("dives/out/link").exists());
    // The output is no content of the next run, and what is there is not made again.
    let said = run.ok(&recursive).stdout;
    assert!(!run.path("dives/out/out").exists());
    assert!(said.contains("3"), "{said}");
    // An image of the user in a folder of the output stays.
    std::fs::write(run.path("dives/out/june/a.png"), "mine").unwrap();
    let said = run.fails(2, &recursive).stderr;
    assert!(said.contains("dives/out/june/a.png exists"), "{said}");
    assert_eq!(run.bytes("dives/out/june/a.png"), b"mine");
}

#[test]
fn depth_maps_stand_in_folders_of_the_same_names() {
    let run = with(&["dives/a.png", "dives/june/a.png"]);
    for (name, map) in [("dives/a.png", "depth/a.png"), ("dives/june/a.png", "depth/june/a.png")] {
        run.ok(&["depth", name, "-o", map]);
    }
    let fuse = [
        "fuse",
        "dives",
        "green.png",
        "-o",
        "out",
        "--recursive",
        "--depth",
        "depth",
        "--depth-kind",
        "relative",
    ];
    run.ok(&fuse);
    std::fs::remove_file(run.path("depth/june/a.png")).unwrap();
    let said = run.fails(2, &[&fuse[..], &["--overwrite"]].concat()).stderr;
    assert!(said.contains("depth/june") && said.contains("dives/june/a.png"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_folder_of_the_output_that_leads_out_is_not_entered() {
    let run = with(&["dives/june/a.png"]);
    std::fs::create_dir_all(run.path("victim")).unwrap();
    std::fs::create_dir_all(run.path("out")).unwrap();
    std::os::unix::fs::symlink(run.path("victim"), run.path("out/june")).unwrap();
    let said = run.fails(2, &["restore", "dives", "-o", "out", "--recursive"]).stderr;
    assert!(said.contains("out/june"), "{said}");
    assert_eq!(std::fs::read_dir(run.path("victim")).unwrap().count(), 0);
}

#[test]
fn several_images_are_inspected_one_after_the_other() {
    let run = with(&["a.png", "b.png", "more/a.png"]);
    let said = run.ok(&["inspect", "a.png", "b.png", "--json"]).stdout;
    let names: Vec<String> = said
        .lines()
        .map(|line| {
            serde_json::from_str::<serde_json::Value>(line).unwrap()["image"].as_str().unwrap().to_owned()
        })
        .collect();
    assert_eq!(names, ["a.png", "b.png"]);
    std::fs::write(run.path("b.png"), "no image").unwrap();
    let ended = run.fails(1, &["inspect", "a.png", "b.png", "more/a.png"]);
    assert!(ended.stdout.contains("a.png:\n") && ended.stdout.contains("more/a.png:\n"), "{}", ended.stdout);
    assert!(
        ended.stderr.contains("b.png") && ended.stderr.contains("1 of 3 images failed"),
        "{}",
        ended.stderr
    );
    let said = run.fails(2, &["inspect", "a.png", "more/a.png", "--plots", "plots"]).stderr;
    assert!(said.contains("plots of the same name"), "{said}");
}
