//! `lab train-network`: the weights of the core's network, from synthetic places alone.

use std::fs::File;
use std::path::Path;

use anyhow::{Context, Result};
use xtask::setup::python_environment;
use xtask::shell::{command, run as run_program, say, target};

use crate::programs;

/// Places of a file, so that a stopped run loses few.
const OF_A_FILE: usize = 250;
/// Files to learn from, and places held back, whose numbers are far from the others.
const FILES: usize = 13;
const HELD: [usize; 2] = [1_000_000, 120];
const SIZE: [&str; 2] = ["160", "120"];
const WATERS: usize = 4000;
/// Where the core has them.
const WEIGHTS: &str = "crates/aquafuse/src/network/weights.bin";
const FIXTURE: &str = "crates/aquafuse/src/network/fixture.bin";

/// Makes what is not made yet. `options` are those of `train.py`.
pub(crate) fn run(options: &[&str]) -> Result<()> {
    train(options, &target().join("network"))
}

fn train(options: &[&str], folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let generator = programs::example("aquafuse", "places_to_learn")?;
    let make = |name: &str, words: &[&str]| -> Result<()> {
        let (path, part) = (folder.join(name), folder.join(format!("{name}.part")));
        if path.exists() {
            return Ok(());
        }
        let file = File::create(&part).with_context(|| format!("cannot write {}", part.display()))?;
        let mut made = command(&generator, words);
        made.stdout(file);
        run_program(made)?;
        std::fs::rename(&part, &path).with_context(|| format!("cannot write {}", path.display()))
    };
    say("Making places to learn from (ten minutes on one core)");
    make("waters.bin", &["waters", "0", &WATERS.to_string()])?;
    let places = |name: &str, first: usize, count: usize| {
        let [width, height] = SIZE;
        make(name, &["places", &first.to_string(), &count.to_string(), width, height])
    };
    places("held-0.bin", HELD[0], HELD[1])?;
    for file in 0..FILES {
        places(&format!("train-{file}.bin"), file * OF_A_FILE, OF_A_FILE)?;
    }
    let python =
        python_environment("python-network", "lab/train_network/requirements.txt")?.join("bin/python");
    let best = folder.join("best.pt");
    say("Training the network");
    let mut training = command(&python, &["lab/train_network/train.py"]);
    training.arg(folder).arg(&best).args(options);
    run_program(training)?;
    let mut export = command(&python, &["lab/train_network/export.py"]);
    export.arg(folder).arg(&best).args([WEIGHTS, FIXTURE]);
    run_program(export)
}
