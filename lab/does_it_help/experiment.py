"""Does it help? A small segmenter is trained on truth scenes in two waters, and tested in a water it has not seen.

    python experiment.py SCENES WORK [--waters N] [--steps N] [--until HH:MM] [--table]

SCENES is the built example `labelled_scenes`, WORK a folder to fill. Each finished run is a line of WORK/runs.jsonl, so that
a stopped experiment goes on; whole waters come first. It prints a table in Markdown of the waters for which a way has runs;
`--table` alone trains nothing.
"""

import argparse
import datetime
import json
import pathlib
import shutil
import subprocess
import sys
import time

import cv2
import network
import numpy as np
import table
import ways

KINDS = ("lit", "as-is")
LARGE = (144, 120)
TRAINED, TESTED, REFERENCES, BATCH = range(200), range(1000, 1080), range(5000, 5003), 8


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes")
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--waters", type=int, default=25)
    parser.add_argument("--steps", type=int, default=500)
    parser.add_argument("--until", help="begin no run after this time of day, as 06:30")
    parser.add_argument("--table", action="store_true", help="print the table of what is there")
    return parser.parse_args()


class Scenes:
    """Scenes in waters by number."""

    def __init__(self, given):
        self.given, self.known = given, {}

    def folder(self, kind, water):
        all_of_them = self.given.work / f"scenes-{self.given.waters}"
        if not all_of_them.exists():
            part = all_of_them.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            ranges = [f"{some.start}-{some.stop - 1}" for some in (TRAINED, TESTED, REFERENCES)]
            command = [self.given.scenes, part, str(self.given.waters), *map(str, LARGE), *ranges]
            turbid = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
            (part / "turbid.txt").write_text(turbid)
            part.rename(all_of_them)
        return all_of_them / f"{kind}-{water:02}"

    def is_turbid(self, water):
        return str(water) in (self.folder("lit", water).parent / "turbid.txt").read_text().split()

    def of(self, kind, water):
        """Large images and small labels by seed; those of two waters more than needed now are forgotten."""
        if (kind, water) not in self.known:
            while len(self.known) >= 3:
                self.known.pop(next(iter(self.known)))
            found = {}
            for path in sorted((self.folder(kind, water) / "images").iterdir()):
                mask = cv2.imread(str(path.parent.parent / "masks" / f"{path.stem}.png"), cv2.IMREAD_GRAYSCALE)
                image = cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB)
                label = cv2.resize(mask, ways.SMALL, interpolation=cv2.INTER_NEAREST)
                found[int(path.stem)] = image, label.astype(np.int32)
            self.known[kind, water] = found
        return self.known[kind, water]

    def references(self, kind, water):
        images = (self.folder(kind, water) / "images").iterdir()
        return sorted(str(path) for path in images if int(path.stem) in REFERENCES)


def tested(scenes, seeds):
    """Images and labels as they are, small."""
    images, labels = zip(*(scenes[seed] for seed in seeds))
    return np.stack([ways.small(image) for image in images]), np.stack(labels)


def batches(images, change, seed):
    """Batches without end: any image, changed, mirrored or not."""
    random = np.random.default_rng(seed)
    while True:
        pictures, labels = [], []
        for at in random.integers(len(images), size=BATCH):
            image, label = images[at]
            image, side = ways.small(change(image, random)), 1 if random.random() < 0.5 else -1
            pictures.append(image[:, ::side])
            labels.append(label[:, ::side])
        yield np.stack(pictures), np.stack(labels)


def run(given, scenes, kind, water, way):
    """Trains in two other waters, and tests in the water and at home."""
    home = [water] * 2 if way == ways.CEILING else [(water + step) % given.waters for step in (1, 2)]
    images = [scenes.of(kind, home[seed % 2])[seed] for seed in TRAINED]
    change = ways.of(way, water, scenes.references(kind, water))
    found = network.trained(batches(images, change, water), given.steps, water)
    of_home = [scenes.of(kind, home[seed % 2])[seed] for seed in TESTED]
    own = np.stack([ways.small(image) for image, _ in of_home]), np.stack([label for _, label in of_home])
    return network.mean_iou(found, *tested(scenes.of(kind, water), TESTED)), network.mean_iou(found, *own)


def main():
    given = arguments()
    given.work.mkdir(parents=True, exist_ok=True)
    path, scenes = given.work / "runs.jsonl", Scenes(given)
    lines = path.read_text().splitlines(keepends=True) if path.exists() else []
    # A line without its end was being written when the process was stopped.
    runs = [json.loads(line) for line in lines if line.endswith("\n")]
    path.write_text("".join(line for line in lines if line.endswith("\n")))
    runs = [one for one in runs if one["steps"] == given.steps]
    done = {(one["kind"], one["water"], one["way"]) for one in runs}
    left = [(kind, water, way) for water in range(given.waters) for kind in KINDS for way in ways.WAYS]
    for kind, water, way in [] if given.table else [one for one in left if one not in done]:
        if given.until and datetime.datetime.now().strftime("%H:%M") >= given.until:
            break
        began = time.process_time()
        away, home = run(given, scenes, kind, water, way)
        one = {"kind": kind, "water": water, "turbid": scenes.is_turbid(water), "way": way, "steps": given.steps}
        one |= {"away": round(away, 4), "home": round(home, 4), "seconds": round(time.process_time() - began, 1)}
        runs.append(one)
        with path.open("a") as file:
            file.write(json.dumps(one) + "\n")
        print(f"{kind}, water {water}, {way}: {away:.3f}, at home {home:.3f}", file=sys.stderr, flush=True)
    print(table.of(runs, given.steps, given.waters, BATCH, len(TRAINED)))


if __name__ == "__main__":
    main()
