//! Output for people and programs: progress, summaries, tables, JSON and words for an estimate.

pub(crate) mod batch;
pub(crate) mod border;
pub(crate) mod doubts;
pub(crate) mod evaluation;
mod json;
pub(crate) mod network;
pub(crate) mod output;
pub(crate) mod progress;
pub(crate) mod published;
pub(crate) mod summary;
pub(crate) mod water;
