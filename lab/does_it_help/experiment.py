"""Does it help? A small segmenter is trained on truth scenes in two waters, and tested in a water it has not seen.

    python experiment.py SCENES AQUAFUSE WORK [--seeds N] [--steps N]

SCENES is the built example `labelled_scenes`, AQUAFUSE the command, WORK a folder to fill. It prints a table in Markdown:
the mean intersection over union in the water not seen, for every way to multiply the images of training; every way
trains for as many steps.
"""

import argparse
import pathlib
import shutil
import subprocess
import sys

import albumentations
import cv2
import numpy as np
import network

WATERS = ["blue", "green", "turbid", "clear", "deep"]
# Images are made and multiplied large, and learned small.
LARGE, SMALL = (144, 120), (48, 40)
TRAINED, TESTED, BATCH, PER_IMAGE = 200, 80, 8, 3
PRESETS = [f"preset:jerlov-{kind}" for kind in ("I", "IA", "IB", "II", "III", "1C", "3C", "5C", "7C", "9C")]
# By what the images are multiplied: the model, whether by the presets or by images of the new water, and colours.
WAYS = {
    "none": (None, False, False),
    "ColorJitter": (None, False, True),
    "`aquafuse`, 3 unlabelled images": ("aquafuse", False, False),
    "`physical`, 3 unlabelled images": ("physical", False, False),
    "`physical`, presets": ("physical", True, False),
    "`physical`, presets, and ColorJitter": ("physical", True, True),
}
RESAMPLINGS = 10_000


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes")
    parser.add_argument("aquafuse")
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--steps", type=int, default=500)
    return parser.parse_args()


def loaded(folder):
    """Images and labels of a dataset, small."""
    pictures, labels = [], []
    for path in sorted((folder / "images").iterdir()):
        picture = cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB)
        mask = cv2.imread(str(folder / "masks" / path.name), cv2.IMREAD_GRAYSCALE)
        pictures.append(cv2.resize(picture, SMALL, interpolation=cv2.INTER_AREA))
        labels.append(cv2.resize(mask, SMALL, interpolation=cv2.INTER_NEAREST))
    return np.stack(pictures), np.stack(labels).astype(np.int32)


class Data:
    """What is trained on and tested with when one of the waters is held out."""

    def __init__(self, given, held_out):
        at = WATERS.index(held_out)
        seen = [WATERS[(at + step) % len(WATERS)] for step in (1, 2)]
        work = given.work / held_out
        train, home = (self.of_both(given.work / kind, seen, work / kind) for kind in ("train", "test"))
        self.test, self.home = loaded(given.work / "test" / held_out), loaded(home)
        # Images of the new water without labels, of places that are not tested.
        unlabelled = given.work / "unlabelled" / held_out / "images"
        self.train = {}
        for model, presets, _ in WAYS.values():
            if model is None:
                self.train[model, presets] = loaded(train)
            elif (model, presets) not in self.train:
                waters, output = (PRESETS, f"{model}-presets") if presets else ([unlabelled], model)
                self.train[model, presets] = self.multiplied(given.aquafuse, train, model, waters, work / output)

    @staticmethod
    def of_both(scenes, waters, folder):
        """A dataset of all scenes, one in the first water, the next in the other."""
        for kind in ("images", "masks"):
            (folder / kind).mkdir(parents=True, exist_ok=True)
            for number, path in enumerate(sorted((scenes / waters[0] / kind).iterdir())):
                shutil.copy(scenes / waters[number % 2] / kind / path.name, folder / kind)
        return folder

    @staticmethod
    def multiplied(aquafuse, data, model, waters, output):
        command = [aquafuse, "augment", data, *waters, "-o", output, "--model", model, "--keep-originals", "--quiet"]
        subprocess.run([*command, "--per-image", str(PER_IMAGE)], check=True)
        return loaded(output)


