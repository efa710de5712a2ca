mod forms;
mod losses;

use std::fs;

use super::*;

/// A folder with these files; `jpg` and `png` need not be images, for none is opened.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

const COCO: &str = r#"{"info": {"year": 2024},
"images": [{"id": 7, "file_name": "a.jpg", "width": 64, "height": 48, "licence": 1.50},
           {"file_name": "b.jpg", "id": 9, "width": 64, "height": 48}],
"annotations": [{"id": 3, "image_id": 7, "bbox": [1.0, 2, 30.25, 40], "score": 1e-3, "category_id": 1},
                {"id": 5, "image_id": 9, "caption": "two fish"}],
"categories": [{"id": 1, "name": "fish"}]}"#;

fn coco(text: &str) -> tempfile::TempDir {
    folder(&[("annotations/instances.json", text), ("images/a.jpg", "a"), ("images/b.jpg", "b")])
}

fn opened(folder: &tempfile::TempDir) -> Dataset {
    Dataset::open(folder.path(), None, &ReadOptions::default()).unwrap()
}

fn faults(dataset: &Dataset) -> Vec<String> {
    dataset.faults.first().iter().map(ToString::to_string).collect()
}

fn keys(dataset: &Dataset) -> Vec<&str> {
    dataset.samples.iter().map(|sample| sample.key.as_str()).collect()
}

fn companions(dataset: &Dataset) -> Vec<Vec<&str>> {
    let of = |sample: &'_ Sample| sample.companions.iter().map(|companion| companion.path.clone()).collect();
    let all: Vec<Vec<String>> = dataset.samples.iter().map(of).collect();
    all.into_iter().map(|paths| paths.into_iter().map(|path| &*path.leak()).collect()).collect()
}

#[test]
fn each_layout_is_told_by_looking() {
    let yolo = [("images/train/a.jpg", ""), ("labels/train/a.txt", "0 0.5 0.5 0.1 0.1\n")];
    let voc = [
        ("Annotations/a.xml", "<annotation><filename>a.jpg</filename></annotation>"),
        ("JPEGImages/a.jpg", ""),
    ];
    let masks = [("images/a.jpg", ""), ("masks/a.png", "")];
    let plain = [("reef/a.jpg", ""), ("wreck/b.jpg", ""), ("notes.txt", "")];
    for (files, layout) in
        [(&yolo[..], Layout::Yolo), (&voc, Layout::Voc), (&masks, Layout::Masks), (&plain, Layout::Folder)]
    {
        let found = opened(&folder(files));
        assert_eq!((found.layout, faults(&found)), (layout, Vec::new()));
    }
    assert_eq!(opened(&coco(COCO)).layout, Layout::Coco);
}

#[test]
fn two_layouts_are_refused_by_name_and_none_too() {
    let both =
        folder(&[("images/a.jpg", ""), ("labels/a.txt", "0 0.5 0.5 0.1 0.1"), ("instances.json", COCO)]);
    let said = Dataset::open(both.path(), None, &ReadOptions::default()).unwrap_err().to_string();
    assert!(said.contains("coco (instances.json") && said.contains("yolo (labels/a.txt"), "{said}");
    assert_eq!(
        keys(&Dataset::open(both.path(), Some(Layout::Yolo), &ReadOptions::default()).unwrap()),
        ["images/a.jpg"]
    );
    let none = folder(&[("notes.txt", "")]);
    assert!(matches!(
        Dataset::open(none.path(), None, &ReadOptions::default()),
        Err(DatasetError::Empty { .. })
    ));
}

#[test]
fn images_come_with_what_is_about_them() {
    let yolo = folder(&[
        ("data.yaml", "names: [fish]\n"),
        ("train/images/a.jpg", ""),
        ("train/images/empty.jpg", ""),
        ("train/labels/a.txt", "0 0.5 0.5 0.1 0.1\n"),
        ("classes.txt", "fish"),
    ]);
    let found = opened(&yolo);
    assert_eq!(companions(&found), [vec!["train/labels/a.txt"], vec![]]);
    assert_eq!(found.indices.iter().map(Index::path).collect::<Vec<_>>(), ["data.yaml", "classes.txt"]);

    let voc = folder(&[
        ("VOC/Annotations/x.xml", "<annotation><filename>a.jpg</filename></annotation>"),
        ("VOC/JPEGImages/a.jpg", ""),
        ("VOC/JPEGImages/b.jpg", ""),
        ("VOC/SegmentationClass/x.png", ""),
        ("VOC/ImageSets/Main/train.txt", "a\n"),
    ]);
    let found = opened(&voc);
    assert_eq!(keys(&found), ["VOC/JPEGImages/a.jpg", "VOC/JPEGImages/b.jpg"]);
    assert_eq!(companions(&found)[0], ["VOC/Annotations/x.xml", "VOC/SegmentationClass/x.png"]);
    assert_eq!(found.indices.len(), 1);

    let masks =
        folder(&[("images/a.jpg", ""), ("images/b.jpg", ""), ("masks/a.png", ""), ("masks/b_mask.png", "")]);
    assert_eq!(companions(&opened(&masks)), [["masks/a.png"], ["masks/b_mask.png"]]);
}

