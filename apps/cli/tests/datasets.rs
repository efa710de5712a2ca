//! What of a dataset is multiplied, what is copied unchanged, and what is said about the rest.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::collections::BTreeSet;
use std::path::Path;

use aquafuse_data::image_file::{ImageFile, WriteOptions};
use run::{Run, scene};

/// Writes a file, with the folders above it.
fn write(run: &Run, name: &str, content: &str) {
    let path = run.path(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

/// Writes an image, with the folders above it.
fn image(run: &Run, name: &str) {
    let path = run.path(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    scene(&path, name.len() as u64, "blue");
}

fn with_water() -> Run {
    let run = Run::new();
    scene(&run.path("green.png"), 9, "green");
    run
}

const BARE: [&str; 5] = ["augment", "set", "green.png", "-o", "out"];
const AUGMENT: [&str; 7] = ["augment", "set", "green.png", "-o", "out", "--keep-share", "0"];

/// The files below a folder.
fn files(root: &Path) -> BTreeSet<String> {
    let (mut found, mut left) = (BTreeSet::new(), vec![root.to_owned()]);
    while let Some(folder) = left.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path);
            } else {
                found.insert(path.strip_prefix(root).unwrap().to_str().unwrap().to_owned());
            }
        }
    }
    found
}

/// What `augment` made of which images: variants, and the images themselves.
fn made(run: &Run) -> (usize, BTreeSet<String>) {
    let all = files(&run.path("out"));
    let variants = all.iter().filter(|name| name.ends_with(".png") && name.contains("__green__")).count();
    let own = |name: &&String| name.ends_with(".png") && !name.contains("__green__");
    (variants, all.iter().filter(own).cloned().collect())
}

const BOX: &str = "0 0.5 0.5 0.25 0.25\n";

