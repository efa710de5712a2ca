//! The network, read from a file of ONNX and run.

use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use aquafuse::depth::{SuppliedDepth, SuppliedError};
use aquafuse::image::{Image, TopEdge};
use rten::{Model, RunOptions, ThreadPool, Value};

use super::cache::{Cache, key};
use super::coarse::{refined, scaled};
use super::contents;
use super::in_time::{Lost, in_time};
use super::preset::{Preset, Unfit};
use super::tensor::{numbers, size_of, supplied, turned};
use super::{CacheCounts, NetworkOptions, SIDES};
use crate::files::{FileError, display, guard_this_thread, is_memory, one_line, sha256};
use crate::image_file::open_file;

/// A network of depth with its weights; clones share them.
#[derive(Clone)]
pub struct DepthNetwork(Arc<Loaded>, Option<Arc<Cache>>);

struct Loaded {
    path: PathBuf,
    sha256: String,
    name: String,
    length: u64,
    model: Model,
    preset: Preset,
    options: NetworkOptions,
    /// The longest time for an image, in milliseconds.
    slowest: AtomicU64,
    /// Whether an image took longer than it may.
    is_too_slow: AtomicBool,
}

/// The longest file that ONNX allows.
const MOST_BYTES: u64 = 2 << 30;
/// The side that Depth Anything was trained at.
const SIDE: u32 = 518;
/// What the layers of a network take for a pixel of its input.
const BYTES_A_PIXEL: u64 = 2048;
const FOREIGN: &str =
    "Give a network of depth in the format ONNX, whole and with its weights in the same file";

impl fmt::Debug for DepthNetwork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = self.0.options.side;
        f.debug_struct("DepthNetwork")
            .field("sha256", &self.0.sha256)
            .field("kind", &self.0.preset.kind)
            .field("side", &side)
            .finish()
    }
}

impl PartialEq for DepthNetwork {
    fn eq(&self, other: &Self) -> bool {
        let of = |network: &Self| (network.0.preset.kind, network.0.options.side);
        self.0.sha256 == other.0.sha256 && of(self) == of(other)
    }
}

impl DepthNetwork {
    /// Reads a network from a file of ONNX.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the file cannot be read, exceeds 2 GiB or the memory, is no ONNX, has an operator that is not supported or
    /// may never end, makes more than 2^28 numbers at once by its constants, keeps weights in another file, takes or gives something else than one image and one map, or its names do not settle what its numbers are.
    pub fn read(path: &Path, options: &NetworkOptions) -> Result<Self, FileError> {
        let (mut file, length) = open_file(path)?;
        if length > MOST_BYTES {
            let cause = format!("it has {length} bytes, and a network at most {MOST_BYTES}");
            return Err(FileError::TooLarge { path: path.to_owned(), cause });
        }
        // The file, its weights, and these as multiplication wants them.
        let memory = length.saturating_mul(3);
        if !is_memory(memory) {
            return Err(FileError::NoMemory { path: path.to_owned(), bytes: memory });
        }
        let mut bytes = Vec::new();
        let read = Read::by_ref(&mut file).take(length).read_to_end(&mut bytes);
        read.map_err(|error| FileError::Read { path: path.to_owned(), error })?;
        Self::from_bytes(path, bytes, options)
    }

