//! The forms in which people have their datasets.

use super::*;

#[test]
fn coco_is_read_as_tools_write_it() {
    let marked = format!("\u{feff}{COCO}");
    let wide: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let in_windows = COCO.replace("a.jpg", "images\\\\a.jpg").replace("b.jpg", "images\\\\b.jpg");
    let floats = COCO.replace("\"image_id\": 9", "\"image_id\": 9.0");
    let strings =
        COCO.replace("\"id\": 7", "\"id\": \"x\"").replace("\"image_id\": 7", "\"image_id\": \"x\"");
    let no_box = COCO.replace("[1.0, 2, 30.25, 40]", "[]");
    for text in [
        marked.as_bytes(),
        &wide,
        in_windows.as_bytes(),
        floats.as_bytes(),
        strings.as_bytes(),
        no_box.as_bytes(),
    ] {
        let set = coco(COCO);
        fs::write(set.path().join("annotations/instances.json"), text).unwrap();
        let found = opened(&set);
        let said = String::from_utf8_lossy(text);
        assert_eq!((found.layout, faults(&found)), (Layout::Coco, Vec::new()), "{said}");
        assert_eq!(keys(&found), ["images/a.jpg", "images/b.jpg"], "{said}");
    }
    for (from, to, cause) in [
        ("[1.0, 2, 30.25, 40]", "[\"1\", \"2\", \"3\", \"4\"]", "its box is not a list of numbers"),
        ("\"id\": 3", "\"id\": 9223372036854775808", "the id is 9223372036854775808, but must be from"),
        ("\"image_id\": 9", "\"image_id\": null", "of its image the id is null, but must be"),
        ("\"caption\": \"two fish\"", "\"segments_info\": []", "a panoptic map"),
    ] {
        let found = opened(&coco(&COCO.replace(from, to)));
        assert!(faults(&found).iter().any(|fault| fault.contains(cause)), "{to}: {:?}", faults(&found));
    }
}

#[test]
fn images_of_coco_are_found_by_split_wherever_they_stand() {
    let of = |name: &str| COCO.replace("b.jpg", &format!("{name}.jpg"));
    let set = folder(&[
        ("SET/SET_ANN/instances_train.json", &of("c")),
        ("SET/SET_ANN/instances_test.json", &of("d")),
        ("SET/SET_pic/train/a.jpg", ""),
        ("SET/SET_pic/train/c.jpg", ""),
        ("SET/SET_pic/test/a.jpg", ""),
        ("SET/SET_pic/test/d.jpg", ""),
    ]);
    let found = opened(&set);
    assert_eq!(faults(&found), Vec::<String>::new());
    assert_eq!((found.samples.len(), found.indices.len()), (4, 2));
    // No image of another split takes the place of one that is missing.
    fs::remove_file(set.path().join("SET/SET_pic/test/a.jpg")).unwrap();
    assert!(faults(&opened(&set))[0].contains("the dataset has no image \"a.jpg\""));
}

#[test]
fn labels_of_yolo_are_found_under_all_names() {
    let line = "0 0.5 0.5 0.1 0.1\n";
    for (key, path) in [
        ("Images/train/A.JPG", "Labels/train/a.txt"),
        ("images/a.jpg", "labels/a.jpg.txt"),
        ("img/a.jpg", "label/a.txt"),
        ("train/a.jpg", "train/labels/a.txt"),
        ("train/images/a.jpg", "labels/train/a.txt"),
        ("obj_train_data/a.PNG", "obj_train_data/a.txt"),
        ("a.jpg", "a.txt"),
    ] {
        let found = opened(&folder(&[(key, ""), (path, line)]));
        assert_eq!((found.layout, faults(&found)), (Layout::Yolo, Vec::new()), "{path}");
        assert_eq!(companions(&found), [[path]]);
        assert!(found.left_out.is_empty(), "{}", found.left_out);
    }
    // What is beside an image may be any text.
    let found = Dataset::open(
        folder(&[("a.jpg", ""), ("a.txt", "two fish\n")]).path(),
        None,
        &ReadOptions::default(),
    );
    assert!(matches!(found, Err(DatasetError::Unread { .. })));
    let classes = folder(&[
        ("images/a.jpg", ""),
        ("labels/a.txt", "2 0.5 0.5 0.1 0.1\n3 0.5 0.5 0.1 0.1\n"),
        ("labels/classes.txt", "one\ntwo\nthree\n"),
        ("classes.txt", "one\ntwo\nthree\n"),
    ]);
    assert_eq!(faults(&opened(&classes)), ["labels/a.txt:2: the class is 3, but the highest of 3 is 2"]);
}

