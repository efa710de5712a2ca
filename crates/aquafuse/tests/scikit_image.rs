//! Scores against scikit-image, on pictures of truth scenes.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::process::Command;

use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim};
use aquafuse::truth::{Scene, Size, waters};

/// Prints PSNR and SSIM of two files of 8-bit RGB, by the settings of the publication.
const SCRIPT: &str = "
import sys, numpy as np
from skimage.metrics import peak_signal_noise_ratio, structural_similarity
a, b = (np.fromfile(name, np.uint8).reshape(int(sys.argv[3]), -1, 3) / 255 for name in sys.argv[1:3])
luma = lambda image: image @ np.array([.299, .587, .114])
print(peak_signal_noise_ratio(a, b, data_range=1))
print(structural_similarity(luma(a), luma(b), data_range=1, gaussian_weights=True, sigma=1.5, use_sample_covariance=False))
";

#[test]
fn psnr_and_ssim_equal_those_of_scikit_image() {
    let Some(python) = std::env::var_os("AQUAFUSE_PYTHON") else {
        eprintln!(
            "skipped: AQUAFUSE_PYTHON names no Python with scikit-image; `cargo xtask test` sets one up"
        );
        return;
    };
    let folder = std::env::temp_dir().join(format!("aquafuse-scores-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let scene = Scene::new(1, Size { width: 97, height: 61 });
    let [blue, green, turbid, ..] = waters().map(|named| scene.seen_through(&named.water).to_samples::<u8>());
    for (a, b) in [(&blue, &green), (&green, &turbid), (&blue, &scene.clear.to_samples())] {
        let write = |name: &str, image: &Image<u8>| {
            let path = folder.join(name);
            std::fs::write(&path, image.as_raw()).unwrap();
            path
        };
        let files = [write("a", a), write("b", b)];
        let ended = Command::new(&python).args(["-c", SCRIPT]).args(files).arg("61").output().unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
        let printed = String::from_utf8(ended.stdout).unwrap();
        let theirs: Vec<f64> = printed.lines().map(|line| line.parse().unwrap()).collect();
        assert!((psnr(a, b).unwrap() - theirs[0]).abs() < 1e-5, "PSNR is {}", theirs[0]);
        assert!((ssim(a, b).unwrap().unwrap() - theirs[1]).abs() < 1e-6, "SSIM is {}", theirs[1]);
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
