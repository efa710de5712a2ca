//! A run on disk: resumed from a checkpoint, it ends in the same bits.
//!
//! Little-endian: a mark, the length of the options and they as JSON, what the images come to, then the state field by
//! field, each list with its length before it.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::adam::Moments;
use super::density::Density;
use super::state::State;
use super::{Options, TrainView, Trainer};
use crate::medium::{PARAMETERS, Water};
use crate::random::Random;
use crate::splats::Splats;

/// Says what the file is, and the version of what follows.
const MARK: &[u8; 16] = b"aquafuse scene 3";

/// Bytes that are enough for all that stands before the state, and its first field.
const HEAD: u64 = 1 << 16;

/// The bytes are no checkpoint of this run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// They do not begin as a checkpoint does.
    #[error("it is no checkpoint of this version; delete it to start again")]
    Unknown,
    /// They end too early, or go on where they should end.
    #[error("it is damaged at byte {at}; delete it to start again")]
    Damaged {
        /// Where.
        at: usize,
    },
    /// They belong to a run with other options.
    #[error("it belongs to a run with other options; give those, or delete it to start again")]
    OtherOptions,
    /// They belong to a run on other images, or of other cameras.
    #[error("it belongs to a run on other images; give those, or delete it to start again")]
    OtherImages,
}

/// Whether a file begins as a checkpoint of any version does, and is no link.
pub(crate) fn is_checkpoint(path: &Path) -> bool {
    let mut begin = [0; 15];
    path.symlink_metadata().is_ok_and(|about| about.is_file())
        && File::open(path).and_then(|mut file| file.read_exact(&mut begin)).is_ok()
        && MARK.starts_with(&begin)
}

/// Whether a file is the checkpoint of a run with these options that took its last step. Only the file's head is read.
pub(crate) fn is_ended(path: &Path, options: &Options) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    let steps = || {
        let rest = head.strip_prefix(MARK).ok_or(CheckpointError::Unknown)?;
        let mut reader = Reader { rest, length: head.len() };
        reader.options(options)?;
        let _subject: [u8; 8] = reader.take()?;
        reader.take().map(u32::from_le_bytes)
    };
    read.is_ok() && is_checkpoint(path) && steps().is_ok_and(|steps| steps == options.iterations)
}

impl Trainer {
    /// The run so far, as bytes.
    pub fn checkpoint(&self) -> Vec<u8> {
        let mut bytes = MARK.to_vec();
        put_list(&mut bytes, options_text(&self.options).as_bytes(), |byte| [*byte]);
        bytes.extend(self.subject.to_le_bytes());
        let state = &self.state;
        bytes.extend(state.step.to_le_bytes());
        bytes.extend(state.random.0.to_le_bytes());
        put_list(&mut bytes, &state.queue, |view| view.to_le_bytes());
        bytes.push(state.splats.sh_degree());
        put_list(&mut bytes, state.splats.rows(), |value| value.to_le_bytes());
        put_moments(&mut bytes, &state.moments);
        put_list(&mut bytes, &state.density.grad2d, |value| value.to_le_bytes());
        put_list(&mut bytes, &state.density.seen, |value| value.to_le_bytes());
        let water = state.water.as_slice();
        bytes.push(u8::from(!water.is_empty()));
        for (water, moments) in water {
            put_list(&mut bytes, &water.raw, |value| value.to_le_bytes());
            put_moments(&mut bytes, moments);
        }
        bytes
    }

    /// Resumes a checkpoint of a run with the same options on the same images.
    ///
    /// # Errors
    ///
    /// [`CheckpointError`] when the bytes are no checkpoint, or belong to a run with other options or images.
    ///
    /// # Panics
    ///
    /// As [`Trainer::new`].
    pub fn resume(options: Options, views: Vec<TrainView>, bytes: &[u8]) -> Result<Self, CheckpointError> {
        let rest = bytes.strip_prefix(MARK).ok_or(CheckpointError::Unknown)?;
        let mut reader = Reader { rest, length: bytes.len() };
        reader.options(&options)?;
        let subject = u64::from_le_bytes(reader.take()?);
        if subject != super::subject(&views) {
            return Err(CheckpointError::OtherImages);
        }
        let state = reader.state()?;
        let count = views.len();
        let is_of_views = state.queue.iter().all(|&view| (view as usize) < count);
        if !reader.rest.is_empty() || !is_of_views || state.step > options.iterations || !is_finite(&state) {
            return Err(reader.damaged());
        }
        Ok(Self::at(options, views, state))
    }
}

