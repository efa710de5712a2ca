//! The `aquafuse` command: moves the waterbody of one underwater picture into another.

mod demo;
mod depth;
mod depth_arguments;
mod depth_model;
mod failure;
mod fit;
mod fuse;
mod inspect;
mod output;
mod progress;
mod reading;
mod signals;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use failure::Failure;
use reading::Reading;

/// Moves the waterbody of one underwater picture into another, by physics in closed form.
///
/// The objects stay where they are: only the veil of water between them and the camera is exchanged.
#[derive(Parser)]
#[command(name = "aquafuse", version, max_term_width = 100, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Work on this many threads [default: one a core]. No output depends on it.
    #[arg(long, global = true, help_heading = COMMON, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=512))]
    threads: Option<u16>,
    #[command(flatten)]
    reading: Reading,
    /// Say nothing but errors and what was asked for.
    #[arg(long, global = true, help_heading = COMMON)]
    quiet: bool,
}

/// Where the help lists what every command takes.
const COMMON: &str = "Common options";

#[derive(Subcommand)]
enum Command {
    Demo(demo::Demo),
    Fuse(fuse::Fuse),
    Inspect(inspect::Inspect),
    Depth(depth::Depth),
    Fit(fit::Fit),
}

const EXAMPLES: &str = "\
Examples:
  aquafuse demo                                      see what it does, on pictures it makes itself
  aquafuse fuse reef.jpg green.jpg -o fused.jpg --model physical
                                                     reef.jpg in green.jpg's water
  aquafuse fuse photos/ green.jpg -o fused/          every picture of a folder, subtly
  aquafuse inspect reef.jpg                          what the picture tells about its water
  aquafuse fuse reef.jpg green.jpg -o fused.jpg --depth reef.tiff --depth-kind metres
                                                     with depth that was measured
  aquafuse depth reef.jpg -o depth.png
  aquafuse fit pairs/ -o mine.toml --depth-kind metres
                                                     a depth model from pictures with known depth

Exit codes: 0 all done; 1 a picture, or several, failed; 2 the arguments cannot be carried
out as they are (a name that nothing bears, an output that exists, a number out of range),
and nothing was done; 129, 130, 143 stopped by SIGHUP, SIGINT, SIGTERM: every file that is
there is whole.";

fn main() -> ExitCode {
    let cli = Cli::parse();
    aquafuse_data::hush_decoders();
    match run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if !matches!(failure, Failure::Told) {
                output::complain(&failure);
            }
            failure.exit_code()
        }
    }
}

fn run(cli: &Cli) -> Result<(), Failure> {
    signals::heed().map_err(Failure::work)?;
    if let Some(threads) = cli.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global().map_err(Failure::work)?;
    }
    match &cli.command {
        Command::Demo(demo) => demo.run(cli.quiet),
        Command::Fuse(fuse) => fuse.run(cli.threads, &cli.reading, cli.quiet),
        Command::Inspect(inspect) => inspect.run(&cli.reading),
        Command::Depth(depth) => depth.run(&cli.reading, cli.quiet),
        Command::Fit(fit) => fit.run(cli.quiet),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        super::Cli::command().debug_assert();
    }
}
