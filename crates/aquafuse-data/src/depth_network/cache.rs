//! What a network gave for an image before, kept in the folder of a run.
//!
//! A file for each image, named by the digest of the network and of what it saw: the shape and the numbers, and a digest of both.
//! A file that is damaged is made again. Not more than [`MOST_BYTES`] are kept; what would exceed them is computed each time.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use sha2::{Digest, Sha256};

use super::{CACHE, CacheCounts};
use crate::files::{hexadecimal, sha256, write_bytes};

/// All files together.
const MOST_BYTES: u64 = 2 << 30;
/// One file.
const LONGEST: u64 = 256 << 20;
const HEADING: &[u8] = b"aquafuse depth 1\n";
/// The digits of a digest.
const DIGITS: usize = 64;
/// Sides of a shape.
const MOST_SIDES: usize = 8;

/// The numbers of an output and its shape.
pub(super) type Output = (Vec<f32>, Vec<usize>);

/// The folder, and counts of its use.
#[derive(Debug)]
pub(super) struct Cache {
    folder: PathBuf,
    most: u64,
    bytes: AtomicU64,
    found: AtomicU64,
    kept: AtomicU64,
    damaged: AtomicU64,
    not_kept: AtomicU64,
}

impl Cache {
    /// The cache in the folder of a run. Nothing is written yet.
    pub(super) fn within(folder: &Path) -> Self {
        Self::bounded(folder, MOST_BYTES)
    }

    fn bounded(folder: &Path, most: u64) -> Self {
        let folder = folder.join(CACHE);
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        let bytes =
            entries.filter_map(|entry| Some(entry.metadata().ok()?.len())).fold(0, u64::saturating_add);
        let [found, kept, damaged, not_kept] = [const { AtomicU64::new(0) }; 4];
        Self { folder, most, bytes: AtomicU64::new(bytes), found, kept, damaged, not_kept }
    }

    /// What became of the maps so far.
    pub(super) fn counts(&self) -> CacheCounts {
        let [found, kept, damaged, not_kept] = [&self.found, &self.kept, &self.damaged, &self.not_kept]
            .map(|count| count.load(Ordering::Relaxed));
        CacheCounts { found, kept, damaged, not_kept }
    }

    /// The output for this input, from the folder or by `run`, whose result is then kept.
    pub(super) fn output<E>(&self, key: &str, run: impl FnOnce() -> Result<Output, E>) -> Result<Output, E> {
        let path = self.folder.join(key);
        match self.read(&path) {
            Some(Some(output)) => {
                self.found.fetch_add(1, Ordering::Relaxed);
                return Ok(output);
            }
            Some(None) => {
                self.damaged.fetch_add(1, Ordering::Relaxed);
            }
            None => {}
        }
        let output = run()?;
        let is_kept = self.keep(&path, &written(&output));
        if is_kept { &self.kept } else { &self.not_kept }.fetch_add(1, Ordering::Relaxed);
        Ok(output)
    }

    /// None where there is no file, and nothing in it where it is damaged.
    fn read(&self, path: &Path) -> Option<Option<Output>> {
        let known = path.symlink_metadata().ok()?;
        if !known.is_file() || known.len() > LONGEST {
            return Some(None);
        }
        Some(std::fs::read(path).ok().and_then(|bytes| parsed(&bytes)))
    }

    fn keep(&self, path: &Path, bytes: &[u8]) -> bool {
        let length = bytes.len() as u64;
        let before = self.bytes.fetch_add(length, Ordering::Relaxed);
        let fits = length <= LONGEST && before.saturating_add(length) <= self.most;
        let is_kept =
            fits && std::fs::create_dir_all(&self.folder).is_ok() && write_bytes(path, bytes, true).is_ok();
        if !is_kept {
            self.bytes.fetch_sub(length, Ordering::Relaxed);
        }
        is_kept
    }
}

/// The name of an input's file.
pub(super) fn key(network: &str, how: &str, (columns, rows): (usize, usize), pixels: &[[u8; 3]]) -> String {
    let mut digest = Sha256::new();
    digest.update(format!("{network} {how} {columns}x{rows}\n"));
    digest.update(pixels.as_flattened());
    hexadecimal(&digest.finalize())
}

fn written((values, shape): &Output) -> Vec<u8> {
    let mut bytes = HEADING.to_vec();
    bytes.extend((shape.len() as u64).to_le_bytes());
    bytes.extend(shape.iter().flat_map(|side| (*side as u64).to_le_bytes()));
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    let digest = sha256(&bytes);
    bytes.extend(digest.into_bytes());
    bytes
}

