//! The program itself. `cargo xtask test` starts the one that is built for this.

use std::process::{Command, Output};

fn lab(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lab")).args(words).output().expect("the program starts")
}

#[test]
fn what_is_no_command_is_answered_with_the_usage() {
    let usage = lab(&["help"]);
    assert!(usage.status.success());
    for words in [&["no-such-command"][..], &["memory", "0"], &["bench", "no-such-part"], &[]] {
        let output = lab(words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert_eq!(output.stderr, usage.stdout, "{words:?}");
    }
}
