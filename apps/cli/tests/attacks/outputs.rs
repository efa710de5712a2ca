//! No file of the user is lost, replaced or read behind a link.

use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::process::Stdio;

use super::run::{Run, reef, scene};
use super::{AUGMENT, FUSE, fish, photos, write};

#[test]
fn what_is_no_record_of_ours_keeps_its_content() {
    for text in ["no line end", "line\ntail", "{\"a\": 1}\n", "\0\0"] {
        for command in [&FUSE[..], &["restore", "photos", "-o", "out"], &["enhance", "photos", "-o", "out"]] {
            let run = photos();
            write(&run, "out/aquafuse-job.jsonl", text);
            run.fails(2, command);
            assert_eq!(run.bytes("out/aquafuse-job.jsonl"), text.as_bytes(), "{command:?}");
        }
    }
    let run = photos();
    reef(&run);
    write(&run, "out/aquafuse-job.jsonl", "diary");
    let fuse = ["scene", "fuse", "reef", "green.png", "-o", "out"];
    run.fails(2, &fuse);
    assert_eq!(run.bytes("out/aquafuse-job.jsonl"), b"diary");
    for target in ["diary.txt", "nowhere.txt"] {
        let run = photos();
        write(&run, "diary.txt", "my day");
        std::fs::create_dir(run.path("out")).unwrap();
        symlink(run.path(target), run.path("out/aquafuse-job.jsonl")).unwrap();
        let said = run.fails(2, &FUSE).stderr;
        assert!(said.contains("aquafuse-job.jsonl"), "{said}");
        assert_eq!(run.bytes("diary.txt"), b"my day");
        assert!(!run.path("nowhere.txt").exists());
    }
}

#[test]
fn a_scene_is_not_fused_into_itself() {
    let run = Run::new();
    reef(&run);
    scene(&run.path("green.png"), 9, "green");
    symlink(run.path("reef"), run.path("link")).unwrap();
    let before = run.bytes("reef/images/view_000.png");
    for output in ["reef", "link", "reef/../reef", "reef/images/.."] {
        let said = run.fails(2, &["scene", "fuse", "reef", "green.png", "-o", output, "--overwrite"]).stderr;
        assert!(said.contains("reef") || said.contains("link"), "{said}");
        assert_eq!(run.bytes("reef/images/view_000.png"), before, "{output}");
    }
}

#[test]
fn no_output_replaces_what_is_read_or_another_output() {
    let run = photos();
    run.ok(&["depth", "photos/a.png", "-o", "a.depth.png"]);
    let depth = ["--depth", "a.depth.png", "--depth-kind", "inverse"];
    let before: Vec<_> = ["photos/a.png", "green.png", "a.depth.png"]
        .map(|name| (name, run.bytes(name)))
        .into_iter()
        .collect();
    let commands: [&[&str]; 8] = [
        &["fuse", "photos", "green.png", "-o", "out", "--report", "green.png"],
        &["fuse", "photos", "green.png", "-o", "out", "--report", "out/../photos/a.png"],
        &["fuse", "photos/a.png", "green.png", "-o", "out/b.png", "--report", "out/b.png"],
        &[&["fuse", "photos/a.png", "green.png", "-o", "b.png", "--maps", "."][..], &depth].concat(),
        &["depth", "photos/a.png", "-o", "photos/../photos/a.png"],
        &["fuse", "photos/a.png", "green.png", "-o", "./green.png"],
        &[&["restore", "photos/a.png", "-o", "a.depth.png"][..], &depth].concat(),
        &[
            "simulate",
            "photos/a.png",
            "a.depth.png",
            "green.png",
            "-o",
            "a.depth.png",
            "--depth-kind",
            "metres",
        ],
    ];
    std::fs::create_dir(run.path("out")).unwrap();
    for command in commands {
        let said = run.fails(2, &[command, &["--overwrite"]].concat()).stderr;
        assert!(said.contains("give another output"), "{command:?}: {said}");
        for (name, bytes) in &before {
            assert_eq!(run.bytes(name), *bytes, "{command:?}");
        }
    }
}

