#!/usr/bin/env python3
"""Median milliseconds of what others use to give an image another look, on one thread.

    python rivals.py CONTENT.ppm REFERENCE.ppm --frames N

Colour transfer (color-matcher, scikit-image) and the augmentations nearest to water (Albumentations) know nothing
of depth; they are here for their speed alone. OpenCV's median is what depth from colour is filtered by.
"""

import argparse
import os
import statistics
import time

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[threads] = "1"
os.environ["NO_ALBUMENTATIONS_UPDATE"] = "1"

import albumentations
import cv2
import numpy as np
from color_matcher import ColorMatcher
from skimage.exposure import match_histograms

cv2.setNumThreads(1)


def matched(content, reference, method):
    result = ColorMatcher(src=content, ref=reference, method=method).main()
    return np.clip(np.round(result), 0, 255).astype(np.uint8)


def rivals(content, reference):
    jitter = albumentations.ColorJitter(p=1)
    fog = albumentations.RandomFog(p=1)
    plane = np.ascontiguousarray(content[..., 1])
    return {
        "color-matcher-mkl": lambda: matched(content, reference, "mkl"),
        "color-matcher-reinhard": lambda: matched(content, reference, "reinhard"),
        "match-histograms": lambda: match_histograms(content, reference, channel_axis=2),
        "color-jitter": lambda: jitter(image=content),
        "random-fog": lambda: fog(image=content),
        "opencv-median": lambda: cv2.medianBlur(plane, 7),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("content")
    parser.add_argument("reference")
    parser.add_argument("--frames", type=int, default=5)
    given = parser.parse_args()
    content, reference = (cv2.cvtColor(cv2.imread(name), cv2.COLOR_BGR2RGB) for name in (given.content, given.reference))
    for name, run in rivals(content, reference).items():
        run()
        spent = []
        for _ in range(given.frames):
            began = time.perf_counter()
            run()
            spent.append(1e3 * (time.perf_counter() - began))
        print(f"{name} {statistics.median(spent):.3f}")


if __name__ == "__main__":
    main()
