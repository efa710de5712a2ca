"""Depth from a network of your own: any callable that takes an image and gives a map.

    python depth_from_network.py [IMAGE] [OUT.png]

Needs pillow. `nearness` is called where a monocular depth network would be, for example one of torch:

    def nearness(image):
        return network(preprocess(image)).squeeze().detach()  # a tensor on the CPU, of any size

Such networks give inverse depth. A network in a file of ONNX needs no callable: `depth_model="FILE.onnx"`.
"""

import sys

import aquafuse
import numpy as np
from PIL import Image


def nearness(image: np.ndarray) -> np.ndarray:
    """No network: what is lower in the image is nearer. A small map is enough, the image refines it."""
    assert image.dtype == np.uint8
    return np.repeat(np.linspace(0.1, 1.0, 48, dtype=np.float32)[:, None], 64, axis=1)


image = np.asarray(Image.open(sys.argv[1]).convert("RGB")) if len(sys.argv) > 1 else aquafuse.example.reef(240, 320)
out = sys.argv[2] if len(sys.argv) > 2 else "with_depth.png"

depth = {"depth": nearness, "depth_kind": "inverse"}
found = aquafuse.inspect(image, **depth)
print(f"{found.verdict}: {', '.join(found.reasons_in_words) or 'nothing speaks against it'}")
fused = aquafuse.fuse(image, "preset:jerlov-3C", model="exchange", **depth)
Image.fromarray(np.hstack([image, fused, aquafuse.restore(image, **depth)])).save(out)
print(f"{out}: as it was, in coastal water, and without water")
