#![no_main]

use aquafuse_data::targets::named;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (named("depth-png").expect("it is in the list").run)(bytes));
