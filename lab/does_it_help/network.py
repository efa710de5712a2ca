"""A small segmenter and its training, on one core."""

import math

import numpy as np
import torch
from torch import nn

CLASSES = 6
WIDTHS = (8, 16, 32)
GROUPS = 4
RATE = 3e-3


class Block(nn.Sequential):
    """Two convolutions, each with group normalisation and ReLU."""

    def __init__(self, into, out):
        def layers(into):
            return nn.Conv2d(into, out, 3, padding=1), nn.GroupNorm(GROUPS, out), nn.ReLU(inplace=True)

        super().__init__(*layers(into), *layers(out))


class Network(nn.Module):
    """A U-Net of three levels."""

    def __init__(self):
        super().__init__()
        self.down = nn.ModuleList(Block(into, out) for into, out in zip((3, *WIDTHS), WIDTHS))
        pairs = list(zip(WIDTHS[1:], WIDTHS[:-1]))
        self.up = nn.ModuleList(Block(below + own, own) for below, own in reversed(pairs))
        self.last = nn.Conv2d(WIDTHS[0], CLASSES, 1)

    def forward(self, pictures):
        x, kept = 2 * pictures - 1, []
        for level, block in enumerate(self.down):
            x = block(x if level == 0 else nn.functional.avg_pool2d(x, 2))
            kept.append(x)
        for block, own in zip(self.up, reversed(kept[:-1])):
            x = block(torch.cat([nn.functional.interpolate(x, scale_factor=2), own], 1))
        return self.last(x)


def tensor(pictures):
    """Images as bytes, as the network takes them."""
    return torch.from_numpy(np.ascontiguousarray(pictures)).permute(0, 3, 1, 2).float().div_(255).contiguous(
        memory_format=torch.channels_last
    )


def trained(batches, steps, seed):
    """A network after `steps` batches of images (bytes) and labels."""
    torch.set_num_threads(1)
    torch.manual_seed(seed)
    network = Network().to(memory_format=torch.channels_last)
    optimiser = torch.optim.Adam(network.parameters(), lr=RATE, betas=(0.9, 0.99))
    for count in range(1, steps + 1):
        pictures, labels = next(batches)
        for group in optimiser.param_groups:
            group["lr"] = RATE * 0.5 * (1 + math.cos(math.pi * count / steps))
        optimiser.zero_grad(set_to_none=True)
        likelihoods = network(tensor(pictures))
        nn.functional.cross_entropy(likelihoods, torch.from_numpy(np.ascontiguousarray(labels)).long()).backward()
        optimiser.step()
    return network


@torch.no_grad()
def mean_iou(network, pictures, labels):
    """Intersection over union of each class that is there, and their mean."""
    found = [network(tensor(part)).argmax(1).numpy() for part in np.array_split(pictures, 8)]
    pairs = np.bincount((CLASSES * labels + np.concatenate(found)).ravel(), minlength=CLASSES**2)
    pairs = pairs.reshape(CLASSES, CLASSES)
    both = np.diag(pairs)
    either = pairs.sum(0) + pairs.sum(1) - both
    there = pairs.sum(1) > 0
    return float((both[there] / either[there]).mean())
