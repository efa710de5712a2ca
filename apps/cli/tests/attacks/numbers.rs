//! What a manifest or a scene of strangers says.

use super::run::{Run, reef};
use super::{AUGMENT, fish, write};

/// A manifest with one text in it replaced.
fn with(run: &Run, from: &str, to: &str) {
    let manifest = String::from_utf8(run.bytes("out/manifest.jsonl")).unwrap();
    assert!(manifest.contains(from), "{from} is not in {manifest}");
    write(run, "changed/manifest.jsonl", manifest.replace(from, to));
}

#[test]
fn numbers_of_a_manifest_are_held_to_their_ranges() {
    let run = fish();
    run.ok(&AUGMENT);
    for (from, to) in [
        ("\"quality\":95", "\"quality\":0"),
        ("\"quality\":95", "\"quality\":255"),
        ("\"quality\":95", "\"quality\":101"),
        ("\"most_gain\":", "\"most_gain\":-1e0,\"other\":"),
        ("\"most_gain\":", "\"most_gain\":1e39,\"other\":"),
        ("\"theta_range\":[", "\"theta_range\":[-5,5],\"other\":["),
        ("\"theta_range\":[", "\"theta_range\":[60,0],\"other\":["),
        ("\"alpha_range\":[", "\"alpha_range\":[-1,1],\"other\":["),
        ("\"theta\":0.0", "\"theta\":91.0"),
        ("\"alpha\":1.0", "\"alpha\":-1.0"),
        ("\"water\":0", "\"water\":7"),
    ] {
        with(&run, from, to);
        let ended = run.command(&["replay", "changed", "-o", "again", "--dataset", "fish"]).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_ne!(ended.status.code(), Some(0), "{to}");
        assert!(said.contains("changed/manifest.jsonl"), "{to}: {said}");
        assert!(
            !run.path("again").exists() || std::fs::read_dir(run.path("again")).unwrap().count() == 0,
            "{to}"
        );
    }
}

#[test]
fn a_bad_name_in_a_manifest_is_named() {
    let run = fish();
    run.ok(&AUGMENT);
    with(&run, "\"key\":\"images/a.png\"", "\"key\":\"../a.png\"");
    for command in [
        &["verify", "changed", "--dataset", "fish"][..],
        &["replay", "changed", "-o", "again", "--dataset", "fish"],
    ] {
        let ended = run.fails(1, command);
        let said = ended.stdout + &ended.stderr;
        assert!(said.contains("../a.png") && said.contains("manifest.jsonl"), "{command:?}: {said}");
    }
    // A link to the dataset's own folder is called what it is.
    std::os::unix::fs::symlink(run.path("fish"), run.path("fish/images/loop")).unwrap();
    let said = run.fails(2, &["augment", "fish", "green.png", "-o", "other"]).stderr;
    assert!(said.contains("images/loop: a link to a folder, which is not followed"), "{said}");
}

#[test]
fn names_of_a_scene_are_found_from_its_own_folder() {
    let run = Run::new();
    reef(&run);
    std::fs::remove_dir_all(run.path("reef/sparse")).unwrap();
    let frame = |number: usize, before: &str| {
        format!(
            "{{\"file_path\": \"{before}view_00{number}.png\", \"transform_matrix\": [[1,0,0,{number}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}"
        )
    };
    for before in ["images/", "./images/", "images\\\\", ""] {
        let frames: Vec<String> = (0..4).map(|number| frame(number, before)).collect();
        let text = format!(
            "{{\"fl_x\": 32, \"fl_y\": 32, \"cx\": 32, \"cy\": 24, \"w\": 64, \"h\": 48, \"frames\": [{}]}}",
            frames.join(",")
        );
        write(&run, "reef/transforms.json", text);
        run.ok(&[
            "scene",
            "train",
            "reef",
            "-o",
            "s.ply",
            "--iterations",
            "1",
            "--longest",
            "32",
            "--overwrite",
        ]);
    }
}
