//! The laboratory: what measures AquaFuse and forges files for it. `cargo lab COMMAND` builds and runs it.

mod arm64;
mod arrays;
mod bench;
mod bounds;
mod chance;
mod corpus;
mod depth;
mod evaluate;
mod flicker;
mod forge;
mod gst;
mod helps;
mod hostile;
mod instructions;
mod memory;
mod multiply;
mod networks;
mod nodes;
mod pages;
mod programs;
mod readings;
mod roundtrip;
mod runner;
mod scene;
mod soak;
mod synthetic;
mod train_network;
mod truth;
mod variations;
mod water;

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result};

const USAGE: &str = "\
cargo lab COMMAND

Each command writes its tables into the page that is named.

docs/results.md
  truth [depth]       estimates and fusion on synthetic scenes whose water and depth are known; alone with `depth`, with
                      true depth made worse as a network's is
  depth               depth from colour compared with measured depth
  water               the veiling light of photographs compared with their open water, marked by eye
  bounds              what each safety bound of a fusion saves, and what it costs
  flicker             how much more a sequence changes from frame to frame than its source
  gst                 the GStreamer element in a live pipeline: dropped frames, processor, latency
  pairs               restoration and enhancement beside references that people chose, and beside rivals
  published           scores of real images, beside the paper's and those of other methods
  hostile             over a thousand bad files, given to `aquafuse` and to a rival
  memory [IMAGES|runs]
                      peak memory of a run over 1,000 images of 24 megapixels; and, alone with `runs`, of commands on
                      scenes and of files of a million lines
  multiply [IMAGES]   a dataset of 10,000 small images multiplied; a run killed 50 times and resumed
  networks            networks of depth with random weights, by the command's runtime and by ONNX Runtime
  nodes               a dataset multiplied on two nodes of Ray, of which one is killed; needs root
  roundtrip           annotations of ten layouts before and after augment, by the readers that people use
  variations          small datasets and scenes of every kind, varied in the ways of users: what is lost without a word
  helps [OPTION...]   whether a small network learns more from images in other waters; goes on where it was stopped, and
                      `helps --table` writes the table of the runs that are finished
  scene [FOLDER]      splats trained on a synthetic scene and on fused scenes; FOLDER is for images to look at
  scene-cost          what a step of training costs, a part of `scene`
  scene-files         splats of ours read by other programs, and theirs by us
  scene-fused         the paper's table of view synthesis, a part of `scene`
  scene-quality [truth|water|pool]
                      what each measure of training is worth on views held out of a synthetic scene, on the same without its
                      water, and on a pool
  soak [MINUTES] [PARSER...]
                      every parser fuzzed, every law tried on 100,000 cases, a folder's job killed 1,000 times;
                      with PARSER, these parsers are fuzzed and nothing else is done

docs/method.md
  readings [TABLE]    how each reading of the paper changes the scores

BENCHMARKS.md
  bench [PART...]     speed beside OpenCV and others; PART is frames, others, scaling, python, footprint,
                      arm64 or video

Files
  corpus              makes the files of fuzz/corpus again; needs `--features parquet`
  train-network [OPTION...]
                      the network of the core, trained on synthetic scenes alone (two hours on one core; the same command
                      continues a run that was stopped): its weights, and a fixture that the tests compute again
  instructions        counts the instructions of each kernel by valgrind, into benches/instructions.tsv

Checks of `cargo xtask test`
  arrays              arrays of any kind given to the Python package, a hundred times as many as in the tests
  arm64               the core's tests on 64-bit Arm, under an emulator that is set up if need be
  guards              `arm64`, and the instructions of each kernel compared with benches/instructions.tsv

Started by other commands, in a process of their own
  rival INPUT OUTPUT  |  recode FOLDER OUTPUT TIMES  |  copy FOLDER OUTPUT  |  frame-memory FILE
  network FILE IMAGE OUTPUT

