//! One file a command: its arguments, one call of the library, what it prints. No command uses another.

pub(crate) mod augment;
pub(crate) mod bag;
pub(crate) mod bench;
pub(crate) mod crossover;
pub(crate) mod demo;
pub(crate) mod depth;
pub(crate) mod enhance;
pub(crate) mod evaluate;
pub(crate) mod fit;
pub(crate) mod fuse;
pub(crate) mod inspect;
pub(crate) mod manual;
pub(crate) mod replay;
pub(crate) mod restore;
pub(crate) mod scene;
pub(crate) mod simulate;
pub(crate) mod verify;
pub(crate) mod video;
pub(crate) mod water;
