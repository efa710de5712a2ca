"""Writes the weights in whole numbers of 8 bits, and a fixture that another program must compute again.

    export.py FOLDER BEST WEIGHTS FIXTURE

Each convolution has a scale for each channel of its result, then its weights in steps of that; normalisations and biases are floats of
32 bits. The order is that in which the network computes.
"""

import hashlib
import sys
from pathlib import Path

import numpy as np
import torch

import waters
from network import Layer, Network
from train import HELD_SEED, Places

MARK = b"aquafuse network 1\n"
FIXTURE = (96, 64)


def in_order(network):
    """The convolutions, and their normalisations where they have one."""
    yield network.stem
    for block in network.down:
        yield from block
    yield from network.narrow
    yield from network.up
    yield network.head


@torch.no_grad()
def written(network):
    """The bytes of the file; the network's own weights become what they say."""
    parts = [MARK]
    for part in in_order(network):
        conv = part.conv if isinstance(part, Layer) else part
        flat = conv.weight.flatten(1)
        scale = (flat.abs().amax(1) / 127).clamp(min=1e-12)
        steps = torch.round(flat / scale[:, None]).clamp(-127, 127)
        conv.weight.copy_((steps * scale[:, None]).view_as(conv.weight))
        parts += [scale.numpy().astype("<f4").tobytes(), steps.numpy().astype(np.int8).tobytes()]
        if isinstance(part, Layer):
            parts += [p.numpy().astype("<f4").tobytes() for p in (part.norm.weight, part.norm.bias)]
    parts.append(network.head.bias.numpy().astype("<f4").tobytes())
    return b"".join(parts)


@torch.no_grad()
def main(folder, best, weights, fixture):
    network = Network()
    network.load_state_dict(torch.load(best, weights_only=True))
    network.eval()
    data = written(network)
    Path(weights).write_bytes(data)
    folder = Path(folder)
    table = torch.from_numpy(np.fromfile(folder / "waters.bin", "<f4").reshape(-1, 12).copy())
    waters.SHAPES = (FIXTURE,)
    image = waters.batch(Places(folder.glob("held-*.bin")), table, HELD_SEED + 1000, 1)[0]
    pixels = (image[0].permute(1, 2, 0) * 255).round().numpy().astype(np.uint8)
    Path(fixture).write_bytes(pixels.tobytes() + network(image)[0].numpy().astype("<f4").tobytes())
    print(f"{len(data)} bytes, sha256 {hashlib.sha256(data).hexdigest()}")


if __name__ == "__main__":
    main(*sys.argv[1:])
