"""A dataset multiplied on the machines of a Ray cluster: one part a task, tried again where a machine fails.

    python ray_augment.py DATASET OUTPUT [PARTS]

Needs ray, opencv-python-headless, and aquafuse. It is not on PyPI yet; docs/python.md says how to build it.
DATASET and OUTPUT lie on storage that all machines share. The files equal those of a run on one machine.
"""

import sys
import tempfile
from pathlib import Path

import aquafuse
import cv2
import ray

WATERS = ["presets"]
SETTINGS = {"per_image": 2, "theta_range": (0.0, 60.0), "seed": 7, "progress": False}


# A task that is tried again continues what the one before it left.
@ray.remote(num_cpus=1, max_retries=-1, retry_exceptions=True)
def part(number: int, parts: int, dataset: str, output: str) -> tuple[int, list[str]]:
    """One part of the dataset, into the output that all parts share."""
    summary = aquafuse.augment(dataset, WATERS, output, shard=(number, parts), threads=1, **SETTINGS)
    return summary.done + summary.skipped, summary.failures


def synthetic(folder: Path) -> Path:
    """Twelve images, to try it."""
    folder.mkdir()
    for number in range(12):
        cv2.imwrite(str(folder / f"{number}.png"), aquafuse.example.reef(96, 128 + number)[..., ::-1])
    return folder


if __name__ == "__main__":
    base = Path(tempfile.mkdtemp())
    dataset = sys.argv[1] if len(sys.argv) > 1 else str(synthetic(base / "reef"))
    output = sys.argv[2] if len(sys.argv) > 2 else str(base / "more")
    parts = int(sys.argv[3]) if len(sys.argv) > 3 else 4
    ray.init()
    made = ray.get([part.remote(number, parts, dataset, output) for number in range(1, parts + 1)])
    for _, failures in made:
        print(*failures, sep="\n", end="")
    # Without a part, the run joins what the parts have listed.
    whole = aquafuse.augment(dataset, WATERS, output, **SETTINGS)
    print(f"{sum(count for count, _ in made)} images in {parts} parts, joined in {output}: {whole}")
