#!/usr/bin/env python3
"""The main way of AquaFuse written with OpenCV and NumPy: the rival, and an independent check.

The same algorithm as the Rust core, step by step, each step done by the fastest call OpenCV has for it:
table look-ups for Eq. 3, means over cells and `resize` for what refines it, histograms and masks for the
estimates, a table over the 256 levels of depth for the fusion. Attenuation is left out: fusion does not use it.

    opencv_pipeline.py fuse CONTENT REFERENCE OUT.png [--model M] [--depth-model D] [--depth OUT.png]
    opencv_pipeline.py time CONTENT.ppm REFERENCE.ppm --frames N

`time` prints the median milliseconds of a frame whose reference's water is known already, and of a frame
for which both images are estimated; `unrefined` is the first with the paper's median of depth instead.
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

# Cells of depth, their least side in pixels, rows that are read of a cell, and steps of z.
DEPTH_CELLS, DEPTH_LEAST_SIDE, DEPTH_ROWS, DEPTH_FLAT, DEPTH_STEPS = 32, 4, 8, 4e-3, 2040
CELLS, LEAST_SIDE, ROUNDING, MOST_NOISE, LIKELY_WATER, SURE = 48, 3, 0.3, 4.0, 0.68, 0.97
SMOOTH, HIGH, FAR, BRIGHT, DARKER, GLARING, DARKEST = 0.73, 0.28, 0.075, -0.044, -1.5, -10.0, 0.05
REGION, SEED, NEAR, ROUNDS, READ, THINGS = 0.12, 0.4, 0.07, 5, 12 / 255, 0.4
ODDS = -16.9, -2.5, 3.05, 4.65, 5.2
FAINTEST_WATER, MOST, BY_COLOUR, ACROSS, ALONG, WITHIN = 0.14, 0.98, 0.8, 0.1, 0.25, 1.4
UNLIKELY, LIKELY, AROUND, FLAT_COLOUR = 0.25, 0.65, 2, 1e-3
BINS, LEAST_PIXELS, DARK, MOVED = 32, 50, 0.004, (2.65, 0.9)
FLOORS, FREQUENCY = np.array([0.0, 0.02, 0.05, 0.1, 0.2]), np.array([0.35, 0.25, 0.2, 0.12, 0.08])
EXCESS, OUTLIER, DEVIATION, WEIGHT = 0.06, 8.0, 8 / 255, 0.1
EXPECTED, RANGE, COARSE, FINE, REACH, LEAST_DEVIATION = (0.182, 0.8), (0.03, 12.0), 40, 33, 3.5, 0.06
SLOPE, SLOPE_DEVIATION, LINE_DEVIATION = (0.262, 0.0, 0.095), 0.3, 0.35
VEILS, VEIL_DEVIATION = np.array([-0.30, -0.20, -0.12, -0.06, 0.0, 0.08, 0.16, 0.27, 0.40]), 0.15
GREY, LINE_SLOPE, LINE_STEPS, LINE_LAST = 0.4, np.array([1.5, 1.0, 1.1]), 64, 6.0
VISIBLE, MOST_FLOOR, LEAST_ON, MOST_DEVIATION = 0.05, 0.08, 0.25, 0.5
FLAT, SATURATED, GLARE, LIVELY, LIVELY_RED, BRIGHTEST = 0.12, 0.6, 0.7, 0.1, 12, 0.7


def depth_before_median(bgr, exact):
    """Eq. 3 by tables. `exact` is integer arithmetic as in Rust; otherwise the fastest way of OpenCV."""
    blue, green, red = cv2.split(bgr)
    largest = cv2.max(green, blue)
    if exact:
        total = OF_RED[red] + OF_MAX[largest] + (1 << (FRACTION - 1))
        return np.clip(total >> FRACTION, 0, 255).astype(np.uint8)
    total = cv2.add(cv2.LUT(red, OF_RED_U16), cv2.LUT(largest, OF_MAX_U16))
    return cv2.convertScaleAbs(total, alpha=1.0 / SIXTEEN, beta=-LIFT)


def depth(bgr, exact=False, model="eq3"):
    """z in steps of 1 / 2040 and its levels of 1 / 255; of the median, levels alone."""
    raw = depth_before_median(bgr, exact)
    if model == "eq3-median":
        return None, cv2.medianBlur(raw, 7)
    if exact:
        steps = np.floor(DEPTH_STEPS * np.clip(refined(bgr, raw), 0, 1) + 0.5).astype(np.int64)
        return steps, ((steps + 4) // 8).astype(np.uint8)
    return None, refined_fast(bgr, raw)


def refined(bgr, raw):
    """Depth as a function of colour that changes from cell to cell, fitted to means over some rows of each."""
    height, width = raw.shape
    side = max(np.float32(min(width, height)) / np.float32(DEPTH_CELLS), np.float32(DEPTH_LEAST_SIDE))
    rows, columns = borders(height, side), borders(width, side)
    values = np.dstack((bgr[..., ::-1], raw)).astype(np.float64) / 255.0
    means = []
    for start, end in zip(rows[:-1], rows[1:]):
        stride = max((end - start) // DEPTH_ROWS, 1)
        some = values[start + (end - start - 1) % stride // 2 : end : stride].mean(axis=0)
        means.append(np.add.reduceat(some, columns[:-1], axis=0) / np.diff(columns)[:, None])
    means = np.stack(means)
    return follow(bgr, guided(means[..., :3], means[..., 3], DEPTH_FLAT), rows, columns)


def refined_fast(bgr, raw):
    """The same in levels, by cells of equal size, as OpenCV makes them fastest."""
    height, width = raw.shape
    side = max(min(width, height) / DEPTH_CELLS, DEPTH_LEAST_SIDE)
    small = lambda image: cv2.resize(image, (int(width / side), int(height / side)), interpolation=cv2.INTER_AREA)
    fits = guided(small(bgr)[..., ::-1] / 255.0, small(raw) / 255.0, DEPTH_FLAT).astype(np.float32)
    fits[..., 3] *= 255.0
    red, green, blue, z = (cv2.resize(np.ascontiguousarray(fits[..., k]), (width, height)) for k in range(4))
    for fit, channel in zip((blue, green, red), cv2.split(bgr)):
        cv2.accumulateProduct(fit, channel.astype(np.float32), z)
    # `convertScaleAbs` would turn what is below 0 round.
    return cv2.convertScaleAbs(cv2.max(z, 0))


def counts_of(levels, mask=None):
    return cv2.calcHist([levels], [0], mask, [256], [0, 256]).ravel()


def borders(length, side):
    wanted = min(max(int(np.float32(length) / np.float32(side)), 1), length)
    count = wanted if wanted % 2 == length % 2 or wanted == 1 else wanted - 1
    from_start = lambda i: (2 * i * length + count) // (2 * count)
    return np.array([from_start(i) if 2 * i <= count else length - from_start(count - i) for i in range(count + 1)])


def mean_around(values, reach):
    """Mean over a square of cells, cut off at the rim."""
    box = lambda array: cv2.boxFilter(array, -1, (2 * reach + 1,) * 2, None, (-1, -1), False, cv2.BORDER_CONSTANT)
    ones = box(np.ones(values.shape[:2]))
    return box(values) / (ones if values.ndim == 2 else ones[..., None])


def standard(values):
    deviation = values.std()
    return (values - values.mean()) / deviation if deviation > 0.3 else 0 * values


def upper_median(values):
    return np.sort(values, axis=0)[len(values) // 2]


def guided(colours, wanted, flat):
    """For each cell the affine function of colour that follows what is wanted around it."""
    colour, of_wanted = mean_around(colours, AROUND), mean_around(wanted, AROUND)
    outer = colours[..., :, None] * colours[..., None, :]
    products = [mean_around(np.ascontiguousarray(outer[..., row, :]), AROUND) for row in range(3)]
    matrix = np.stack(products, axis=2) - colour[..., :, None] * colour[..., None, :]
    right = mean_around(colours * wanted[..., None], AROUND) - colour * of_wanted[..., None]
    slope = np.linalg.solve(matrix + flat * np.eye(3), right[..., None])[..., 0]
    return mean_around(np.concatenate((slope, (of_wanted - (slope * colour).sum(axis=2))[..., None]), axis=2), AROUND)


def follow(bgr, fits, rows, columns):
    """What these functions make of each pixel, interpolated between the middles of cells."""
    middles = lambda borders: (borders[:-1] + borders[1:] - 1) / 2
    cells = lambda borders: np.arange(len(borders) - 1)
    place = lambda length, borders: np.interp(np.arange(length), middles(borders), cells(borders)).astype(np.float32)
    x, y = np.meshgrid(place(bgr.shape[1], columns), place(bgr.shape[0], rows))
    # OpenCV interpolates in steps of 1/32 of a cell, so this is done by hand.
    left, above = np.minimum(x.astype(int), fits.shape[1] - 2), np.minimum(y.astype(int), fits.shape[0] - 2)
    x, y = (x - left)[..., None], (y - above)[..., None]
    corner = lambda down, right: fits[above + down, left + right]
    fit = (1 - y) * ((1 - x) * corner(0, 0) + x * corner(0, 1)) + y * ((1 - x) * corner(1, 0) + x * corner(1, 1))
    return (fit[..., :3] * bgr[..., ::-1] / 255.0).sum(axis=2) + fit[..., 3]


class Region:
    """The cells that look most like open water, and how likely they are to be any."""

    def __init__(self, bgr, levels):
        height, width = levels.shape
        side = max(np.float32(min(width, height)) / np.float32(CELLS), np.float32(LEAST_SIDE))
        rows, columns = borders(height, side), borders(width, side)
        sums, squares = cv2.integral2(bgr, sdepth=cv2.CV_64F, sqdepth=cv2.CV_64F)
        depth_sums = cv2.integral(levels, sdepth=cv2.CV_64F)
        of_cells = lambda table: np.diff(np.diff(table[rows][:, columns], axis=0), axis=1)
        count = np.outer(np.diff(rows), np.diff(columns)).astype(np.float64)
        mean = of_cells(sums) / count[..., None]
        variance = np.maximum(of_cells(squares) / count[..., None] - mean * mean, 0)
        self.rows, self.columns, self.mean = rows, columns, mean[..., ::-1] / 255.0
        spread, level = np.sqrt(variance.max(axis=2)), of_cells(depth_sums) // count
        # Sums that are taken off each other may leave less than nothing.
        rough = np.sqrt(np.maximum(mean_around(variance.mean(axis=2) / 255.0**2, 1), 0))
        grey = self.mean.mean(axis=2)
        usual = upper_median(grey.ravel())
        high = 1 - (np.arange(len(rows) - 1) + 0.5) / (len(rows) - 1)
        self.evidence = mean_around(
            -SMOOTH * np.log(rough + 0.004) + HIGH * high[:, None] + FAR * standard(level)
            + BRIGHT * standard((65536 * grey).astype(np.int64).astype(np.float64))
            + DARKER * np.maximum(usual - grey, 0) / (usual + DARKEST) + GLARING * np.maximum(grey - 0.92, 0), 1)
        ordered = np.sort(self.evidence.ravel())[::-1]
        members = math.ceil(REGION * len(ordered))
        inside = self.evidence >= ordered[members - 1]
        read = self.evidence >= ordered[math.ceil(SEED * members) - 1]
        self.colour = upper_median(self.mean[read])
        for turn in range(ROUNDS + 1):
            off = np.abs(self.mean - self.colour)
            near = inside & ((off**2).sum(axis=2) < NEAR**2 if turn < ROUNDS else (off < READ).all(axis=2))
            if not near.any():
                break
            read, self.colour = near, upper_median(self.mean[near])
        # One more, so that equal cells count.
        more = 65536 * (self.evidence - ordered[math.ceil(THINGS * len(ordered)) - 1])
        weights = np.where(more >= 0, np.floor(more) + 1, 0)
        self.of_things = np.average(self.mean.reshape(-1, 3), axis=0, weights=weights.ravel())
        self.typical = upper_median(self.evidence[inside])
        smooth, most = upper_median(rough[inside]), self.colour.max()
        self.noise = float(np.clip(upper_median(spread[read]), ROUNDING, MOST_NOISE))
        contrast = math.log(upper_median(rough.ravel()) / (smooth + 0.0005) + 0.01)
        brighter = math.log((self.colour.mean() + 0.02) / (usual + 0.02))
        colourful = (most - self.colour.min()) / (most + DARKEST)
        odds = np.dot(ODDS, (1, math.log(smooth + 0.002), contrast, brighter, colourful))
        self.seen = 1 / (1 + math.exp(-odds))

    def share(self, bgr, veil):
        """How much of each pixel is open water."""
        sure = min(max((self.seen - UNLIKELY) / (LIKELY - UNLIKELY), 0), 1)
        if sure == 0 or veil.max() < FAINTEST_WATER:
            return None
        by_evidence = np.clip(1 - (self.typical - self.evidence) / WITHIN, 0, 1)
        off, length = self.mean - veil, max(np.linalg.norm(veil), 1e-3)
        along = off @ veil / length
        across = np.maximum((off**2).sum(axis=2) - along**2, 0)
        alike = np.exp(-across / ACROSS**2 - (along / ALONG) ** 2)
        share = MOST * (1 - (1 - by_evidence) * (1 - BY_COLOUR * alike))
        shares = follow(bgr, guided(self.mean, share, FLAT_COLOUR), self.rows, self.columns)
        return sure * sure * (3 - 2 * sure) * np.clip(shares, 0, 1)


def veiling_light(bgr, levels):
    """The region, its colour, the camera's noise, and whether it is open water."""
    region = Region(bgr, levels)
    if region.seen >= LIKELY_WATER:
        return region, region.colour, region.noise, True
    return region, region.of_things, ROUNDING, False


