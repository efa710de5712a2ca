//! Scores against scikit-image and against the publications' formulas in NumPy, on images of truth scenes.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::ffi::OsString;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim, uciqe, uiqm};
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

/// Prints the parts of UCIQE and UIQM of one file of 8-bit RGB, written from the publications with the choices
/// that the documentation states; CIELab and Sobel are scikit-image's.
const QUALITY: &str = "
import sys, numpy as np
from skimage.color import rgb2lab
from skimage.filters import sobel
image = np.fromfile(sys.argv[1], np.uint8).reshape(int(sys.argv[2]), -1, 3)
lab = rgb2lab(image / 255.) / 100
chroma = np.hypot(lab[..., 1], lab[..., 2]); light = lab[..., 0]
print(chroma.std())
ordered = np.sort(light, axis=None); percent = -(-ordered.size // 100)
print(ordered[-percent] - ordered[percent - 1])
length = np.hypot(chroma, light)
print(np.where(length > 0, chroma / np.where(length > 0, length, 1), 0).mean())

levels = image.astype(float); r, g, b = np.moveaxis(levels, -1, 0)
def moments(values):
    values = np.sort(values, axis=None); n = values.size
    mean = values[int(np.ceil(.1 * n)):n - int(np.floor(.1 * n))].mean()
    return mean, ((values - mean) ** 2).mean()
(m1, v1), (m2, v2) = moments(r - g), moments((r + g) / 2 - b)
print(-.0268 * np.sqrt(m1 ** 2 + m2 ** 2) + .1586 * np.sqrt(v1 + v2))
def blocks(plane):
    h, w = (side // 10 * 10 for side in plane.shape)
    cut = plane[:h, :w].reshape(h // 10, 10, w // 10, 10)
    return cut.min((1, 3)), cut.max((1, 3))
def eme(plane):
    low, high = blocks(sobel(plane) * plane)
    ratio = np.where(low > 0, high / np.where(low > 0, low, 1), 1)
    return 2 * np.log(ratio).mean()
print(.299 * eme(r) + .587 * eme(g) + .114 * eme(b))
low, high = blocks(levels @ np.array([.299, .587, .114]))
total = high + low - high * low / 1026
m = 1026 * (high - low) / (1026 - low) / np.where(total > 0, total, 1)
print(-np.where(m > 0, m * np.log(np.where(m > 0, m, 1)), 0).mean())
";

/// The Python that has scikit-image; none, and a word about it, if there is none.
fn python() -> Option<OsString> {
    let python = std::env::var_os("AQUAFUSE_PYTHON");
    if python.is_none() {
        eprintln!(
            "skipped: AQUAFUSE_PYTHON names no Python with scikit-image; `cargo xtask test` sets one up"
        );
    }
    python
}

/// The numbers that `script` prints about these images of 61 rows.
fn scores(python: &OsString, script: &str, images: &[&Image<u8>]) -> Vec<f64> {
    let folder = new_folder();
    let write = |(i, image): (usize, &&Image<u8>)| {
        let path = folder.join(i.to_string());
        std::fs::write(&path, image.as_raw()).unwrap();
        path
    };
    let files: Vec<_> = images.iter().enumerate().map(write).collect();
    let ended = Command::new(python).args(["-c", script]).args(&files).arg("61").output().unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    let printed = String::from_utf8(ended.stdout).unwrap();
    printed.lines().map(|line| line.parse().unwrap()).collect()
}

/// A folder of this call's own: tests run at the same time.
fn new_folder() -> std::path::PathBuf {
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let call = CALLS.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("aquafuse-scores-{}-{call}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn psnr_and_ssim_equal_those_of_scikit_image() {
    let Some(python) = python() else { return };
    let scene = Scene::new(1, Size { width: 97, height: 61 });
    let [blue, green, turbid, ..] = waters().map(|named| scene.seen_through(&named.water).convert::<u8>());
    for (a, b) in [(&blue, &green), (&green, &turbid), (&blue, &scene.clear.convert())] {
        let theirs = scores(&python, SCRIPT, &[a, b]);
        assert!((psnr(a, b).unwrap() - theirs[0]).abs() < 1e-5, "PSNR is {}", theirs[0]);
        assert!((ssim(a, b).unwrap().unwrap() - theirs[1]).abs() < 1e-6, "SSIM is {}", theirs[1]);
    }
}

#[test]
fn uciqe_and_uiqm_equal_their_definitions_in_numpy() {
    let Some(python) = python() else { return };
    let scene = Scene::new(1, Size { width: 97, height: 61 });
    let seen = waters().map(|named| scene.seen_through(&named.water).convert::<u8>());
    let clear = scene.clear.convert();
    // The clear image has black open water: blocks without a logarithm, colours without saturation.
    for image in seen.iter().chain([&clear]) {
        let theirs = scores(&python, QUALITY, &[image]);
        let (colour, quality) = (uciqe(image), uiqm(image).unwrap());
        let ours = [
            colour.chroma_deviation,
            colour.luminance_contrast,
            colour.saturation,
            quality.colourfulness,
            quality.sharpness,
            quality.contrast,
        ];
        for (i, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            // Our values and the transfer function are 32-bit floats: seven digits, of numbers up to 10.
            assert!((ours - theirs).abs() < 2e-6 * theirs.abs().max(1.0), "part {i}: {ours} for {theirs}");
        }
    }
}
