//! Words of strangers in what we print.

use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::process::Stdio;

use super::run::{Run, program, reef, scene};
use super::{AUGMENT, fish, write};

/// Nothing that moves a terminal.
fn is_plain(text: &str) -> bool {
    text.chars().all(|c| {
        c == '\n'
            || (!c.is_control()
                && !('\u{202a}'..='\u{202e}').contains(&c)
                && !('\u{2066}'..='\u{2069}').contains(&c))
    })
}

#[test]
fn no_name_of_a_stranger_moves_the_terminal() {
    for name in ["\u{1b}[31mx", "a\u{202e}gpj.b", "a\u{9b}31m", "a\rb", "a\u{2066}b"] {
        let run = fish();
        symlink("/etc", run.path("fish/images").join(name)).unwrap();
        let ended = run.fails(2, &AUGMENT);
        assert!(is_plain(&ended.stderr) && ended.stderr.contains("fish"), "{:?}", ended.stderr);
        let run = fish();
        write(&run, &format!("fish/labels/{name}.txt"), "0 0.5 0.5 2 2\n");
        let ended = run.fails(2, &AUGMENT);
        assert!(is_plain(&ended.stderr), "{:?}", ended.stderr);
        // An image that fails, in the messages of a run.
        let run = fish();
        write(&run, &format!("fish/images/{name}.png"), b"\x89PNG\r\n\x1a\n");
        let ended = run.fails(1, &AUGMENT);
        assert!(is_plain(&ended.stderr) && is_plain(&ended.stdout), "{:?}", ended.stderr);
    }
    let run = Run::new();
    reef(&run);
    let lines = "case \"$*\" in *'import pycolmap') exit 0;; esac\nprintf '\\033[31mred\\n\\033]0;title\\007' >&2\nexit 3";
    let python = program(&run, "python", lines);
    let said = run.fails(1, &["scene", "sfm", "reef/images", "-o", "reef3d", "--python", &python]).stderr;
    assert!(is_plain(&said) && said.contains("red"), "{said:?}");
}

#[test]
fn no_name_in_json_moves_the_terminal_and_each_is_still_itself() {
    for name in ["a\u{202e}gpj.png", "a\u{9b}31m.png", "a\u{2066}.png"] {
        let run = Run::new();
        std::fs::create_dir(run.path("photos")).unwrap();
        scene(&run.path("one.png"), 1, "blue");
        std::fs::rename(run.path("one.png"), run.path("photos").join(name)).unwrap();
        scene(&run.path("green.png"), 9, "green");
        for command in [
            &["fuse", "photos", "green.png", "-o", "out", "--json"][..],
            &["augment", "photos", "green.png", "-o", "more", "--json"],
        ] {
            let said = run.ok(command).stdout;
            assert!(is_plain(&said), "{said:?}");
            let stem = name.trim_end_matches(".png");
            let has = |line: &str| {
                serde_json::from_str::<serde_json::Value>(line).unwrap().to_string().contains(stem)
            };
            assert!(said.lines().all(has), "{said:?}");
        }
    }
}

#[test]
fn names_in_a_report_are_no_markup_and_no_formulas() {
    let run = Run::new();
    for (seed, group) in
        ["<script>alert(1)<x>", "[x](javascript:1)", "a\\|b", "=1+1", "a`b*c_d"].iter().enumerate()
    {
        std::fs::create_dir_all(run.path(&format!("photos/{group}"))).unwrap();
        scene(&run.path(&format!("photos/{group}/=2+2.png")), seed as u64, "blue");
    }
    scene(&run.path("green.png"), 9, "green");
    for report in ["report.md", "report.html", "report.csv"] {
        run.ok(&[
            "evaluate",
            "fusion",
            "--contents",
            "photos",
            "--references",
            "photos",
            "--group-by",
            "folder",
            "-o",
            report,
        ]);
    }
    let text = |name: &str| String::from_utf8(run.bytes(name)).unwrap();
    let markdown = text("report.md");
    assert!(!markdown.contains("<script>") && markdown.contains("\\<script"), "{markdown}");
    assert!(!markdown.contains("[x](javascript") && !markdown.contains("| a\\\\|b"), "{markdown}");
    let html = text("report.html");
    assert!(!html.contains("<script>alert(1)"));
    let csv = text("report.csv");
    let cells = csv.lines().flat_map(|line| line.split(','));
    assert!(!cells.into_iter().any(|cell| cell.trim_matches('"').starts_with(['=', '+', '@'])), "{csv}");
}

#[test]
fn names_that_are_no_text_stay_apart() {
    let run = Run::new();
    std::fs::create_dir(run.path("photos")).unwrap();
    scene(&run.path("green.png"), 9, "green");
    for name in [&b"a\xff.png"[..], b"a\xfe.png"] {
        scene(&run.path("one.png"), 1, "blue");
        std::fs::rename(run.path("one.png"), run.path("photos").join(std::ffi::OsStr::from_bytes(name)))
            .unwrap();
    }
    let said = run.ok(&["fuse", "photos", "green.png", "-o", "out", "--json"]).stdout;
    let lines: Vec<&str> = said.lines().filter_map(|line| line.split("\"output\"").next()).collect();
    assert!(lines.len() == 2 && lines[0] != lines[1], "{said}");
    let said =
        run.ok(&["evaluate", "fusion", "--contents", "photos", "--references", "photos", "-o", "report.md"]);
    let report = String::from_utf8(run.bytes("report.md")).unwrap();
    assert!(!(said.stdout + &report).contains('\u{fffd}'));
}

#[test]
fn a_long_name_is_cut() {
    let run = Run::new();
    reef(&run);
    let images = std::fs::read_to_string(run.path("reef/sparse/0/images.txt")).unwrap();
    let long = images.replacen("view_000.png", &"x".repeat(5_000_000), 1);
    write(&run, "reef/sparse/0/images.txt", long);
    let train = ["scene", "train", "reef", "-o", "s.ply", "--iterations", "1"];
    let ended = run.command(&train).stdout(Stdio::null()).output().unwrap();
    assert_ne!(ended.status.code(), Some(0));
    assert!(ended.stderr.len() < 3_000, "{} bytes", ended.stderr.len());
}

#[test]
fn help_that_cannot_be_written_is_a_failure() {
    let run = Run::new();
    for arguments in [&["--help"][..], &["fuse", "--help"], &["--version"]] {
        let Ok(full) = std::fs::File::create("/dev/full") else {
            println!("skipped: no /dev/full here");
            return;
        };
        let ended = run.command(arguments).stdout(full).output().unwrap();
        assert_eq!(ended.status.code(), Some(1), "{arguments:?}");
        assert!(String::from_utf8_lossy(&ended.stderr).contains("cannot write"));
    }
    run.ok(&["--help"]);
}