def binned(bgr, levels):
    """Bins of depth, equally full: z / z95, number of pixels, counts of each value by channel; and z95."""
    counts = counts_of(levels).astype(np.int64)
    seen = np.cumsum(counts)
    bin_of = np.minimum((2 * (seen - counts) + counts) * BINS // (2 * seen[-1]), BINS - 1)
    z95 = max(int(np.argmax(seen >= 0.95 * seen[-1])), 1) / 255.0
    places = cv2.LUT(levels, bin_of.astype(np.uint8))
    values = np.stack([
        cv2.calcHist([places, bgr], [0, 1 + channel], None, [BINS, 256], [0, BINS, 0, 256])
        for channel in (2, 1, 0)
    ]).astype(np.float64)
    number = np.bincount(bin_of, counts, BINS)
    weighted = np.bincount(bin_of, counts * np.arange(256), BINS)
    kept = number >= LEAST_PIXELS
    z = weighted[kept] / number[kept] / 255.0
    return z / z95, number[kept], values[:, kept], z95


def envelope(number, values, noise):
    """The dark end of each bin in one channel, what noise took from it given back."""
    every = np.arange(256)
    mean = values @ every / number
    spread = np.sqrt(np.maximum(values @ every**2 / number - mean * mean, 0))
    seen, rank = np.cumsum(values, axis=1), DARK * number[:, None]
    value = np.argmax((values > 0) & (seen >= rank), axis=1)
    at = np.take_along_axis
    within = (rank - (at(seen, value[:, None], 1) - at(values, value[:, None], 1))) / at(values, value[:, None], 1)
    dark = np.clip(value + within.ravel() - 0.5, 0, 255)
    plain = np.clip(1 - (spread - noise) / (4 * noise + 1e-3), 0, 1)
    return np.minimum(dark + noise * (plain * MOVED[0] + (1 - plain) * MOVED[1]), 255) / 255.0


def both(a, b):
    """What two bells (mean, deviation) say together."""
    p, q = a[1] ** -2, b[1] ** -2
    return (p * a[0] + q * b[0]) / (p + q), (p + q) ** -0.5


def bell(values, costs):
    weight = np.exp(costs.min() - costs)
    mean = (weight * values).sum() / weight.sum()
    return mean, math.sqrt(max((weight * values * values).sum() / weight.sum() - mean * mean, 0.0))


def weigh(z, dark, veil, noise, prior, taus, veils):
    """Posterior over optical depth, veil and floor: bells of ln τ and ln veil, expected floor, share on the curve."""
    deviation = math.hypot(DEVIATION, noise / 255.0)
    factor = np.exp(-np.exp(taus)[:, None] * z)[:, None, None, :]
    b = np.minimum(veil * np.exp(veils[:, 0]), 1.0)[None, :, None, None]
    off = dark - (b + (FLOORS[None, None, :, None] - b) * factor)
    scale = deviation + EXCESS * factor
    rarity = np.log(scale / deviation)
    above = np.minimum(rarity + 0.7 + off / scale, OUTLIER + rarity)
    cost = np.minimum(0.5 * (off / deviation) ** 2, np.where(off < 0, OUTLIER, above)).sum(axis=3)
    prior_cost = 0.5 * ((taus - prior[0]) / prior[1]) ** 2
    cost = WEIGHT * cost - np.log(FREQUENCY) + prior_cost[:, None, None] + veils[None, :, 1, None]
    least = cost.min(axis=2)
    together = least - np.log(np.exp(least[..., None] - cost).sum(axis=2))
    best = np.unravel_index(np.argmin(cost), cost.shape)
    on = (np.abs(off[best]) / deviation < 2).mean()
    ln_tau = bell(np.broadcast_to(taus[:, None], together.shape), together)
    ln_veil = bell(np.broadcast_to(veils[None, :, 0], together.shape), together)
    return ln_tau, ln_veil, bell(np.broadcast_to(FLOORS, cost.shape), cost)[0], on


def thickness(depth, t, z):
    """Optical depth at which the line first has each depth of z."""
    after = np.searchsorted(depth, z, side="left")
    inside = np.clip(after, 1, len(t) - 1)
    low, high = depth[inside - 1], depth[inside]
    along = (z - low) / np.where(high > low, high - low, 1.0)
    between = t[inside - 1] + (t[inside] - t[inside - 1]) * along
    return np.where(after == 0, 0.0, np.where(after == len(t), LINE_LAST, between))


def mixing_line(z, z95, veil, taus):
    """ln of the optical depth that serves Eq. 3 best, from the line on which grey mixes with the water's colour."""
    t = np.linspace(0, LINE_LAST, LINE_STEPS)
    left = np.exp(-t[:, None] * LINE_SLOPE)
    colours = (np.clip(GREY * left + veil * (1 - left), 0, 1) * 255 + 0.5).astype(int)
    total = OF_RED[colours[:, 0]] + OF_MAX[colours[:, 1:].max(axis=1)] + (1 << (FRACTION - 1))
    depth = np.maximum.accumulate(np.clip(total >> FRACTION, 0, 255) / 255.0)
    thick = 0.5 * (thickness(depth, t, z * z95 - 0.5 / 255) + thickness(depth, t, z * z95 + 0.5 / 255))
    factor = np.exp(-np.exp(taus)[:, None] * z)
    return [taus[np.argmin(((factor - np.exp(-thick * slope)) ** 2).sum(axis=1))] for slope in LINE_SLOPE]


def backscatter(bgr, levels, region, veil, noise, seen):
    """B∞, β_B, and whether the estimate is good."""
    z, number, values, z95 = binned(bgr, levels)
    coarse = np.linspace(math.log(RANGE[0]), math.log(RANGE[1]), COARSE)
    line = mixing_line(z, z95, veil, coarse) if seen else None
    prior = lambda c: (line[c], LINE_DEVIATION) if seen else EXPECTED
    veils = np.zeros((1, 2)) if seen else np.stack([VEILS, 0.5 * (VEILS / VEIL_DEVIATION) ** 2], axis=1)
    darks = [envelope(number, values[c], noise) for c in range(3)]
    look = lambda c, prior, taus: weigh(z, darks[c], veil[c], noise, prior, taus, veils)
    first = [look(c, prior(c), coarse)[0] for c in range(3)]
    first = [(mean, max(deviation, LEAST_DEVIATION)) for mean, deviation in first]
    found = []
    for c in range(3):
        of = lambda o: (first[o][0] - SLOPE[o] + SLOPE[c], math.hypot(first[o][1], SLOPE_DEVIATION))
        others = both(of((c + 1) % 3), of((c + 2) % 3))
        mean, deviation = both(first[c], others)
        reach = REACH * max(deviation, LEAST_DEVIATION)
        found.append(look(c, both(prior(c), others), np.linspace(mean - reach, mean + reach, FINE)))
    veil = np.array([min(veil[c] * math.exp(found[c][1][0]), 1.0) for c in range(3)])
    beta = np.array([math.exp(ln_tau[0]) / z95 for ln_tau, *_ in found])
    sure = seen and region.seen >= SURE and region.colour.max() >= FAINTEST_WATER
    return veil, beta, quality(found, veil, levels, z, number, values, sure)


def quality(found, veil, levels, z, number, values, seen):
    """Whether nothing speaks against an estimate, and whether its light is glare. L_z, the one reason that
    needs β_D, is left out: where it speaks against depth from colour, others did as well in every image tried."""
    visible = [one for c, one in enumerate(found) if veil[c] >= VISIBLE]
    dark = any(floor > MOST_FLOOR or ln_tau[1] > MOST_DEVIATION for ln_tau, _, floor, _ in visible)
    off = any(on < LEAST_ON for *_, on in visible)
    flat = z[-1] - z[0] < FLAT
    ends = counts_of(levels)[[0, 255]].max() > SATURATED * levels.size
    glare = veil[0] >= veil[1:].max() or veil.min() > GLARE
    dead = values[0, :, LIVELY_RED:].sum() <= LIVELY * number.sum()
    return seen and not (dark or off or flat or ends or glare or dead), glare


def estimate(bgr, exact=False, model="eq3"):
    steps, levels = depth(bgr, exact, model)
    return (steps, levels, *backscatter(bgr, levels, *veiling_light(bgr, levels)))


def depth_factors(bgr, levels, beta, good):
    """F of things by distance where open water is in view; the physical model reads it."""
    _, veil, noise, seen = veiling_light(bgr, levels)
    if not seen:
        return None
    z, number, values, z95 = binned(bgr, levels)
    least = [1 - envelope(number, values[c], noise) / max(veil[c], 1e-3) for c in range(3)]
    factors = np.maximum(np.exp(-beta * (z * z95)[:, None]), np.stack(least, axis=1))
    z, factors = z95 * z[z > 0], factors[z > 0]
    factors = np.maximum(np.maximum.accumulate(factors[::-1])[::-1], 0)
    if not good:
        factors[:, 0] = np.maximum(factors[:, 0], factors[:, 1:].min(axis=1))
    return lambda at: np.stack([np.interp(at, np.r_[0, z], np.r_[1, factors[:, c]]) for c in range(3)], axis=1)


def bounded(veil, beta, good, reference_veil, reference_glare, model):
    """What keeps a doubtful estimate from painting what is not there."""
    if model == "aquafuse":
        return beta, reference_veil
    if not good:
        beta = np.array([min(beta[0], beta[1:].max()), *beta[1:]])
    if reference_glare:
        largest = reference_veil[1:].max()
        held = np.array([min(reference_veil[0], largest), *reference_veil[1:]])
        reference_veil = held * (min(BRIGHTEST / largest, 1.0) if largest > 0 else 1.0)
    return beta, reference_veil


def fuse(bgr, levels, veil, beta, reference_veil, model, steps=None, factors=None, share=None):
    """The shift is a table over depth: one positive and one negative part, each added with saturation."""
    at = BYTES if steps is None else np.arange(DEPTH_STEPS + 1) / DEPTH_STEPS
    factor = np.exp(-beta[None, :] * at[:, None]) if factors is None else factors(at)
    if share is not None:
        shift = 255.0 * (1 - (1 - share[..., None]) * factor[levels if steps is None else steps]) * (reference_veil - veil)
        shift = np.sign(shift) * np.floor(np.abs(shift) + 0.5)
        return np.clip(bgr + shift[..., ::-1], 0, 255).astype(np.uint8)
    cosine = math.cos(math.radians(45.0)) if model == "aquafuse" else 1.0
    weight = factor * (1 - factor) if model == "aquafuse" else 1 - factor
    shift = np.floor(255.0 * cosine * weight * (reference_veil - veil)[None, :] + 0.5)[:, ::-1]
    if steps is not None:
        return np.clip(bgr + shift[steps], 0, 255).astype(np.uint8)
    table = lambda part: np.clip(part, 0, 255).astype(np.uint8).reshape(256, 1, 3)
    three = cv2.merge([levels, levels, levels])
    out = bgr
    if (shift > 0).any():
        out = cv2.add(out, cv2.LUT(three, table(shift)))
    if (shift < 0).any():
        out = cv2.subtract(out, cv2.LUT(three, table(-shift)))
    return out


def time_frames(content, reference, frames):
    _, _, reference_veil, *_ = estimate(reference)

    def cached(model="eq3"):
        _, levels, veil, beta, _ = estimate(content, model=model)
        return fuse(content, levels, veil, beta, reference_veil, "aquafuse")

    def both_estimated():
        _, _, veil2, *_ = estimate(reference)
        _, levels, veil, beta, _ = estimate(content)
        return fuse(content, levels, veil, beta, veil2, "aquafuse")

    def smoothed():
        return cv2.bilateralFilter(cached(), 5, 75, 75)

    unrefined = lambda: cached("eq3-median")
    named = ("cached", cached), ("estimated", both_estimated), ("smoothed", smoothed), ("unrefined", unrefined)
    for name, run in named:
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
    parser.add_argument("--depth-model", choices=["eq3", "eq3-median"], default="eq3")
    parser.add_argument("--depth", help="write the depth map here, 16 bit")
    parser.add_argument("--fast", action="store_true", help="the arithmetic that `time` measures")
    parser.add_argument("--frames", type=int, default=10)
    given = parser.parse_args()
    content, reference = cv2.imread(given.content), cv2.imread(given.reference)
    if given.task == "time":
        print(f"opencv {cv2.__version__}")
        time_frames(content, reference, given.frames)
        return
    look = lambda image: estimate(image, not given.fast, given.depth_model)
    steps, levels, veil, beta, (good, _) = look(content)
    _, _, reference_veil, _, (_, glare) = look(reference)
    factors = depth_factors(content, levels, beta, good) if given.model == "physical" else None
    share = Region(content, levels).share(content, veil) if given.model == "physical" else None
    beta, reference_veil = bounded(veil, beta, good, reference_veil, glare, given.model)
    fused = fuse(content, levels, veil, beta, reference_veil, given.model, steps, factors, share)
    cv2.imwrite(given.output, fused)
    if given.depth:
        z = levels.astype(np.float64) / 255.0 if steps is None else steps / DEPTH_STEPS
        cv2.imwrite(given.depth, np.floor(65535 * z + 0.5).astype(np.uint16))


if __name__ == "__main__":
    main()
