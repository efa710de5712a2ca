//! `aquafuse video`, with clips that ffmpeg makes. Without ffmpeg these tests skip and say so.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

#[path = "../run/mod.rs"]
mod run;

mod clips;
mod damaged;
mod kept;
mod stopped;
mod streams;
