#![no_main]

use aquafuse_scene::targets::named;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (named("scene-colmap-text").expect("it is in the list").run)(bytes));
