#![no_main]

use aquafuse_scene::targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (targets::SCENE_SPZ.run)(bytes));
