//! AquaFuse moves the *waterbody* of one underwater image into another and leaves the objects where
//! they are: physics in closed form, on a CPU, after the paper
//! [AquaFuse](https://arxiv.org/abs/2411.01119) (IEEE RA-L, 2025).
//!
//! # Where do I start?
//!
//! ```
//! use aquafuse::{Fuser, truth};
//!
//! // Two images of synthetic places in synthetic waters; yours come from a camera.
//! let size = truth::Size { width: 96, height: 64 };
//! let content = truth::Scene::new(1, size).seen_through(&truth::waters()[0].water);
//! let reference = truth::Scene::new(2, size).seen_through(&truth::waters()[1].water);
//!
//! let fused = Fuser::new(&reference)?.fuse(&content)?;
//! assert_eq!(fused.image.size(), (96, 64));
//! # Ok::<(), aquafuse::image::ImageError>(())
//! ```
//!
//! The fused image keeps the content's size, sample type and objects; what did not fit into the range was clipped
//! and counted, and safety bounds keep a doubtful estimate from painting what is not there; `fused.report` says what
//! happened. From here:
//!
//! - somebody else's buffer, with padding between its rows: [`image::ImageRef`] and [`image::ImageMut`];
//! - [`Fuser`] also fuses in place, into a buffer, with supplied depth, and into a known water; [`stream::Stream`] is
//!   the same for video;
//! - how much water: [`fusion::Model`] goes from a safe veil to the whole water, and [`fusion::Options`] sets its strength;
//! - measured depth: [`depth::Supplied`], of a declared kind;
//! - the steps one by one: [`depth::estimate`], [`waterbody::estimate`] (with intervals and a verdict),
//!   [`fusion::Bounded`] (the safety bounds) and [`fusion::fuse`];
//! - the scene without water: [`formation::restore`]; a scene in water: [`formation::form`];
//! - programs to read and run: `cargo run --release -p aquafuse --example` with `restore_scene`, `sweep` (the
//!   angle θ), `sensor_depth`, `presets` or `scene`.
//!
//! # Concepts
//!
//! The **content** is the image that keeps its objects, the **reference** the one that gives its water. A
//! **waterbody** is a dozen numbers: the veiling light B∞ (the colour of water at infinity), β_B (how fast
//! backscatter grows with the distance z) and β_D(z) (how fast the scene's own light fades). A camera records
//! `U = I e^(-β_D z) + B∞ (1 - e^(-β_B z))`, where I is the **clear image**, as seen through air.
//!
//! The modules, read in this order, are the pipeline of the paper:
//!
//! | module | does | equations |
//! |---|---|---|
//! | [`image`] | pixels and what their values mean | |
//! | [`scene_area`] | which pixels show the scene: borders and overlays are left out | |
//! | [`depth`] | image → [`DepthMap`](depth::DepthMap), 0 near, larger farther | Eq. 3 |
//! | [`depth::Supplied`] | supplied depth of a declared kind → [`DepthMap`](depth::DepthMap) | |
//! | [`depth::fit`] | images with known depth → coefficients of Eq. 3 | Eq. 4 |
//! | [`waterbody`] | image + depth → [`Waterbody`](waterbody::Waterbody) {B∞, β_B, β_D} | Eq. 5-8 |
//! | [`waterbody::presets`] | waters from published tables, per metre | |
//! | [`formation`] | the image formation model, forwards and back | Eq. 1-2 |
//! | [`fusion`] | scene + reference water → fused image | Eq. 9-11 |
//! | [`fuser`] | all of it in one call, within safety bounds | |
//! | [`stream`] | the same, frame after frame, in the memory of the last | |
//! | [`smooth`] | the bilateral filter the paper ends with; off by default | |
//! | [`metrics`] | scores: PSNR, SSIM, depth consistency, rank correlation, UCIQE, UIQM | |
//! | [`truth`] | a ray-marched scene whose clear image, depth and water are known | |
//!
//! Colours are RGB in `[0, 1]`, whatever the sample type. Encoded (sRGB) values are the default, as in the
//! paper; linear light is another type. Coefficients are per unit of the depth map's z, whatever that is: a water per
//! metre meets relative depth through [`Waterbody::per_relative`](waterbody::Waterbody::per_relative).
//!
//! # Features
//!
//! - `simd` (default): AVX2 where the processor has it, NEON on 64-bit Arm. Without it the crate has no unsafe code; the results are
//!   the same to the bit.
//! - `threads` (default): several cores for large images, by bands of rows. Without it no thread is started; the results are the
//!   same to the bit.
//! - `network`: a tiny network that was trained on synthetic scenes alone says where open water is and what is farther, if it is
//!   asked: [`WaterMap`](waterbody::WaterMap), [`DepthModel`](depth::DepthModel). It computes on the processor and needs no other
//!   crate.
//! - `serde`: `Serialize` and `Deserialize` for the types that describe water and depth; what is read is checked.
//! - `image`: views of the crate `image`'s buffers (`RgbImage`, 16 bits, floats), and images for it.
//! - `ndarray`: views of arrays of shape (height, width, 3).
//!
//! # Simplifications
//!
//! - One water fills the image, in three channels; ambient light is the same everywhere.
//! - β_B does not depend on the distance, and β_D on nothing else. Light is not blurred on its way.
//! - Encoded values are treated as if light added up in them, as in the paper; where that is too wrong, fuse
//!   [`Linear`](image::Linear) ones.
//! - Depth from colour is relative, has no unit that two images share, and fails where no red is left.
//!
//! Where the paper leaves something open, `docs/method.md` of the repository says what we chose and what the
//! other choices do to the scores.
//!
//! # Out of scope
//!
//! Files, folders and the command line (see the crate `aquafuse-data` and the `aquafuse` command); networks
//! that make images; forward scattering (blur); several light sources.

#![cfg_attr(not(feature = "simd"), forbid(unsafe_code))]

mod bands;
pub mod depth;
pub mod formation;
pub mod fuser;
pub mod fusion;
mod grid;
mod guided;
pub mod image;
mod integration;
pub mod levels;
pub mod metrics;
mod names;
#[cfg(feature = "network")]
pub mod network;
mod packed;
#[doc(hidden)]
pub mod random;
mod rank;
pub mod scene_area;
#[doc(hidden)]
pub mod simd;
pub mod smooth;
pub mod stream;
pub mod truth;
pub mod waterbody;

pub use bands::on_this_thread;
pub use fuser::Fuser;
pub use names::NameError;