fn parsed(bytes: &[u8]) -> Option<Output> {
    let (content, digest) = bytes.split_at_checked(bytes.len().checked_sub(DIGITS)?)?;
    if sha256(content).as_bytes() != digest {
        return None;
    }
    let (sides, rest) = content.strip_prefix(HEADING)?.split_first_chunk::<8>()?;
    let sides = usize::try_from(u64::from_le_bytes(*sides)).ok().filter(|sides| *sides <= MOST_SIDES)?;
    let (shape, values) = rest.split_at_checked(sides.checked_mul(8)?)?;
    let shape = shape.as_chunks::<8>().0.iter().map(|side| usize::try_from(u64::from_le_bytes(*side)).ok());
    let shape: Vec<usize> = shape.collect::<Option<_>>()?;
    let (values, rest) = values.as_chunks::<4>();
    let count = shape.iter().try_fold(1_usize, |count, side| count.checked_mul(*side))?;
    (count == values.len() && rest.is_empty())
        .then(|| (values.iter().map(|value| f32::from_le_bytes(*value)).collect(), shape))
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    fn output() -> Output {
        (vec![0.5, -1.0, f32::NAN, 3e9, 0.0, 7.0], vec![1, 2, 3])
    }

    fn bits(output: &Output) -> (Vec<u32>, Vec<usize>) {
        (output.0.iter().map(|value| value.to_bits()).collect(), output.1.clone())
    }

    /// The output of an input, and whether it had to be computed.
    fn asked(cache: &Cache, key: &str) -> (Output, bool) {
        let mut is_run = false;
        let run = || -> Result<Output, Infallible> {
            is_run = true;
            Ok(output())
        };
        (cache.output(key, run).expect("it cannot fail"), is_run)
    }

    #[test]
    fn what_was_computed_is_found_bit_by_bit() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::within(folder.path());
        assert!(asked(&cache, "a").1);
        let (found, is_run) = asked(&Cache::within(folder.path()), "a");
        assert!(!is_run);
        assert_eq!(bits(&found), bits(&output()));
        assert!(asked(&cache, "b").1);
        assert_eq!(cache.counts(), CacheCounts { kept: 2, ..CacheCounts::default() });
    }

    #[test]
    fn damaged_files_are_made_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::within(folder.path());
        let (whole, path) = (written(&output()), folder.path().join(CACHE).join("a"));
        assert!(asked(&cache, "a").1);
        for place in 0..whole.len() {
            let mut flipped = whole.clone();
            flipped.iter_mut().skip(place).take(1).for_each(|byte| *byte ^= 1);
            assert!(
                parsed(&flipped).is_none() && parsed(whole.get(..place).unwrap_or_default()).is_none(),
                "{place}"
            );
        }
        std::fs::write(&path, b"short").expect("written");
        assert!(asked(&cache, "a").1);
        assert!(!asked(&cache, "a").1);
        assert_eq!(cache.counts(), CacheCounts { found: 1, kept: 2, damaged: 1, not_kept: 0 });
    }

    #[test]
    fn no_more_than_the_bound_is_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let one = written(&output()).len() as u64;
        let cache = Cache::bounded(folder.path(), 2 * one);
        for key in ["a", "b", "c"] {
            assert!(asked(&cache, key).1);
        }
        assert!(!asked(&cache, "b").1 && asked(&cache, "c").1);
        assert_eq!(cache.counts(), CacheCounts { found: 1, kept: 2, damaged: 0, not_kept: 2 });
        // Another run counts what is there.
        assert!(asked(&Cache::bounded(folder.path(), 2 * one), "d").1);
        assert!(!folder.path().join(CACHE).join("d").exists());
    }

    #[test]
    fn another_network_another_size_and_another_image_are_others() {
        let pixels = [[1, 2, 3], [4, 5, 6]];
        let of = |network: &str, size, pixels: &[[u8; 3]]| key(network, "Unit", size, pixels);
        let keys = [
            of("n", (2, 1), &pixels),
            of("m", (2, 1), &pixels),
            of("n", (1, 2), &pixels),
            of("n", (2, 1), &[[1, 2, 3], [4, 5, 7]]),
            key("n", "Bytes", (2, 1), &pixels),
        ];
        for (i, a) in keys.iter().enumerate() {
            assert!(a.len() == DIGITS && keys.iter().skip(i + 1).all(|b| a != b));
        }
    }
}
