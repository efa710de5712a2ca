//! Every parser on the stored corpus, and on 10,000 files made of it by chance: nothing panics.
//!
//! `cargo xtask soak` goes on from here with a fuzzer that looks at the code it reaches.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::path::Path;

use aquafuse_data::targets::ALL;

const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus");
const EXECUTIONS: usize = 10_000;

fn corpus(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(CORPUS).join(name);
    let mut files: Vec<_> = std::fs::read_dir(&folder)
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

#[test]
fn every_parser_bears_the_corpus_and_what_chance_makes_of_it() {
    aquafuse_data::hush_decoders();
    std::thread::scope(|scope| {
        for target in ALL {
            scope.spawn(move || {
                let corpus = corpus(target.name);
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
