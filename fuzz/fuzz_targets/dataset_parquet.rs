#![no_main]

use aquafuse_data::{hush_decoders, targets::named};

libfuzzer_sys::fuzz_target!(
    // A decoder's panic is caught and becomes an error: only what gets past that is a fault.
    init: hush_decoders(),
    |bytes: &[u8]| (named("dataset-parquet").expect("it is in the list").run)(bytes)
);
