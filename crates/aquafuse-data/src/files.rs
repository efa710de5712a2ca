//! Files as such, whatever they hold: errors that name them, atomic writes, locks, digests, and a tally of the work done.

mod atomic;
mod catch_panic;
mod digest;
mod display;
mod error;
mod folders;
mod lock;
mod memory;
mod patient;
mod tally;
mod text;

pub use atomic::{Claim, abandon_parts, remove_stale_parts, write_bytes, write_text};
pub(crate) use atomic::{Output, Staged, write_atomically};
pub(crate) use catch_panic::catch_panic;
#[cfg(feature = "onnx")]
pub(crate) use catch_panic::guard_this_thread;
pub use catch_panic::silence_decoder_panics;
pub use digest::sha256;
pub(crate) use digest::{Hashed, hexadecimal, sha256_of};
pub use display::{display, one_line, plain_json};
pub use error::FileError;
pub use folders::{holds_files, make_folder, make_folder_of, make_work_folder, place_of, refuse_inputs};
pub(crate) use folders::{make_folder_within, stays_within};
pub(crate) use lock::lock;
pub(crate) use memory::is_memory;
pub(crate) use patient::Patient;
pub use tally::{Step, Tally, count, tally};
pub(crate) use text::{decoded, text_of};
