//! What the system does not give: pipes that nobody fills, threads, memory.

#[cfg(target_os = "linux")]
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use aquafuse::image::{Encoded, Image};
use aquafuse_data::image_file::{ImageFile, WriteOptions};

use super::run::{Run, reef, scene};
use super::{AUGMENT, FUSE, fish, photos};

/// Runs within a limit of time; the exit code, and what was said.
fn within(seconds: u64, command: &mut Command) -> (Option<i32>, String) {
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let began = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if began.elapsed() > Duration::from_secs(seconds) {
            child.kill().unwrap();
            panic!("{command:?} did not end in {seconds} s");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let ended = child.wait_with_output().unwrap();
    let said = [ended.stdout, ended.stderr].concat();
    (ended.status.code(), String::from_utf8_lossy(&said).into_owned())
}

/// The command by a shell that sets limits first.
fn limited(run: &Run, limits: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    let line = format!("{limits}; exec \"$0\" \"$@\"");
    command.args(["-c", &line, env!("CARGO_BIN_EXE_aquafuse")]).args(arguments);
    command.current_dir(run.path(""));
    command
}

#[test]
fn verify_waits_for_no_pipe() {
    let run = fish();
    std::fs::write(run.path("fish/labels/b.txt"), "").unwrap();
    run.ok(&AUGMENT);
    for name in ["labels/b__green__0.txt", "images/a__green__0.png"] {
        std::fs::remove_file(run.path("out").join(name)).unwrap();
        assert!(Command::new("mkfifo").arg(run.path("out").join(name)).status().unwrap().success());
        let (code, said) = within(20, &mut run.command(&["verify", "out"]));
        assert!(code == Some(1) && said.contains(name), "{said}");
    }
}

/// A command of a user who may have so many threads; the administrator is not limited, and becomes nobody.
#[cfg(target_os = "linux")]
fn with_threads(run: &Run, threads: usize, arguments: &[&str]) -> Command {
    use std::os::unix::fs::MetadataExt;
    let is_root = Path::new("/proc/self").metadata().is_ok_and(|about| about.uid() == 0);
    let nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"];
    let limit = format!("--nproc={threads}");
    let limited = ["prlimit", &limit, env!("CARGO_BIN_EXE_aquafuse")];
    let words: Vec<&str> = nobody.into_iter().filter(|_| is_root).chain(limited).collect();
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).args(arguments).current_dir(run.path(""));
    command
}

#[cfg(target_os = "linux")]
#[test]
fn without_threads_one_does_the_work_or_says_why_not() {
    use std::os::unix::fs::PermissionsExt;
    let run = fish();
    for folder in ["", "out"] {
        std::fs::create_dir_all(run.path(folder)).unwrap();
        std::fs::set_permissions(run.path(folder), std::fs::Permissions::from_mode(0o777)).unwrap();
    }
    let fuse = ["fuse", "fish/images", "green.png", "-o", "out", "--overwrite", "--threads", "4"];
    if !with_threads(&run, 1_000, &fuse).output().is_ok_and(|ended| ended.status.success()) {
        println!("skipped: no prlimit or setpriv here, or nobody may run the command");
        return;
    }
    let mut refused = 0;
    for threads in 1..10 {
        for arguments in [&fuse[..], &["verify", "out"], &["inspect", "green.png"]] {
            let (code, said) = within(60, &mut with_threads(&run, threads, arguments));
            assert!(matches!(code, Some(0..=2)) && !said.contains("panicked"), "{threads}: {code:?}, {said}");
            // There is no manifest to verify.
            let is_fine = code == Some(0) || said.contains("manifest.jsonl");
            assert!(is_fine || said.contains("the system gives no more threads"), "{threads}: {said}");
            refused += usize::from(!is_fine);
        }
    }
    assert!(refused > 0, "one thread is too few for any command: the limit does not hold");
}

#[cfg(target_os = "linux")]
#[test]
fn memory_that_the_system_does_not_give_is_an_error_of_the_file() {
    let run = photos();
    // No two neighbours are equal, as in a mask they would be.
    let columns = [[90_u8; 3], [91; 3]].concat().repeat(6_000_000);
    let large = Image::<u8, Encoded>::from_raw(4_000, 3_000, columns).unwrap();
    ImageFile::new(large).write(&run.path("photos/large.png"), &WriteOptions::default()).unwrap();
    for (limit, arguments) in [
        (150_000, &["fuse", "photos", "green.png", "-o", "out"][..]),
        (110_000, &["fuse", "green.png", "photos/large.png", "-o", "out.png"]),
        (110_000, &["inspect", "photos/large.png"]),
        (150_000, &["augment", "photos", "green.png", "-o", "more", "--keep-share", "0"]),
    ] {
        let one = [arguments, &["--threads", "1"]].concat();
        let (code, said) = within(60, &mut limited(&run, &format!("ulimit -v {limit}"), &one));
        assert!(code == Some(1) && said.contains("photos/large.png"), "{arguments:?}: {code:?}, {said}");
        assert!(said.contains("MiB of memory") && !said.contains("panicked"), "{said}");
    }
    // The others are made.
    assert!(run.path("out/a.png").exists() && run.path("out/b.png").exists());
}

