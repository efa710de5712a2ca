"""What others do with an underwater image: CLAHE, Reinhard's transfer, and the fusion of Ancuti et al., written with OpenCV.

enhancement_rivals.py RAW REFERENCE OUT: for each image of RAW an OUT/clahe/STEM.png, an OUT/reinhard/STEM.png and an
OUT/fusion/STEM.png.
"""

import pathlib
import sys

import cv2
import numpy as np


def clahe(image):
    """Contrast-limited histogram equalisation of lightness, the defaults of OpenCV but for the clip limit."""
    lab = cv2.cvtColor(image, cv2.COLOR_BGR2LAB)
    lab[..., 0] = cv2.createCLAHE(clipLimit=2.0, tileGridSize=(8, 8)).apply(lab[..., 0])
    return cv2.cvtColor(lab, cv2.COLOR_LAB2BGR)


def palette(image):
    """Mean and deviation of each channel of Lab."""
    lab = cv2.cvtColor(image.astype(np.float32) / 255, cv2.COLOR_BGR2LAB)
    return np.stack([lab.mean((0, 1)), lab.std((0, 1))])


def reinhard(image, target):
    """E. Reinhard et al., "Color Transfer between Images" (IEEE CG&A, 2001), to a mean and a deviation in Lab."""
    lab = cv2.cvtColor(image.astype(np.float32) / 255, cv2.COLOR_BGR2LAB)
    mean, deviation = palette(image)
    moved = (lab - mean) / np.maximum(deviation, 1e-3) * target[1] + target[0]
    made = cv2.cvtColor(moved.astype(np.float32), cv2.COLOR_LAB2BGR)
    return np.clip(made * 255 + 0.5, 0, 255).astype(np.uint8)


def balanced(image):
    """Red made up from green, then each channel from its .5 % to its 99.5 % percentile."""
    u = image.astype(np.float32) / 255
    mean = u.mean((0, 1))
    u[..., 2] += np.clip(mean[1] - mean[2], 0, 1) * (1 - u[..., 2]) * u[..., 1]
    low, high = np.percentile(u, [0.5, 99.5], axis=(0, 1)).astype(np.float32)
    return np.clip((u - low) / np.maximum(high - low, 1e-3), 0, 1)


def weights(x):
    """Laplacian contrast, saliency and saturation."""
    grey = cv2.cvtColor(x, cv2.COLOR_BGR2GRAY)
    contrast = np.abs(cv2.Laplacian(grey, cv2.CV_32F))
    lab = cv2.cvtColor(x, cv2.COLOR_BGR2LAB)
    blurred = cv2.GaussianBlur(lab, (5, 5), 0)
    saliency = np.linalg.norm(blurred - lab.mean((0, 1)), axis=2)
    saturation = np.sqrt(((x - grey[..., None]) ** 2).mean(2))
    return contrast + saliency / max(float(saliency.max()), 1e-6) + saturation


def fusion(image):
    """C. O. Ancuti et al., "Color Balance and Fusion for Underwater Image Enhancement" (IEEE TIP, 2018)."""
    white = balanced(image)
    sharp = np.clip(2 * white - cv2.GaussianBlur(white, (0, 0), 3), 0, 1)
    inputs = [white**1.2, sharp]
    weight = np.stack([weights(x) for x in inputs]) + 0.1
    weight /= weight.sum(0)
    levels = max(1, int(np.log2(min(image.shape[:2]))) - 3)
    result = None
    for x, w in zip(inputs, weight):
        gauss, laplace = [w], []
        for _ in range(levels):
            down = cv2.pyrDown(x)
            laplace.append(x - cv2.pyrUp(down, dstsize=x.shape[1::-1]))
            x = down
            gauss.append(cv2.pyrDown(gauss[-1]))
        laplace.append(x)
        mixed = [layer * g[..., None] for layer, g in zip(laplace, gauss)]
        result = mixed if result is None else [a + b for a, b in zip(result, mixed)]
    made = result[-1]
    for layer in result[-2::-1]:
        made = cv2.pyrUp(made, dstsize=layer.shape[1::-1]) + layer
    return np.clip(made * 255 + 0.5, 0, 255).astype(np.uint8)


def main():
    raw, reference, out = map(pathlib.Path, sys.argv[1:])
    palettes = {path.stem: palette(cv2.imread(str(path))) for path in sorted(reference.iterdir())}

    def others(stem):
        """What the references look like on average, the image's own left out."""
        return np.mean([found for other, found in palettes.items() if other != stem], axis=0)

    rivals = {
        "clahe": lambda image, _: clahe(image),
        "reinhard": lambda image, stem: reinhard(image, others(stem)),
        "fusion": lambda image, _: fusion(image),
    }
    for name, rival in rivals.items():
        folder = out / name
        folder.mkdir(parents=True, exist_ok=True)
        for path in sorted(raw.iterdir()):
            cv2.imwrite(str(folder / f"{path.stem}.png"), rival(cv2.imread(str(path)), path.stem))


main()
