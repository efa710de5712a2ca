"""An image in three waters, and what is known of its own.

    python fuse_arrays.py [IMAGE] [OUT.png]

Needs pillow.
"""

import sys

import aquafuse
import numpy as np
from PIL import Image

image = np.asarray(Image.open(sys.argv[1]).convert("RGB")) if len(sys.argv) > 1 else aquafuse.example.reef(240, 320)
out = sys.argv[2] if len(sys.argv) > 2 else "waters.png"

found = aquafuse.inspect(image)
print(f"depth and water: {found.verdict} {', '.join(found.reasons_in_words)}")
print(f"colour of open water: {found.water.colour}")

waters = ["preset:jerlov-I", "preset:jerlov-3C", "preset:jerlov-7C"]
fused = [aquafuse.fuse(image, water, theta=20) for water in waters]
Image.fromarray(np.hstack([image, *fused])).save(out)
print(f"{out}: as it was, and in {', '.join(waters)}")