    /// Reads a network whose file is in memory already; errors call it `path`.
    ///
    /// # Errors
    ///
    /// [`FileError`] as for [`read`](Self::read).
    pub fn from_bytes(path: &Path, bytes: Vec<u8>, options: &NetworkOptions) -> Result<Self, FileError> {
        let unfit = |unfit| unfit_network(path, unfit);
        let foreign = |cause: String| unfit_network(path, (cause, FOREIGN.into()));
        contents::check(&bytes).map_err(unfit)?;
        let (digest, length) = (sha256(&bytes), bytes.len() as u64);
        let limit = limit(options);
        let model = in_time(limit, || Model::load(bytes)).map_err(|lost| match lost {
            Lost::TooSlow => unfit((
                format!("reading it took longer than {} s", limit.as_secs()),
                "Give a smaller network, or more --depth-model-seconds".into(),
            )),
            Lost::Panicked => foreign("its reader panicked".into()),
            Lost::NoThread => unfit(no_thread()),
        })?;
        let model = model.map_err(|error| foreign(error.to_string()))?;
        let preset = Preset::of(&model, options).map_err(unfit)?;
        if options.side.is_some_and(|side| !SIDES.contains(&side)) {
            let cause =
                format!("its input must have from {} to {} pixels a side", SIDES.start(), SIDES.end());
            return Err(unfit((cause, "Give another --depth-model-size".into())));
        }
        if options.seconds == Some(0) {
            let cause = "no network is done within 0 s".to_owned();
            return Err(unfit((cause, "Give 1 or more --depth-model-seconds".into())));
        }
        if let ([Some(columns), Some(rows)], Some(_)) = (preset.fixed, options.side) {
            return Err(unfit((
                format!("it takes images of {columns}x{rows} only"),
                "Leave --depth-model-size out".into(),
            )));
        }
        let short: String = digest.chars().take(12).collect();
        let name = format!("{} (sha256 {short}, {})", display(path), preset.kind.name());
        let (path, sha256, options) = (path.to_owned(), digest, *options);
        let (slowest, is_too_slow) = (AtomicU64::new(0), AtomicBool::new(false));
        let loaded = Loaded { path, sha256, name, length, model, preset, options, slowest, is_too_slow };
        Ok(Self(Arc::new(loaded), None))
    }

    /// The same network, which keeps what it gives in the folder of a run, in `.aquafuse-depth`, and takes it from there the next
    /// time it sees the same image: numbers are the same, bit by bit. At most 2 GiB are kept.
    #[must_use]
    pub fn kept_in(&self, folder: &Path) -> Self {
        Self(self.0.clone(), Some(Arc::new(Cache::within(folder))))
    }

    /// What became of the maps that are kept; none where none are.
    pub fn cached(&self) -> Option<CacheCounts> {
        self.1.as_ref().map(|cache| cache.counts())
    }

    /// The longest that an image has taken so far.
    pub fn slowest(&self) -> Duration {
        Duration::from_millis(self.0.slowest.load(Ordering::Relaxed))
    }

    /// Its name in reports: the file, the beginning of its SHA-256, and what its numbers are taken as.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// What its numbers are taken as.
    pub fn kind(&self) -> super::NetworkKind {
        self.0.preset.kind
    }

    /// Where it was read from, its SHA-256, and the options that read it again.
    pub fn origin(&self) -> (&Path, &str, NetworkOptions) {
        let options = NetworkOptions { kind: Some(self.0.preset.kind), ..self.0.options };
        (&self.0.path, &self.0.sha256, options)
    }

    /// What running it takes in bytes, whatever the size of the image.
    pub(crate) fn memory(&self) -> u64 {
        let side = u64::from(self.0.options.side.unwrap_or(SIDE));
        let [columns, rows] = self.0.preset.fixed.map(|fixed| fixed.map_or(side, |fixed| fixed as u64));
        columns.saturating_mul(rows).saturating_mul(BYTES_A_PIXEL).saturating_add(self.0.length)
    }

