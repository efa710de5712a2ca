//! Long runs, whatever they make: threads, memory, events, options and a flag that stops them.
//!
//! A run is an object of the library: [`batch`](crate::batch), [`augment`](crate::augment),
//! [`evaluate`](crate::evaluate) and [`pairs`](crate::pairs) take [`RunOptions`], report [`Event`]s to a [`Listener`],
//! share one [`Budget`] of memory, and end when [`Stop`] asks them to. A front parses, calls and prints.

mod budget;
mod differences;
mod event;
mod options;
mod pool;
mod program;
mod stop;

pub use budget::{Budget, Reservation};
pub(crate) use differences::differences;
pub use event::{Event, Listener};
pub use options::{RunOptions, Summary};
pub use pool::{Ending, Permit};
pub use program::{Program, end_programs};
pub use stop::{Stop, Stopped};