Real images are looked for in the folder AQUAFUSE_TEST_DATA.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    if let ["help" | "--help" | "-h"] = words[..] {
        print!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    match run(&words) {
        Some(Ok(())) => ExitCode::SUCCESS,
        Some(Err(error)) => {
            eprintln!("lab: {error:#}");
            ExitCode::FAILURE
        }
        None => {
            eprint!("{USAGE}");
            ExitCode::from(2)
        }
    }
}

/// Nothing if the words are no command.
fn run(words: &[&str]) -> Option<Result<()>> {
    Some(match *words {
        ["truth"] => truth::run(),
        ["truth", "depth"] => truth::coarse_depth(),
        ["depth"] => depth::run(),
        ["water"] => water::run(),
        ["bounds"] => bounds::run(),
        ["flicker"] => flicker::run(),
        ["gst"] => gst::run(),
        ["pairs"] => evaluate::pairs(),
        ["published"] => evaluate::published(),
        ["hostile"] => hostile::run(),
        ["memory"] => memory::run(memory::IMAGES),
        ["memory", "runs"] => memory::runs(),
        ["memory", images] => memory::run(images.parse().ok().filter(|&count| count > 0)?),
        ["multiply"] => multiply::run(multiply::IMAGES),
        ["multiply", images] => multiply::run(images.parse().ok().filter(|&count| count >= 10)?),
        ["networks"] => networks::run(),
        ["nodes"] => nodes::run(),
        ["arrays"] => arrays::run(),
        ["roundtrip"] => roundtrip::run(),
        ["variations"] => variations::run(),
        ["helps", ref options @ ..] => helps::run(options),
        ["scene"] => scene::run(None),
        ["scene", folder] => scene::run(Some(Path::new(folder))),
        ["scene-cost"] => scene::cost(),
        ["scene-files"] => scene::files(),
        ["scene-fused"] => scene::fused(),
        ["scene-quality"] => scene::quality(None),
        ["scene-quality", only @ ("truth" | "water" | "pool")] => scene::quality(Some(only)),
        ["soak"] => soak::run(soak::DEFAULT_MINUTES, &[]),
        ["soak", minutes, ref parsers @ ..] => soak::run(minutes.parse().ok()?, parsers),
        ["readings"] => readings::run(None),
        ["readings", table] => readings::run(Some(table)),
        ["bench"] => bench::run(&bench::PARTS),
        ["bench", ref parts @ ..] if parts.iter().all(|part| bench::PARTS.contains(part)) => {
            bench::run(parts)
        }
        ["corpus"] => corpus::run(),
        ["train-network", ref options @ ..] => train_network::run(options),
        ["instructions"] => instructions::renew(),
        ["arm64"] => arm64::run(),
        ["guards"] => guards(),
        ["rival", input, output] => hostile::rival::run(Path::new(input), Path::new(output)),
        ["recode", folder, output, times] => {
            multiply::dataset::recode(Path::new(folder), Path::new(output), times.parse().ok()?)
        }
        ["network", file, image, output] => {
            networks::one(Path::new(file), Path::new(image), Path::new(output))
        }
        ["copy", folder, output] => bench::apart::copy(Path::new(folder), Path::new(output)),
        ["frame-memory", file] => bench::apart::memory(Path::new(file)),
        _ => return None,
    })
}

/// What `cargo xtask test` has of this: a line `passed: NAME` or `skipped: NAME: WHY` for each.
fn guards() -> Result<()> {
    type Guard = fn() -> Result<Option<String>>;
    let guards: [(&str, Guard); 2] =
        [("64-bit Arm", arm64::run_if_possible), ("instructions", instructions::guard)];
    for (name, guard) in guards {
        match guard().with_context(|| name.to_owned())? {
            Some(why) => println!("skipped: {name}: {why}"),
            None => println!("passed: {name}"),
        }
    }
    Ok(())
}