#[test]
fn bad_annotations_are_named_with_their_place() {
    for (from, to, said) in [
        ("[1.0, 2, 30.25, 40]", "[1.0, 2, 90, 40]", "annotations[0]: the box 1, 2, 90, 40 is not inside"),
        ("\"b.jpg\"", "\"c.jpg\"", "images[1]: the dataset has no image \"c.jpg\""),
        ("\"b.jpg\"", "\"../b.jpg\"", "with `..`"),
        ("\"b.jpg\"", "\"/b.jpg\"", "an absolute name"),
        ("\"b.jpg\"", "\"a.jpg\"", "has more than one entry"),
        ("\"id\": 9", "\"id\": 7", "another image has its id 7"),
        ("\"id\": 5", "\"id\": 3", "another annotation has its id 3"),
        ("\"image_id\": 9", "\"image_id\": 8", "no image has the id 8"),
        ("\"id\": 5", "\"id\": 5.5", "but must be a whole number"),
        ("[1.0, 2, 30.25, 40]", "[1.0, 2]", "2 numbers instead of 4"),
    ] {
        assert!(COCO.contains(from));
        let found = opened(&coco(&COCO.replace(from, to)));
        assert!(faults(&found).iter().any(|fault| fault.contains(said)), "{to}: {:?}", faults(&found));
    }
    let masks =
        folder(&[("images/a.jpg", ""), ("images/b.jpg", ""), ("masks/a.png", ""), ("masks/c.png", "")]);
    let found = opened(&masks);
    assert_eq!(
        faults(&found),
        ["images/b.jpg: it has no mask", "masks/c.png: no image belongs to this mask"]
    );
    assert_eq!(found.faults.first()[0].sample.as_deref(), Some("images/b.jpg"));
    let yolo = folder(&[
        ("images/a.jpg", ""),
        ("labels/a.txt", "0 0.5 0.5 0.1 0.1\n0 0.9 0.5 0.4 0.1\n"),
        ("labels/b.txt", ""),
    ]);
    let said = faults(&opened(&yolo));
    assert!(said[0].starts_with("labels/a.txt:2: the box reaches from 0.7000 to 1.1000"), "{said:?}");
    assert!(said[1].starts_with("labels/b.txt: no image belongs"), "{said:?}");
}

/// One annotation that is no text spoils no other, and a file that is too large is reported, not skipped.
#[test]
fn a_file_that_is_no_text_is_a_fault_of_its_image_and_one_too_large_is_refused() {
    let yolo = folder(&[("images/a.jpg", ""), ("images/b.jpg", ""), ("labels/b.txt", "0 .5 .5 .1 .1\n")]);
    fs::write(yolo.path().join("labels/a.txt"), b"0 .5 .5 .1 .1 \xe9\n").unwrap();
    fs::write(yolo.path().join("notes.txt"), b"\xe9\n").unwrap();
    let found = opened(&yolo);
    assert_eq!(
        faults(&found),
        ["labels/a.txt", "notes.txt"].map(|path| format!("{path}: it is not UTF-8 text; save it as UTF-8"))
    );
    assert!(found.faults.concern("images/a.jpg") && found.samples.len() == 2);

    let voc = folder(&[("JPEGImages/a.jpg", "")]);
    fs::create_dir(voc.path().join("Annotations")).unwrap();
    fs::write(voc.path().join("Annotations/a.xml"), b"<annotation><folder>\xe9</folder></annotation>")
        .unwrap();
    let found = opened(&voc);
    assert_eq!(faults(&found), ["Annotations/a.xml: it is not UTF-8 text; save it as UTF-8"]);
    assert!(found.faults.concern("JPEGImages/a.jpg"));

    let tight = ReadOptions { max_memory: 400, ..ReadOptions::default() };
    let said = Dataset::open(coco(COCO).path(), None, &tight).unwrap_err().to_string();
    assert!(said.contains("instances.json: it has") && said.contains("a quarter of --max-memory"), "{said}");
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_of_the_data_set_are_not_followed() {
    let elsewhere = folder(&[("secret.jpg", "")]);
    let own = folder(&[("a.jpg", "")]);
    std::os::unix::fs::symlink(elsewhere.path().join("secret.jpg"), own.path().join("b.jpg")).unwrap();
    std::os::unix::fs::symlink(elsewhere.path(), own.path().join("c")).unwrap();
    std::os::unix::fs::symlink(own.path(), own.path().join("loop")).unwrap();
    std::os::unix::fs::symlink(own.path().join("a.jpg"), own.path().join("d.jpg")).unwrap();
    let found = opened(&own);
    assert_eq!((keys(&found), found.faults.count()), (vec!["a.jpg", "d.jpg"], 3));
}

#[test]
fn lists_are_no_objects_of_coco() {
    let lists = folder(&[("a.jpg", ""), ("a.json", "[[1], [2]]")]);
    let plain = Dataset::open(lists.path(), Some(Layout::Folder), &ReadOptions::default()).unwrap();
    assert_eq!(plain.left_out.to_string(), "1 .json (a.json)");
    let entries =
        opened(&coco(&COCO.replace(r#"{"id": 5, "image_id": 9, "caption": "two fish"}"#, "[5, 9]")));
    let [fault] = entries.faults.first() else { panic!("{:?}", entries.faults) };
    assert!(fault.to_string().contains("annotations[1]"), "{fault}");
}
