//! `aquafuse bench`: the speed of this machine on synthetic images.

mod machine;
mod measure;
mod table;

use aquafuse::smooth::Smoothing;
use aquafuse::truth::Size;
use clap::Args;
use serde::Serialize;

use crate::args::common::Common;
use crate::args::fusion::smoothing;
use crate::failure::Failure;
use crate::report::output;
use machine::Machine;
use measure::{Images, Reference};
use table::{Case, Restoration};

/// The sizes of the paper's table.
const SIZES: [(usize, usize); 4] = [(256, 256), (512, 512), (1024, 1024), (1920, 1080)];
/// The longest side of an image; a square of it has 256 megapixels.
const LONGEST_SIDE: usize = 16_384;

const HELP: &str = "\
A frame is an 8-bit image in memory. Its depth and water are estimated, and it is fused with the
model `aquafuse`; memory is reused between frames. Cached: the water of the reference is known.
Estimated: it is estimated again for every frame. Streamed: the water of the reference is known, and
the content's water is estimated for every eighth frame. `restore` is measured too. The JSON also
has each stage alone, with its own memory. Times are medians; of eight frames at once if streamed.";

/// Measure the speed of fusion on this machine.
///
/// Uses synthetic images, on one thread and on all cores, or on --threads threads.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Bench {
    /// Size of the images in pixels; may be repeated [default: the four sizes of the paper].
    #[arg(long = "size", value_name = "WIDTHxHEIGHT", value_parser = size)]
    sizes: Vec<Size>,
    /// Frames per case [default: as many as half a second allows, at least 5].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Measure only this way to estimate [default: all].
    #[arg(long, value_name = "WHICH")]
    reference: Option<Reference>,
    /// Measure only this smoothing [default: with and without].
    #[arg(long, value_name = "HOW", value_parser = smoothing())]
    smooth: Option<Smoothing>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    schema: u32,
    machine: Machine,
    results: Vec<Case>,
    restorations: Vec<Restoration>,
}

impl Bench {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let machine = Machine::this();
        let mut threads = vec![common.threads.map_or(1, usize::from)];
        if common.threads.is_none() && machine.cores > 1 {
            threads.push(machine.cores);
        }
        let default = SIZES.map(|(width, height)| Size { width, height });
        let sizes = if self.sizes.is_empty() { &default[..] } else { &self.sizes };
        self.line(&format!("{machine}\n\n{}", Case::HEADING))?;
        let mut report = Report { schema: 1, machine, results: Vec::new(), restorations: Vec::new() };
        for &size in sizes {
            // Making the images uses all cores, also if one thread is measured.
            let all = rayon::ThreadPoolBuilder::new().num_threads(report.machine.cores).build();
            let images = all.map_err(Failure::work)?.install(|| Images::new(size)).map_err(Failure::work)?;
            for &threads in &threads {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                pool.map_err(Failure::work)?.install(|| self.measure(&images, threads, &mut report))?;
            }
        }
        if self.json {
            let json = serde_json::to_string_pretty(&report).map_err(Failure::work)?;
            return output::print(&format!("{json}\n"));
        }
        Ok(())
    }

    /// The cases of one size on so many threads, which this is called on.
    fn measure(&self, images: &Images, threads: usize, report: &mut Report) -> Result<(), Failure> {
        let stages = images.stages(self.frames).map_err(Failure::work)?;
        for smooth in Smoothing::ALL.iter().copied().filter(|one| self.smooth.is_none_or(|only| only == *one))
        {
            for reference in
                Reference::ALL.into_iter().filter(|one| self.reference.is_none_or(|only| only == *one))
            {
                let speed = images.fused(reference, smooth, self.frames).map_err(Failure::work)?;
                let case = Case::new(images.size(), threads, reference, smooth, speed, stages);
                self.line(&case.to_string())?;
                report.results.push(case);
            }
        }
        if self.smooth.is_none() && self.reference.is_none() {
            let speed = images.restored(self.frames).map_err(Failure::work)?;
            let restoration = Restoration::new(images.size(), threads, speed);
            self.line(&restoration.to_string())?;
            report.restorations.push(restoration);
        }
        Ok(())
    }

    /// A line for people, as soon as it is known.
    fn line(&self, line: &str) -> Result<(), Failure> {
        if self.json { Ok(()) } else { output::print(&format!("{line}\n")) }
    }
}

fn size(given: &str) -> Result<Size, String> {
    let sides =
        given.split_once('x').and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    match sides {
        Some((width, height))
            if (1..=LONGEST_SIDE).contains(&width) && (1..=LONGEST_SIDE).contains(&height) =>
        {
            Ok(Size { width, height })
        }
        _ => Err(format!("give WIDTHxHEIGHT, such as 1920x1080, each side from 1 to {LONGEST_SIDE}")),
    }
}
