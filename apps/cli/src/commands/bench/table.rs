//! What was measured, as a row for people and as JSON for programs.

use std::fmt;

use aquafuse::smooth::Smoothing;
use aquafuse::truth::Size;
use serde::Serialize;

use super::measure::{MODEL, Reference, Speed, Stages};

/// Whole frames, fused.
#[derive(Serialize)]
pub(super) struct Case {
    width: usize,
    height: usize,
    threads: usize,
    reference: Reference,
    smooth: &'static str,
    model: &'static str,
    #[serde(flatten)]
    speed: Speed,
    stages: Stages,
}

impl Case {
    pub(super) const HEADING: &str =
        "         size  threads  reference  smoothing    ms/frame  frames/s  ns/pixel";

    pub(super) fn new(
        Size { width, height }: Size,
        threads: usize,
        reference: Reference,
        smoothing: Smoothing,
        speed: Speed,
        stages: Stages,
    ) -> Self {
        let (smooth, model) = (smoothing.name(), MODEL.name());
        Self { width, height, threads, reference, smooth, model, speed, stages }
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = format!("{} x {}", self.width, self.height);
        row(f, &size, self.threads, [self.reference.name(), self.smooth], self.speed)
    }
}

/// `restore`: depth and water estimated, the water taken out within its bounds.
#[derive(Serialize)]
pub(super) struct Restoration {
    width: usize,
    height: usize,
    threads: usize,
    #[serde(flatten)]
    speed: Speed,
}

impl Restoration {
    pub(super) fn new(Size { width, height }: Size, threads: usize, speed: Speed) -> Self {
        Self { width, height, threads, speed }
    }
}

impl fmt::Display for Restoration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = format!("{} x {}", self.width, self.height);
        row(f, &size, self.threads, ["restore", ""], self.speed)
    }
}

fn row(
    f: &mut fmt::Formatter<'_>,
    size: &str,
    threads: usize,
    [what, smooth]: [&str; 2],
    Speed { ms_per_frame, fps, ns_per_pixel }: Speed,
) -> fmt::Result {
    write!(
        f,
        "{size:>13}  {threads:>7}  {what:<9}  {smooth:<9}  {ms_per_frame:>10.2}  {fps:>8.1}  {ns_per_pixel:>8.2}"
    )
}
