//! Training and fusing of scenes, killed at any moment and run again: the same bytes as of one clean run.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::cell::Cell;
use std::time::{Duration, Instant};

use run::{Chance, Run, killed_after, kills, reef, scene};

/// Runs a command to its end again and again, killing it at a moment by chance before that, until it has been killed so often;
/// `check` looks at what it left, and `clear` takes away what it made. Each time it ends it must have made the same.
fn kill_again_and_again(
    run: &Run,
    arguments: &[&str],
    took: Duration,
    mut left: impl FnMut(),
    mut ended: impl FnMut(),
) -> usize {
    let (mut chance, mut killed) = (Chance(7), 0);
    while killed < kills() {
        let wait = took.mul_f64(1.1 * chance.share());
        if killed_after(run.command(arguments), wait) {
            killed += 1;
            left();
        } else {
            ended();
        }
    }
    killed
}

fn timed(run: &Run, arguments: &[&str]) -> Duration {
    let began = Instant::now();
    run.ok(arguments);
    began.elapsed()
}

#[test]
fn training_that_is_killed_goes_on_to_the_same_splats() {
    let run = Run::new();
    reef(&run);
    let train = |output| {
        [
            "scene",
            "train",
            "reef",
            "-o",
            output,
            "--iterations",
            "260",
            "--water",
            "learn",
            "--splats",
            "3000",
        ]
    };
    let took = timed(&run, &train("clean.ply"));
    let mut resumable = 0;
    let ends = Cell::new(0);
    let checked = || {
        assert_eq!(run.bytes("killed.ply"), run.bytes("clean.ply"));
        assert_eq!(run.bytes("killed.water.json"), run.bytes("clean.water.json"));
        for name in ["killed.ply", "killed.water.json"] {
            std::fs::remove_file(run.path(name)).unwrap();
        }
        ends.set(ends.get() + 1);
    };
    let killed = kill_again_and_again(
        &run,
        &train("killed.ply"),
        took,
        || match run.path("killed.ply.checkpoint").is_file() {
            true => resumable += 1,
            // All was written, and only the process had not ended.
            false if run.path("killed.ply").is_file() => checked(),
            false => {}
        },
        &checked,
    );
    run.ok(&train("killed.ply"));
    checked();
    println!("kills: {killed}, {resumable} with a checkpoint, {} ends", ends.get());
    assert!(resumable > 0, "no kill found the run noted");
}

#[test]
fn a_scene_whose_fusing_is_killed_is_finished_by_the_next_run() {
    let run = Run::new();
    reef(&run);
    scene(&run.path("green.png"), 3, "green");
    let fuse = |output| ["scene", "fuse", "reef", "green.png", "-o", output, "--model", "physical"];
    let took = timed(&run, &fuse("clean"));
    let names: Vec<String> = (0..9).map(|i| format!("images/view_00{i}.png")).collect();
    let files = || names.iter().map(String::as_str).chain(["sparse/0/images.txt"]);
    let (mut begun, mut ends) = (0, 0);
    let checked = |ends: &mut usize| {
        for name in files() {
            assert_eq!(run.bytes(&format!("killed/{name}")), run.bytes(&format!("clean/{name}")), "{name}");
        }
        std::fs::remove_dir_all(run.path("killed")).unwrap();
        *ends += 1;
    };
    let killed = kill_again_and_again(
        &run,
        &fuse("killed"),
        took,
        || begun += usize::from(files().any(|name| run.path(&format!("killed/{name}")).is_file())),
        || checked(&mut ends),
    );
    run.ok(&fuse("killed"));
    checked(&mut ends);
    println!("kills: {killed}, {begun} with images there, {ends} ends");
    assert!(begun > 0, "no kill came between two images");

    // A kill before the first file leaves folders only.
    std::fs::create_dir_all(run.path("killed/images")).unwrap();
    run.ok(&fuse("killed"));

    // Another recipe does not go on with these images, and images that are not ours stay.
    let other = ["scene", "fuse", "reef", "green.png", "-o", "killed", "--model", "aquafuse"];
    let said = run.fails(2, &other).stderr;
    assert!(said.contains("model"), "{said}");
    std::fs::write(run.path("killed/images/view_004.png"), "mine").unwrap();
    run.fails(2, &fuse("killed"));
    assert_eq!(run.bytes("killed/images/view_004.png"), b"mine");
}

#[test]
fn a_scene_larger_than_memory_allows_is_refused_before_images_are_read() {
    let run = Run::new();
    reef(&run);
    std::fs::remove_file(run.path("reef/images/view_003.png")).unwrap();
    let said = run.fails(2, &["scene", "train", "reef", "-o", "reef.ply", "--max-memory", "64MiB"]).stderr;
    assert!(said.contains("64 MiB of --max-memory") && said.contains("--longest or --splats"), "{said}");
    let said = run.fails(2, &["scene", "train", "reef", "-o", "reef.ply", "--splats", "2000"]).stderr;
    assert!(said.contains("view_003.png"), "{said}");
}
