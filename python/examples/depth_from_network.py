"""Depth from a network of your own: any callable that gives a map of the image's size.

    python depth_from_network.py [IMAGE] [OUT.png]

Needs pillow. `nearness` stands for a monocular depth network, for example
`lambda image: network(preprocess(image)).squeeze().numpy()`; such networks give inverse depth.
"""

import sys

import aquafuse
import numpy as np
from PIL import Image


def nearness(image: np.ndarray) -> np.ndarray:
    """A stand-in: what is lower in the image is nearer."""
    height, width, _ = image.shape
    return np.repeat(np.linspace(0.1, 1.0, height, dtype=np.float32)[:, None], width, axis=1)


image = np.asarray(Image.open(sys.argv[1]).convert("RGB")) if len(sys.argv) > 1 else aquafuse.example.reef(240, 320)
out = sys.argv[2] if len(sys.argv) > 2 else "with_depth.png"

depth = {"depth": nearness(image), "depth_kind": "inverse"}
found = aquafuse.inspect(image, **depth)
print(f"{found.verdict}: {', '.join(found.reasons_in_words) or 'nothing speaks against it'}")
fused = aquafuse.fuse(image, "preset:jerlov-3C", model="exchange", **depth)
Image.fromarray(np.hstack([image, fused, aquafuse.restore(image, **depth)])).save(out)
print(f"{out}: as it was, in coastal water, and without water")
