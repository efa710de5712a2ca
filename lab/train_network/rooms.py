"""Places made of rough planes: floors, slopes, walls, canyons, caves, seen from any pose."""

import math

import torch
from torch.nn import functional as F

FARTHEST = 40.0  # metres; what is farther is open water
SIDE = 96  # of a sheet of noise
SHEETS = ((12, 1.0), (12, 2.0), (96, 0.5))  # cells of each, and how often it repeats


def room(chance, width, height):
    """Clear linear colours and metres (100 is open water) of one place for each image of a batch."""
    ray, pixel = rays(chance, width, height)
    size = chance.ln_between(0.4, 2.5)
    base = chance.ln_between(0.03, 0.7) * torch.exp(chance.normal(0.35, 3))
    clear = torch.zeros(chance.count, 3, height, width)
    z = torch.full((chance.count, 1, height, width), 100.0)
    for normal, distance, often in planes(chance, size):
        scale = (normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2).sqrt()
        towards = sum(n * r for n, r in zip(normal, ray)) / scale
        along = distance / towards.clamp(min=1e-3)
        hit = [along * r for r in ray]
        # Two coordinates on the plane, whichever side it faces.
        flat = normal[1].abs() / scale > 0.7
        upright = normal[0].abs() / scale > 0.7
        u = torch.where(upright & ~flat, hit[2], hit[0])
        v = torch.where(flat, hit[2], hit[1])
        coarse = chance.ln_between(0.25, 2.0) / size
        relief = chance.between(0, 0.5)
        height_of, shade = rough(u * coarse, v * coarse, along * coarse * pixel, chance)
        seen = (along * (1 - relief * height_of)).clamp(min=0.1)
        there = (towards > 1e-3) & (seen < z) & (seen < FARTHEST) & (chance.happens(often) > 0)
        own = base * torch.exp(chance.normal(0.25, 3))
        colour = own * torch.exp(chance.between(0.1, 0.8) * shade + relief * height_of)
        clear = torch.where(there, colour.clamp(0, 1), clear)
        z = torch.where(there, seen, z)
    return clear, z


def rays(chance, width, height):
    """The unit vector of each pixel (right, down, ahead) as the camera is held, and how wide a pixel is at one metre."""
    y, x = torch.meshgrid(torch.linspace(-height / width, height / width, height), torch.linspace(-1, 1, width), indexing="ij")
    view = chance.ln_between(0.35, 1.5)
    ray = [x * view, y * view, torch.ones(chance.count, 1, height, width)]
    length = (ray[0] ** 2 + ray[1] ** 2 + 1).sqrt()
    kind = chance.between(0, 1)
    level, downwards, upwards = 0.12 + chance.normal(0.15), chance.between(0.2, 1.5), chance.between(-0.6, 0)
    pitch = torch.where(kind < 0.65, level, torch.where(kind < 0.9, downwards, upwards))
    kind = chance.between(0, 1)
    level, askew, anyhow = chance.normal(0.08), chance.normal(0.5), chance.between(-math.pi, math.pi)
    roll = torch.where(kind < 0.75, level, torch.where(kind < 0.92, askew, anyhow))
    right, down = ray[0] * roll.cos() - ray[1] * roll.sin(), ray[0] * roll.sin() + ray[1] * roll.cos()
    down, ahead = down * pitch.cos() + pitch.sin(), pitch.cos() - down * pitch.sin()
    return [side / length for side in (right, down, ahead)], 2 * view / width


def planes(chance, size):
    """Planes around the camera: the normal of each (right, down, ahead; away from the camera), its distance, how often it is there."""
    angle = chance.between(-0.5, 0.5)
    one = torch.ones_like(angle)
    tilt = lambda: chance.normal(0.15)
    return [
        ((tilt(), one, tilt()), size * chance.between(0.5, 1.5), 0.85),
        ((angle.cos(), tilt(), angle.sin()), size * chance.ln_between(0.4, 4), 0.4),
        ((-angle.cos(), tilt(), chance.between(-0.4, 0.8)), size * chance.ln_between(0.4, 4), 0.4),
        ((chance.normal(0.5), tilt(), one), size * chance.ln_between(1.5, 12), 0.35),
        ((tilt(), -one, tilt()), size * chance.ln_between(0.6, 3), 0.08),
        ((chance.normal(0.5), chance.between(0.3, 1.2), chance.between(0, 1.2)), size * chance.ln_between(0.6, 3), 0.3),
    ]


def rough(u, v, blur, chance):
    """Height in [-1, 1] and shading of a rough surface at coordinates on it: sheets of noise, each finer; faint where a pixel is wide."""
    height, shade, strength = 0.0, 0.0, 1.0
    steep = chance.between(0.4, 0.9)
    for cells, often in SHEETS:
        sheet = torch.randn(chance.count, 2, cells, cells, generator=chance.of)
        sheet = F.interpolate(sheet, size=(SIDE, SIDE), mode="bicubic", align_corners=True) if cells < SIDE else sheet
        # Beyond its edge a sheet goes on as its own mirror image.
        at = torch.stack([u[:, 0] * often, v[:, 0] * often], -1)
        found = F.grid_sample(sheet, at, padding_mode="reflection", align_corners=True)
        found = strength * found / (1 + (0.5 * cells * often * blur) ** 2)
        height = height + 0.5 * found[:, :1] if cells < SIDE else height
        shade = shade + found[:, 1:]
        strength = strength * steep
    return height.clamp(-1, 1), shade
