//! Image files, datasets, long runs and evaluation around the [`aquafuse`] crate.
//!
//! # Where do I start?
//!
//! [`batch`] has a complete example: one image fused with the water of another, as `aquafuse fuse` does it. A run over a
//! folder is the same call with a folder's name.
//!
//! # Concepts
//!
//! A **run** is an object of this library: it is planned once, works on threads of its own within one memory budget,
//! reports events, and stops when it is asked to ([`run`]). A program parses its arguments, makes a run and prints its
//! events.
//!
//! | module | does |
//! |---|---|
//! | [`files`] | errors that name the file, atomic writes, locks, digests |
//! | [`image_file`] | PNG, JPEG, TIFF, WebP, BMP and GIF files of 8 and 16 bits, with opacity, colour profile and EXIF |
//! | [`depth_file`] | depth maps as PNG, TIFF, OpenEXR, NPY and PFM, of a declared kind |
//! | [`model_file`], [`water_file`] | fitted depth models as TOML, waters as JSON |
//! | [`run`] | threads, memory budget, events, options and the stop flag of every run |
//! | [`pipeline`] | one image: depth and water are estimated, an operation changes it, maps and scores describe the change |
//! | [`batch`] | the same operation on an image or a folder of images; a stopped run can be continued |
//! | [`video`] | videos, decoded and encoded by the program ffmpeg; their frames fused, restored or enhanced |
//! | `bag` | logs of robots in MCAP, whose camera images are changed (a feature) |
//! | [`dataset`] | datasets: images and their annotations, read |
//! | [`augment`] | a dataset multiplied in other waters, with its annotations and a manifest; verified, and made again |
//! | [`pairs`] | images with known depth, to fit a depth model to |
//! | [`evaluate`] | scores of methods on images, on scenes of known truth, before and after, and against depth maps |
//! | [`drawing`] | images side by side with captions, and the sheet of what an estimate rests on |
//!
//! The feature `fuzz-targets` adds `targets`, every parser by itself, for fuzzing; `lpips` adds
//! [`evaluate::Lpips`] with a network from a file; `parquet` reads and writes datasets as tables.
//!
//! # Out of scope
//!
//! The command line and the network. Every error names its file, its cause and what to do.

// Sizes and places in here come from files. Tests may panic: that is how they fail.
#![cfg_attr(
    not(test),
    deny(
        clippy::arithmetic_side_effects,
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        clippy::disallowed_methods,
        clippy::indexing_slicing,
        clippy::string_slice
    )
)]

pub mod augment;
#[cfg(feature = "bag")]
pub mod bag;
pub mod batch;
pub mod dataset;
pub mod depth_file;
pub mod depth_network;
#[allow(
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::indexing_slicing,
    reason = "it draws images that are read already, at places that we choose"
)]
pub mod drawing;
pub mod evaluate;
pub mod files;
pub mod image_file;
pub mod model_file;
pub mod pairs;
pub mod pipeline;
pub mod run;
#[cfg(feature = "fuzz-targets")]
pub mod targets;
pub mod video;
pub mod water_file;

/// Networks made for tests.
#[cfg(all(test, feature = "onnx"))]
#[path = "../tests/onnx/mod.rs"]
#[allow(dead_code, reason = "other tests use what is not used here")]
mod onnx;
