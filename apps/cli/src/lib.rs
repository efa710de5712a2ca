//! The `aquafuse` command as a library: a program and the Python package both call [`run`].

mod args;
mod commands;
mod failure;
mod refusal;
mod report;
mod signals;
mod tool;

use std::ffi::OsString;

use args::common::Common;
use clap::{CommandFactory, Parser, Subcommand};
use commands::{
    augment, bag, bench, crossover, demo, depth, enhance, evaluate, fit, fuse, inspect, manual, replay,
    restore, scene, simulate, verify, video, water,
};
use failure::Failure;
use report::output;

/// Moves the waterbody of one underwater image into another, by physics in closed form.
///
/// The scene stays the same: only the water between the camera and the objects is exchanged.
#[derive(Parser)]
#[command(name = "aquafuse", version, max_term_width = 100, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::Demo),
    Fuse(fuse::Fuse),
    Crossover(crossover::Crossover),
    Restore(restore::Restore),
    Enhance(enhance::Enhance),
    Depth(depth::Depth),
    Inspect(inspect::Inspect),
    Water(water::Water),
    Fit(fit::Fit),
    Simulate(simulate::Simulate),
    Augment(augment::Augment),
    Verify(verify::Verify),
    Replay(replay::Replay),
    Evaluate(evaluate::Evaluate),
    Bench(bench::Bench),
    Bag(Box<bag::Bag>),
    Video(video::Video),
    Scene(scene::Scene),
    Completions(manual::Completions),
    Man(manual::Man),
}

const EXAMPLES: &str = "\
Examples:
  aquafuse demo                                      try it on synthetic images
  aquafuse fuse reef.jpg green.jpg -o fused.jpg
                                                     reef.jpg in the water of green.jpg
  aquafuse fuse photos/ green.jpg -o fused/          every image of a folder
  aquafuse inspect reef.jpg                          estimated depth and water, with a verdict
  aquafuse fuse reef.jpg green.jpg -o fused.jpg --depth reef.tiff --depth-kind metres
                                                     with measured depth
  aquafuse fuse reef.jpg preset:jerlov-3C -o fused.jpg
                                                     in the water of a published table
  aquafuse enhance reef.jpg -o clearer.jpg           stretched colours, with scores before and after
  aquafuse restore reef.jpg -o air.jpg               as if seen through air
  aquafuse water extract green.jpg -o green.water.json
                                                     save a water to a file
  aquafuse depth reef.jpg -o depth.png               estimated depth as a file
  aquafuse augment fish/ waters/ -o more/ --per-image 5 --keep-originals
                                                     a dataset six times as large
  aquafuse fit pairs/ -o mine.toml --depth-kind metres
                                                     a depth model from images with known depth
  aquafuse evaluate fusion --contents photos/ --references waters/ -o report.html
                                                     the scores of the paper on your images
  aquafuse video dive.mp4 green.jpg -o green_dive.mp4
                                                     every frame of a video, with its sound
  aquafuse scene train reef/ -o reef.ply --water learn
                                                     a 3D scene and its water

Exit codes: 0 success; 1 at least one image failed; 2 invalid arguments (no such file, output
exists, value out of range), nothing was written; 129, 130, 143 stopped by SIGHUP, SIGINT,
SIGTERM, all written files are complete.";

/// Runs the command with its arguments, of which the first is the name of the program, and returns its exit code.
///
/// It is for a process of its own: it takes over signals, the panic hook and the process's pool of threads, and a signal
/// ends the process.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(refusal) => {
            let code = said(&refusal);
            if let Some(tip) = refusal::tip(&arguments, &refusal) {
                output::remark(&format_args!("  tip: {tip}"));
            }
            return code;
        }
    };
    aquafuse_data::files::silence_decoder_panics();
    let ended = run_command(&cli);
    if cli.common.verbose {
        output::remark(&format_args!("work: {}", aquafuse_data::files::tally()));
    }
    match ended {
        Ok(()) => 0,
        Err(failure) => {
            if !matches!(failure, Failure::Reported) {
                output::complain(&failure);
            }
            failure.exit_code()
        }
    }
}

/// Prints why the arguments are refused, or the help that was asked for. A reader that has gone away is no failure.
fn said(refusal: &clap::Error) -> u8 {
    match refusal.print() {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            output::complain(&format_args!("cannot write: {error}"));
            1
        }
        _ => u8::try_from(refusal.exit_code()).unwrap_or(2),
    }
}

fn run_command(cli: &Cli) -> Result<(), Failure> {
    signals::heed().map_err(Failure::work)?;
    let common = &cli.common;
    start_threads(common.threads)?;
    match &cli.command {
        Command::Demo(demo) => demo.run(common.quiet),
        Command::Fuse(fuse) => fuse.run(common),
        Command::Crossover(crossover) => crossover.run(common),
        Command::Restore(restore) => restore.run(common),
        Command::Enhance(enhance) => enhance.run(common),
        Command::Depth(depth) => depth.run(&common.reading, common.quiet),
        Command::Inspect(inspect) => inspect.run(common),
        Command::Water(water) => water.run(common),
        Command::Fit(fit) => fit.run(common),
        Command::Simulate(simulate) => simulate.run(common),
        Command::Augment(augment) => augment.run(common),
        Command::Verify(verify) => verify.run(common),
        Command::Replay(replay) => replay.run(common),
        Command::Evaluate(evaluate) => evaluate.run(common),
        Command::Bench(bench) => bench.run(common),
        Command::Bag(bag) => bag.run(common),
        Command::Video(video) => video.run(common),
        Command::Scene(scene) => scene.run(common),
        Command::Completions(completions) => completions.run(Cli::command()),
        Command::Man(man) => man.run(Cli::command(), common),
    }
}

/// Starts the threads that work on one image or file together. Their number is ours to say: one that the environment says
/// would have no bounds. Where the system gives no threads, this one does the work.
fn start_threads(threads: Option<u16>) -> Result<(), Failure> {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.map_or_else(cores, usize::from);
    // A pool that could not be started cannot be started again: whether there are threads is tried before.
    let pool = match can_start(threads) {
        true => rayon::ThreadPoolBuilder::new().num_threads(threads),
        false => rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread(),
    };
    let no_threads = |_| anyhow::anyhow!("the system gives no more threads; end other programs");
    pool.build_global().map_err(no_threads).map_err(Failure::work)
}

/// Whether the system gives so many threads at once.
fn can_start(threads: usize) -> bool {
    let gate = std::sync::Mutex::new(());
    std::thread::scope(|scope| {
        let closed = gate.lock();
        let wait = || drop(gate.lock());
        let can_start = (0..threads).all(|_| std::thread::Builder::new().spawn_scoped(scope, wait).is_ok());
        drop(closed);
        can_start
    })
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        super::Cli::command().debug_assert();
    }
}
