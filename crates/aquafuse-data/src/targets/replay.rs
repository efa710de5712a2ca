//! Targets on a stored corpus, and on files made of it by chance.

#![allow(
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    reason = "a test in all but name: what it cannot set up should fail loudly"
)]

use std::path::Path;

use super::Target;

/// Files that are made of the corpus of each target.
const EXECUTIONS: usize = 10_000;

/// Feeds each target all files of its folder in `corpus`, and 10,000 made of them, the same ones in every run.
///
/// # Panics
///
/// When a target has no corpus, or breaks a promise.
pub fn replay(targets: &[Target], corpus: &Path) {
    crate::files::silence_decoder_panics();
    std::thread::scope(|scope| {
        for target in targets {
            scope.spawn(move || {
                let corpus = files(&corpus.join(target.name));
                assert!(!corpus.is_empty(), "no corpus for {}", target.name);
                corpus.iter().for_each(|bytes| (target.run)(bytes));
                let mut chance = Chance(1);
                for _ in 0..EXECUTIONS {
                    (target.run)(&mutated(&corpus, &mut chance));
                }
            });
        }
    });
}

fn files(folder: &Path) -> Vec<Vec<u8>> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files.into_iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// A generator whose numbers are the same everywhere.
struct Chance(u64);

impl Chance {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % most.max(1)
    }
}

/// One file of the corpus, changed in a few places; the numbers that parsers trip over come up often.
fn mutated(corpus: &[Vec<u8>], chance: &mut Chance) -> Vec<u8> {
    let mut bytes = corpus[chance.below(corpus.len())].clone();
    for _ in 0..1 + chance.below(4) {
        let at = chance.below(bytes.len());
        match chance.below(6) {
            _ if bytes.is_empty() => bytes.push(chance.below(256) as u8),
            0 => bytes[at] ^= 1 << chance.below(8),
            1 => bytes[at] = chance.below(256) as u8,
            2 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][chance.below(5)],
            3 => bytes.truncate(at),
            4 => {
                let other = &corpus[chance.below(corpus.len())];
                let from = chance.below(other.len());
                bytes.truncate(at);
                bytes.extend(&other[from.min(other.len())..]);
            }
            _ => {
                let end = (at + 1 + chance.below(16)).min(bytes.len());
                bytes.drain(at..end);
            }
        }
    }
    bytes
}
