//! Scenes in 3D from underwater pictures, on a CPU: Gaussian splatting with the water inside.

pub mod camera;
pub mod medium;
pub mod points;
mod random;
pub mod render;
pub mod scalar;
pub mod splats;
pub mod train;
pub mod truth;