#[test]
fn no_folder_of_the_output_is_entered_through_a_link_that_leads_out() {
    let run = fish();
    run.ok(&AUGMENT);
    std::fs::create_dir(run.path("victim")).unwrap();
    std::fs::remove_dir_all(run.path("out/images")).unwrap();
    symlink(run.path("victim"), run.path("out/images")).unwrap();
    let said = run.fails(2, &[&AUGMENT[..], &["--theta", "20", "--overwrite"]].concat()).stderr;
    assert!(said.contains("out/images"), "{said}");
    std::fs::remove_file(run.path("out/images")).unwrap();
    run.ok(&[&AUGMENT[..], &["--overwrite"]].concat());
    std::fs::create_dir(run.path("again")).unwrap();
    symlink(run.path("victim"), run.path("again/images")).unwrap();
    let said = run.fails(1, &["replay", "out", "-o", "again"]).stderr;
    assert!(said.contains("again/images"), "{said}");
    assert_eq!(std::fs::read_dir(run.path("victim")).unwrap().count(), 0);
}

#[test]
fn a_link_that_leads_out_of_a_dataset_is_refused_by_every_command() {
    let run = fish();
    run.ok(&AUGMENT);
    std::fs::rename(run.path("fish/images/a.png"), run.path("elsewhere.png")).unwrap();
    symlink(run.path("elsewhere.png"), run.path("fish/images/a.png")).unwrap();
    for (code, command) in [
        (2, &["augment", "fish", "green.png", "-o", "other"][..]),
        (1, &["replay", "out", "-o", "again"]),
        (1, &["verify", "out", "--dataset", "fish"]),
    ] {
        let ended = run.fails(code, command);
        let said = ended.stdout + &ended.stderr;
        assert!(said.contains("images/a.png") && said.contains("link"), "{command:?}: {said}");
    }
    std::fs::rename(run.path("out/images"), run.path("moved")).unwrap();
    symlink(run.path("moved"), run.path("out/images")).unwrap();
    let ended = run.fails(1, &["verify", "out"]);
    let said = ended.stdout + &ended.stderr;
    assert!(said.contains("out/images/a__green__0.png") && said.contains("link"), "{said}");
}

#[test]
fn a_private_file_stays_private_and_what_is_not_ours_is_not_removed() {
    let run = photos();
    write(&run, "out.png", "mine");
    std::fs::set_permissions(run.path("out.png"), std::fs::Permissions::from_mode(0o600)).unwrap();
    run.ok(&["fuse", "photos/a.png", "green.png", "-o", "out.png", "--overwrite"]);
    assert_eq!(run.path("out.png").metadata().unwrap().mode() & 0o777, 0o600);

    reef(&run);
    write(&run, "reef.ply.checkpoint", "my own notes");
    let train = ["scene", "train", "reef", "-o", "reef.ply", "--iterations", "2", "--longest", "32"];
    run.fails(2, &[&train[..], &["--overwrite"]].concat());
    assert_eq!(run.bytes("reef.ply.checkpoint"), b"my own notes");
    std::fs::remove_file(run.path("reef.ply.checkpoint")).unwrap();
    write(&run, "reef.ply.brush/diary.txt", "my day");
    let brush = super::run::program(&run, "brush", "echo brush 0.3");
    let with_brush = [&train[..], &["--engine", "brush", "--brush", &brush, "--overwrite"]].concat();
    assert_ne!(run.command(&with_brush).output().unwrap().status.code(), Some(0));
    assert_eq!(run.bytes("reef.ply.brush/diary.txt"), b"my day");
}

