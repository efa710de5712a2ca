"""Trains the network on places in water, none of them a photograph; goes on where it was stopped.

    train.py FOLDER OUTPUT [--steps N] [--seed N] [--minutes N]

FOLDER has train-*.bin, held-*.bin and waters.bin of `places_to_learn`. OUTPUT gets the weights that are best on scenes held back.
"""

import argparse
import copy
import math
import sys
import time
from pathlib import Path

import numpy as np
import torch

import waters
from network import Network, losses

BATCH = 32
RATE = 3e-3
WARM = 100
SLOW = 0.998  # what the mean of weights keeps in a step
HELD = 10  # batches held back
EACH = 250  # steps between trials
HELD_SEED = 1 << 40


class Places:
    """Records of places: clear colours, and metres (100 is open water)."""

    def __init__(self, files):
        area = waters.WIDTH * waters.HEIGHT
        records = np.concatenate([np.fromfile(file, np.uint8).reshape(-1, 5 * area) for file in sorted(files)])
        shape = (len(records), waters.HEIGHT, waters.WIDTH)
        self.colours = np.ascontiguousarray(records[:, : 3 * area]).reshape(*shape, 3)
        self.centimetres = np.ascontiguousarray(records[:, 3 * area :]).view("<u2").reshape(shape)

    def __len__(self):
        return len(self.colours)

    def __call__(self, which):
        which = which.numpy()
        colours = torch.from_numpy(self.colours[which]).permute(0, 3, 1, 2).float() / 255
        metres = torch.from_numpy(self.centimetres[which].astype(np.float32)).unsqueeze(1) / 100
        return waters.linear(colours), torch.where(metres > 655, 100.0, metres)


@torch.no_grad()
def tried(network, held, table):
    """Losses on scenes held back: share, distance, and how far the share is off where it matters."""
    network.eval()
    sums = np.zeros(4)
    for number in range(HELD):
        image, share, ln_z, valid, known = waters.batch(held, table, HELD_SEED + number, BATCH)
        found = network(image)
        of_share, _, off = losses(found, share, ln_z, valid, known)
        said, true = found[:, 0] > 0, share > 0.5
        iou = ((said & true) * known).sum() / ((said | true) * known).sum().clamp(min=1)
        sums += [of_share, off, iou, 1]
    network.train()
    return sums[:3] / sums[3]


def main():
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("folder", type=Path)
    words.add_argument("output", type=Path)
    words.add_argument("--steps", type=int, default=9000)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--minutes", type=float, default=120)
    words = words.parse_args()
    torch.set_num_threads(1)
    table = torch.from_numpy(np.fromfile(words.folder / "waters.bin", "<f4").reshape(-1, 12).copy())
    held = Places(words.folder.glob("held-*.bin"))
    files = sorted(words.folder.glob("train-*.bin"))
    places = Places(files)
    torch.manual_seed(words.seed)
    network = Network().to(memory_format=torch.channels_last)
    slow = copy.deepcopy(network)
    optimiser = torch.optim.AdamW(network.parameters(), lr=RATE, betas=(0.9, 0.99), weight_decay=1e-3)
    saved = words.output.with_suffix(".state")
    step, best = 0, math.inf
    if saved.exists():
        state = torch.load(saved, weights_only=True)
        network.load_state_dict(state["network"])
        slow.load_state_dict(state["slow"])
        optimiser.load_state_dict(state["optimiser"])
        step, best = state["step"], state["best"]
    began = time.monotonic()
    while step < words.steps and time.monotonic() - began < 60 * words.minutes:
        if step % EACH == 0 and len(found := sorted(words.folder.glob("train-*.bin"))) > len(files):
            files, places = found, Places(found)
        share_done = step / words.steps
        rate = RATE * min(1, (step + 1) / WARM) * 0.5 * (1 + math.cos(math.pi * share_done))
        for group in optimiser.param_groups:
            group["lr"] = rate
        image, share, ln_z, valid, known = waters.batch(places, table, (words.seed << 32) + step, BATCH)
        of_share, of_distance, _ = losses(network(image.contiguous(memory_format=torch.channels_last)), share, ln_z, valid, known)
        optimiser.zero_grad(set_to_none=True)
        (of_share + 0.5 * of_distance).backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimiser.step()
        step += 1
        with torch.no_grad():
            keep = min(SLOW, (1 + step) / (10 + step))
            for mean, own in zip(slow.parameters(), network.parameters()):
                mean.lerp_(own, 1 - keep)
        if step % EACH == 0 or step == words.steps:
            of_share, off, iou = tried(slow, held, table)
            score = of_share + 0.5 * off
            if score < best:
                best = score
                torch.save(slow.state_dict(), words.output)
            torch.save({"network": network.state_dict(), "slow": slow.state_dict(), "optimiser": optimiser.state_dict(),
                        "step": step, "best": float(best)}, saved)
            print(f"{step} of {words.steps} steps, {len(places)} places: share {of_share:.4f}, distance {off:.4f}, IoU {iou:.3f}; "
                  f"{(time.monotonic() - began) / 60:.1f} min", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
