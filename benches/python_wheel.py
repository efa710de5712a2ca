#!/usr/bin/env python3
"""Median milliseconds of the Python package and of other augmentations, on one thread.

    python python_wheel.py CONTENT.ppm REFERENCE.ppm --frames N

Lines of a name and a number. `two-threads` is how many times as many images two threads of Python make as one does. With
torchvision installed its ColorJitter is measured too.
"""

import argparse
import importlib.util
import os
import statistics
import time
from concurrent.futures import ThreadPoolExecutor

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[threads] = "1"
os.environ["NO_ALBUMENTATIONS_UPDATE"] = "1"

import albumentations
import cv2

import aquafuse
from aquafuse.albumentations import WaterFusion

cv2.setNumThreads(1)
aquafuse.set_threads(1)


def cases(content, reference):
    fuser = aquafuse.Fuser(aquafuse.Water.from_image(reference))
    transforms = {
        "transform": WaterFusion(waters=(given.reference_png,), p=1),
        "color-jitter": albumentations.ColorJitter(p=1),
        "random-fog": albumentations.RandomFog(p=1),
    }
    runs = {"fuse": lambda: fuser.fuse(content)}
    for name, transform in transforms.items():
        runs[name] = lambda transform=transform: transform(image=content)
    if importlib.util.find_spec("torchvision") is not None:
        import torch
        from torchvision.transforms import v2

        torch.set_num_threads(1)
        jitter = v2.ColorJitter(0.2, 0.2, 0.2, 0.2)
        tensor = torch.from_numpy(content).permute(2, 0, 1).contiguous()
        runs["torchvision-jitter"] = lambda: jitter(tensor)
    return runs, fuser


def spent(run, times):
    began = time.perf_counter()
    for _ in range(times):
        run()
    return time.perf_counter() - began


def main():
    read = [cv2.cvtColor(cv2.imread(name), cv2.COLOR_BGR2RGB) for name in (given.content, given.reference)]
    given.reference_png = given.reference.replace(".ppm", ".png")
    cv2.imwrite(given.reference_png, read[1][..., ::-1])
    runs, fuser = cases(*read)
    for name, run in runs.items():
        run()
        # What takes half a second a turn is known well enough after three.
        frames = 3 if name == "random-fog" else given.frames
        print(f"{name} {statistics.median(1e3 * spent(run, 1) for _ in range(frames)):.3f}")
    one = lambda: fuser.fuse(read[0])
    alone = spent(one, 2 * given.frames)
    with ThreadPoolExecutor(2) as pool:
        began = time.perf_counter()
        for done in [pool.submit(spent, one, given.frames) for _ in range(2)]:
            done.result()
        together = time.perf_counter() - began
    print(f"two-threads {alone / together:.3f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("content")
    parser.add_argument("reference")
    parser.add_argument("--frames", type=int, default=5)
    given = parser.parse_args()
    main()
