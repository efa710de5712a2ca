//! Folder jobs: what is done is done once, whatever stops the run.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use run::{Chance, Run, killed_after, kills, scene, scenes_folder};

const FUSE: [&str; 5] = ["fuse", "photos", "water.png", "-o", "fused"];

/// The images of a folder; its record and whatever else is hidden left out.
fn image_files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let Ok(entries) = std::fs::read_dir(folder) else { return BTreeMap::new() };
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let image_files = names.filter(|name| !name.starts_with('.') && name != "aquafuse-job.jsonl");
    image_files.map(|name| (name.clone(), std::fs::read(folder.join(name)).unwrap())).collect()
}

fn parts(folder: &Path) -> usize {
    let Ok(entries) = std::fs::read_dir(folder) else { return 0 };
    entries.filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().ends_with(".part")).count()
}

fn small() -> Run {
    let run = Run::new();
    scenes_folder(&run.path("photos"));
    scene(&run.path("water.png"), 9, "turbid");
    run
}

#[test]
fn a_finished_job_is_not_done_again_and_a_new_image_is_added() {
    let run = small();
    run.ok(&FUSE);
    let time = || run.path("fused/a.png").metadata().unwrap().modified().unwrap();
    let before = time();
    let again = run.ok(&FUSE);
    assert!(again.stdout.contains("3 images skipped"), "{}", again.stdout);
    scene(&run.path("photos/d.png"), 5, "deep");
    let added = run.ok(&FUSE);
    assert!(added.stdout.contains("d.png: written"), "{}", added.stdout);
    assert_eq!((time(), image_files(&run.path("fused")).len()), (before, 4));
}

#[test]
fn other_settings_need_a_word() {
    let run = small();
    run.ok(&FUSE);
    let before = image_files(&run.path("fused"));
    let other = [&FUSE[..], &["--model", "aquafuse"]].concat();
    let refused = run.fails(2, &other);
    assert!(
        refused.stderr.contains("other settings") && refused.stderr.contains("--overwrite"),
        "{}",
        refused.stderr
    );
    assert_eq!(image_files(&run.path("fused")), before);
    run.ok(&[&other[..], &["--overwrite"]].concat());
    assert!(image_files(&run.path("fused")).iter().all(|(name, bytes)| bytes != &before[name]));
}

#[test]
fn another_folder_of_the_same_names_is_refused_and_another_way_to_depth_too() {
    let run = small();
    run.ok(&FUSE);
    let before = image_files(&run.path("fused"));
    scenes_folder(&run.path("others"));
    let others = run.fails(2, &["fuse", "others", "water.png", "-o", "fused"]);
    assert!(others.stderr.contains("--overwrite"), "{}", others.stderr);
    run.fails(2, &[&FUSE[..], &["--depth-model", "ratio"]].concat());
    assert_eq!(image_files(&run.path("fused")), before);
    let onto_water = run.fails(2, &["fuse", "others", "photos/a.png", "-o", "photos", "--overwrite"]);
    assert!(onto_water.stderr.contains("is an input"), "{}", onto_water.stderr);
}

#[test]
fn what_failed_is_made_once_it_is_repaired() {
    let run = small();
    run.ok(&FUSE);
    let whole = run.bytes("photos/a.png");
    std::fs::write(run.path("photos/a.png"), &whole[..whole.len() / 2]).unwrap();
    run.fails(1, &FUSE);
    std::fs::write(run.path("photos/a.png"), &whole).unwrap();
    assert!(run.ok(&FUSE).stdout.contains("a.png: written"));
}

#[test]
fn as_many_failures_as_allowed_and_the_failed_are_listed() {
    let run = small();
    for name in ["bad1.png", "bad2.png", "bad3.png"] {
        std::fs::write(run.path("photos").join(name), "no image").unwrap();
    }
    let ended = run.fails(1, &FUSE);
    assert!(
        ended.stderr.contains("3 of 6 images failed") && ended.stderr.contains("aquafuse-job.jsonl"),
        "{}",
        ended.stderr
    );
    let record = String::from_utf8(run.bytes("fused/aquafuse-job.jsonl")).unwrap();
    let listed: Vec<_> = record.lines().filter(|line| line.contains("\"failed\"")).collect();
    assert_eq!(listed.len(), 3);
    assert!(listed.iter().all(|line| line.contains("convert it first")), "{listed:?}");

    std::fs::remove_dir_all(run.path("fused")).unwrap();
    let one_thread = [&FUSE[..], &["--threads", "1", "--fail-fast"]].concat();
    assert!(
        run.fails(1, &one_thread).stderr.contains("1 of 6 images failed, 3 were not tried"),
        "a.png and b.png come before"
    );
    let with_two = [&FUSE[..], &["--threads", "1", "--max-errors", "2"]].concat();
    assert!(run.fails(1, &with_two).stderr.contains("3 of 6 images failed"), "the third is one too many");
}

