//! The project's habits, one command each: `cargo xtask check | test | test-arm64 | truth | readings | depth | published |
//! hostile | memory | multiply | helps | corpus | soak | instructions | bench | scene`.

mod arm64;
mod bench;
mod checks;
mod corpus;
mod helps;
mod hostile;
mod instructions;
mod memory;
mod multiply;
mod results;
mod runner;
mod scene;
mod setup;
mod shell;
mod soak;
mod tests;

use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask COMMAND

  check      format, spelling, lints, documentation, licences: what a reviewer would say first
  test       sets up what is missing, then `check` and every test: what CI runs
  test-arm64 the core's tests on 64-bit Arm, under an emulator that is set up if need be
  truth      how much of the true change is made on scenes of known truth, into docs/results.md
  readings   what each way to read the paper does to the scores, into docs/method.md
  depth      how well depth from colour agrees with measured depth, into docs/results.md
  published  real images scored beside the paper's tables and other methods, into docs/results.md
  hostile    hundreds of bad files given to the command and to a rival, into docs/results.md
  memory     [PICTURES] what a run over 1,000 images of 24 megapixels holds, into docs/results.md
  multiply   [PICTURES] a dataset of 10,000 small images multiplied, and killed 50 times, into docs/results.md
  helps      whether a small network learns more from a dataset multiplied, into docs/results.md
  corpus     the examples that fuzzing starts from, made again
  soak       [MINUTES] [PARSERS] every parser fuzzed, each law tried on 100,000 cases, and a folder's job killed 1,000 times,
             into docs/results.md; where parsers are named, those are fuzzed and nothing else is done
  scene      splats trained on a truth scene, with the water inside, and scenes beside themselves fused, into
             docs/results.md
  instructions
             of each kernel, counted by valgrind, into benches/instructions.tsv
  bench      [PARTS] whole frames against the same in OpenCV, and others, into BENCHMARKS.md; parts are frames, others,
             scaling, footprint, arm64

Tests on real images look for them in the folder AQUAFUSE_TEST_DATA and say so when they skip.
Tools are kept in AQUAFUSE_CACHE (default ~/.cache/aquafuse), Python packages under target/.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words[..] {
        ["check"] => setup::set_up().and_then(|tools| checks::run(&tools)),
        ["test"] => tests::run(),
        ["depth"] => results::depth(),
        ["published"] => results::published(),
        ["truth"] => results::truth(),
        ["readings"] => results::readings(),
        ["hostile"] => hostile::run(),
        ["memory"] => memory::run_with(memory::PICTURES),
        ["memory", images] if images.parse::<usize>().is_ok_and(|count| count > 0) => {
            memory::run_with(images.parse().unwrap_or(memory::PICTURES))
        }
        ["multiply"] => multiply::run_with(multiply::PICTURES),
        ["multiply", images] if images.parse::<usize>().is_ok_and(|count| count >= 10) => {
            multiply::run_with(images.parse().unwrap_or(multiply::PICTURES))
        }
        ["helps"] => helps::run_all(),
        ["corpus"] => corpus::run_all(),
        ["soak"] => soak::run_for(soak::DEFAULT_MINUTES, &[]),
        ["soak", minutes, ref parsers @ ..] if minutes.parse::<u64>().is_ok() => {
            soak::run_for(minutes.parse().unwrap_or(soak::DEFAULT_MINUTES), parsers)
        }
        ["test-arm64"] => arm64::run(),
        ["instructions"] => instructions::renew(),
        ["scene"] => scene::run_all(),
        ["bench"] => setup::set_up().and_then(|tools| bench::run(&tools, &bench::PARTS)),
        ["bench", ref parts @ ..] if parts.iter().all(|part| bench::PARTS.contains(part)) => {
            setup::set_up().and_then(|tools| bench::run(&tools, parts))
        }
        ["help" | "--help" | "-h"] => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            let cannot_set_up = error.downcast_ref::<setup::Missing>().is_some();
            ExitCode::from(if cannot_set_up { 2 } else { 1 })
        }
    }
}