def batches(data, seed, jitter):
    """Batches without end: any image, turned round or not."""
    random = np.random.default_rng(seed)
    pictures, labels = data
    colours = albumentations.ColorJitter(brightness=0.4, contrast=0.4, saturation=0.4, hue=0.1, p=1.0)
    change = albumentations.Compose([colours], seed=seed) if jitter else None
    while True:
        chosen = random.integers(len(pictures), size=BATCH)
        some, named = pictures[chosen], labels[chosen]
        if change:
            some = np.stack([change(image=picture)["image"] for picture in some])
        flip = random.random(BATCH) < 0.5
        some = np.where(flip[:, None, None, None], some[:, :, ::-1], some)
        yield some, np.where(flip[:, None, None], named[:, :, ::-1], named)


def interval(values):
    """The middle 95 % of means of resampled values."""
    random = np.random.default_rng(0)
    means = random.choice(values, (RESAMPLINGS, len(values))).mean(1)
    return np.quantile(means, [0.025, 0.975])


def main():
    given = arguments()
    for name, first, count in (("train", 0, TRAINED), ("test", 1000, TESTED), ("unlabelled", 5000, 3)):
        if not (given.work / name).exists():
            part = given.work / f"{name}.part"
            subprocess.run([given.scenes, part, str(first), str(count), *map(str, LARGE)], check=True)
            part.rename(given.work / name)
    scores = Scores(given.work / "scores.tsv")
    for water in WATERS:
        data = None
        for seed in range(given.seeds):
            for way, (model, presets, jitter) in WAYS.items():
                if scores.has(water, seed, way, given.steps):
                    continue
                data = data or Data(given, water)
                start = batches(data.train[model, presets], seed, jitter)
                layers = network.trained(start, given.steps, seed)
                away, home = network.mean_iou(layers, *data.test), network.mean_iou(layers, *data.home)
                scores.add(water, seed, way, given.steps, away, home)
    print(table(given, scores))


class Scores:
    """What was measured so far, kept in a file: a run that was stopped goes on."""

    def __init__(self, path):
        self.path, self.found = path, {}
        if path.exists():
            for line in path.read_text().splitlines():
                water, seed, way, steps, away, home = line.split("\t")
                self.found[water, int(seed), way, int(steps)] = float(away), float(home)

    def has(self, *key):
        return key in self.found

    def add(self, water, seed, way, steps, away, home):
        self.found[water, seed, way, steps] = away, home
        with self.path.open("a") as file:
            file.write(f"{water}\t{seed}\t{way}\t{steps}\t{away:.4f}\t{home:.4f}\n")
        print(f"{water}, seed {seed}, {way}: {away:.3f}, at home {home:.3f}", file=sys.stderr, flush=True)

    def of(self, given, way, water):
        """Away and at home, seed by seed."""
        return np.array([self.found[water, seed, way, given.steps] for seed in range(given.seeds)])


def table(given, scores):
    lines = [
        f"Mean intersection over union of {network.CLASSES} classes in the water not seen; {TRAINED} pictures in two other waters, "
        f"{given.steps} steps of {BATCH} pictures; means of {given.seeds} seeds; the last two columns are over all waters and seeds.",
        "",
        "| multiplied by | " + " | ".join(WATERS) + " | beside none, 95 % of resampled means | in the waters of training |",
        "|---" * (len(WATERS) + 3) + "|",
    ]
    everywhere = {way: np.concatenate([scores.of(given, way, water) for water in WATERS]) for way in WAYS}
    for way in WAYS:
        means = [f"{scores.of(given, way, water)[:, 0].mean():.3f}" for water in WATERS]
        gain = everywhere[way][:, 0] - everywhere["none"][:, 0]
        low, high = interval(gain)
        said = "" if way == "none" else f"{gain.mean():+.3f} ({low:+.3f} to {high:+.3f})"
        lines.append(f"| {way} | " + " | ".join(means) + f" | {said} | {everywhere[way][:, 1].mean():.3f} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