#[test]
fn each_image_has_a_record_for_programs() {
    let run = small();
    std::fs::write(run.path("photos/bad.png"), "no image").unwrap();
    let ended = run.fails(1, &[&FUSE[..], &["--json"]].concat());
    let mut statuses = BTreeMap::new();
    for line in ended.stdout.lines() {
        let record: serde_json::Value = serde_json::from_str(line).unwrap();
        assert_eq!(record["schema"], 1);
        let status = record["status"].as_str().unwrap().to_owned();
        match status.as_str() {
            "failed" => assert!(record["error"].as_str().unwrap().contains("bad.png")),
            _ => assert!(record["clipping"]["pixels"].as_u64().unwrap() > 0, "{line}"),
        }
        statuses.insert(record["input"].as_str().unwrap().to_owned(), status);
    }
    let expected = [
        ("photos/a.png", "done"),
        ("photos/b.png", "done"),
        ("photos/bad.png", "failed"),
        ("photos/c.jpg", "done"),
    ];
    assert_eq!(statuses, expected.map(|(input, status)| (input.to_owned(), status.to_owned())).into());
    let again = run.fails(1, &[&FUSE[..], &["--json"]].concat());
    assert_eq!(again.stdout.matches("\"status\":\"kept\"").count(), 3);
}

#[test]
fn bmp_becomes_png_and_two_images_never_share_an_output() {
    let run = small();
    let image = ::image::RgbImage::from_fn(32, 24, |x, y| ::image::Rgb([x as u8, y as u8, 90]));
    image.save(run.path("photos/d.bmp")).unwrap();
    image.save(run.path("photos/ignored.gif")).unwrap();
    run.ok(&FUSE);
    let names: Vec<_> = image_files(&run.path("fused")).into_keys().collect();
    assert_eq!(names, ["a.png", "b.png", "c.jpg", "d.bmp.png"]);
    image.save(run.path("photos/d.bmp.png")).unwrap();
    assert!(run.fails(2, &FUSE).stderr.contains("rename one of them"));
}

/// Enough work that a run can be stopped in its midst.
fn larger(count: usize) -> Run {
    let run = Run::new();
    std::fs::create_dir(run.path("photos")).unwrap();
    let [blue, .., deep] = waters();
    let image_file = |seed| {
        ImageFile::new(
            Scene::new(seed, Size { width: 192, height: 128 }).seen_through(&blue.water).convert::<u8>(),
        )
    };
    let made: Vec<_> = (0..4).map(image_file).collect();
    for i in 0..count {
        made[i % 4].write(&run.path(&format!("photos/{i:02}.png")), &WriteOptions::default()).unwrap();
    }
    let water = Scene::new(9, Size { width: 96, height: 64 }).seen_through(&deep.water).convert::<u8>();
    ImageFile::new(water).write(&run.path("water.png"), &WriteOptions::default()).unwrap();
    run
}

#[test]
fn killed_and_run_again_equals_one_clean_run() {
    let run = larger(16);
    let began = Instant::now();
    run.ok(&["fuse", "photos", "water.png", "-o", "clean", "--quiet"]);
    let whole_run = began.elapsed();
    let clean = image_files(&run.path("clean"));
    let folder = run.path("fused");
    let (mut killed, mut finished, mut most_parts, mut chance) = (0, 0, 0, Chance(1));
    while killed < kills() {
        let is_killed = killed_after(run.command(&FUSE), whole_run.mul_f64(chance.share()));
        killed += usize::from(is_killed);
        let there = image_files(&folder);
        assert!(there.iter().all(|(name, bytes)| bytes == &clean[name]), "a half file");
        most_parts = most_parts.max(parts(&folder));
        if !is_killed {
            assert_eq!((&there, parts(&folder)), (&clean, 0));
            finished += 1;
            std::fs::remove_dir_all(&folder).unwrap();
        }
    }
    run.ok(&FUSE);
    assert_eq!((image_files(&folder), parts(&folder)), (clean, 0));
    let threads = std::thread::available_parallelism().unwrap().get();
    assert!(most_parts <= threads + 1, "{most_parts} temporary files of {threads} threads");
    println!(
        "kills: {killed}, jobs finished: {}, half files: 0, differing bytes: 0, temporary files left by a kill: {most_parts} at most",
        finished + 1
    );
}

#[cfg(unix)]
#[test]
fn signals_end_it_at_once_with_their_code_and_leave_nothing_half() {
    let run = larger(16);
    run.ok(&["fuse", "photos", "water.png", "-o", "clean", "--quiet"]);
    let clean = image_files(&run.path("clean"));
    let folder = run.path("fused");
    let signals = [("INT", 130), ("TERM", 143), ("HUP", 129)];
    let mut latencies = Vec::new();
    for (name, code) in signals.into_iter().cycle().take(kills().div_ceil(4)) {
        let mut child = run.command(&FUSE).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        while image_files(&folder).is_empty() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let sent = Instant::now();
        // It may have ended by itself: then there is nobody to tell.
        let _ = std::process::Command::new("kill").args(["-s", name, &child.id().to_string()]).output();
        let output = child.wait_with_output().unwrap();
        // A fast machine may have been done before.
        if output.status.code() != Some(0) {
            latencies.push(sent.elapsed());
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(code), "{said}");
            assert!(said.contains("stopped") && said.contains("repeat the command"), "{said}");
        }
        assert_eq!(parts(&folder), 0);
        assert!(image_files(&folder).iter().all(|(name, bytes)| bytes == &clean[name]));
        std::fs::remove_dir_all(&folder).unwrap();
    }
    assert!(!latencies.is_empty(), "every run was done before it could be stopped");
    let slowest = latencies.iter().max().copied().unwrap_or_default().as_millis();
    println!(
        "signals: {}, temporary files left: 0, half files: 0, slowest end: {slowest} ms",
        latencies.len()
    );
}
