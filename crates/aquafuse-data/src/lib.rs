//! Images on disk around the [`aquafuse`] crate: files in, files out, folders of them.
//!
//! # Where do I start?
//!
//! ```
//! use aquafuse::{fusion::Options, smooth::Smoothing};
//! use aquafuse_data::analysis::{DepthSource, analyse};
//! use aquafuse_data::{job, image_file::{ImageFile, ReadOptions, WriteOptions}, treatment::Treatment};
//! # use aquafuse::truth::{Scene, Size, waters};
//! # let folder = tempfile::tempdir()?;
//! # let path = |name: &str| folder.path().join(name);
//! # for (name, water) in ["content.png", "reference.png"].into_iter().zip(waters()) {
//! #     let scene = Scene::new(1, Size { width: 64, height: 48 });
//! #     let image = scene.seen_through(&water.water).convert::<u8>();
//! #     ImageFile::new(image).write(&path(name), &WriteOptions::default())?;
//! # }
//!
//! let reference = ImageFile::read(&path("reference.png"))?;
//! let job: job::Job = job::Job {
//!     items: vec![job::Item {
//!         input: path("content.png"),
//!         output: path("fused.png"),
//!         depth: DepthSource::default(),
//!     }],
//!     recipe: job::Recipe {
//!         treatment: Treatment::Fuse {
//!             reference: analyse(&reference, &DepthSource::default())?.estimate,
//!             options: Options::default(),
//!         },
//!         smoothing: Smoothing::default(),
//!         upright: false,
//!         reading: ReadOptions::default(),
//!         writing: WriteOptions::default(),
//!     },
//!     conduct: job::Conduct::default(),
//!     record: None,
//! };
//! let summary = job.run(&|message| println!("{message:?}"));
//! assert_eq!((summary.done, summary.failed), (1, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Concepts
//!
//! | module | does |
//! |---|---|
//! | [`image`] | PNG, JPEG, TIFF, WebP, BMP and GIF files, 8 and 16 bits, with opacity, colour profile and EXIF; limits before memory is taken; written all or nothing |
//! | [`memory`] | one budget of memory for all images in work |
//! | [`depth_file`] | depth maps as PNG, TIFF, OpenEXR, NPY and PFM, read as a declared kind |
//! | [`analysis`] | what an image tells about its depth and water: the one estimator of every command |
//! | [`treatment`] | what is done to an image: fused with a water, or restored; encoded or in linear light |
//! | [`dataset`] | datasets: images, and the annotations about them |
//! | [`augment`] | a dataset multiplied in other waters, with a manifest; verified, and made again |
//! | [`digest`] | SHA-256 |
//! | [`folder`] | which images a folder holds |
//! | [`job`] | a long run as a stream of messages; one that was stopped goes on where it was |
//! | [`pairs`] | images with known depth, a folder `rgb` and a folder `depth`, to fit a depth model to |
//! | [`model_file`] | fitted depth models as TOML |
//! | [`water_file`] | waters as JSON |
//! | [`maps`] | what a fusion is made from, as images |
//! | [`scores`] | how good an image looks |
//! | [`evaluate`] | what methods are worth: on anybody's images, on scenes of known truth, before and after, against depth maps |
//! | [`sheet`] | images side by side with captions |
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

pub mod analysis;
pub mod augment;
mod barrier;
mod base64;
pub mod dataset;
pub mod depth_file;
pub mod digest;
pub mod evaluate;
pub mod folder;
pub mod image_file;
pub mod job;
mod lock;
pub mod maps;
pub mod memory;
pub mod model_file;
pub mod pairs;
pub mod scores;
mod settings;
#[allow(
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::indexing_slicing,
    reason = "it draws images that are read already, at places that we choose"
)]
pub mod sheet;
#[cfg(feature = "fuzz-targets")]
pub mod targets;
pub mod treatment;
pub mod water_file;

pub use barrier::hush_decoders;
pub use base64::base64;
