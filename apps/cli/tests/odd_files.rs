//! Files as they really come: odd names, odd kinds, odd places.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod borders;
mod run;

use aquafuse::image::Image;
use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::image_file::{ImageFile, Layers, Pixels, WriteOptions};
use run::{Run, scene};

/// An image of 16 bits with opacity, none of it 0: transparent pixels are left as they are.
fn fine() -> ImageFile {
    let [blue, ..] = waters();
    let image: Image<u16> = Scene::new(3, Size { width: 64, height: 48 }).seen_through(&blue.water).convert();
    let alpha = Some((0..64 * 48).map(|i| (i * 21) as u16 | 1).collect());
    ImageFile::new(Pixels::Words(Layers { image, alpha }))
}

#[test]
fn sixteen_bits_stay_sixteen_and_opacity_is_untouched() {
    let run = Run::new();
    scene(&run.path("water.png"), 9, "turbid");
    let content = fine();
    content.write(&run.path("fine.png"), &WriteOptions::default()).unwrap();
    run.ok(&["fuse", "fine.png", "water.png", "-o", "fused.tif", "--model", "physical"]);
    let Pixels::Words(fused) = ImageFile::read(&run.path("fused.tif")).unwrap().pixels else {
        panic!("16 bits became fewer");
    };
    let Pixels::Words(before) = &content.pixels else { unreachable!() };
    assert_eq!(fused.alpha, before.alpha);
    assert_ne!(fused.image, before.image);
    // The low bytes are no multiple of 257, as they would be had it gone through bytes.
    let fine = fused.image.as_raw().iter().filter(|&&value| value % 257 != 0).count();
    assert!(fine > fused.image.as_raw().len() * 9 / 10);

    // The same image in bytes is fused to the same: by one exponential to a few bytes, for its depth has 256 levels; by
    // a table of F, which may be steep, as nearly on the mean.
    ImageFile::new(content.bytes().into_owned())
        .write(&run.path("coarse.png"), &WriteOptions::default())
        .unwrap();
    let apart = |model: &str| -> Vec<u8> {
        let fused = |content: &str, fused: &str| {
            run.ok(&["fuse", content, "water.png", "-o", fused, "--model", model, "--overwrite"]);
            ImageFile::read(&run.path(fused)).unwrap().bytes().as_raw().to_vec()
        };
        let (fine, coarse) = (fused("fine.png", "fused.tif"), fused("coarse.png", "coarse_fused.png"));
        fine.iter().zip(coarse).map(|(a, b)| a.abs_diff(b)).collect()
    };
    let aquafuse = apart("aquafuse");
    assert!(aquafuse.iter().max() <= Some(&3), "{:?}", aquafuse.iter().max());
    let physical = apart("physical");
    let mean = physical.iter().map(|&off| f64::from(off)).sum::<f64>() / physical.len() as f64;
    assert!(mean < 0.5, "{mean}");
}

