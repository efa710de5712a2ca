//! Scenes in 3D from underwater images, on a CPU: Gaussian splatting with the water inside.
//!
//! # Where do I start?
//!
//! [`training`] trains a scene's folder, [`views`] renders it and [`fuse`] fuses one, as `aquafuse scene` does it. The example of
//! [`train::Trainer`] is a whole run in memory: images with [cameras](camera), [points] to begin with, steps.
//! [`render::render`] renders the result through the learned water, through air, or through any other water
//! ([`medium::Medium`]).
//!
//! # Modules
//!
//! | module | from → to |
//! |---|---|
//! | [`files`], [`capture`] | a folder of COLMAP or NeRF → cameras, points, images without the distortion of their [lens] |
//! | [`points`] | points → the [splats] training begins with |
//! | [`render`] | splats, camera, [medium] → image, distances, transmittance; and the exact gradients back |
//! | [`train`], [`training`] | images → splats, and the water between: steps in memory, and runs with resume |
//! | [`model`] | splats and their medium on disk |
//! | [`fuse`] | a scene → the same scene in another water, on the threads and in the memory of one run |
//! | [`views`] | a model and cameras → a folder of views, through any medium |
//! | [`page`] | a model and cameras → one HTML page that shows it |
//! | [`around`] | cameras and splats → new views: an orbit, from above |
//! | [`compare`] | two scenes → how alike their images and surfaces are |
//! | [`shared_water`] | images and points → one water for all images, in the scene's unit |
//! | [`truth`] | a synthetic place, seen by many cameras |
//!
//! The method is that of B. Kerbl et al., "3D Gaussian Splatting for Real-Time Radiance Field Rendering" (2023); where
//! the water enters is described in [`medium`]. Numbers are [`scalar::Scalar`]: `f32` at work, `f64` where gradients are compared
//! with finite differences. No output depends on the number of threads.
//!
//! # Out of scope
//!
//! Finding cameras (COLMAP does that), lens models beyond OPENCV's, the command line. Distances are along the line of
//! sight, in units of the scene, whose length COLMAP chooses freely.

pub mod around;
pub mod camera;
pub mod capture;
pub mod compare;
pub mod files;
pub mod fuse;
pub mod lens;
pub mod medium;
pub mod model;
pub mod page;
pub mod points;
mod random;
pub mod render;
pub mod scalar;
pub mod shared_water;
pub mod splats;
#[cfg(feature = "fuzz-targets")]
pub mod targets;
pub mod train;
pub mod training;
pub mod truth;
pub mod views;