/// A dataset in each way in which people say what is for training: two images to train on, one to validate by.
fn with_splits(how: &str) -> Run {
    let run = with_water();
    let coco = |names: &[&str]| {
        let images: Vec<String> = names
            .iter()
            .enumerate()
            .map(|(id, name)| format!(r#"{{"id": {id}, "file_name": "{name}", "width": 96, "height": 64}}"#))
            .collect();
        let boxes: Vec<String> = (0..names.len())
            .map(|id| {
                format!(r#"{{"id": {id}, "image_id": {id}, "category_id": 1, "bbox": [1, 2, 30, 40]}}"#)
            })
            .collect();
        format!(
            r#"{{"images": [{}], "annotations": [{}], "categories": []}}"#,
            images.join(","),
            boxes.join(",")
        )
    };
    let xml = |name: &str| format!("<annotation><filename>{name}</filename></annotation>");
    match how {
        "yolo, folders" | "yolo, folders of a configuration" | "yolo, lists" => {
            let (train, val) = match how {
                "yolo, folders" => ("images/train", "images/val"),
                "yolo, folders of a configuration" => ("images/reef", "images/wreck"),
                _ => ("images", "images"),
            };
            for (folder, name) in [(train, "a"), (train, "b"), (val, "c")] {
                image(&run, &format!("set/{folder}/{name}.png"));
                write(&run, &format!("set/{}/{name}.txt", folder.replace("images", "labels")), BOX);
            }
            match how {
                "yolo, lists" => {
                    write(&run, "set/one.txt", "./images/a.png\n./images/b.png\n");
                    write(&run, "set/two.txt", "./images/c.png\n");
                    write(&run, "set/data.yaml", "train: one.txt\nval: two.txt\nnames: [fish]\n");
                }
                _ => {
                    write(&run, "set/data.yaml", &format!("train: ../{train}\nval: {val}/\nnames: [fish]\n"));
                }
            }
        }
        "coco" | "coco, a file beside the images" => {
            let (one, two) = match how {
                "coco" => ("annotations/instances_train2017.json", "annotations/instances_val2017.json"),
                _ => ("train/_annotations.coco.json", "valid/_annotations.coco.json"),
            };
            for name in ["a", "b", "c"] {
                let folder = match (how, name) {
                    ("coco", _) => "images",
                    (_, "c") => "valid",
                    _ => "train",
                };
                image(&run, &format!("set/{folder}/{name}.png"));
            }
            write(&run, &format!("set/{one}"), &coco(&["a.png", "b.png"]));
            write(&run, &format!("set/{two}"), &coco(&["c.png"]));
        }
        "voc" => {
            for name in ["a", "b", "c"] {
                image(&run, &format!("set/JPEGImages/{name}.png"));
                write(&run, &format!("set/Annotations/{name}.xml"), &xml(&format!("{name}.png")));
            }
            for (list, names) in [
                ("train", "a\nb\n"),
                ("val", "c\n"),
                ("trainval", "a\nb\nc\n"),
                ("fish_train", "a  1\nb -1\n"),
            ] {
                write(&run, &format!("set/ImageSets/Main/{list}.txt"), names);
            }
        }
        "folders" => {
            for name in ["train/cod/a", "train/eel/b", "test/cod/c"] {
                image(&run, &format!("set/{name}.png"));
            }
        }
        "masks" => {
            for name in ["train/a", "train/b", "valid/c"] {
                image(&run, &format!("set/images/{name}.png"));
                image(&run, &format!("set/masks/{name}.png"));
            }
        }
        other => unreachable!("{other}"),
    }
    run
}

const HOWS: [&str; 8] = [
    "yolo, folders",
    "yolo, folders of a configuration",
    "yolo, lists",
    "coco",
    "coco, a file beside the images",
    "voc",
    "folders",
    "masks",
];

/// The images themselves that are there, masks left out.
fn stems(own: &BTreeSet<String>) -> String {
    let names = own.iter().filter(|name| !name.contains("masks/"));
    names.map(|name| name.rsplit('/').next().unwrap().trim_end_matches(".png")).collect::<Vec<_>>().join(" ")
}

#[test]
fn only_the_training_split_is_multiplied_and_others_are_copied_unchanged() {
    for how in HOWS {
        let run = with_splits(how);
        let said = run.ok(&AUGMENT).stdout;
        let (variants, own) = made(&run);
        let of_masks = if how == "masks" { 2 } else { 1 };
        assert_eq!((variants, stems(&own).as_str()), (2 * of_masks, "c"), "{how}: {said}");
        assert!(said.contains("2 variants of 2 images written"), "{how}: {said}");
        assert!(said.contains("copied unchanged: 1 images of other splits than train"), "{how}: {said}");
        run.ok(&["verify", "out", "--dataset", "set"]);
        // What is copied is as it was, and listed where it was listed.
        let all = files(&run.path("out"));
        for name in all.iter().filter(|name| run.path("set").join(name).exists() && name.contains("/c.")) {
            assert_eq!(run.bytes(&format!("out/{name}")), run.bytes(&format!("set/{name}")), "{how}: {name}");
        }
        let key = own.iter().find(|name| !name.contains("masks/")).unwrap();
        let refused = run.fails(2, &["replay", "out", "-o", "again", "--only", key]).stderr;
        assert!(refused.contains("its split was not multiplied"), "{refused}");
        run.ok(&["replay", "out", "-o", "again"]);
        let again = run.ok(&AUGMENT).stdout;
        assert!(again.contains("nothing is left to do"), "{how}: {again}");
        let other = run.fails(2, &[&AUGMENT[..], &["--splits", "all"]].concat()).stderr;
        assert!(other.contains("splits"), "{how}: {other}");
    }
}

#[test]
fn lists_and_annotations_name_what_is_copied_and_variants_of_the_rest() {
    let text = |run: &Run, name: &str| String::from_utf8(run.bytes(name)).unwrap();
    let run = with_splits("voc");
    run.ok(&AUGMENT);
    assert_eq!(text(&run, "out/ImageSets/Main/train.txt"), "a__green__0\nb__green__0\n");
    assert_eq!(text(&run, "out/ImageSets/Main/val.txt"), "c\n");
    assert_eq!(text(&run, "out/ImageSets/Main/trainval.txt"), "a__green__0\nb__green__0\nc\n");
    let run = with_splits("yolo, lists");
    run.ok(&[&BARE[..], &["--keep-originals"]].concat());
    assert_eq!(text(&run, "out/two.txt"), "./images/c.png\n");
    assert!(text(&run, "out/one.txt").starts_with("./images/a.png\n./images/a__green__0.png\n"));
    let run = with_splits("coco");
    run.ok(&AUGMENT);
    let val = text(&run, "out/annotations/instances_val2017.json");
    assert!(val.contains("\"c.png\"") && !val.contains("green") && val.contains("[1, 2, 30, 40]"), "{val}");
    let train = text(&run, "out/annotations/instances_train2017.json");
    assert!(train.contains("\"a__green__0.png\"") && !train.contains("\"a.png\""), "{train}");
}

#[test]
fn splits_are_chosen_by_name_and_must_be_there() {
    for (splits, variants, own) in [("all", 3, ""), ("val", 1, "a b"), ("train,val", 3, "")] {
        let run = with_splits("yolo, folders");
        run.ok(&[&AUGMENT[..], &["--splits", splits]].concat());
        let (made, rest) = made(&run);
        assert_eq!((made, stems(&rest).as_str()), (variants, own), "{splits}");
    }
    let run = with_splits("yolo, folders");
    let said = run.fails(2, &[&AUGMENT[..], &["--splits", "test"]].concat()).stderr;
    assert!(said.contains("has no image of the split test"), "{said}");
    let said = run.fails(2, &[&AUGMENT[..], &["--splits", "valid"]].concat()).stderr;
    assert!(said.contains("give all, or some of train,val,test"), "{said}");
    // One split alone is the whole dataset.
    std::fs::remove_dir_all(run.path("set/images/train")).unwrap();
    std::fs::remove_dir_all(run.path("set/labels/train")).unwrap();
    run.ok(&AUGMENT);
    assert_eq!(made(&run).0, 1);
}

#[test]
fn a_shard_of_another_split_is_copied_byte_for_byte() {
    let run = with_water();
    image(&run, "a.png");
    std::fs::create_dir(run.path("set")).unwrap();
    for name in ["fish-train-000.tar", "fish-val-000.tar"] {
        let mut shard = tar::Builder::new(std::fs::File::create(run.path("set").join(name)).unwrap());
        shard.append_path_with_name(run.path("a.png"), "a.png").unwrap();
        shard.finish().unwrap();
    }
    run.ok(&AUGMENT);
    assert_eq!(run.bytes("out/fish-val-000.tar"), run.bytes("set/fish-val-000.tar"));
    assert_ne!(run.bytes("out/fish-train-000.tar"), run.bytes("set/fish-train-000.tar"));
    run.ok(&["verify", "out", "--dataset", "set"]);
}

#[test]
fn hidden_labels_are_named_and_never_lost_in_silence() {
    for hidden in [
        "set/.labels/a.txt",
        "set/labels/.a.txt",
        "set/.hidden/labels/a.txt",
        "set/.annotations/a.json",
        "set/labels/._a.txt",
    ] {
        let run = with_water();
        image(&run, "set/images/a.png");
        write(&run, hidden, BOX);
        let said = run.fails(2, &AUGMENT).stderr;
        let name = hidden.strip_prefix("set/").unwrap();
        assert!(said.contains(name) && said.contains("begin with a dot"), "{hidden}: {said}");
        assert!(!run.path("out").exists());
        let said = run.ok(&[&AUGMENT[..], &["--format", "folder"]].concat()).stdout;
        assert!(said.contains(name), "{said}");
    }
    // Those of programs are nobody's labels.
    let run = with_water();
    image(&run, "set/images/a.png");
    write(&run, "set/._a.txt", "\0\u{5}\u{16}\u{7}of macOS");
    for name in [".DS_Store", ".git/a.txt", ".ipynb_checkpoints/a.json", ".gitattributes"] {
        write(&run, &format!("set/{name}"), "x");
    }
    let said = run.ok(&AUGMENT).stdout;
    assert!(!said.contains("left out"), "{said}");
    #[cfg(unix)]
    {
        // Neither is what cannot be read, or is no file.
        use std::os::unix::fs::PermissionsExt;
        std::fs::create_dir(run.path("set/.locked")).unwrap();
        std::fs::set_permissions(run.path("set/.locked"), std::fs::Permissions::from_mode(0o0)).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(run.path("set/.pipe")).status().unwrap().success());
        run.ok(&[&AUGMENT[..], &["--overwrite"]].concat());
    }
    image(&run, "set/images/.b.png");
    let said = run.ok(&[&AUGMENT[..], &["--overwrite"]].concat());
    assert!(
        (said.stdout.clone() + &said.stderr).contains("1 .png hidden (images/.b.png)"),
        "{}",
        said.stdout
    );
}

#[test]
fn annotations_are_known_by_their_content_where_their_names_say_nothing() {
    for (name, text) in [
        ("set/instances_train", "{\"images\": [], \"annotations\": []}"),
        ("set/export.label2", "\u{feff} [{\"box\": [1, 2]}]"),
        ("set/all.out", "<?xml version=\"1.0\"?><annotations></annotations>"),
    ] {
        let run = with_water();
        image(&run, "set/images/a.png");
        write(&run, name, text);
        let said = run.fails(2, &AUGMENT).stderr;
        assert!(said.contains(name.strip_prefix("set/").unwrap()), "{name}: {said}");
    }
    let run = with_water();
    image(&run, "set/images/a.png");
    for (name, text) in [("README.md", "[a link](b)"), ("notes", "[1] two fish"), ("run.sh", "{ true; }")] {
        write(&run, &format!("set/{name}"), text);
    }
    run.ok(&AUGMENT);
}

#[test]
fn the_summary_counts_what_has_no_variants() {
    let run = with_water();
    image(&run, "set/images/a.png");
    let flat = aquafuse::image::Image::<u8>::from_raw(96, 64, vec![120; 3 * 96 * 64]).unwrap();
    ImageFile::new(flat).write(&run.path("set/images/flat.jpg"), &WriteOptions::default()).unwrap();
    let skip = ["augment", "set", "preset:jerlov-3C", "-o", "out", "--on-doubtful", "skip"];
    let said = run.ok(&skip).stdout;
    assert!(said.contains("without variants, because their estimate is not good: "), "{said}");
    std::fs::write(run.path("set/images/bad.png"), "no image").unwrap();
    let said = run.fails(1, &skip).stdout;
    assert!(said.contains("failed: 1"), "{said}");
}

#[test]
fn what_augment_has_made_is_a_dataset_again() {
    let run = with_splits("yolo, folders");
    run.ok(&[&BARE[..], &["--keep-originals"]].concat());
    assert!(run.path("out/preview.jpg").exists());
    let said = run.ok(&["augment", "out", "green.png", "-o", "twice", "--dry-run"]).stdout;
    assert!(!said.contains("left out") && said.contains("splits: train 4, val 1"), "{said}");
    let run = with_splits("folders");
    run.ok(&AUGMENT);
    let said = run.ok(&["augment", "out", "green.png", "-o", "twice", "--dry-run"]).stdout;
    assert!(!said.contains("left out") && said.contains("would make 2 variants of 2 images"), "{said}");
    // Its manifest is no annotation of somebody else.
    for name in files(&run.path("out")).iter().filter(|name| name.ends_with(".png")) {
        std::fs::remove_file(run.path("out").join(name)).unwrap();
    }
    let said = run.fails(2, &["augment", "out", "green.png", "-o", "twice"]).stderr;
    assert!(said.contains("holds no images") && !said.contains("manifest"), "{said}");
}

#[test]
fn a_sidecar_goes_with_each_variant_and_names_it() {
    let labelme = r#"{"version": "5.0", "shapes": [{"points": [[1.5, 2], [30, 40]]}], "imagePath": "a.png", "imageData": "iVBORw0KGgo=", "imageHeight": 64}"#;
    for place in ["set/a.json", "set/images/a.json", "set/annotations/a.json", "set/images/a.png.json"] {
        let run = with_water();
        let image_at = if place.starts_with("set/a.json") { "set/a.png" } else { "set/images/a.png" };
        image(&run, image_at);
        write(&run, place, labelme);
        run.fails(2, &AUGMENT);
        run.ok(&[&BARE[..], &["--sidecar", "json", "--keep-originals"]].concat());
        let variant = match place.strip_suffix(".png.json") {
            Some(begin) => format!("{begin}__green__0.png.json"),
            None => place.replace("a.json", "a__green__0.json"),
        };
        let text = String::from_utf8(run.bytes(&variant.replacen("set", "out", 1))).unwrap();
        let expected =
            labelme.replace("\"a.png\"", "\"a__green__0.png\"").replace("\"iVBORw0KGgo=\"", "null");
        assert_eq!(text, expected, "{place}");
        assert_eq!(run.bytes(&place.replacen("set", "out", 1)), labelme.as_bytes());
        run.ok(&["verify", "out", "--dataset", "set"]);
    }
    // Beside the labels of a layout that is read.
    let run = with_splits("yolo, folders");
    write(&run, "set/images/train/a.caption", "two cod in a.png");
    run.ok(&[&AUGMENT[..], &["--sidecar", ".caption"]].concat());
    assert_eq!(run.bytes("out/images/train/a__green__0.caption"), b"two cod in a__green__0.png");
    assert!(run.path("out/labels/train/a__green__0.txt").exists());
}

#[test]
fn the_preview_shows_boxes_outlines_and_masks_on_images_and_variants() {
    for how in HOWS {
        let run = with_splits(how);
        run.ok(&[&AUGMENT[..], &["--preview", "1"]].concat());
        let sheet = ImageFile::read(&run.path("out/preview.jpg")).unwrap();
        assert_eq!(sheet.pixels.size(), (8 + 2 * 328, 8 + 270), "{how}");
        let bytes = sheet.bytes();
        let yellow = |from: usize| {
            let cells =
                bytes.pixels().chunks(bytes.width()).flat_map(move |row| row.iter().skip(from).take(320));
            cells.filter(|[r, g, b]| *r > 170 && *g > 140 && *b < 130).count()
        };
        if how.starts_with("yolo") || how.starts_with("coco") {
            assert!(yellow(8) > 100 && yellow(336) > 100, "{how}: {} {}", yellow(8), yellow(336));
        }
        std::fs::write(run.path("out/preview.jpg"), "other").unwrap();
        assert!(run.fails(1, &["verify", "out"]).stderr.contains("preview.jpg"));
    }
    let run = with_splits("folders");
    run.ok(&[&AUGMENT[..], &["--preview", "0"]].concat());
    assert!(!run.path("out/preview.jpg").exists());
    // An image of the dataset keeps its name.
    scene(&run.path("set/preview.jpg"), 3, "blue");
    run.ok(&[&BARE[..], &["--keep-originals", "--overwrite"]].concat());
    assert_eq!(run.bytes("out/preview.jpg"), run.bytes("set/preview.jpg"));
    run.ok(&["verify", "out"]);
}
