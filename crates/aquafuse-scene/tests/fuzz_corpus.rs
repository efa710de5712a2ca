//! Every parser of a scene on the stored corpus, and on 10,000 files made of it by chance: nothing panics.
//!
//! `cargo lab soak` goes on from here with a fuzzer that looks at the code it reaches.

use std::path::Path;

use aquafuse_data::targets::replay;
use aquafuse_scene::targets::ALL;

#[test]
fn every_parser_bears_the_corpus_and_what_chance_makes_of_it() {
    replay(&ALL, Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus")));
}