#[test]
fn an_image_on_its_side_stays_so_or_is_turned_on_request() {
    let run = Run::new();
    scene(&run.path("water.png"), 9, "turbid");
    scene(&run.path("plain.png"), 1, "blue");
    let mut turned = ImageFile::read(&run.path("plain.png")).unwrap();
    // Orientation 6: column 0 is up.
    turned.metadata.exif = Some(b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0".to_vec());
    turned.write(&run.path("side.jpg"), &WriteOptions::default()).unwrap();
    for (name, size, orientation, arguments) in
        [("kept.tif", (96, 64), 6, &[][..]), ("up.tif", (64, 96), 1, &["--upright"])]
    {
        run.ok(&[&["fuse", "side.jpg", "water.png", "-o", name], arguments].concat());
        let fused = ImageFile::read(&run.path(name)).unwrap();
        assert_eq!((fused.pixels.size(), fused.metadata.orientation()), (size, orientation));
    }
    let [kept, up] = ["kept.tif", "up.tif"].map(|name| ImageFile::read(&run.path(name)).unwrap());
    assert_eq!(kept.upright().pixels, up.pixels);
}

#[test]
fn an_image_cut_short_is_refused_or_taken_and_marked() {
    let run = Run::new();
    scene(&run.path("water.png"), 9, "turbid");
    scene(&run.path("whole.jpg"), 1, "blue");
    let whole = run.bytes("whole.jpg");
    std::fs::write(run.path("cut.jpg"), &whole[..whole.len() * 2 / 3]).unwrap();
    let fuse = ["fuse", "cut.jpg", "water.png", "-o", "fused.png"];
    let refused = run.fails(1, &fuse);
    assert!(refused.stderr.contains("cut.jpg") && refused.stderr.contains("--lenient"), "{}", refused.stderr);
    assert!(!run.path("fused.png").exists());
    let taken = run.ok(&[&fuse[..], &["--lenient"]].concat());
    assert!(taken.stdout.contains("damaged"), "{}", taken.stdout);
    let marked = run.bytes("fused.png");
    assert!(marked.windows(22).any(|window| window == b"aquafuse from a damage"));
    assert!(run.ok(&["inspect", "cut.jpg", "--lenient"]).stdout.contains("WARNING"));
}

#[test]
fn limits_are_obeyed_and_can_be_raised() {
    let run = Run::new();
    scene(&run.path("water.png"), 9, "turbid");
    for limit in [["--max-pixels", "6143"], ["--max-memory", "4MiB"]] {
        let refused = run.fails(1, &[&["inspect", "water.png"][..], &limit].concat());
        assert!(
            refused.stderr.contains("water.png") && refused.stderr.contains(limit[0]),
            "{}",
            refused.stderr
        );
    }
    run.ok(&["inspect", "water.png", "--max-pixels", "6144", "--max-memory", "17MiB"]);

    // What a strip and an image in floats take beside the image itself is counted too.
    let large = Scene::new(9, Size { width: 600, height: 400 });
    ImageFile::new(large.clear.convert::<u8>())
        .write(&run.path("large.png"), &WriteOptions::default())
        .unwrap();
    run.ok(&["depth", "large.png", "-o", "z.png", "--max-memory", "28MiB"]);
    let values = ["theta=0,5,10,15,20,25,30,35,40,45,50,55,60,65,70,75", "theta=0,5"];
    let sweep = |values| {
        ["fuse", "large.png", "water.png", "-o", "s.png", "--max-memory", "28MiB", "--sweep", values]
    };
    let simulate =
        ["simulate", "large.png", "z.png", "preset:jerlov-3C", "-o", "d.png", "--depth-kind", "relative"];
    for refused in [&sweep(values[0])[..], &[&simulate[..], &["--max-memory", "28MiB"]].concat()] {
        let said = run.fails(1, refused).stderr;
        assert!(said.contains("large.png") && said.contains("--max-memory"), "{said}");
    }
    run.ok(&sweep(values[1]));
    run.ok(&simulate);
}

#[test]
fn a_closed_pipe_does_not_stop_the_work() {
    let run = Run::new();
    scene(&run.path("water.png"), 9, "turbid");
    scene(&run.path("a.png"), 1, "blue");
    let mut child = run
        .command(&["fuse", "a.png", "water.png", "-o", "fused.png", "--json"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    assert!(run.path("fused.png").exists());
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::os::unix::fs::symlink;
    use std::process::Command;

    #[test]
    fn names_may_hold_anything() {
        let run = Run::new();
        scene(&run.path("water.png"), 9, "turbid");
        std::fs::create_dir(run.path("photos")).unwrap();
        let names = [
            &b"two\nlines.png"[..],
            b"quo\"te's.png",
            b"-dash.png",
            b"\xff\xfe.png",
            b" .png",
            b"\x1b[2J.png",
        ];
        for name in names {
            std::fs::copy(run.path("water.png"), run.path("photos").join(OsStr::from_bytes(name))).unwrap();
        }
        std::fs::write(run.path("photos/bad\n.png"), "no image").unwrap();
        let ended = run.fails(1, &["fuse", "photos", "water.png", "-o", "fused"]);
        assert!(ended.stderr.contains("bad\\n.png") && !ended.stderr.contains("bad\n"), "{}", ended.stderr);
        for name in names {
            assert!(run.path("fused").join(OsStr::from_bytes(name)).exists(), "{name:?}");
        }
        let again = run.fails(1, &["fuse", "photos", "water.png", "-o", "fused"]);
        assert!(again.stdout.contains("6 images skipped"), "{}", again.stdout);
        run.ok(&["fuse", "-o", "out.png", "--", "photos/-dash.png", "water.png"]);
    }

    #[test]
    fn links_are_followed_and_loops_are_errors() {
        let run = Run::new();
        scene(&run.path("water.png"), 9, "turbid");
        std::fs::create_dir(run.path("photos")).unwrap();
        symlink("../water.png", run.path("photos/link.png")).unwrap();
        symlink("loop.png", run.path("photos/loop.png")).unwrap();
        symlink("nowhere.png", run.path("photos/dangling.png")).unwrap();
        symlink(".", run.path("photos/self")).unwrap();
        let ended = run.fails(1, &["fuse", "photos", "water.png", "-o", "fused"]);
        assert!(ended.stderr.contains("2 of 3 images failed"), "{}", ended.stderr);
        assert!(
            ended.stderr.contains("loop.png") && ended.stderr.contains("dangling.png"),
            "{}",
            ended.stderr
        );
        assert!(run.path("fused/link.png").symlink_metadata().unwrap().is_file());

        // An output that is a link is replaced, not followed.
        std::fs::copy(run.path("water.png"), run.path("mine.png")).unwrap();
        symlink("../mine.png", run.path("fused/out.png")).unwrap();
        let before = run.bytes("mine.png");
        run.ok(&["fuse", "photos/link.png", "water.png", "-o", "fused/out.png", "--overwrite"]);
        assert_eq!(run.bytes("mine.png"), before);
        assert!(run.path("fused/out.png").symlink_metadata().unwrap().is_file());
    }

    #[test]
    fn a_full_disk_is_named_and_leaves_nothing() {
        let run = Run::new();
        scene(&run.path("water.png"), 9, "turbid");
        // The smallest disk there is: no file may grow beyond 4 blocks of 512 or 1024 bytes.
        let fuse = "ulimit -f 4; exec \"$0\" fuse water.png water.png -o out/full.png --theta 80 --quiet";
        let output = Command::new("sh")
            .args(["-c", fuse, env!("CARGO_BIN_EXE_aquafuse")])
            .current_dir(run.path("."))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("full.png") && said.contains("File too large"), "{said}");
        assert_eq!(std::fs::read_dir(run.path("out")).unwrap().count(), 0);
    }

    #[test]
    fn a_folder_that_may_not_be_written_is_named() {
        use std::os::unix::fs::PermissionsExt;
        let run = Run::new();
        scene(&run.path("water.png"), 9, "turbid");
        let locked = run.path("locked");
        std::fs::create_dir(&locked).unwrap();
        std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
        if std::fs::write(locked.join("probe"), "").is_ok() {
            println!("skipped: this user may write into every folder");
            return;
        }
        let failed = run.fails(1, &["fuse", "water.png", "water.png", "-o", "locked/out.png"]);
        assert!(
            failed.stderr.contains("locked/out.png") && failed.stderr.contains("permission"),
            "{}",
            failed.stderr
        );
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_in_the_place_of_a_file_is_refused_and_not_waited_for() {
    let run = Run::new();
    std::fs::create_dir(run.path("made")).unwrap();
    for pipe in ["made/manifest.jsonl", "a.ply"] {
        assert!(std::process::Command::new("mkfifo").arg(run.path(pipe)).status().unwrap().success());
    }
    let tries: [&[&str]; 3] = [
        &["verify", "made"],
        &["replay", "made/manifest.jsonl", "-o", "again"],
        &["scene", "export", "a.ply", "-o", "a.splat"],
    ];
    for arguments in tries {
        let said = run.fails(1, arguments).stderr;
        assert!(said.contains("it is a device, a pipe or a socket"), "{arguments:?}: {said}");
    }
}
