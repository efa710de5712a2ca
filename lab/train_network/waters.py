"""Images of places in waters drawn by chance, as cameras show them: what the network learns from."""

import math

import torch
from torch.nn import functional as F

import rooms

WIDTH, HEIGHT = 160, 120
OPEN = 65535
SHAPES = ((128, 96), (128, 96), (144, 80), (112, 112), (96, 128))
ROOMS = 0.35  # of all places
FADED = 18.0  # metres from which the floor of a place fades into the dark


class Chance:
    """Numbers by chance for each image of a batch, shaped to be spread over it."""

    def __init__(self, seed, count):
        self.of = torch.Generator().manual_seed(seed)
        self.count = count

    def between(self, low, high, channels=1):
        return low + (high - low) * torch.rand(self.count, channels, 1, 1, generator=self.of)

    def normal(self, deviation=1.0, channels=1):
        return deviation * torch.randn(self.count, channels, 1, 1, generator=self.of)

    def happens(self, likelihood):
        return (torch.rand(self.count, 1, 1, 1, generator=self.of) < likelihood).float()

    def ln_between(self, low, high, channels=1):
        return torch.exp(self.between(math.log(low), math.log(high), channels))

    def field(self, cells, size, channels=1):
        """A smooth field, deviation about 1."""
        coarse = torch.randn(self.count, channels, cells * 3 // 4 + 1, cells + 1, generator=self.of)
        return F.interpolate(coarse, size=size, mode="bicubic", align_corners=True)

    def below(self, limit, count=None):
        return torch.randint(limit, (count or self.count,), generator=self.of)


def linear(encoded):
    return torch.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def encode(light):
    light = light.clamp(0, 1)
    return torch.where(light <= 0.0031308, 12.92 * light, 1.055 * light.clamp(min=1e-8) ** (1 / 2.4) - 0.055)


def over(other, chance, image):
    """`image` where it happens by chance, else `other`."""
    return other + chance * (image - other)


def gathered(places, chance):
    """Clear linear colours and metres of places, some of them of two places or with made-up shapes in front."""
    clear, z = places(chance.below(len(places)))
    planes = chance.happens(ROOMS).flatten() > 0
    if planes.any():
        clear[planes], z[planes] = rooms.room(Chance(int(chance.below(1 << 40, 1)), int(planes.sum())), WIDTH, HEIGHT)
    other, other_z = places(chance.below(len(places)))
    mirror = chance.happens(0.5) > 0
    clear, z = torch.where(mirror, clear.flip(3), clear), torch.where(mirror, z.flip(3), z)
    for axis in (2, 3):
        turned = chance.happens(0.4 if axis == 2 else 0.5) > 0
        other = torch.where(turned, other.flip(axis), other)
        other_z = torch.where(turned, other_z.flip(axis), other_z)
    scaled = torch.where(other_z < 99, other_z * chance.ln_between(0.4, 2.0), other_z)
    nearer = (scaled < z) & (chance.happens(0.35) > 0)
    # Of the second place no floor that would hide all of the first.
    nearer &= scaled < chance.ln_between(1.5, 30.0)
    clear, z = torch.where(nearer, other, clear), torch.where(nearer, scaled, z)
    # What is farther than this is not there: things that float in open water, with no floor.
    z = torch.where((z > chance.ln_between(1.2, 6.0)) & (chance.happens(0.2) > 0), torch.full_like(z, 100.0), z)
    for _ in range(3):
        clear, z = bodied(clear, z, chance)
    return clear, z


def bodied(clear, z, chance):
    """A thing of made-up shape, colour and texture in front of a place, now and then."""
    size = (HEIGHT, WIDTH)
    y, x = torch.meshgrid(torch.linspace(-0.75, 0.75, HEIGHT), torch.linspace(-1, 1, WIDTH), indexing="ij")
    angle = chance.between(0, math.pi)
    x, y = x - chance.between(-1, 1), y - chance.between(-0.75, 0.75)
    u, v = x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin()
    wide, high = chance.ln_between(0.06, 0.9), chance.ln_between(0.04, 0.6)
    power = chance.ln_between(1.2, 8.0)
    shape = ((u / wide).abs() ** power + (v / high).abs() ** power) + 0.25 * chance.field(12, size)
    distance = chance.ln_between(0.4, 9.0)
    body_z = distance * torch.exp(chance.normal(0.15) * u + chance.normal(0.15) * v)
    colour = chance.ln_between(0.01, 0.9) * torch.exp(chance.normal(0.5, 3))
    rough = chance.between(0, 0.6) * chance.happens(0.7)
    texture = rough * (0.6 * chance.field(24, size) + 0.4 * chance.field(80, size))
    stripes = chance.happens(0.2) * torch.sign(torch.sin(u * chance.ln_between(8, 60)))
    shading = torch.exp(chance.normal(0.4) * v / high.clamp(min=0.1) + texture + 0.5 * stripes)
    there = (shape < 1) & (body_z < z) & (chance.happens(0.3) > 0)
    return torch.where(there, (colour * shading).clamp(0, 1), clear), torch.where(there, body_z, z)


def drawn_water(waters, chance):
    """B∞, β_B, β_D and the light on things: from the table of the sea's waters, or made up."""
    table = waters[chance.below(len(waters))].view(-1, 4, 3, 1, 1)
    veil, beta_b, beta_d, white = (table[:, k] for k in range(4))
    # Made-up waters: a strongest channel, the others weaker; blue, green, yellow, grey.
    kind = chance.between(0, 1)
    weak = chance.ln_between(0.05, 1.0, 3)
    middle = chance.between(0.45, 1.0)
    hue = torch.cat([
        torch.where(kind < 0.8, 0.6 * weak[:, :1], chance.between(0.7, 1.1)),
        torch.where(kind < 0.4, middle, torch.ones_like(middle)),
        torch.where(kind < 0.4, torch.ones_like(middle), torch.where(kind < 0.8, middle, weak[:, 2:])),
    ], 1)
    hue = torch.where(kind > 0.93, torch.exp(chance.normal(0.08, 3)), hue)
    own_veil = chance.ln_between(0.03, 0.9) * hue
    own_b = torch.exp(chance.normal(0.25, 3)) * (1 - 0.4 * (hue / hue.amax(1, keepdim=True)))
    red = torch.tensor([1.0, 0, 0]).view(1, 3, 1, 1)
    own_d = own_b * chance.between(0.7, 1.5) + red * chance.between(0, 1.5)
    own_white = (hue / hue.amax(1, keepdim=True)).clamp(min=0.02) ** chance.between(0, 1.3)
    made_up = chance.happens(0.55)
    pairs = ((veil, own_veil), (beta_b / beta_b[:, 1:2], own_b), (beta_d / beta_b[:, 1:2], own_d), (white, own_white))
    return [over(a, made_up, b) for a, b in pairs]


def formed(clear, z, waters, chance):
    """Linear light of places in water, and what is left of the things' own light in it (the most of three channels)."""
    size = (HEIGHT, WIDTH)
    veil, beta_b, beta_d, white = drawn_water(waters, chance)
    things = torch.where(z < 99, z, torch.zeros_like(z))
    farthest = torch.quantile(things.flatten(1), 0.97, dim=1).view(-1, 1, 1, 1).clamp(min=0.3)
    # Where the floor is seen fading into the dark, water must hide that.
    least = torch.where((things > FADED).flatten(1).any(1).view(-1, 1, 1, 1), 2.0 / FADED, 0.0)
    thick = torch.maximum(chance.ln_between(0.3, 4.0) / farthest, least)
    tau = thick * torch.where(z < 99, z, torch.full_like(z, 1e4))
    left = torch.exp(-beta_b * tau)
    # Light fades with depth: brighter water above; and a sun's glow.
    y, x = torch.meshgrid(torch.linspace(-0.75, 0.75, HEIGHT), torch.linspace(-1, 1, WIDTH), indexing="ij")
    up = chance.normal(0.5) + 0.5
    slope = -up * y + chance.normal(0.35) * x + 0.15 * chance.happens(0.5) * chance.field(3, size)
    far = ((x - chance.between(-1.2, 1.2)) ** 2 + (y - chance.between(-1.2, 0.4)) ** 2) / chance.ln_between(0.05, 1.0)
    glow = chance.happens(0.3) * chance.between(0, 2.0) * torch.exp(-far)
    angle = chance.between(-0.6, 0.6)
    across = (x * angle.cos() + y * angle.sin() + 1.6) / 3.2
    rays = F.grid_sample(
        chance.field(40, (1, 128)), torch.cat([(2 * across - 1).unsqueeze(-1), torch.zeros_like(across).unsqueeze(-1)], -1)[:, 0],
        align_corners=False)
    rays = chance.happens(0.2) * chance.between(0, 0.2) * rays * torch.sigmoid(-4 * y)
    field = torch.exp(slope + rays) + glow
    light = torch.exp(slope * chance.between(0, 0.8) + chance.happens(0.3) * 0.4 * chance.field(3, size))
    # At night a torch lights what is near, and the water itself is dark.
    night = chance.happens(0.12)
    spot = torch.exp(-((x - chance.normal(0.3)) ** 2 + (y - chance.normal(0.2)) ** 2) / chance.ln_between(0.15, 3.0))
    reach = chance.ln_between(0.15, 0.8) * farthest
    torch_light = spot * torch.exp(-thick * z.clamp(max=60)) / (0.1 + (z.clamp(max=60) / reach) ** 2)
    ambient = chance.ln_between(0.003, 0.3)
    light = over(light, night, ambient * light + torch_light)
    field = over(field, night, ambient * field * chance.ln_between(0.1, 1.0) + 0.1 * chance.between(0, 1) * spot)
    white = over(white, night, white ** 0.3)
    direct = clear * torch.exp(chance.normal(0.2, 3)) * white * light * torch.exp(-beta_d * tau)
    level = over(torch.ones_like(veil[:, :1]), chance.happens(0.5), chance.ln_between(0.4, 2.5))
    return direct + level * veil * field * (1 - left), left.amax(1, keepdim=True)


def photographed(light, chance):
    """Encoded values in [0, 1] of linear light, by a camera that is drawn."""
    size = light.shape[2:]
    light = over(light, chance.happens(0.3), blurred(light, chance.between(0.4, 1.3)))
    haze = chance.happens(0.25) * chance.between(0, 0.3)
    light = light * (1 - haze) + haze * light.mean((2, 3), keepdim=True) * torch.exp(chance.normal(0.2, 3))
    light = light + chance.happens(0.15) * snow(size, chance) * light.amax((2, 3), keepdim=True)
    light = light * torch.exp(chance.normal(0.2, 3) * chance.happens(0.6))
    mean = light.mean((2, 3), keepdim=True).clamp(min=1e-6)
    balanced = (mean.mean(1, keepdim=True) / mean).clamp(0.1, 12) ** (chance.between(0, 1) * chance.happens(0.6))
    light = light * balanced
    bright = torch.quantile(light.mean(1).flatten(1), 0.98, dim=1).view(-1, 1, 1, 1).clamp(min=1e-6)
    image = encode(light / bright * linear(chance.between(0.35, 1.1).clamp(max=1.1)))
    mix = torch.eye(3) + chance.happens(0.4).squeeze(-1) * 0.08 * torch.randn(image.shape[0], 3, 3, generator=chance.of)
    image = torch.einsum("bij,bjhw->bihw", mix, image).clamp(0, 1)
    image = image.clamp(min=1e-6) ** torch.exp(chance.normal(0.2))
    middle = image.mean((2, 3), keepdim=True)
    image = middle + (image - middle) * torch.exp(chance.normal(0.25))
    y, x = torch.meshgrid(torch.linspace(-1, 1, size[0]), torch.linspace(-1, 1, size[1]), indexing="ij")
    image = image * (1 - chance.happens(0.35) * chance.between(0, 0.5) * 0.5 * (x**2 + y**2))
    image = over(image, chance.happens(0.3), image + chance.between(0, 1.2) * (image - blurred(image, chance.between(0.6, 1.5))))
    return image


def snow(size, chance):
    """Particles near the camera: soft dots."""
    dots = (torch.rand(chance.count, 1, *size, generator=chance.of) < chance.ln_between(0.0003, 0.005)).float()
    return chance.between(0.3, 4) * blurred(dots, chance.between(0.4, 1.2))


def blurred(image, sigma):
    """A gaussian of its own for each image."""
    reach = torch.arange(-3, 4).float().view(1, 1, 1, 7)
    weights = torch.exp(-0.5 * (reach / sigma) ** 2)
    weights = weights / weights.sum(3, keepdim=True)
    count, channels, height, width = image.shape
    weights = weights.expand(count, channels, 1, 7).reshape(count * channels, 1, 1, 7)
    flat = F.pad(image.reshape(1, count * channels, height, width), (3, 3, 3, 3), mode="replicate")
    across = F.conv2d(flat, weights, groups=count * channels)
    return F.conv2d(across, weights.transpose(2, 3), groups=count * channels).view(image.shape)


LUMA = torch.tensor([
    16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14, 17, 22, 29, 51, 87, 80, 62,
    18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100,
    103, 99]).float().view(8, 8)
COSINES = torch.tensor([[math.cos((2 * i + 1) * k * math.pi / 16) * (0.5 if k else 0.5 / math.sqrt(2)) for i in range(8)]
                        for k in range(8)])


def compressed(image, chance):
    """As JPEG does: blocks of cosines, in steps (colour in the steps of luma, twice as wide)."""
    quality = chance.between(40, 95)
    scale = torch.where(quality < 50, 50 / quality, 2 - quality / 50)
    y = (image * torch.tensor([0.299, 0.587, 0.114]).view(1, 3, 1, 1)).sum(1, keepdim=True)
    planes = torch.cat([y, 0.564 * (image[:, 2:] - y), 0.713 * (image[:, :1] - y)], 1)
    count, _, height, width = planes.shape
    blocks = 255 * planes.view(count, 3, height // 8, 8, width // 8, 8).transpose(3, 4)
    steps = (LUMA * scale.view(-1, 1, 1, 1, 1, 1)).clamp(min=1) * torch.tensor([1.0, 2, 2]).view(1, 3, 1, 1, 1, 1)
    waves = COSINES @ blocks @ COSINES.T
    blocks = COSINES.T @ (torch.round(waves / steps) * steps) @ COSINES
    y, blue, red = (blocks.transpose(3, 4).reshape(count, 3, height, width) / 255).unbind(1)
    rgb = torch.stack([y + red / 0.713, y, y + blue / 0.564], 1)
    rgb[:, 1] = (y - 0.299 * rgb[:, 0] - 0.114 * rgb[:, 2]) / 0.587
    return rgb


def batch(places, waters, seed, count):
    """Images, and at half their sides: the share of water, ln z, where z counts, and where the share is known."""
    chance = Chance(seed, count)
    width, height = SHAPES[int(chance.below(len(SHAPES), 1))]
    clear, z = gathered(places, chance)
    light, left = formed(clear, z, waters, chance)
    # What lets less than a thirtieth through is water to any eye; from a quarter on it is a thing.
    share = (torch.log(0.25 / left.clamp(min=1e-9)) / math.log(0.25 / 0.03)).clamp(0, 1)
    # A part of each, in the proportions of the shape, now and then by a camera that is held askew.
    kind = chance.between(0, 1)
    askew = torch.where(kind < 0.75, chance.normal(0.04), torch.where(kind < 0.9, chance.normal(0.4), chance.between(-math.pi, math.pi)))
    cos, sin = askew.cos(), askew.sin()
    wide, high = width * cos.abs() + height * sin.abs(), width * sin.abs() + height * cos.abs()
    scale = chance.between(0.6, 1.0) * torch.minimum(WIDTH / wide, HEIGHT / high)
    half = torch.cat([scale * wide / WIDTH, scale * high / HEIGHT], 1)
    centre = (2 * torch.rand(count, 2, 1, 1, generator=chance.of) - 1) * (1 - half)
    y, x = torch.meshgrid((torch.arange(height) + 0.5) - height / 2, (torch.arange(width) + 0.5) - width / 2, indexing="ij")
    turned = torch.cat([(x * cos - y * sin) * 2 / WIDTH, (x * sin + y * cos) * 2 / HEIGHT], 1)
    grid = (centre + scale * turned).permute(0, 2, 3, 1)
    light = F.grid_sample(light, grid, align_corners=False, padding_mode="border")
    share = F.grid_sample(share, grid, align_corners=False, padding_mode="border")
    z = F.grid_sample(z, grid, mode="nearest", align_corners=False, padding_mode="border")
    image = photographed(light, chance)
    noise = torch.randn(image.shape, generator=chance.of) * chance.between(0, 4 / 255) * chance.happens(0.7)
    image = image + noise
    image = over(image, chance.happens(0.35), compressed(image, chance))
    known = torch.ones_like(z)
    bar = (chance.happens(0.06) * chance.between(0, 0.2) * height).long()
    rows = torch.arange(height).view(1, 1, -1, 1)
    inside = ((rows >= bar) & (rows < height - bar)).float()
    image, known = image * inside, known * inside
    image = (image.clamp(0, 1) * 255).round() / 255
    thing = known * (share < 0.5) * (z < 99)
    ln_z = torch.log(z.clamp(0.05, 99))
    weight = F.avg_pool2d(thing, 2)
    ln_z = F.avg_pool2d(ln_z * thing, 2) / weight.clamp(min=1e-6)
    squeeze = lambda map: map.squeeze(1).contiguous()
    return image, squeeze(F.avg_pool2d(share, 2)), squeeze(ln_z), squeeze((weight > 0.6).float()), squeeze(F.avg_pool2d(known, 2))
