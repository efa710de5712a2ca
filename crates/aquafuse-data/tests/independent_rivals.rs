//! Transfer of colours against scikit-image and NumPy.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::process::Command;

use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::evaluate::{Palette, Rival};
use aquafuse_data::image_file::{ImageFile, WriteOptions};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/independent_rivals.py");

#[test]
fn transfer_of_colours_is_that_of_others() {
    let Some(python) = std::env::var_os("AQUAFUSE_PYTHON") else {
        println!(
            "skipped: AQUAFUSE_PYTHON names no Python with scikit-image; `cargo xtask test` sets one up"
        );
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [content, reference] = [(1, 0, "content"), (2, 1, "reference")].map(|(seed, water, name)| {
        let scene = Scene::new(seed, Size { width: 96, height: 64 });
        let image = scene.seen_through(&waters()[water].water).convert::<u8>();
        ImageFile::new(image.clone())
            .write(&folder.path().join(format!("{name}.png")), &WriteOptions::default())
            .unwrap();
        image
    });
    let (own, other) = (Palette::of(&content), Palette::of(&reference));
    for (rival, name) in [
        (Rival::Histogram, "histogram"),
        (Rival::MongeKantorovich, "monge_kantorovich"),
        (Rival::Reinhard, "reinhard"),
        (Rival::GrayWorld, "gray_world"),
    ] {
        let made = rival.transfer(&content, &own, &other);
        let bytes: Vec<u8> = made.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
        std::fs::write(folder.path().join(format!("{name}.f32")), bytes).unwrap();
    }
    let ended = Command::new(python).arg(SCRIPT).arg(folder.path()).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
}