/// The most memory of a command in KiB, as the system counts it.
#[cfg(target_os = "linux")]
fn peak(run: &Run, arguments: &[&str]) -> u64 {
    let mut child = run.command(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
        most = most.max(line.and_then(|number| number.trim().parse().ok()).unwrap_or(0));
        std::thread::sleep(Duration::from_millis(2));
    }
    most
}

#[cfg(target_os = "linux")]
#[test]
fn files_of_a_run_are_not_read_whole() {
    let run = fish();
    run.ok(&AUGMENT);
    std::fs::create_dir_all(run.path("photos")).unwrap();
    scene(&run.path("photos/a.png"), 1, "blue");
    run.ok(&["fuse", "photos", "green.png", "-o", "fused"]);
    for name in ["fused/aquafuse-job.jsonl", "out/manifest.jsonl"] {
        std::fs::OpenOptions::new().write(true).open(run.path(name)).unwrap().set_len(1 << 30).unwrap();
    }
    for arguments in [
        &["fuse", "photos", "green.png", "-o", "fused", "--max-memory", "64MiB"][..],
        &["augment", "fish", "green.png", "-o", "out", "--max-memory", "64MiB"],
        &["verify", "out", "--max-memory", "64MiB"],
        &["replay", "out", "-o", "again", "--max-memory", "64MiB"],
    ] {
        let most = peak(&run, arguments);
        assert!(most < 128 << 10, "{arguments:?} took {} MiB", most >> 10);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn files_of_a_scene_are_held_to_the_budget() {
    let run = Run::new();
    reef(&run);
    let trained = ["scene", "train", "reef", "-o", "s.ply", "--iterations", "1", "--longest", "32"];
    run.ok(&trained);
    std::fs::copy(run.path("s.ply"), run.path("large.ply")).unwrap();
    std::fs::create_dir_all(run.path("posed/images")).unwrap();
    std::fs::write(run.path("posed/transforms.json"), "{\"frames\": []}").unwrap();
    for name in ["large.ply", "reef/sparse/0/points3D.txt", "posed/transforms.json"] {
        std::fs::OpenOptions::new().write(true).open(run.path(name)).unwrap().set_len(1 << 30).unwrap();
    }
    for (arguments, name) in [
        (&["scene", "render", "large.ply", "reef", "-o", "views"][..], "large.ply"),
        (&["scene", "export", "large.ply", "-o", "large.splat"], "large.ply"),
        (&["scene", "view", "large.ply", "-o", "large.html"], "large.ply"),
        (&["scene", "render", "s.ply", "reef", "-o", "views"], "points3D.txt"),
        (&["scene", "fuse", "reef", "preset:jerlov-IB", "-o", "fused"], "points3D.txt"),
        (&["scene", "train", "posed", "-o", "t.ply"], "transforms.json"),
    ] {
        let arguments = [arguments, &["--max-memory", "64MiB"]].concat();
        let output = run.command(&arguments).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success(), "{arguments:?}");
        assert!(said.contains(name) && said.contains("2147483648 bytes, more than the 67108864"), "{said}");
        let most = peak(&run, &arguments);
        assert!(most < 128 << 10, "{arguments:?} took {} MiB", most >> 10);
    }
}

#[test]
fn a_number_of_splats_that_memory_cannot_hold_is_refused_however_large() {
    let run = Run::new();
    reef(&run);
    for splats in ["18446744073709551615", "17080318586768104", "4294967295", "1000000000"] {
        let train = [
            "scene",
            "train",
            "reef",
            "-o",
            "s.ply",
            "--splats",
            splats,
            "--max-memory",
            "300MiB",
            "--iterations",
            "1",
        ];
        let (code, said) = within(60, &mut run.command(&train));
        assert!(code == Some(2), "{splats}: {code:?}, {said}");
    }
}

#[test]
fn the_environment_starts_no_number_of_threads() {
    let run = photos();
    for arguments in [&FUSE[..], &["inspect", "green.png"]] {
        let (code, said) = within(60, run.command(arguments).env("RAYON_NUM_THREADS", "999999"));
        assert_eq!(code, Some(0), "{said}");
    }
}

#[test]
fn a_few_bytes_that_unpack_to_many_pixels_ask_for_consent() {
    let run = photos();
    let wide = Image::<u8, Encoded>::from_raw(8_000, 6_000, vec![90; 144_000_000]).unwrap();
    ImageFile::new(wide).write(&run.path("flat.webp"), &WriteOptions::default()).unwrap();
    let began = Instant::now();
    let said = run.fails(1, &["fuse", "flat.webp", "green.png", "-o", "out.png"]).stderr;
    assert!(said.contains("flat.webp") && said.contains("--max-pixels 48000000"), "{said}");
    assert!(began.elapsed() < Duration::from_secs(5), "it was decoded");
    run.ok(&["depth", "flat.webp", "-o", "depth.png", "--max-pixels", "48000000"]);
}
