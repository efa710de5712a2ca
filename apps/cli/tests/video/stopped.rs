//! A signal ends the programs that were started, and leaves no file.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::clips::{H264, PICTURE, has_parts, make, run};

/// Whether a process runs whose arguments hold these words.
fn runs(words: &str) -> bool {
    let said = Command::new("pgrep").args(["-f", "--", words]).output().unwrap();
    !said.stdout.is_empty()
}

#[test]
fn a_signal_ends_the_children_and_leaves_no_file() {
    let Some(run) = run() else { return };
    if Command::new("pgrep").arg("-V").stdout(Stdio::null()).status().is_err() {
        println!("skipped: no pgrep here");
        return;
    }
    make(&run, &[&PICTURE, &["-t", "60"], &H264, &["long.mp4"]]);
    for (signal, code) in [("TERM", 143), ("INT", 130)] {
        let long = run.path("long.mp4");
        let mut command = run.command(&["video"]);
        command.arg(&long).args(["green.png", "-o", "out.mkv", "--codec", "ffv1"]);
        let mut child = command.stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
        let began = Instant::now();
        let words = format!("-f ivf .*{}", long.display());
        while !runs(&words) {
            assert!(began.elapsed() < Duration::from_secs(60), "it does not encode");
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(Duration::from_millis(300));
        let kill = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status();
        assert!(kill.unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(code));
        assert!(!runs(&long.display().to_string()), "a child is left");
        assert!(!run.path("out.mkv").exists() && !has_parts(&run.path("")));
    }
}
