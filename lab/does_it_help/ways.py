"""Ways to change the images of a batch, each drawn again for every image of every step."""

import albumentations
import cv2
import numpy as np
from aquafuse import Fuser
from albumentations import ColorJitter

# Images are made and changed large, and learned small.
SMALL = (48, 40)
# The share of images that stay as they are, as `aquafuse augment` keeps it; jitter acts on all, as in training usually.
KEPT = 0.25
STRENGTH = {"brightness": 0.4, "contrast": 0.4, "saturation": 0.4, "hue": 0.1}


def small(image):
    return cv2.resize(image, SMALL, interpolation=cv2.INTER_AREA)


class Plain:
    def __call__(self, image, random):
        return image


class Jitter:
    """ColorJitter, or one part of it."""

    def __init__(self, seed, *parts):
        strength = {part: STRENGTH[part] if not parts or part in parts else 0.0 for part in STRENGTH}
        self.change = albumentations.Compose([ColorJitter(**strength, p=1.0)], seed=seed)

    def __call__(self, image, random):
        return self.change(image=image)["image"]


class Hsv:
    """Random factors on hue, saturation and value, with the strengths that Ultralytics trains with."""

    GAINS = np.array([0.015, 0.7, 0.4])

    def __call__(self, image, random):
        factors = 1 + random.uniform(-1, 1, 3) * self.GAINS
        hue, saturation, value = cv2.split(cv2.cvtColor(image, cv2.COLOR_RGB2HSV))
        steps = np.arange(256)
        changed = (
            cv2.LUT(hue, ((steps * factors[0]) % 180).astype(np.uint8)),
            cv2.LUT(saturation, np.clip(steps * factors[1], 0, 255).astype(np.uint8)),
            cv2.LUT(value, np.clip(steps * factors[2], 0, 255).astype(np.uint8)),
        )
        return cv2.cvtColor(cv2.merge(changed), cv2.COLOR_HSV2RGB)


class Water:
    """Another water: one of some references, or a new one of the sea for each image; then perhaps jitter."""

    def __init__(self, model, references=None, then=None):
        self.model, self.then = model, then
        self.fusers = references and [Fuser(path, model=model) for path in references]

    def __call__(self, image, random):
        if random.random() >= KEPT:
            image = self.fuser(random).fuse(image)
        return self.then(image, random) if self.then else image

    def fuser(self, random):
        if self.fusers:
            return self.fusers[random.integers(len(self.fusers))]
        return Fuser(f"sea:{random.integers(2**32)}", model=self.model)


PARTS = list(STRENGTH)
# The ceiling is trained in the water that it is tested in.
CEILING = "trained in the water itself"
WATERS = {
    "`aquafuse`, 3 references": ("aquafuse", True),
    "`physical`, sea": ("physical", False),
    "`physical`, 3 references": ("physical", True),
    "`relight`, sea": ("relight", False),
    "`relight`, 3 references": ("relight", True),
}
WAYS = [
    "none",
    "ColorJitter",
    *WATERS,
    CEILING,
    *(f"{way}, and ColorJitter" for way in WATERS),
    "HSV of Ultralytics",
    *(f"ColorJitter, {part} alone" for part in PARTS),
]


def of(way, seed, references):
    """The change of a way; `references` are images of the water not seen, without labels."""
    if way in ("none", CEILING):
        return Plain()
    if way == "ColorJitter":
        return Jitter(seed)
    if way == "HSV of Ultralytics":
        return Hsv()
    for part in PARTS:
        if way == f"ColorJitter, {part} alone":
            return Jitter(seed, part)
    name, jitter, _ = way.partition(", and ColorJitter")
    model, has_references = WATERS[name]
    return Water(model, references if has_references else None, Jitter(seed) if jitter else None)
