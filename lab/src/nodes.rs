//! `lab nodes`: a dataset multiplied on two nodes of Ray, of which one is killed.

use anyhow::Result;
use xtask::setup::{python_environment, set_up};
use xtask::shell::{command, output, say};

use crate::bench::python::install;
use crate::pages::{RESULTS, show_section};

const HEAD: &str = "| made by | files | different from one process | seconds |\n|---|---|---|---|\n";

pub(crate) fn run() -> Result<()> {
    let tools = set_up()?;
    let python = python_environment("python-nodes", "lab/two_nodes/requirements.txt")?.join("bin/python");
    install(&tools.python, &python)?;
    say("Multiplying a dataset on two nodes (about two minutes)");
    let rows = output(command(python, &["lab/two_nodes/two_nodes.py"]))?;
    show_section(RESULTS, "nodes", &format!("{HEAD}{rows}"))
}
