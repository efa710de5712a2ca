//! No label is lost in silence, and none that is wrong is taken.

use super::run::{Run, scene};
use super::{AUGMENT, fish, write};

const COCO: &str = r#"{"images": [{"id": 1, "file_name": "a.png", "width": 96, "height": 64}],
"annotations": [{"id": 1, "image_id": 1, "category_id": 1, "bbox": [1, 1, 5, 5]}], "categories": [{"id": 1, "name": "fish"}]}"#;

fn coco(text: impl AsRef<[u8]>) -> Run {
    let run = Run::new();
    std::fs::create_dir_all(run.path("fish/images")).unwrap();
    scene(&run.path("fish/images/a.png"), 1, "blue");
    scene(&run.path("green.png"), 9, "green");
    write(&run, "fish/annotations/instances.json", text);
    run
}

#[test]
fn annotations_that_cannot_be_parsed_are_refused_by_name_whatever_the_layout() {
    let bad: [(&str, Vec<u8>); 6] = [
        ("cut short", COCO[..COCO.len() / 2].into()),
        ("a comma too many", COCO.replace("}]}", "},]}").into()),
        ("NaN", COCO.replace("[1, 1, 5, 5]", "[1, 1, 5, 5], \"area\": NaN").into()),
        ("a list twice", COCO.replacen("\"annotations\"", "\"images\": [], \"annotations\"", 1).into()),
        ("brackets", ["{\"images\": ", &"[".repeat(100_000)].concat().into()),
        ("no text", b"{\"images\": [\xff\xfe]}".to_vec()),
    ];
    for (what, text) in bad {
        let run = coco(&text);
        for more in [&[][..], &["--format", "coco"], &["--format", "yolo"]] {
            let said = run.fails(2, &[&AUGMENT[..], more].concat()).stderr;
            assert!(said.contains("annotations/instances.json"), "{what}, {more:?}: {said}");
            assert!(!run.path("out").exists(), "{what}");
        }
        // Another file that is good does not help.
        write(&run, "fish/annotations/good.json", COCO);
        let said = run.fails(2, &AUGMENT).stderr;
        assert!(said.contains("annotations/instances.json"), "{what}, beside a good one: {said}");
    }
    let wide: Vec<u8> =
        "\u{feff}".chars().chain(COCO.chars()).flat_map(|c| (c as u16).to_le_bytes()).collect();
    for text in [["\u{feff}", COCO].concat().into_bytes(), wide] {
        let run = coco(text);
        run.ok(&AUGMENT);
        assert!(run.path("out/annotations/instances.json").exists());
    }
}

#[test]
fn compressed_shards_are_named_and_not_passed_over() {
    let run = fish();
    let tar = |name: &str, files: &[&str]| {
        let ended = std::process::Command::new("tar")
            .args(["-cf", name])
            .args(files)
            .current_dir(run.path("fish/images"))
            .status();
        assert!(ended.unwrap().success());
    };
    std::fs::create_dir(run.path("shards")).unwrap();
    tar("../../shards/s0.tar", &["a.png"]);
    for name in ["s1.tar.gz", "s2.tgz"] {
        write(&run, &format!("shards/{name}"), b"\x1f\x8b\x08 a compressed shard");
    }
    let augment = ["augment", "shards", "green.png", "-o", "out"];
    let said = run.fails(2, &augment).stderr;
    assert!(said.contains("s1.tar.gz") && said.contains("s2.tgz") && said.contains("gunzip"), "{said}");
    // The others alone, because somebody said so.
    run.ok(&[&augment[..], &["--on-bad-annotation", "skip"]].concat());
    std::fs::remove_file(run.path("shards/s0.tar")).unwrap();
    let said = run.fails(2, &[&augment[..], &["--format", "shards"]].concat()).stderr;
    assert!(said.contains("s1.tar.gz") && said.contains("gunzip"), "{said}");
}

#[test]
fn wrong_entries_are_refused_by_name_and_files_of_labelling_programs_are_known() {
    let run = fish();
    write(&run, "fish/classes.txt", "cod\nherring\neel\n");
    write(&run, "fish/labels/classes.txt", "cod\nherring\neel\n");
    run.ok(&AUGMENT);
    write(&run, "fish/labels/b.txt", "7 0.5 0.5 0.25 0.25\n");
    let said = run.fails(2, &AUGMENT).stderr;
    assert!(said.contains("labels/b.txt:1") && said.contains('7'), "{said}");

    let run = coco(COCO.replace("\"a.png\"", "\"\""));
    let said = run.fails(2, &AUGMENT).stderr;
    assert!(said.contains("annotations/instances.json, images[0]"), "{said}");

    let run = fish();
    let tar = "cd fish/images && tar -cf ../../twice.tar a.png && tar -rf ../../twice.tar a.png && \
               mkdir ../../shards && mv ../../twice.tar ../../shards";
    let made = std::process::Command::new("sh").args(["-c", tar]).current_dir(run.path("")).status();
    assert!(made.unwrap().success());
    let ended = run.fails(1, &["augment", "shards", "green.png", "-o", "out"]);
    assert!(ended.stderr.contains("twice.tar") && ended.stderr.contains("a.png"), "{}", ended.stderr);
}

#[test]
fn an_annotation_with_a_document_type_is_not_carried_on() {
    let xml = "<annotation><filename>a.png</filename><size><width>96</width><height>64</height></size></annotation>";
    for dtd in [
        "<!DOCTYPE a [<!ENTITY x SYSTEM \"file:///etc/hostname\">]>",
        "<!DOCTYPE a [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;\">]>",
        "<!doctype a SYSTEM \"http://localhost/a.dtd\">",
        "<!DOCTYPE a [<!ENTITY % x SYSTEM \"file:///etc/hostname\"> %x;]>",
    ] {
        let run = fish();
        std::fs::remove_dir_all(run.path("fish/labels")).unwrap();
        write(&run, "fish/annotations/a.xml", format!("<?xml version=\"1.0\"?>{dtd}{xml}"));
        let said = run.fails(2, &AUGMENT).stderr;
        assert!(said.contains("annotations/a.xml"), "{dtd}: {said}");
    }
}
