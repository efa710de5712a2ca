//! What the project's own programs share: saying and running steps, set-up, clocks.

pub mod clock;
pub mod setup;
pub mod shell;
