//! Depth in even steps, of which a law is worth a table.

use super::{LEVELS, level_to_z};

/// Steps between two levels of a byte.
const STEPS_A_LEVEL: u16 = 8;
/// The step of z = 1.
pub(in crate::depth) const LAST_STEP: u16 = 255 * STEPS_A_LEVEL;
/// Places in a table that is read by level or by step; more than there are, so that any place taken modulo this number is one.
pub(crate) const TABLE: usize = 2048;

/// z of a step.
pub(super) fn step_to_z(step: u16) -> f32 {
    f32::from(step) / f32::from(LAST_STEP)
}

/// The level nearest to a step.
#[inline(always)]
pub(in crate::depth) fn step_to_level(step: u16) -> u8 {
    ((step + STEPS_A_LEVEL / 2) / STEPS_A_LEVEL) as u8
}

/// Depth in so few steps that a law is worth a table: a byte or a step.
pub(crate) trait Stepped: Copy + Send + Sync {
    /// How many there are.
    const COUNT: usize;

    /// The z of one of them.
    fn z(place: usize) -> f32;

    /// Which it is; less than [`TABLE`].
    fn place(self) -> usize;
}

impl Stepped for u8 {
    const COUNT: usize = LEVELS;

    fn z(place: usize) -> f32 {
        level_to_z(place as u8)
    }

    #[inline(always)]
    fn place(self) -> usize {
        usize::from(self)
    }
}

impl Stepped for u16 {
    const COUNT: usize = LAST_STEP as usize + 1;

    fn z(place: usize) -> f32 {
        step_to_z(place as u16)
    }

    #[inline(always)]
    fn place(self) -> usize {
        usize::from(self) % TABLE
    }
}

/// The levels or the steps of a map.
#[derive(Clone, Copy)]
pub(crate) enum InSteps<'a> {
    Levels(&'a [u8]),
    Steps(&'a [u16]),
}

impl InSteps<'_> {
    /// A law at each level or step.
    pub(crate) fn table<V>(self, law: impl Fn(f32) -> V) -> Vec<V> {
        match self {
            Self::Levels(_) => (0..u8::COUNT).map(u8::z).map(law).collect(),
            Self::Steps(_) => (0..u16::COUNT).map(u16::z).map(law).collect(),
        }
    }

    /// The place in such a table for pixel `i`.
    #[inline(always)]
    pub(crate) fn place(self, i: usize) -> usize {
        match self {
            Self::Levels(levels) => levels[i].place(),
            Self::Steps(steps) => steps[i].place(),
        }
    }
}
