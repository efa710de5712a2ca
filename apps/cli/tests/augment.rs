//! Datasets multiplied by the command, read back by the readers that people use, killed and gone on with.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use run::{Chance, Run, killed_after, kills, scene};

const READER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/read_datasets.py");
const MATRIX: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/round_trip.py");
const WRITER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/write_tables.py");

/// A dataset of YOLO with `image_files` images in two splits, and two waters beside it.
fn fish(image_files: usize) -> Run {
    let run = Run::new();
    for folder in ["fish/images/train", "fish/images/val", "fish/labels/train", "fish/labels/val", "waters"] {
        fs::create_dir_all(run.path(folder)).unwrap();
    }
    fs::write(
        run.path("fish/data.yaml"),
        "path: ../fish\ntrain: images/train\nval: images/val\nnames: [fish]\n",
    )
    .unwrap();
    for number in 0..image_files {
        let split = if number % 4 == 0 { "val" } else { "train" };
        scene(&run.path(&format!("fish/images/{split}/{number}.png")), number as u64, "blue");
        let label = format!("0 0.5 0.4 0.{}25 0.3\n0 0.25 0.25 0.125 0.0625\n", 1 + number % 5);
        fs::write(run.path(&format!("fish/labels/{split}/{number}.txt")), label).unwrap();
    }
    scene(&run.path("waters/green.png"), 90, "green");
    scene(&run.path("waters/turbid.png"), 91, "turbid");
    run
}

const AUGMENT: [&str; 11] =
    ["augment", "fish", "waters", "-o", "more", "--per-image", "2", "--splits", "all", "--preview", "0"];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&AUGMENT[..], more].concat()
}

