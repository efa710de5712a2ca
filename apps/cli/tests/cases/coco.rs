//! Files of COCO as their tools write them.

use super::{augmented, has, made, refused, with_images, write};

/// A file about images of these names, with a box each.
fn about(names: &[&str]) -> String {
    let list = |form: &dyn Fn(usize, &str) -> String| {
        names.iter().enumerate().map(|(id, name)| form(id + 1, name)).collect::<Vec<_>>().join(",\n")
    };
    format!(
        "{{\"images\": [{}],\n\"annotations\": [{}],\n\"categories\": [{{\"id\": 1, \"name\": \"fish\"}}]}}",
        list(&|id, name| format!(r#"{{"id": {id}, "file_name": "{name}", "width": 96, "height": 64}}"#)),
        list(&|id, _| format!(
            r#"{{"id": {id}, "image_id": {id}, "category_id": 1, "bbox": [1, 2, 30, 40]}}"#
        )),
    )
}

const TWO: [&str; 2] = ["images/a.png", "images/b.png"];
const FILES: [&str; 5] =
    ["annotations.json", "images/a.png", "images/a__green__0.png", "images/b.png", "images/b__green__0.png"];

/// Whether a file of the output has so many boxes.
fn boxes(run: &crate::run::Run, file: &str, count: usize) {
    let text = String::from_utf8(run.bytes(&format!("out/{file}"))).unwrap();
    assert_eq!(text.matches("[1, 2, 30, 40]").count(), count, "{text}");
}

#[test]
fn coco_bom() {
    let run = with_images(&TWO);
    write(&run, "annotations.json", format!("\u{feff}{}", about(&["a.png", "b.png"])));
    augmented(&run);
    has(&run, &FILES);
    boxes(&run, "annotations.json", 4);
}

#[test]
fn coco_nan() {
    let run = with_images(&TWO);
    write(&run, "annotations.json", about(&["a.png"]).replace("\"bbox\"", "\"area\": NaN, \"bbox\""));
    refused(&run, &["annotations.json: it is not JSON", "line 2 column", "NaN and Infinity are no JSON"]);
}

#[test]
fn coco_truncated() {
    let run = with_images(&TWO);
    write(&run, "annotations.json", &about(&["a.png"])[..100]);
    refused(&run, &["annotations.json: it is not JSON: it ends too early, at line 2 column"]);
}

#[test]
fn coco_odd_values() {
    let run = with_images(&TWO);
    let text = about(&["a.png", "b.png"]);
    write(&run, "annotations.json", text.replacen("[1, 2, 30, 40]", "[\"1\", \"2\", \"3\", \"4\"]", 1));
    refused(&run, &["annotations.json, annotations[0]: its box is not a list of numbers"]);
    write(
        &run,
        "annotations.json",
        text.replacen("{\"id\": 2, \"image_id\"", "{\"id\": 9223372036854775808, \"image_id\"", 1),
    );
    refused(&run, &["annotations[1]: the id is 9223372036854775808, but must be from -9223372036854775808"]);
    write(&run, "annotations.json", text.replacen("[1, 2, 30, 40]", "[]", 1));
    augmented(&run);
    boxes(&run, "annotations.json", 2);
}

#[test]
fn coco_backslash() {
    let run = with_images(&TWO);
    write(&run, "annotations.json", about(&[r"images\\a.png", r"images\\b.png"]));
    augmented(&run);
    has(&run, &FILES);
    boxes(&run, "annotations.json", 4);
}

#[test]
fn coco_float_ids() {
    let run = with_images(&TWO);
    write(
        &run,
        "annotations.json",
        about(&["a.png", "b.png"]).replace("\"image_id\": 1", "\"image_id\": 1.0"),
    );
    augmented(&run);
    boxes(&run, "annotations.json", 4);
}

#[test]
fn coco_trashcan() {
    let folder = "instance_version";
    let run = with_images(&[&format!("{folder}/train/a.png"), &format!("{folder}/val/b.png")]);
    write(&run, &format!("{folder}/instances_train_trashcan.json"), about(&["a.png"]));
    write(&run, &format!("{folder}/instances_val_trashcan.json"), about(&["b.png"]));
    augmented(&run);
    for split in ["train", "val"] {
        boxes(&run, &format!("{folder}/instances_{split}_trashcan.json"), 2);
    }
    assert!(made(&run).contains(&format!("{folder}/val/b__green__0.png")));
}

#[test]
fn coco_ruod() {
    let run = with_images(&["RUOD/RUOD_pic/train/a.png", "RUOD/RUOD_pic/test/b.png"]);
    write(&run, "RUOD/RUOD_ANN/instances_train.json", about(&["a.png"]));
    write(&run, "RUOD/RUOD_ANN/instances_test.json", about(&["b.png"]));
    augmented(&run);
    for split in ["train", "test"] {
        boxes(&run, &format!("RUOD/RUOD_ANN/instances_{split}.json"), 2);
    }
    // The same from the folder below.
    run.ok(&["augment", "set/RUOD", "green.png", "-o", "below", "--splits", "all", "--keep-share", "0"]);
    assert!(run.path("below/RUOD_ANN/instances_train.json").exists());
    assert!(run.path("below/RUOD_pic/train/a__green__0.png").exists());
}
