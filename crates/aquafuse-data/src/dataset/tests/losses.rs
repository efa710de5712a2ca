//! No annotation is left out in silence, and no mask is an image.

use aquafuse::image::Image;

use super::*;
use crate::image_file::{ImageFile, WriteOptions};

fn unread(files: &[(&str, &str)]) -> String {
    let set = folder(files);
    match Dataset::open(set.path(), None, &ReadOptions::default()) {
        Err(error @ DatasetError::Unread { .. }) => error.to_string(),
        other => panic!("{files:?}: {other:?}"),
    }
}

#[test]
fn a_folder_is_plain_only_where_nothing_looks_like_annotations() {
    let labelme = r#"{"shapes": [], "imagePath": "a.jpg"}"#;
    for (files, said) in [
        (&[("a.jpg", ""), ("a.json", labelme)][..], "labelme2coco"),
        (
            &[("images/a.jpg", ""), ("annotations.xml", "<annotations><image id=\"0\"/></annotations>")],
            "from CVAT",
        ),
        (&[("a.jpg", ""), ("boxes.csv", "filename,x\na.jpg,1\n")], "1 .csv (boxes.csv)"),
        (&[("a.jpg", ""), ("boxes.txt", "a.jpg 1,2,3,4,0\n")], "1 .txt (boxes.txt)"),
        (&[("a.jpg", ""), ("groundtruth_rect.txt", "1\t1\t30\t20\n")], "1 .txt (groundtruth_rect.txt)"),
        (&[("seq/img1/a.jpg", ""), ("seq/det.txt", "1,-1,1,1,30,20,1\n")], "1 .txt (seq/det.txt)"),
        (&[("a.jpg", ""), ("metadata.jsonl", "{\"file_name\": \"a.jpg\"}\n")], "Hugging Face"),
        (&[("a.jpg", ""), ("labels.zip", "")], "unpack it"),
        (&[("a.jpg", ""), ("s0.tar.gz", "")], "gunzip"),
        (&[("a.jpg", ""), ("a.mat", "")], "1 .mat"),
        (&[("a.jpg", ""), ("a.caption", "two fish")], "1 .caption"),
        (&[("a.jpg", ""), ("x.tfrecord-00000-of-00001", "")], "x.tfrecord-00000"),
    ] {
        let text = unread(files);
        assert!(text.contains(said) && text.contains("--format folder"), "{text}");
        let set = folder(files);
        let plain = Dataset::open(set.path(), Some(Layout::Folder), &ReadOptions::default()).unwrap();
        assert_eq!((keys(&plain).len(), plain.left_out.has_labels()), (1, true));
    }
    let plain =
        opened(&folder(&[("a.jpg", ""), ("README.md", ""), ("notes.txt", "two fish\n"), ("b.heic", "")]));
    assert_eq!(plain.left_out.to_string(), "1 .heic (b.heic); 1 .md (README.md); 1 .txt (notes.txt)");
    assert!(!plain.left_out.has_labels());
}

#[test]
fn a_layout_that_reads_no_annotation_is_no_layout() {
    let text = unread(&[("data.yaml", "names: [fish]\n"), ("images/a.jpg", ""), ("labels/a.json", "{}")]);
    assert!(text.contains("layout yolo reads none of them: 1 .json (labels/a.json)"), "{text}");
    // Where some are read the others are named.
    let found = opened(&folder(&[
        ("images/a.jpg", ""),
        ("labels/a.txt", "0 0.5 0.5 0.1 0.1\n"),
        ("extra/b.jpg", ""),
        ("boxes.csv", ""),
    ]));
    assert_eq!(found.left_out.to_string(), "1 .csv (boxes.csv); 1 .jpg (extra/b.jpg)");
}

#[test]
fn json_that_cannot_be_read_is_refused_whatever_the_layout() {
    let cut = &COCO[..COCO.len() / 2];
    for (text, said) in [
        (cut.to_owned(), "it ends too early, at line 4 column "),
        (COCO.replace("1e-3", "NaN"), "NaN and Infinity are no JSON: write null"),
        (COCO.replace("1e-3", "-Infinity"), "NaN and Infinity are no JSON: write null"),
        (COCO.replace("\"categories\"", ",\"categories\""), "line 6 column 1"),
        (COCO.replace("\"categories\"", "\"images\": [], \"categories\""), "it has `images` twice"),
        ("[".repeat(100_000), "it ends too early"),
    ] {
        let good = COCO.replace("a.jpg", "c.jpg");
        let set = coco(&text);
        for (name, text) in
            [("images/c.jpg", ""), ("annotations/good.json", &good), ("labels/a.txt", "0 .5 .5 .1 .1")]
        {
            fs::create_dir_all(set.path().join(name).parent().unwrap()).unwrap();
            fs::write(set.path().join(name), text).unwrap();
        }
        for layout in [Layout::Coco, Layout::Yolo, Layout::Folder] {
            let found = Dataset::open(set.path(), Some(layout), &ReadOptions::default()).unwrap();
            let named = faults(&found)
                .into_iter()
                .any(|fault| fault.starts_with("annotations/instances.json: ") && fault.contains(said));
            assert!(
                named || (layout != Layout::Coco && said.contains("twice")),
                "{said}: {:?}",
                faults(&found)
            );
        }
    }
}