/// Every file below a folder, hidden ones left out.
fn files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let (mut found, mut left) = (BTreeMap::new(), vec![root.to_owned()]);
    while let Some(folder) = left.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
            if path.is_dir() {
                left.push(path);
            } else if !name.rsplit('/').next().unwrap().starts_with('.') {
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

#[test]
fn a_data_set_is_multiplied_checked_and_made_again() {
    let run = fish(4);
    let dry = run.ok(&with(&["--dry-run", "--keep-originals"]));
    assert!(dry.stdout.contains("splits: train 3, val 1"), "{}", dry.stdout);
    assert!(dry.stdout.contains("would make 8 variants of 4 images"), "{}", dry.stdout);
    assert!(!run.path("more").exists());
    let said = run.ok(&with(&["--keep-originals"]));
    assert!(said.stdout.contains("layout yolo, 2 waters"), "{}", said.stdout);
    assert!(said.stdout.contains("8 variants of 4 images written to more; estimates: "), "{}", said.stdout);
    let made = files(&run.path("more"));
    assert_eq!(made.len(), 2 * 12 + 2);
    assert_eq!(made["data.yaml"], b"train: images/train\nval: images/val\nnames: [fish]\n");
    assert!(
        made.contains_key("images/val/0__green__0.png") || made.contains_key("images/val/0__turbid__0.png")
    );

    let again = run.ok(&with(&["--keep-originals"]));
    assert!(again.stdout.contains("4 images skipped"), "{}", again.stdout);
    let checked = run.ok(&["verify", "more", "--dataset", "fish"]);
    assert_eq!(checked.stdout, "30 of 30 files are unchanged\n");
    fs::write(run.path("more/labels/val/0.txt"), "0 0.5 0.5 0.5 0.5\n").unwrap();
    let wrong = run.fails(1, &["verify", "more"]);
    assert!(wrong.stderr.contains("more/labels/val/0.txt: it has"), "{}", wrong.stderr);

    fs::write(run.path("more/labels/val/0.txt"), &made["labels/val/0.txt"]).unwrap();
    fs::write(run.path("more/images/extra.jpg"), "").unwrap();
    let stranger = run.ok(&["verify", "more/manifest.jsonl"]);
    assert!(
        stranger.stdout.contains("no manifest lists: 1, the first is more/images/extra.jpg"),
        "{}",
        stranger.stdout
    );
    let none = run.fails(2, &["verify", "fish"]);
    assert!(none.stderr.contains("not made by `aquafuse augment`"), "{}", none.stderr);

    let key = made.keys().find(|name| name.starts_with("images/val/0__")).unwrap();
    run.ok(&["replay", "more", "--only", key, "-o", "again"]);
    // A replay that was stopped goes on, but takes nothing else for what it made.
    let kept = run.ok(&["replay", "more", "--only", key, "-o", "again"]).stdout;
    assert!(
        kept.contains("0 variants made again") && kept.contains("1 were made by an earlier run"),
        "{kept}"
    );
    std::fs::write(run.path("again").join(key), "mine").unwrap();
    let exists = run.fails(1, &["replay", "more", "--only", key, "-o", "again"]);
    assert!(exists.stderr.contains("failed: 1, different from the manifest: 0"), "{}", exists.stderr);
    assert_eq!(std::fs::read(run.path("again").join(key)).unwrap(), b"mine");
    run.ok(&["replay", "more", "--only", key, "-o", "again", "--overwrite"]);
    assert_eq!(files(&run.path("again")), BTreeMap::from([(key.clone(), made[key].clone())]));
}

#[test]
fn drawn_waters_need_no_reference_and_are_made_again() {
    let run = fish(2);
    let sea = ["augment", "fish", "--waters", "sea", "--model", "relight", "--per-image", "3", "-o", "sea"];
    let said = run.ok(&[&sea[..], &["--splits", "all", "--preview", "0"]].concat());
    assert!(said.stdout.contains("layout yolo, waters of the sea\n"), "{}", said.stdout);
    // With three variants and the original a quarter of the images are as they were.
    assert!(said.stdout.contains("6 variants of 2 images") && said.stdout.contains("copied originals: 2"));
    let made = files(&run.path("sea"));
    for number in [0, 1] {
        let split = if number == 0 { "val" } else { "train" };
        let label = run.bytes(&format!("fish/labels/{split}/{number}.txt"));
        let same = made.iter().filter(|(name, bytes)| name.starts_with("labels") && **bytes == label);
        assert_eq!(same.count(), 4);
    }
    let variants: Vec<&String> = made.keys().filter(|name| name.contains("__sea__")).collect();
    // Images and labels.
    assert_eq!(variants.len(), 2 * 3 * 2, "{variants:?}");
    let manifest = std::str::from_utf8(&made["manifest.jsonl"]).unwrap();
    let numbers: std::collections::BTreeSet<&str> = manifest
        .match_indices("\"sea\":")
        .filter_map(|(at, found)| manifest[at + found.len()..].split(',').next())
        .filter(|number| number.parse::<u32>().is_ok())
        .collect();
    assert_eq!(numbers.len(), 6, "{numbers:?}");
    let checked = run.ok(&["verify", "sea", "--dataset", "fish"]);
    assert!(checked.stdout.ends_with("files are unchanged\n"), "{}", checked.stdout);
    let images = variants.iter().filter(|name| name.starts_with("images/"));
    for name in images {
        run.ok(&["replay", "sea", "--only", name, "-o", "again"]);
        assert_eq!(run.bytes(&format!("again/{name}")), made[*name]);
    }
    run.ok(&with(&["--waters", "sea", "--keep-share", "0", "--theta-range", "0,90"]));
    let both = files(&run.path("more"));
    assert_eq!(both.keys().filter(|name| name.ends_with(".png")).count(), 4);
    let again = run.ok(&with(&["--waters", "sea", "--keep-share", "0", "--theta-range", "0,90"]));
    assert!(again.stdout.contains("nothing is left to do"), "{}", again.stdout);
    let all = run.ok(&["replay", "more", "-o", "more-again"]).stdout;
    assert_eq!(all, "4 variants made again, equal to the manifest\n");
    let other = run.fails(2, &with(&["--waters", "sea", "--theta-range", "0,90"])).stderr;
    assert!(other.contains("keep_share"), "{other}");
    for share in ["-0.1", "1.1", "NaN", "a"] {
        let refused = run.fails(2, &with(&[&format!("--keep-share={share}")])).stderr;
        assert!(refused.contains("--keep-share"), "{refused}");
    }
    let refused = run.fails(2, &with(&["--keep-share", "0.5", "--keep-originals"])).stderr;
    assert!(refused.contains("cannot be used with"), "{refused}");
    let refused = run.fails(2, &["fuse", "fish/images/train/1.png", "sea:many", "-o", "o.png"]);
    assert!(refused.stderr.contains("sea:NUMBER"), "{}", refused.stderr);
}

#[test]
fn what_cannot_be_done_is_said_before_anything_is_made() {
    let run = fish(2);
    let equal = run.fails(2, &with(&["--per-image", "3"]));
    assert!(equal.stderr.contains("cannot be used multiple times"), "{}", equal.stderr);
    let equal = run.fails(2, &["augment", "fish", "waters", "-o", "more", "--per-image", "3"]);
    assert!(equal.stderr.contains("some would be equal"), "{}", equal.stderr);
    let nested = run.fails(2, &["augment", "fish", "waters", "-o", "fish/more"]);
    assert!(nested.stderr.contains("contains the other"), "{}", nested.stderr);
    let none = run.fails(2, &["augment", "fish", "preset:milk", "-o", "more"]);
    assert!(none.stderr.contains("no preset \"milk\""), "{}", none.stderr);
    let other = run.fails(2, &with(&["--format", "masks"]));
    assert!(other.stderr.contains("layout masks"), "{}", other.stderr);
    fs::write(run.path("fish/labels/val/0.txt"), "0 0.9 0.5 0.4 0.1\n").unwrap();
    fs::write(run.path("fish/labels/val/9.txt"), "0 0.5 0.5 0.5 0.5\n").unwrap();
    let bad = run.fails(2, &AUGMENT);
    assert!(
        bad.stderr.contains("labels/val/0.txt:1: the box reaches from 0.7000 to 1.1000 across")
            && bad.stderr.contains("labels/val/9.txt: no image belongs")
            && bad.stderr.contains("--on-bad-annotation"),
        "{}",
        bad.stderr
    );
    assert!(!run.path("more").exists());
    let skipped = run.ok(&with(&["--on-bad-annotation", "skip", "--keep-share", "0"]));
    assert!(skipped.stdout.contains("left out for bad annotations: 1"), "{}", skipped.stdout);
    assert_eq!(files(&run.path("more")).keys().filter(|name| name.ends_with(".png")).count(), 2);
}

#[test]
fn what_is_left_out_is_named_and_a_dataset_without_its_annotations_is_no_folder() {
    let run = fish(2);
    fs::write(run.path("fish/boxes.csv"), "file,x\n0.png,1\n").unwrap();
    let named = run.ok(&with(&["--dry-run"]));
    assert!(named.stdout.contains("left out: 1 .csv (boxes.csv)"), "{}", named.stdout);
    let quiet = run.ok(&with(&["--quiet"]));
    assert!(quiet.stderr.contains("left out: 1 .csv (boxes.csv)"), "{}", quiet.stderr);
    fs::remove_dir_all(run.path("fish/labels")).unwrap();
    fs::remove_file(run.path("fish/data.yaml")).unwrap();
    let refused = run.fails(2, &["augment", "fish", "waters", "-o", "plain"]);
    assert!(refused.stderr.contains("reads none of them: 1 .csv (boxes.csv)"), "{}", refused.stderr);
    assert!(!run.path("plain").exists());
    run.ok(&["augment", "fish", "waters", "-o", "plain", "--format", "folder"]);
    assert!(!run.path("plain/boxes.csv").exists());
}

#[test]
fn an_image_that_fails_is_named_and_listed() {
    let run = fish(4);
    fs::write(run.path("fish/images/val/0.png"), "no image").unwrap();
    let failed = run.fails(1, &with(&["--keep-share", "0"]));
    assert!(failed.stderr.contains("fish/images/val/0.png"), "{}", failed.stderr);
    assert!(failed.stderr.contains("1 of 4 images failed"), "{}", failed.stderr);
    let manifest = String::from_utf8(run.bytes("more/manifest.jsonl")).unwrap();
    assert!(manifest.contains(r#""line":"failed","key":"images/val/0.png""#), "{manifest}");
    assert_eq!(files(&run.path("more")).keys().filter(|name| name.ends_with(".png")).count(), 6);
}

#[test]
fn an_augmentation_killed_and_run_again_equals_one_clean_run() {
    let run = fish(12);
    let arguments = with(&["--keep-originals", "--theta-range", "0,60", "--quiet"]);
    let began = Instant::now();
    run.ok(&arguments);
    let whole_run = began.elapsed();
    let more = run.path("more");
    let clean = files(&more);
    fs::remove_dir_all(&more).unwrap();
    let (mut killed, mut finished, mut chance) = (0, 0, Chance(7));
    while killed < kills() {
        let is_killed = killed_after(run.command(&arguments), whole_run.mul_f64(chance.share()));
        killed += usize::from(is_killed);
        let there = files(&more);
        let whole = |(name, bytes): (&String, &Vec<u8>)| name == "manifest.jsonl" || bytes == &clean[name];
        assert!(there.iter().all(whole), "a half file");
        if !is_killed {
            assert!(there == clean, "gone on with, it is another");
            finished += 1;
            fs::remove_dir_all(&more).unwrap();
        }
    }
    run.ok(&arguments);
    assert!(files(&more) == clean, "gone on with, it is another");
    println!("augmentations killed: {killed}, finished: {}, half files: 0, differing bytes: 0", finished + 1);
}

/// Has a dataset and what was made of it compared by the readers of others.
fn compare(layout: &str, before: &Path, after: &Path) -> bool {
    let Some(python) = std::env::var_os("AQUAFUSE_PYTHON") else {
        println!(
            "skipped: AQUAFUSE_PYTHON names no Python with pycocotools and supervision; `cargo xtask test` sets one up"
        );
        return false;
    };
    let ended = Command::new(python).args([READER, layout]).args([before, after]).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    print!("{}", String::from_utf8_lossy(&ended.stdout));
    true
}

#[test]
fn the_readers_of_others_find_the_same_annotations() {
    let run = fish(4);
    run.ok(&with(&["--keep-originals"]));
    if !compare("yolo", &run.path("fish"), &run.path("more")) {
        return;
    }
    // The same images, described in the other two ways.
    let image_files: Vec<PathBuf> = ["val/0.png", "train/1.png", "train/2.png"]
        .map(|name| run.path(&format!("fish/images/{name}")))
        .into();
    let (mut images, mut annotations) = (Vec::new(), Vec::new());
    fs::create_dir_all(run.path("coco/images")).unwrap();
    for folder in ["voc/Annotations", "voc/JPEGImages", "voc/ImageSets/Main", "masks/images", "masks/masks"] {
        fs::create_dir_all(run.path(folder)).unwrap();
    }
    for (image_file, number) in image_files.iter().zip(1..) {
        let name = image_file.file_name().unwrap().to_str().unwrap();
        for folder in ["coco/images", "voc/JPEGImages", "masks/images", "masks/masks"] {
            fs::copy(image_file, run.path(folder).join(name)).unwrap();
        }
        images.push(format!(r#"{{"id": {number}, "file_name": "{name}", "width": 96, "height": 64}}"#));
        annotations.push(format!(
            r#"{{"id": {number}, "image_id": {number}, "category_id": 1, "bbox": [{number}.5, 4, 20.25, 30], "area": 607.5, "iscrowd": 0, "segmentation": [[1, 1, 20, 1, 20, 30.5]], "mine": 1e-3}}"#
        ));
        let xml = format!(
            "<annotation>\n  <filename>{name}</filename>\n  <size><width>96</width><height>64</height><depth>3</depth></size>\n  \
             <object><name>fish</name><bndbox><xmin>{number}</xmin><ymin>2</ymin><xmax>60</xmax><ymax>40</ymax></bndbox></object>\n</annotation>\n"
        );
        fs::write(run.path("voc/Annotations").join(name).with_extension("xml"), xml).unwrap();
    }
    let json = format!(
        r#"{{"images": [{}], "annotations": [{}], "categories": [{{"id": 1, "name": "fish"}}]}}"#,
        images.join(", "),
        annotations.join(", ")
    );
    fs::write(run.path("coco/instances.json"), json).unwrap();
    fs::write(run.path("voc/ImageSets/Main/train.txt"), "0\n1\n2\n").unwrap();
    fs::create_dir(run.path("shards")).unwrap();
    let mut shard = tar::Builder::new(fs::File::create(run.path("shards/train-000.tar")).unwrap());
    for image_file in &image_files {
        let key = image_file.file_stem().unwrap().to_str().unwrap();
        for (end, bytes) in
            [("png", fs::read(image_file).unwrap()), ("cls", key.into()), ("seg.mask.png", vec![7; 600])]
        {
            let mut header = tar::Header::new_gnu();
            header.set_size(bytes.len() as u64);
            header.set_mode(0o644);
            shard.append_data(&mut header, format!("{key}.{end}"), bytes.as_slice()).unwrap();
        }
    }
    shard.finish().unwrap();
    let tables = cfg!(feature = "parquet");
    if tables {
        let python = std::env::var_os("AQUAFUSE_PYTHON").unwrap();
        let writer =
            Command::new(python).arg(WRITER).arg(run.path("parquet")).args(&image_files).output().unwrap();
        assert!(writer.status.success(), "{}", String::from_utf8_lossy(&writer.stderr));
    }
    let of_tables = tables.then_some(["parquet", "kinds"]).into_iter().flatten();
    let layouts = ["coco", "voc", "masks", "shards"].into_iter().chain(of_tables);
    for layout in layouts {
        let output = format!("{layout}-more");
        let mut arguments =
            vec!["augment", layout, "waters", "-o", &output, "--per-image", "2", "--keep-originals"];
        arguments.extend(tables.then_some(["--manifest", "parquet"]).into_iter().flatten());
        run.ok(&arguments);
        run.ok(&["verify", &output]);
        assert!(compare(layout, &run.path(layout), &run.path(&output)));
    }
}

#[test]
fn ten_layouts_come_back_equal_to_the_readers_of_others() {
    let Some(python) = std::env::var_os("AQUAFUSE_PYTHON") else {
        println!("skipped: AQUAFUSE_PYTHON names no Python with pycocotools, supervision and webdataset");
        return;
    };
    let run = Run::new();
    let mut matrix = Command::new(python);
    let ended = matrix.args([MATRIX, env!("CARGO_BIN_EXE_aquafuse")]).arg(run.path("work")).output().unwrap();
    let said = String::from_utf8_lossy(&ended.stdout);
    assert!(ended.status.success(), "{said}{}", String::from_utf8_lossy(&ended.stderr));
    let rows = said.lines().filter(|line| line.starts_with('|')).skip(2);
    let different: Vec<&str> =
        rows.filter_map(|row| row.trim_end_matches(" |").rsplit("| ").next()).collect();
    assert_eq!(different, ["0"; 10], "{said}");
}

#[test]
fn real_fish_and_real_masks_six_times() {
    let Some(data) = std::env::var_os("AQUAFUSE_TEST_DATA").map(PathBuf::from) else {
        println!("skipped: AQUAFUSE_TEST_DATA names no folder of real images");
        return;
    };
    let run = Run::new();
    let scenes = data.join("scenes");
    let waters: Vec<PathBuf> =
        ["greenish_03.jpg", "blueish_04.jpg", "turbid_09.jpg", "clear_01.jpg", "greenish_06.jpg"]
            .map(|name| scenes.join(name))
            .into();
    for (folder, layout) in [
        ("annotated_yolo_deepfish", "yolo"),
        ("annotated_yolo_deepfish", "coco"),
        ("annotated_suim", "masks"),
    ] {
        let (before, after) = (data.join(folder), run.path(layout));
        let mut command =
            run.command(&["augment", "--format", layout, "--per-image", "5", "--keep-originals", "--quiet"]);
        command.args(["--splits", "all", "--preview", "0"]);
        command.arg("-o").arg(&after).arg(&before).args(&waters);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let image_files = |root: &Path| {
            let names = files(root).into_keys().filter(|name| name.starts_with("images/"));
            names.filter(|name| !name.ends_with(".txt")).count()
        };
        assert_eq!(image_files(&after), 6 * image_files(&before), "{layout}");
        run.ok(&["verify", layout]);
        if !compare(layout, &before, &after) {
            return;
        }
    }
}
