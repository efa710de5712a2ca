//! What the Python package `aquafuse` calls: arrays in and out, one topic a file.
//!
//! Names, defaults and documentation stand in the Python files beside this crate. Nothing here is physics.

#![allow(clippy::needless_pass_by_value, reason = "what Python passes is taken from it by value")]

mod array;
mod augment;
mod command;
mod depth;
mod draws;
mod error;
mod estimate;
mod evaluate;
mod fuser;
mod metrics;
mod network;
mod operations;
mod runs;
mod scene;
mod sequence;
mod settings;
mod threads;
mod water;

/// The compiled part of `aquafuse`. Use the package `aquafuse` itself; names in here may change.
#[pyo3::pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::augment::augment;
    #[pymodule_export]
    use crate::command::main;
    #[pymodule_export]
    use crate::depth::estimate_depth;
    #[pymodule_export]
    use crate::draws::Draws;
    #[pymodule_export]
    use crate::estimate::{Estimate, inspect};
    #[pymodule_export]
    use crate::evaluate::{PyReport, evaluate_depth, evaluate_enhancement, evaluate_fusion, evaluate_truth};
    #[pymodule_export]
    use crate::fuser::Fuser;
    #[pymodule_export]
    use crate::metrics::{depth_rmse, psnr, scores, ssim};
    #[pymodule_export]
    use crate::network::DepthNetwork;
    #[pymodule_export]
    use crate::operations::{enhance, restore, simulate};
    #[pymodule_export]
    use crate::scene::{fuse_scene, render_scene, train_scene};
    #[pymodule_export]
    use crate::sequence::Sequence;
    #[pymodule_export]
    use crate::threads::{get_threads, panic, set_threads};
    #[pymodule_export]
    use crate::water::Water;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::threads::remember_process();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