/// Writes a picture: of one channel, or of three.
fn picture(set: &tempfile::TempDir, name: &str, channels: u8) {
    let path = set.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    if channels == 1 {
        image::GrayImage::new(8, 6).save(&path).unwrap();
    } else {
        let image = Image::from_raw(8, 6, [[90_u8, 120, 130]; 48].concat()).unwrap();
        ImageFile::new(image).write(&path, &WriteOptions::default()).unwrap();
    }
}

#[test]
fn a_mask_is_never_an_image() {
    for (image, mask, channels) in [
        ("i0.jpg", "i0.png", 1),
        ("i0.jpg", "i0.png", 3),
        ("i0.png", "i0_mask.png", 3),
        ("i0.png", "i0_SEG.png", 1),
        ("pictures/i0.png", "coloured/i0.png", 1),
        ("a/pictures/i0.jpg", "b/masks/i0.png", 3),
        ("x/images/x.png", "x/masks/0.png", 3),
        ("i0.jpg", "other/i0.tif", 1),
        ("i0.jpg", "other/i0.bmp", 1),
    ] {
        let set = tempfile::tempdir().unwrap();
        picture(&set, image, 3);
        picture(&set, mask, channels);
        let said = Dataset::open(set.path(), None, &ReadOptions::default()).unwrap_err().to_string();
        assert!(said.contains("like masks") && said.contains(mask), "{said}");
        let plain = Dataset::open(set.path(), Some(Layout::Folder), &ReadOptions::default()).unwrap();
        assert_eq!(keys(&plain), [image]);
    }
    // Photographs of one name in folders of classes are photographs, of one channel or of three.
    for channels in [1, 3] {
        let set = tempfile::tempdir().unwrap();
        picture(&set, "cod/1.png", channels);
        picture(&set, "eel/1.png", channels);
        assert_eq!(keys(&opened(&set)).len(), 2);
    }
}

/// Writes an image in which nearly every pixel equals the one before it, or none does.
fn drawn(set: &tempfile::TempDir, name: &str, is_drawn: bool) {
    let path = set.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let colour = |x: u32, y: u32| match is_drawn {
        true => [200 * u8::from(x > 30), 60, 60],
        false => [(x * 7 + y * 13) as u8 % 31, 120 + (x * 11 + y * 3) as u8 % 29, 130],
    };
    image::RgbImage::from_fn(96, 72, |x, y| image::Rgb(colour(x, y))).save(&path).unwrap();
}

#[test]
fn a_mask_whose_name_says_nothing_is_known_by_its_pixels() {
    for mask in ["task-1-annotation-1-by-1-tag-fish-0.png", "Beschriftet/x.png", "other/x.bmp", "a_mask.png"]
    {
        let set = tempfile::tempdir().unwrap();
        drawn(&set, "a_mask.jpg", false);
        drawn(&set, mask, true);
        let said = Dataset::open(set.path(), None, &ReadOptions::default()).unwrap_err().to_string();
        assert!(said.contains("like masks") && said.contains(mask), "{said}");
    }
    // Photographs are none, in any format; nor are drawings where nothing else is.
    for is_drawn in [false, true] {
        let set = tempfile::tempdir().unwrap();
        ["a.png", "b.bmp"].iter().for_each(|name| drawn(&set, name, is_drawn));
        assert_eq!(keys(&opened(&set)), ["a.png", "b.bmp"]);
    }
}

#[test]
fn a_table_about_a_shard_hides_no_shard() {
    let found = opened(&folder(&[("00000.tar", ""), ("00000.parquet", ""), ("00000_stats.json", "{}")]));
    assert_eq!((found.layout, keys(&found)), (Layout::Shards, vec!["00000.tar"]));
    assert_eq!(found.left_out.to_string(), "1 .json (00000_stats.json); 1 .parquet (00000.parquet)");
}

#[test]
fn a_compressed_shard_beside_others_is_named() {
    let found = opened(&folder(&[("s0.tar", ""), ("s1.tar.gz", "")]));
    assert!(faults(&found)[0].starts_with("s1.tar.gz: it is a compressed shard"), "{:?}", faults(&found));
}