#[test]
fn lists_of_images_are_found_behind_folders_of_other_machines() {
    let set = folder(&[
        ("obj_train_data/a.jpg", ""),
        ("obj_train_data/a.txt", "0 0.5 0.5 0.1 0.1\n"),
        ("obj.data", "train = data/train.txt\n"),
        ("brackish.names", "fish\n"),
        ("train.txt", "data/obj_train_data/a.jpg\n"),
    ]);
    let found = opened(&set);
    assert_eq!(
        found.indices.iter().map(Index::path).collect::<Vec<_>>(),
        ["brackish.names", "obj.data", "train.txt"]
    );
    assert!(matches!(found.indices[2], Index::Paths { .. }) && found.left_out.is_empty());
}

#[test]
fn annotations_of_voc_are_found_beside_images_and_in_folders_of_other_names() {
    let xml = "<annotation><frame>a</frame></annotation>";
    for (key, path) in [
        ("a.jpg", "a.xml"),
        ("train/image/a.jpg", "train/box/a.xml"),
        ("train/a.jpg", "train/annotations/a.xml"),
        ("images/train/a.JPG", "annotations/train/A.xml"),
        ("images/a.jpg", "Annotations/xmls/a.xml"),
    ] {
        let found = opened(&folder(&[(key, ""), (path, xml)]));
        assert_eq!((found.layout, faults(&found)), (Layout::Voc, Vec::new()), "{path}");
        assert_eq!(companions(&found), [[path]]);
    }
    let twice = folder(&[("a.jpg", ""), ("a.xml", xml), ("annotations/a.xml", xml)]);
    assert_eq!(faults(&opened(&twice)), ["annotations/a.xml: a.xml is about a.jpg too"]);
}

#[test]
fn masks_are_found_in_splits_and_in_folders_of_classes() {
    for (key, masks) in [
        ("Segmentation/images/valid/a.jpg", &["Segmentation/masks/valid/a.png"][..]),
        ("images/a.jpg", &["labels/a.png"]),
        ("img_dir/train/a.jpg", &["ann_dir/train/a.png"]),
        ("TEST/images/a.jpg", &["TEST/masks/FV/a.bmp", "TEST/masks/a.bmp"]),
        ("images/train/a.jpg", &["masks/fish/train/a.png", "masks/train/fish/a_mask.png"]),
        ("a.jpg", &["masks/a.png"]),
        ("rgb/a.jpg", &["depth/a.tif"]),
        ("train/a.png", &["train_labels/a.png"]),
        ("train/a.png", &["trainannot/a.png"]),
        ("Images/a.jpg", &["GroundTruth/a_GT.png"]),
        ("JPEGImages/a.jpg", &["SegmentationClass/a.png", "SegmentationObject/a.png"]),
        ("train/images/a.jpg", &["masks/train/a.png"]),
        ("images_train/a.jpg", &["CombinedMasks_train/a.png"]),
        ("images/train/a.png", &["GTFINE/train/a.png"]),
    ] {
        let files: Vec<(&str, &str)> = [key].iter().chain(masks).map(|path| (*path, "")).collect();
        let found = opened(&folder(&files));
        assert_eq!((found.layout, faults(&found)), (Layout::Masks, Vec::new()), "{key}");
        assert_eq!((keys(&found), companions(&found)), (vec![key], vec![masks.to_vec()]));
    }
    // No mask of another split.
    let set = folder(&[
        ("train/a.png", ""),
        ("train_labels/a.png", ""),
        ("val/a.png", ""),
        ("val_labels/a.png", ""),
    ]);
    assert_eq!(companions(&opened(&set)), [["train_labels/a.png"], ["val_labels/a.png"]]);
    // Other layouts carry masks too.
    let both = folder(&[("images/a.jpg", ""), ("labels/a.txt", "0 0.5 0.5 0.1 0.1\n"), ("masks/a.png", "")]);
    assert_eq!(companions(&opened(&both)), [["labels/a.txt", "masks/a.png"]]);
}
