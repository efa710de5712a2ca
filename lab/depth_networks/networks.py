"""Exports networks of the real shapes with random weights, or runs one by ONNX Runtime.

    python networks.py export FOLDER              writes NAME.onnx for each shape
    python networks.py run FILE INPUT OUTPUT      INPUT: float32 of 3 x side x side, raw; prints ms of the processor and MiB, writes the map, raw
"""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path

import numpy as np

SIDE = 518
PATCH = 14
TURNS = 3


def export(folder: Path) -> None:
    import torch
    from shapes import DensePrediction, Several, UNet

    dynamic = {2: torch.export.Dim.DYNAMIC, 3: torch.export.Dim.DYNAMIC}
    shapes = [
        ("transformer-static", DensePrediction, "image", ["depth"], None),
        ("transformer-dynamic", DensePrediction, "pixel_values", ["predicted_depth"], dynamic),
        ("u-net", UNet, "image", ["disparity"], None),
        ("several", Several, "image", ["points", "depth", "mask"], None),
    ]
    for name, kind, given, made, sides in shapes:
        torch.manual_seed(7)
        network = kind().eval()
        rows, columns = (SIDE, SIDE) if sides is None else (28 * PATCH, 21 * PATCH)
        example = torch.randn(1, 3, rows, columns)
        torch.onnx.export(
            network,
            (example,),
            folder / f"{name}.onnx",
            input_names=[given],
            output_names=made,
            dynamic_shapes=None if sides is None else (sides,),
            dynamo=True,
            external_data=False,
            opset_version=18,
            verbose=False,
        )
        print(name, file=sys.stderr)



def run(file: str, given: str, made: str) -> None:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 3
    session = onnxruntime.InferenceSession(file, options, providers=["CPUExecutionProvider"])
    image = np.fromfile(given, np.float32).reshape(1, 3, SIDE, SIDE)
    names = [output.name for output in session.get_outputs()]
    wanted = next(name for name in ("depth", "predicted_depth", "disparity") if name in names)
    spent = []
    for _ in range(TURNS):
        began = time.process_time()
        (depth,) = session.run([wanted], {session.get_inputs()[0].name: image})
        spent.append(1e3 * (time.process_time() - began))
    depth.astype(np.float32).tofile(made)
    print(f"{sorted(spent)[TURNS // 2]:.1f} {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f}")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["export", folder]:
            export(Path(folder))
        case ["run", file, given, made]:
            run(file, given, made)
        case _:
            sys.exit(__doc__)
