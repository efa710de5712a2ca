//! Scenes in 3D from underwater images, on a CPU: Gaussian splatting with the water inside.
//!
//! # Where do I start?
//!
//! [`train::Trainer`] has a whole run in its example: images with [cameras](camera), [points] to begin with, steps.
//! [`render::render`] draws what came of it, through the water that was learned, through none, or through any other
//! ([`medium::Medium`]).
//!
//! # The way of a scene
//!
//! | module | from → to |
//! |---|---|
//! | [`files`], [`capture`] | a folder of COLMAP or NeRF → cameras, points, images without their [lens] |
//! | [`points`] | points → the [splats] training begins with |
//! | [`render`] | splats, camera, [medium] → image, distances, what comes through; and the way back, exact |
//! | [`train`] | images → splats, and the water between |
//! | [`around`] | cameras and splats → views that no camera took: an orbit, from above |
//! | [`compare`] | two scenes → how alike their images and surfaces are |
//! | [`shared_water`] | images and points → one water in the scene's unit |
//! | [`truth`] | a place of which everything is known, seen by many cameras |
//!
//! The method is that of B. Kerbl et al., "3D Gaussian Splatting for Real-Time Radiance Field Rendering" (2023); where
//! water goes in is told in [`medium`]. Numbers are [`scalar::Scalar`]: `f32` at work, `f64` where gradients are held
//! against finite differences. No output depends on the number of threads.
//!
//! # Out of scope
//!
//! Finding cameras (COLMAP does), lenses beyond OPENCV's, the command line. Distances are along the line of sight, in
//! units of the scene, which COLMAP chooses as it likes.

pub mod around;
pub mod camera;
pub mod capture;
pub mod compare;
pub mod files;
pub mod lens;
pub mod medium;
pub mod points;
mod random;
pub mod render;
pub mod scalar;
pub mod shared_water;
pub mod splats;
#[cfg(feature = "fuzz-targets")]
pub mod targets;
pub mod train;
pub mod truth;
