#![no_main]

use aquafuse_data::targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (targets::BAG_MESSAGE.run)(bytes));
