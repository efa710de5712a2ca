//! `lab arrays`: a hundred times as many made arrays for the Python package as its tests take.

use anyhow::Result;
use xtask::setup::set_up;
use xtask::shell::{command, root, run as call, say};

use crate::bench::python::install;

const EXAMPLES: &str = "100000";

pub(crate) fn run() -> Result<()> {
    let python = set_up()?.python;
    install(&python, &python)?;
    say("Arrays of any kind, in any order in memory (half an hour)");
    let mut tests =
        command(python, &["-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/test_arrays.py"]);
    tests.current_dir(root().join("python")).env("AQUAFUSE_EXAMPLES", EXAMPLES);
    call(tests)
}
