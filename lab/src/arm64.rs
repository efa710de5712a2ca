//! `lab arm64`: the core on 64-bit Arm, under an emulator of a Raspberry Pi 4's processor.
//!
//! The emulator tells whether NEON gives the same bits, and how many instructions a frame takes; its seconds mean nothing.

mod toolchain;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use crate::pages::show_section;
use anyhow::{Context, Result, bail};
use toolchain::Toolchain;
use xtask::shell::{run as call, say, target};

const TARGET: &str = "aarch64-unknown-linux-gnu";
/// Parts of the core whose code differs between processors, and those that hold the pieces together. The rest is
/// plain arithmetic, and would take a quarter of an hour.
const TESTS: [&str; 10] = [
    "depth::eq3",
    "depth::map",
    "depth::median",
    "depth::model",
    "depth::tables",
    "formation",
    "fusion",
    "image::",
    "network::convolution",
    "smooth",
];
/// Every function by every model and sample type: an emulator would take a quarter of an hour. A padded buffer that is
/// fused where it lies is tested here too.
const SKIPPED: [&str; 2] = ["--skip", "padding_changes_no_bit"];

/// `lab arm64`.
pub(crate) fn run() -> Result<()> {
    test(&Toolchain::set_up()?)
}

/// [`run`] as a part of all tests: why it was skipped, if the packages cannot be had.
pub(crate) fn run_if_possible() -> Result<Option<String>> {
    match Toolchain::set_up() {
        Ok(toolchain) => test(&toolchain).map(|()| None),
        Err(error) => Ok(Some(format!("{error:#}"))),
    }
}

fn test(toolchain: &Toolchain) -> Result<()> {
    say("The core on 64-bit Arm, emulated");
    let arguments = [
        "test",
        "--locked",
        "--package",
        "aquafuse",
        "--features",
        "network",
        "--lib",
        "--",
        "--test-threads=2",
    ];
    call(toolchain.cargo(&[&arguments[..], &TESTS, &SKIPPED].concat()))
}

/// Instructions of one frame, beside what the paper says of a Raspberry Pi 4, into a page.
pub(crate) fn write_instructions(page: &str, images: &Path, published: &str) -> Result<()> {
    let text = match Toolchain::set_up() {
        Err(error) => format!("Not counted: {error:#}.\n"),
        Ok(toolchain) => {
            say("Counting instructions on 64-bit Arm (a minute)");
            let build = ["build", "--release", "--quiet", "--locked", "--package", "kernels"];
            call(toolchain.cargo(&[&build[..], &["--features", "simd"]].concat()))?;
            let [one, two] = [1, 2].map(|frames| executed(&toolchain, images, frames));
            format!(
                "| instructions of a frame of 256 x 256, cached, Cortex-A72 emulated | published, other machine: Raspberry Pi 4 |\n\
                 |---|---|\n| {:.1} million | {published} |\n",
                (two? - one?) as f64 / 1e6
            )
        }
    };
    show_section(page, "arm64", &text)
}

/// Instructions of the whole program: the emulator names each before it is executed.
fn executed(toolchain: &Toolchain, images: &Path, frames: u64) -> Result<u64> {
    let program = built().join(TARGET).join("release/kernels");
    let mut traced = toolchain.emulator(&["-singlestep", "-d", "exec,nochain"]);
    traced.arg(program).arg("frame").arg(images.join("blue.ppm")).arg(frames.to_string());
    let mut child = traced.stderr(Stdio::piped()).spawn().context("cannot start the emulator")?;
    let mut count = 0;
    if let Some(stderr) = child.stderr.take() {
        for line in BufReader::new(stderr).split(b'\n') {
            count += u64::from(line.context("cannot read what the emulator says")?.starts_with(b"Trace"));
        }
    }
    if !child.wait()?.success() || count == 0 {
        bail!("the emulator did not run a frame");
    }
    Ok(count)
}

fn built() -> PathBuf {
    target().join("arm64")
}