/// Whether all of it are numbers: no step makes others, and they would spread.
fn is_finite(state: &State) -> bool {
    let all = |list: &[f32]| list.iter().all(|value| value.is_finite());
    let moments = |moments: &Moments| all(&moments.first) && all(&moments.second);
    let water = state.water.as_ref().is_none_or(|(water, of)| all(&water.raw) && moments(of));
    all(state.splats.rows()) && moments(&state.moments) && all(&state.density.grad2d) && water
}

fn options_text(options: &Options) -> String {
    serde_json::to_string(options).unwrap_or_default()
}

fn put_list<T, const N: usize>(bytes: &mut Vec<u8>, list: &[T], of: impl Fn(&T) -> [u8; N]) {
    bytes.extend((list.len() as u64).to_le_bytes());
    bytes.extend(list.iter().flat_map(of));
}

fn put_moments(bytes: &mut Vec<u8>, moments: &Moments) {
    put_list(bytes, &moments.first, |value| value.to_le_bytes());
    put_list(bytes, &moments.second, |value| value.to_le_bytes());
}

/// Reads a state for nothing but that, as it stands behind options and images: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_state(bytes: &[u8]) {
    let _ = Reader { rest: bytes, length: bytes.len() }.state();
}

struct Reader<'a> {
    rest: &'a [u8],
    length: usize,
}

impl Reader<'_> {
    fn damaged(&self) -> CheckpointError {
        CheckpointError::Damaged { at: self.length - self.rest.len() }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], CheckpointError> {
        let (taken, rest) = self.rest.split_first_chunk().ok_or_else(|| self.damaged())?;
        self.rest = rest;
        Ok(*taken)
    }

    /// The options of the run, which must be these.
    fn options(&mut self, options: &Options) -> Result<(), CheckpointError> {
        let text: Vec<u8> = self.list(|[byte]: [u8; 1]| byte)?;
        if text == options_text(options).into_bytes() { Ok(()) } else { Err(CheckpointError::OtherOptions) }
    }

    /// A list, whose length is held against what is left before memory is taken.
    fn list<T, const N: usize>(&mut self, of: impl Fn([u8; N]) -> T) -> Result<Vec<T>, CheckpointError> {
        let length = usize::try_from(u64::from_le_bytes(self.take()?)).unwrap_or(usize::MAX);
        let taken = length.checked_mul(N).and_then(|bytes| self.rest.split_at_checked(bytes));
        let (taken, rest) = taken.ok_or_else(|| self.damaged())?;
        self.rest = rest;
        Ok(taken.as_chunks::<N>().0.iter().map(|chunk| of(*chunk)).collect())
    }

    fn floats(&mut self, expected: usize) -> Result<Vec<f32>, CheckpointError> {
        let list = self.list(f32::from_le_bytes)?;
        if list.len() == expected { Ok(list) } else { Err(self.damaged()) }
    }

    fn moments(&mut self, expected: usize) -> Result<Moments, CheckpointError> {
        Ok(Moments { first: self.floats(expected)?, second: self.floats(expected)? })
    }

    fn state(&mut self) -> Result<State, CheckpointError> {
        let step = u32::from_le_bytes(self.take()?);
        let random = Random(u64::from_le_bytes(self.take()?));
        let queue = self.list(u32::from_le_bytes)?;
        let [degree] = self.take()?;
        let rows = self.list(f32::from_le_bytes)?;
        let splats = Splats::from_rows(degree, rows).ok_or_else(|| self.damaged())?;
        let moments = self.moments(splats.rows().len())?;
        let grad2d = self.floats(splats.len())?;
        let seen = self.list(u32::from_le_bytes)?;
        if seen.len() != splats.len() {
            return Err(self.damaged());
        }
        let water = match self.take()? {
            [0] => None,
            [1] => {
                let raw = self.floats(PARAMETERS)?;
                let raw = raw.try_into().map_err(|_| self.damaged())?;
                Some((Water { raw }, self.moments(PARAMETERS)?))
            }
            _ => return Err(self.damaged()),
        };
        Ok(State { step, splats, moments, water, density: Density { grad2d, seen }, random, queue })
    }
}
