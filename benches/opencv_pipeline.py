#!/usr/bin/env python3
"""The main way of AquaFuse written with OpenCV and NumPy: the rival, and an independent check.

The same algorithm as the Rust core, step by step, each step done by the fastest call OpenCV has for it:
table look-ups for Eq. 3, `medianBlur`, histograms and masks for the estimates, a table over the 256 levels
of depth for the fusion. Attenuation is left out: fusion does not use it.

    opencv_pipeline.py fuse CONTENT REFERENCE OUT.png [--model M] [--depth OUT.png]
    opencv_pipeline.py time CONTENT.ppm REFERENCE.ppm --frames N

`time` prints the median milliseconds of a frame whose reference's water is known already, and of a frame
for which both pictures are estimated.
"""

import argparse
import math
import statistics
import time

import cv2
import numpy as np

cv2.setNumThreads(1)

MU = (0.556495, 0.518993, -6.0, -0.557781, -2.0)
BYTES = np.arange(256) / 255.0
FRACTION = 16
OF_RED = np.rint((MU[0] + MU[1] * np.exp(MU[2] * BYTES)) * 255.0 * (1 << FRACTION)).astype(np.int32)
OF_MAX = np.rint(MU[3] * np.exp(MU[4] * BYTES) * 255.0 * (1 << FRACTION)).astype(np.int32)
# The fast path: 16-bit tables halve the memory that OpenCV moves. Level 143 keeps the second one positive.
LIFT, SIXTEEN = 143, 64
OF_RED_U16 = np.rint(OF_RED / (1 << FRACTION) * SIXTEEN).astype(np.uint16)
OF_MAX_U16 = np.rint((OF_MAX / (1 << FRACTION) + LIFT) * SIXTEEN).astype(np.uint16)

CELLS, SMOOTH, SMOOTHEST, LEAST_CELLS, STEP, NEAR = 48, 1.5, 0.10, 0.02, 8, 12
FARTHEST_SHARE, FEW_PIXELS, CORNER_SHARE = 0.05, 100, 0.20
BINS, SPAN, LEAST_SHARE, LEAST_PIXELS = 11, (0.02, 0.98), 0.002, 50
DARK, SHADOW, EXPECTED, SPREAD, NOISE = 0.02, 0.04, 1.2, 2.0, 0.03
RANGE, STEPS = (0.05, 8.0), 96


def depth_before_median(bgr, exact):
    """Eq. 3 by tables. `exact` is integer arithmetic as in Rust; otherwise the fastest way of OpenCV."""
    blue, green, red = cv2.split(bgr)
    largest = cv2.max(green, blue)
    if exact:
        total = OF_RED[red] + OF_MAX[largest] + (1 << (FRACTION - 1))
        return np.clip(total >> FRACTION, 0, 255).astype(np.uint8)
    total = cv2.add(cv2.LUT(red, OF_RED_U16), cv2.LUT(largest, OF_MAX_U16))
    return cv2.convertScaleAbs(total, alpha=1.0 / SIXTEEN, beta=-LIFT)


def depth(bgr, exact=False):
    return cv2.medianBlur(depth_before_median(bgr, exact), 7)


def counts_of(levels, mask=None):
    return cv2.calcHist([levels], [0], mask, [256], [0, 256]).ravel()


