#![no_main]

use aquafuse_data::{hush_decoders, targets};

libfuzzer_sys::fuzz_target!(
    // A decoder's panic is caught and becomes an error: only what gets past that is a fault.
    init: hush_decoders(),
    |bytes: &[u8]| (targets::PNG.run)(bytes)
);
