#![no_main]

use aquafuse_data::targets;
use aquafuse_data::files::silence_decoder_panics;

libfuzzer_sys::fuzz_target!(
    // A decoder's panic is caught and becomes an error: only what gets past that is a fault.
    init: silence_decoder_panics(),
    |bytes: &[u8]| (targets::DEPTH_NETWORK.run)(bytes)
);