#[test]
fn a_rendering_goes_on_after_a_kill() {
    let run = Run::new();
    reef(&run);
    run.ok(&["scene", "train", "reef", "-o", "reef.ply", "--iterations", "2", "--longest", "32"]);
    for more in [&[][..], &["--orbit", "40"]] {
        let render =
            [&["scene", "render", "reef.ply", "reef", "-o", "views", "--longest", "32"][..], more].concat();
        let mut child = run.command(&render).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while std::fs::read_dir(run.path("views")).map_or(0, Iterator::count) < 3
            && child.try_wait().unwrap().is_none()
        {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let _ = child.kill();
        child.wait().unwrap();
        run.ok(&render);
        std::fs::remove_dir_all(run.path("views")).unwrap();
    }
}

#[test]
fn an_image_whose_line_of_the_record_is_lost_is_ours_as_far_as_the_record_can_say() {
    let run = photos();
    run.ok(&FUSE);
    let record = String::from_utf8(run.bytes("out/aquafuse-job.jsonl")).unwrap();
    // The line "begun" of each image is on the disk before the image has its name: after a power cut, the lines behind it
    // may be gone, and no others.
    let begun: String =
        record.lines().filter(|line| !line.contains("\"done\"")).map(|line| format!("{line}\n")).collect();
    assert_ne!(begun, record);
    write(&run, "out/aquafuse-job.jsonl", &begun);
    let images = ["a.png", "b.png"].map(|name| run.bytes(&format!("out/{name}")));
    run.ok(&FUSE);
    assert_eq!(images, ["a.png", "b.png"].map(|name| run.bytes(&format!("out/{name}"))));
}

#[cfg(target_os = "linux")]
#[test]
fn the_record_is_on_the_disk_before_an_image_has_its_name() {
    let run = photos();
    let mut strace = std::process::Command::new("strace");
    let strace = strace.args([
        "-f",
        "-y",
        "-e",
        "trace=fsync,fdatasync,rename,renameat,renameat2,link,linkat",
        "-o",
        "calls",
    ]);
    let traced = strace
        .arg(env!("CARGO_BIN_EXE_aquafuse"))
        .args(FUSE)
        .current_dir(run.path(""))
        .stdout(Stdio::null())
        .status();
    if !traced.is_ok_and(|ended| ended.success()) {
        println!("skipped: no strace here");
        return;
    }
    let calls = String::from_utf8(run.bytes("calls")).unwrap();
    let first = |of: &str| {
        calls.lines().position(|line| line.contains(of)).unwrap_or_else(|| panic!("{of}: {calls}"))
    };
    let named =
        calls.lines().position(|line| line.contains("out/a.png\"") || line.contains("out/b.png\"")).unwrap();
    assert!(first("aquafuse-job.jsonl>") < named, "{calls}");
    // The folder that was made is on the disk as an entry of its parent.
    let parent = format!("{}>", run.path("").display().to_string().trim_end_matches('/'));
    assert!(first(&parent) < named, "{calls}");
}

#[test]
fn a_second_training_to_one_output_is_refused_at_its_beginning() {
    let run = Run::new();
    reef(&run);
    let train = ["scene", "train", "reef", "-o", "reef.ply", "--longest", "32"];
    let mut first = run.command(&[&train[..], &["--iterations", "200000"]].concat());
    let mut first = first.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let claims = || {
        let names = std::fs::read_dir(run.path("")).unwrap().map(|entry| entry.unwrap().file_name());
        names.filter(|name| name.to_string_lossy().starts_with(".aquafuse-")).count()
    };
    while claims() == 0 {
        assert!(first.try_wait().unwrap().is_none(), "the first training ended by itself");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let said = run.fails(2, &[&train[..], &["--iterations", "2"]].concat()).stderr;
    let other = ["scene", "train", "reef", "-o", "other.ply", "--longest", "32", "--iterations", "2"];
    let ended = run.command(&other).status().unwrap();
    // A signal leaves nothing behind; neither does a kill, once the next run has been there.
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(said.contains("another aquafuse process writes to reef.ply"), "{said}");
    assert!(ended.success());
    run.ok(&[&train[..], &["--iterations", "2", "--overwrite"]].concat());
    assert_eq!(claims(), 0);
}
