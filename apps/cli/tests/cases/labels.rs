//! Labels of YOLO and Pascal VOC where their tools put them, and formats that are not read.

use super::{LINE, augmented, has, refused, with_images, write};

/// A label of YOLO goes with its image's variant, wherever both stand.
fn carried(image: &str, label: &str, content: impl AsRef<[u8]>) {
    let run = with_images(&[image]);
    write(&run, label, content.as_ref());
    augmented(&run);
    let variant = |path: &str| {
        let (folder, name) = path.rsplit_once('/').map_or(("", path), |(folder, name)| (folder, name));
        let (stem, end) = name.split_once('.').unwrap();
        let between = if folder.is_empty() { "" } else { "/" };
        format!("{folder}{between}{stem}__green__0.{end}")
    };
    has(&run, &[image, label, &variant(image), &variant(label)]);
    assert_eq!(run.bytes(&format!("out/{}", variant(label))), content.as_ref());
}

#[test]
fn yolo_labels_uppercase() {
    carried("Images/a.png", "Labels/a.txt", LINE);
}

#[test]
fn yolo_jpg_txt() {
    carried("images/a.png", "labels/a.png.txt", LINE);
}

#[test]
fn yolo_bom() {
    carried("images/a.png", "labels/a.txt", format!("\u{feff}{LINE}"));
}

#[test]
fn yolo_overhang() {
    // .3 of 96 pixels.
    carried("images/a.png", "labels/a.txt", "0 0.9 0.5 0.206 0.2\n");
}

#[test]
fn cvat_yolo11() {
    let run = with_images(&["obj_train_data/a.png"]);
    write(&run, "obj_train_data/a.txt", LINE);
    write(&run, "obj.names", "fish\n");
    write(&run, "obj.data", "classes = 1\ntrain = data/train.txt\n");
    write(&run, "train.txt", "data/obj_train_data/a.png\n");
    augmented(&run);
    let variant = "obj_train_data/a__green__0";
    let variants = [format!("{variant}.png"), format!("{variant}.txt")];
    has(
        &run,
        &[
            "obj.data",
            "obj.names",
            "obj_train_data/a.png",
            "obj_train_data/a.txt",
            &variants[0],
            &variants[1],
            "train.txt",
        ],
    );
    let list = String::from_utf8(run.bytes("out/train.txt")).unwrap();
    assert!(list.contains("data/obj_train_data/a__green__0.png\n"), "{list}");
}

fn voc(name: &str, class: &str) -> String {
    let sides = "<xmin>1</xmin><ymin>2</ymin><xmax>30</xmax><ymax>40</ymax>";
    format!(
        "<annotation><filename>{name}</filename><object><name>{class}</name><bndbox>{sides}</bndbox></object></annotation>"
    )
}

/// An annotation of Pascal VOC goes with its image's variant and names it.
fn annotated(image: &str, annotation: &str, text: &[u8]) {
    let run = with_images(&[image]);
    write(&run, annotation, text);
    augmented(&run);
    let made = run.bytes(&format!("out/{}", annotation.replace(".xml", "__green__0.xml")));
    let has = |words: &[u8]| made.windows(words.len()).any(|part| part == words);
    assert!(has(b"<filename>a__green__0.png</filename>") && has(b"<xmax>30</xmax>"));
    assert!(run.path(&format!("out/{}", image.replace(".png", "__green__0.png"))).exists());
}

#[test]
fn voc_beside_pictures() {
    annotated("a.png", "a.xml", voc("a.png", "fish").as_bytes());
}

#[test]
fn voc_urpc() {
    annotated("train/image/a.png", "train/box/a.xml", voc("a.png", "echinus").as_bytes());
}

#[test]
fn voc_gb2312() {
    let text = format!("<?xml version=\"1.0\" encoding=\"gb2312\"?>{}", voc("a.png", "?"));
    // The word "fish" in that encoding.
    let bytes: Vec<u8> = text.replacen("<name>?", "<name>", 1).into_bytes();
    let at = bytes.windows(6).position(|part| part == b"<name>").unwrap() + 6;
    let bytes = [&bytes[..at], &[0xd3, 0xe3], &bytes[at..]].concat();
    annotated("JPEGImages/a.png", "Annotations/a.xml", &bytes);
}

#[test]
fn labelme() {
    let run = with_images(&["a.png"]);
    write(&run, "a.json", r#"{"version": "5.4", "shapes": [], "imagePath": "a.png", "imageData": null}"#);
    refused(&run, &["1 .json (a.json)", "labelme2coco", "--format folder"]);
}

#[test]
fn cvat_xml() {
    let run = with_images(&["images/a.png"]);
    write(&run, "annotations.xml", "<annotations><image id=\"0\" name=\"a.png\"/></annotations>");
    refused(&run, &["1 .xml (annotations.xml)", "export them from CVAT as COCO"]);
}

#[test]
fn csv_boxes() {
    let run = with_images(&["train/a.png"]);
    write(&run, "train/_annotations.csv", "filename,class,xmin,ymin,xmax,ymax\na.png,fish,1,2,30,40\n");
    refused(&run, &["1 .csv (train/_annotations.csv)", "convert it to COCO"]);
}

#[test]
fn shards_input_jpg() {
    let run = with_images(&[]);
    std::fs::create_dir_all(run.path("set")).unwrap();
    crate::run::scene(&run.path("photo.jpg"), 1, "blue");
    let mut shard = tar::Builder::new(std::fs::File::create(run.path("set/s0.tar")).unwrap());
    for (name, bytes) in [
        ("sample0.input.jpg", run.bytes("photo.jpg")),
        ("sample0.outputs.txt", b"two fish".to_vec()),
        ("sample1.input.jpg", run.bytes("photo.jpg")),
        ("sample1.outputs.txt", b"one crab".to_vec()),
    ] {
        let mut header = tar::Header::new_gnu();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        shard.append_data(&mut header, name, &bytes[..]).unwrap();
    }
    shard.into_inner().unwrap();
    let said = augmented(&run).stdout;
    assert!(said.contains("2 variants of 1 shards"), "{said}");
}
