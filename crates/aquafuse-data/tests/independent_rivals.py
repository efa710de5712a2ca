"""Transfer of colours by scikit-image and NumPy, compared with what the test has written beside the images."""

import sys
from pathlib import Path

import numpy as np
from PIL import Image
from skimage.exposure import match_histograms


def read(path):
    return np.asarray(Image.open(path), dtype=np.float64) / 255.0


def root(matrix):
    values, vectors = np.linalg.eigh(matrix)
    return (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T


def monge_kantorovich(content, reference):
    x, y = content.reshape(-1, 3), reference.reshape(-1, 3)
    a, b = np.cov(x.T, bias=True), np.cov(y.T, bias=True)
    half = root(a)
    inverse = np.linalg.inv(half)
    transport = inverse @ root(half @ b @ half) @ inverse
    return (x - x.mean(0)) @ transport.T + y.mean(0)


def reinhard(content, reference):
    lms = np.array([[0.3811, 0.5783, 0.0402], [0.1967, 0.7244, 0.0782], [0.0241, 0.1288, 0.8444]])
    back = np.array([[4.4679, -3.5873, 0.1193], [-1.2186, 2.3809, -0.1624], [0.0497, -0.2439, 1.2045]])
    turn = np.diag([3**-0.5, 6**-0.5, 2**-0.5]) @ np.array([[1, 1, 1], [1, 1, -2], [1, -1, 0]])

    def lab(image):
        return np.log10(np.maximum(image.reshape(-1, 3), 0.5 / 255.0) @ lms.T) @ turn.T

    x, y = lab(content), lab(reference)
    given = (x - x.mean(0)) * (y.std(0) / x.std(0)) + y.mean(0)
    return 10.0 ** (given @ np.linalg.inv(turn).T) @ back.T


def main(folder):
    content, reference = read(folder / "content.png"), read(folder / "reference.png")
    expected = {
        "histogram": match_histograms(content, reference, channel_axis=-1),
        "monge_kantorovich": monge_kantorovich(content, reference),
        "reinhard": reinhard(content, reference),
        "gray_world": content * (reference.mean((0, 1)) / content.mean((0, 1))),
    }
    for name, values in expected.items():
        ours = np.fromfile(folder / f"{name}.f32", dtype="<f4")
        most = np.abs(ours - values.reshape(-1)).max()
        # Ours are rounded to 32 bits.
        assert most < 2e-6, f"{name} differs by {most}"


main(Path(sys.argv[1]))