def is_bluish_green(bgr):
    blue, green, _ = cv2.split(bgr)
    low, high = cv2.min(blue, green), cv2.max(blue, green)
    floor = cv2.LUT(high, np.where(np.arange(256) >= 16, np.arange(256) // 8, 255).astype(np.uint8))
    fits = cv2.compare(low, floor, cv2.CMP_GE)
    return cv2.bitwise_and(fits, cv2.compare(low, 240, cv2.CMP_LT))


def median_colour(bgr, mask):
    """Per-channel median from histograms; of an even number, the mean of the middle two."""
    result = []
    for channel in range(3):
        counts = cv2.calcHist([bgr], [channel], mask, [256], [0, 256]).ravel().astype(np.int64)
        seen, count = np.cumsum(counts), int(counts.sum())
        ranks = ((count - 1) // 2, count // 2)
        result.append(sum(int(np.searchsorted(seen, rank, side="right")) for rank in ranks) / 510.0)
    return np.array(result[::-1])


def farthest_mask(levels, usable):
    every = counts_of(levels)
    kept = every if usable is None else counts_of(levels, usable)
    total = levels.size
    taken, passed = np.cumsum(kept[::-1]), np.cumsum(every[::-1])
    stop = (taken >= FARTHEST_SHARE * total) | (passed >= 0.5 * total)
    nearest = 255 - int(np.argmax(stop)) if stop.any() else 0
    mask = cv2.compare(levels, nearest, cv2.CMP_GE)
    return mask if usable is None else cv2.bitwise_and(mask, usable)


def corners_mask(shape, usable, top):
    height, width = shape
    rows, columns = math.ceil(height * CORNER_SHARE), math.ceil(width * CORNER_SHARE)
    mask = np.zeros(shape, np.uint8)
    band = slice(0, rows) if top else slice(height - rows, height)
    mask[band, :columns] = 255
    mask[band, width - columns:] = 255
    return cv2.bitwise_and(mask, usable)


def borders(length, side):
    wanted = min(max(int(np.float32(length) / np.float32(side)), 1), length)
    count = wanted if wanted % 2 == length % 2 or wanted == 1 else wanted - 1
    from_start = lambda i: (2 * i * length + count) // (2 * count)
    return np.array([from_start(i) if 2 * i <= count else length - from_start(count - i) for i in range(count + 1)])


def open_water(bgr, levels):
    """The commonest colour of smooth bluish-green cells, or None."""
    height, width = levels.shape
    side = max(np.float32(min(width, height)) / np.float32(CELLS), np.float32(1))
    rows, columns = borders(height, side), borders(width, side)
    sums, squares = cv2.integral2(bgr, sdepth=cv2.CV_64F, sqdepth=cv2.CV_64F)
    depth_sums = cv2.integral(levels, sdepth=cv2.CV_64F)
    of_cells = lambda table: np.diff(np.diff(table[rows][:, columns], axis=0), axis=1)
    count = np.outer(np.diff(rows), np.diff(columns)).astype(np.float64)
    mean = of_cells(sums) / count[..., None]
    spread = np.sqrt(np.maximum(of_cells(squares) / count[..., None] - mean * mean, 0).max(axis=2))
    mean = mean.reshape(-1, 3)[:, ::-1].astype(np.float32)
    spread = spread.ravel().astype(np.float32)
    level = (of_cells(depth_sums) // count).ravel().astype(int)
    needed = np.sort(spread)[int(len(spread) * SMOOTHEST)]
    rounded = (mean + np.float32(0.5)).astype(int)
    low, high = rounded[:, 1:].min(axis=1), rounded[:, 1:].max(axis=1)
    bluish_green = (high >= 16) & (low < 240) & (low >= high // 8)
    smooth = (spread <= max(needed, SMOOTH)) & bluish_green
    rank = np.cumsum(np.bincount(level, minlength=256))
    side = 256 // STEP + 2
    place = (mean[smooth] / np.float32(STEP)).astype(int) + 1
    flat = (place[:, 0] * side + place[:, 1]) * side + place[:, 2]
    # Whole numbers far below 2^53: sums of doubles are exact.
    cube = np.bincount(flat, rank[level[smooth]].astype(np.float64) ** 2, side**3).reshape(side, side, side)
    for axis in range(3):
        # Neighbours count half; the margin is empty, so nothing wraps around.
        cube = 2 * cube + np.roll(cube, 1, axis) + np.roll(cube, -1, axis)
    # Of several places that are commonest, the last.
    commonest = cube.size - 1 - int(np.argmax(cube.ravel()[::-1]))
    middle = (np.array(np.unravel_index(commonest, cube.shape)) - 0.5) * STEP
    alike = mean[smooth][(np.abs(mean[smooth] - middle) < NEAR).all(axis=1)]
    if len(alike) < LEAST_CELLS * len(mean):
        return None
    return np.sort(alike, axis=0)[len(alike) // 2] / 255.0


def veiling_light(bgr, levels):
    water = open_water(bgr, levels)
    if water is not None:
        return water
    usable = is_bluish_green(bgr)
    for read in (
        lambda: farthest_mask(levels, usable),
        lambda: corners_mask(levels.shape, usable, top=True),
        lambda: corners_mask(levels.shape, usable, top=False),
    ):
        mask = read()
        if cv2.countNonZero(mask) > FEW_PIXELS:
            return median_colour(bgr, mask)
    return median_colour(bgr, farthest_mask(levels, None))


def dark_envelope(bgr, levels):
    """Per bin of depth: z / z95 and the dark quantile of red, green and blue; and z95."""
    counts = counts_of(levels).astype(np.int64)
    total = levels.size
    seen = np.cumsum(counts)
    level_at = lambda share: int(np.argmax(seen >= share * total))
    low, high = level_at(SPAN[0]), level_at(SPAN[1])
    every = np.arange(256)
    bin_of = (np.clip(every, low, high) - low) * BINS // (high - low + 1)
    z95 = max(level_at(0.95), 1) / 255.0
    binned = cv2.LUT(levels, bin_of.astype(np.uint8))
    values = np.stack([
        cv2.calcHist([binned, bgr], [0, 1 + channel], None, [BINS, 256], [0, BINS, 0, 256])
        for channel in (2, 1, 0)
    ]).astype(np.float64)
    envelope = []
    for index in range(BINS):
        members = bin_of == index
        count = counts[members].sum()
        if count < max(int(LEAST_SHARE * total), LEAST_PIXELS):
            continue
        z = (counts[members] * every[members]).sum() / count / 255.0
        envelope.append((z / z95, [quantile(values[c, index], count, DARK) for c in range(3)]))
    return envelope, z95


def quantile(counts, count, share):
    rank, seen = share * count, np.cumsum(counts)
    value = int(np.argmax((counts > 0) & (seen >= rank)))
    within = (rank - (seen[value] - counts[value])) / counts[value] - 0.5
    return min(max(value + within, 0.0), 255.0) / 255.0


LN_TAU = np.linspace(math.log(RANGE[0]), math.log(RANGE[1]), STEPS + 1)


def backscatter_coefficient(envelope, z95, veil):
    result = []
    z = np.array([place for place, _ in envelope])
    factor = np.exp(-np.exp(LN_TAU)[:, None] * z[None, :])
    prior = 0.5 * ((LN_TAU - math.log(EXPECTED)) / math.log(SPREAD)) ** 2
    for c in range(3):
        dark = np.array([colours[c] for _, colours in envelope])
        shadow = min(SHADOW, veil[c])
        off = np.abs(veil[c] * (1 - factor) + shadow * factor - dark) / NOISE
        cost = np.where(off <= 1, 0.5 * off * off, off - 0.5).sum(axis=1) + prior
        best = int(np.argmin(cost))
        ln_tau = LN_TAU[best]
        if 0 < best < STEPS:
            left, middle, right = cost[best - 1:best + 2]
            curvature = left - 2 * middle + right
            if curvature > 0:
                ln_tau += (LN_TAU[1] - LN_TAU[0]) * np.clip(0.5 * (left - right) / curvature, -0.5, 0.5)
        result.append(math.exp(ln_tau) / z95)
    return np.array(result)


def estimate(bgr, exact=False):
    levels = depth(bgr, exact)
    veil = veiling_light(bgr, levels)
    return levels, veil, backscatter_coefficient(*dark_envelope(bgr, levels), veil)


def fuse(bgr, levels, veil, beta, reference_veil, model):
    """The shift is a table over depth: one positive and one negative part, each added with saturation."""
    factor = np.exp(-beta[None, :] * BYTES[:, None])
    cosine = math.cos(math.radians(45.0)) if model == "aquafuse" else 1.0
    weight = factor * (1 - factor) if model == "aquafuse" else 1 - factor
    shift = np.floor(255.0 * cosine * weight * (reference_veil - veil)[None, :] + 0.5)[:, ::-1]
    table = lambda part: np.clip(part, 0, 255).astype(np.uint8).reshape(256, 1, 3)
    three = cv2.merge([levels, levels, levels])
    out = bgr
    if (shift > 0).any():
        out = cv2.add(out, cv2.LUT(three, table(shift)))
    if (shift < 0).any():
        out = cv2.subtract(out, cv2.LUT(three, table(-shift)))
    return out


def time_frames(content, reference, frames):
    _, reference_veil, _ = estimate(reference)

    def cached():
        levels, veil, beta = estimate(content)
        return fuse(content, levels, veil, beta, reference_veil, "aquafuse")

    def both():
        _, veil2, _ = estimate(reference)
        levels, veil, beta = estimate(content)
        return fuse(content, levels, veil, beta, veil2, "aquafuse")

    for name, run in (("cached", cached), ("estimated", both)):
        run()
        spent = []
        for _ in range(frames):
            began = time.perf_counter()
            run()
            spent.append(1e3 * (time.perf_counter() - began))
        print(f"{name} {statistics.median(spent):.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("task", choices=["fuse", "time"])
    parser.add_argument("content")
    parser.add_argument("reference")
    parser.add_argument("output", nargs="?")
    parser.add_argument("--model", choices=["aquafuse", "physical"], default="aquafuse")
    parser.add_argument("--depth", help="write the depth map here, 16 bit")
    parser.add_argument("--fast", action="store_true", help="the arithmetic that `time` measures")
    parser.add_argument("--frames", type=int, default=10)
    given = parser.parse_args()
    content, reference = cv2.imread(given.content), cv2.imread(given.reference)
    if given.task == "time":
        print(f"opencv {cv2.__version__}")
        time_frames(content, reference, given.frames)
        return
    levels, veil, beta = estimate(content, exact=not given.fast)
    _, reference_veil, _ = estimate(reference, exact=not given.fast)
    cv2.imwrite(given.output, fuse(content, levels, veil, beta, reference_veil, given.model))
    if given.depth:
        cv2.imwrite(given.depth, levels.astype(np.uint16) * 257)


if __name__ == "__main__":
    main()
