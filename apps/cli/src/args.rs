//! The arguments of the command line as values of the library: parsed and checked here, used by the commands.

pub(crate) mod batch;
pub(crate) mod border;
pub(crate) mod common;
pub(crate) mod depth;
pub(crate) mod depth_model;
pub(crate) mod enhance;
pub(crate) mod evaluation;
pub(crate) mod failures;
pub(crate) mod fusion;
pub(crate) mod levels;
pub(crate) mod max_gain;
pub(crate) mod pairs;
pub(crate) mod reading;
pub(crate) mod water;
