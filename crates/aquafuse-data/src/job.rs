//! A long run as a stream of messages: whoever started it decides what to show.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use aquafuse::depth::SuppliedReport;
use aquafuse::fusion::{Bounded, Bounds, Clipping, Options, fuse_mut};
use aquafuse::smooth::Smoothing;
use aquafuse::waterbody::{Estimate, Quality};
use rayon::prelude::*;

use crate::analysis::{DepthSource, analyse};
use crate::picture::{FileError, Picture, WriteOptions};

/// Fuses pictures with one water.
#[derive(Clone, Debug)]
pub struct Fuse {
    /// What to read, and where to write it.
    pub items: Vec<Item>,
    /// The reference's water, and what it is worth.
    pub reference: Estimate,
    /// How to fuse.
    pub options: Options,
    /// How to smooth what was fused.
    pub smoothing: Smoothing,
    /// How to write.
    pub writing: WriteOptions,
}

/// One picture of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The content.
    pub input: PathBuf,
    /// The fused picture.
    pub output: PathBuf,
    /// How to come by the content's depth.
    pub depth: DepthSource,
}

/// What a running job says.
#[derive(Debug)]
#[non_exhaustive]
pub enum Message<'a> {
    /// It begins, with this many pictures.
    Started {
        /// Pictures.
        total: usize,
    },
    /// A picture is written.
    Done {
        /// Which.
        item: &'a Item,
        /// What is worth knowing about it.
        report: Report,
    },
    /// A picture failed; the others go on.
    Failed {
        /// Which.
        item: &'a Item,
        /// Why.
        error: FileError,
    },
}

/// What is worth knowing about a fused picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Values that did not fit into the range.
    pub clipping: Clipping,
    /// What the estimate of the content is worth.
    pub quality: Quality,
    /// Which safety bounds acted.
    pub bounds: Bounds,
    /// What is worth knowing about its depth, where that was supplied.
    pub supplied: Option<SuppliedReport>,
}

/// How a job ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Pictures written.
    pub done: usize,
    /// Pictures that failed.
    pub failed: usize,
}

impl Fuse {
    /// Runs the job on the threads of the pool it is called in, telling `listener` in the order in which
    /// pictures get done. The files do not depend on that order.
    pub fn run(&self, listener: &(dyn Fn(Message<'_>) + Sync)) -> Summary {
        listener(Message::Started { total: self.items.len() });
        let (done, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
        self.items.par_iter().for_each(|item| match self.fuse_file(item) {
            Ok(report) => {
                done.fetch_add(1, Ordering::Relaxed);
                listener(Message::Done { item, report });
            }
            Err(error) => {
                failed.fetch_add(1, Ordering::Relaxed);
                listener(Message::Failed { item, error });
            }
        });
        Summary { done: done.into_inner(), failed: failed.into_inner() }
    }

    fn fuse_file(&self, item: &Item) -> Result<Report, FileError> {
        let mut picture = Picture::read(&item.input)?;
        let found = analyse(&picture, &item.depth)?;
        let bounded = Bounded::new(&found.estimate, &self.reference, self.options);
        let clipping = fuse_mut(&mut picture.image, &found.depth, bounded.waters(), &bounded.options)
            .expect("the depth map was made for this picture");
        picture.image = self.smoothing.apply(picture.image);
        picture.write(&item.output, &self.writing)?;
        let quality = found.estimate.quality;
        Ok(Report { clipping, quality, bounds: bounded.bounds, supplied: found.supplied })
    }
}
