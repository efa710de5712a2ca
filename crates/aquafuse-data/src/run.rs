//! Long runs: threads, memory, events and options that every run shares.

mod budget;
mod differences;

pub use budget::{Budget, Reservation};
pub(crate) use differences::differences;