    /// The depth of an image, of which `top` is the edge that is up: the network sees it upright, and the image refines what it gives.
    ///
    /// # Errors
    ///
    /// [`FileError::UnfitNetwork`] when the network cannot take an image of that size, or gives no depth map.
    pub fn depth(&self, image: &Image<u8>, top: TopEdge) -> Result<SuppliedDepth, FileError> {
        let unfit = |unfit| unfit_network(&self.0.path, unfit);
        let preset = &self.0.preset;
        let side = self.0.options.side.unwrap_or(SIDE);
        let (_, upright) = turned::<u8>(&[], image.size(), top, false);
        let wanted = preset.size(upright, side);
        let stored = match top {
            TopEdge::First | TopEdge::Last => wanted,
            TopEdge::Left | TopEdge::Right => (wanted.1, wanted.0),
        };
        let small = scaled(image, stored);
        let (pixels, _) = turned(small.pixels(), stored, top, false);
        let run = || {
            let input = Value::from_shape([1, 3, wanted.1, wanted.0], numbers(&pixels, preset.colours));
            self.run(input.expect("a value for each channel of each pixel"))
        };
        let output = match &self.1 {
            Some(cache) => {
                let how = format!("{:?} {}", preset.colours, preset.output_name);
                cache.output(&key(&self.0.sha256, &how, wanted, &pixels), run)
            }
            None => run(),
        };
        let output = output.map_err(unfit)?;
        let size = size_of(&output.1).map_err(unfit)?;
        // As stored again.
        let (values, size) = turned(&output.0, size, top, true);
        let map = supplied(values, size, preset.kind).map_err(unfit)?;
        let small = if size == stored { small } else { scaled(image, size) };
        refined(&map, &small, image, top).map_err(|error| {
            let remedy = match error {
                SuppliedError::TooFewValid { .. } => "Check --depth-model-kind",
                _ => "Check that it is a network of depth",
            };
            unfit((error.to_string(), remedy.into()))
        })
    }

    /// The numbers of the output, and its shape, if it comes in time.
    fn run(&self, input: Value) -> Result<(Vec<f32>, Vec<usize>), Unfit> {
        let limit = limit(&self.0.options);
        // A second image would wait as long, beside the first.
        if self.0.is_too_slow.load(Ordering::Relaxed) {
            return Err(too_slow("an image before this one", limit));
        }
        let loaded = self.0.clone();
        in_time(limit, move || loaded.run(input)).unwrap_or_else(|lost| {
            Err(match lost {
                Lost::TooSlow => {
                    self.0.is_too_slow.store(true, Ordering::Relaxed);
                    too_slow("one image", limit)
                }
                Lost::Panicked => ("it panicked on an image".to_owned(), CHECK.to_owned()),
                Lost::NoThread => no_thread(),
            })
        })
    }
}

impl Loaded {
    fn run(&self, input: Value) -> Result<(Vec<f32>, Vec<usize>), Unfit> {
        let Preset { input: node, output, .. } = self.preset;
        // One thread: images are shared out already, and sums then do not depend on how many there are. It is made for this run
        // alone: a process that was forked has none of the threads of its parent.
        let alone = Arc::new(ThreadPool::with_num_threads(1));
        alone.run(guard_this_thread);
        let options = RunOptions::default().with_thread_pool(Some(alone));
        let began = Instant::now();
        let ended = self.model.run_n(vec![(node, input.into())], [output], Some(options));
        let taken = u64::try_from(began.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.slowest.fetch_max(taken, Ordering::Relaxed);
        let [output] = ended.map_err(|error| (error.to_string(), CHECK.to_owned()))?;
        let Some(values) = output.as_tensor_view::<f32>() else {
            let remedy = "Export the network again with an output of 32-bit floats";
            return Err((
                format!("its output holds {:?} instead of 32-bit floats", output.dtype()),
                remedy.into(),
            ));
        };
        Ok((values.iter().copied().collect(), rten_shape(&output)))
    }
}

const CHECK: &str = "Check with another program that it takes images, or give --depth-model-size";

/// The longest that reading a network, or an image, may take.
fn limit(options: &NetworkOptions) -> Duration {
    Duration::from_secs(options.seconds.unwrap_or(NetworkOptions::SECONDS).into())
}

fn too_slow(what: &str, limit: Duration) -> Unfit {
    (
        format!("{what} took longer than {} s", limit.as_secs()),
        "Give a smaller --depth-model-size, if it takes any size, a smaller network, or more --depth-model-seconds"
            .to_owned(),
    )
}

fn no_thread() -> Unfit {
    ("the system gives no thread for it".to_owned(), "End other programs and try again".to_owned())
}

fn rten_shape(value: &Value) -> Vec<usize> {
    use rten_tensor::Layout;
    value.shape().iter().copied().collect()
}

fn unfit_network(path: &Path, (cause, remedy): Unfit) -> FileError {
    FileError::UnfitNetwork { path: path.to_owned(), cause: one_line(&cause), remedy }
}

#[cfg(test)]
mod tests;
