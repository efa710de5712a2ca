"""Networks of depth in the shapes that people have, with random weights: a vision transformer with a dense head, a U-Net, and
one that gives several maps."""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

PATCH = 14


class Block(nn.Module):
    """A block of a transformer, with scaled branches."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.before, self.after = nn.LayerNorm(width, eps=1e-6), nn.LayerNorm(width, eps=1e-6)
        self.qkv, self.out = nn.Linear(width, 3 * width), nn.Linear(width, width)
        self.wide, self.narrow = nn.Linear(width, 4 * width), nn.Linear(4 * width, width)
        self.scales = nn.Parameter(torch.full((2, width), 0.5))

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        batch, count, width = tokens.shape
        split = self.qkv(self.before(tokens)).reshape(batch, count, 3, self.heads, width // self.heads)
        query, key, value = split.permute(2, 0, 3, 1, 4).unbind(0)
        weights = ((query * query.shape[-1] ** -0.5) @ key.transpose(-2, -1)).softmax(dim=-1)
        mixed = (weights @ value).transpose(1, 2).reshape(batch, count, width)
        tokens = tokens + self.scales[0] * self.out(mixed)
        return tokens + self.scales[1] * self.narrow(functional.gelu(self.wide(self.after(tokens))))


class Transformer(nn.Module):
    """Patches of 14 x 14 pixels to the tokens after four of its blocks, as maps."""

    def __init__(self, width: int = 384, blocks: int = 12, heads: int = 6, side: int = 37) -> None:
        super().__init__()
        self.patches = nn.Conv2d(3, width, PATCH, PATCH)
        self.first = nn.Parameter(torch.randn(1, 1, width))
        self.places = nn.Parameter(0.1 * torch.randn(1, width, side, side))
        self.blocks = nn.ModuleList(Block(width, heads) for _ in range(blocks))
        self.norm = nn.LayerNorm(width, eps=1e-6)

    def forward(self, image: torch.Tensor) -> list[torch.Tensor]:
        patches = self.patches(image)
        rows, columns = patches.shape[-2:]
        places = functional.interpolate(self.places, size=(rows, columns), mode="bicubic", align_corners=False)
        tokens = (patches + places).flatten(2).transpose(1, 2)
        tokens = torch.cat([self.first.expand(tokens.shape[0], -1, -1), tokens], dim=1)
        taken = []
        for number, block in enumerate(self.blocks, 1):
            tokens = block(tokens)
            if number % (len(self.blocks) // 4) == 0:
                taken.append(self.norm(tokens)[:, 1:].transpose(1, 2).reshape(1, -1, rows, columns))
        return taken


class Refine(nn.Module):
    """Two convolutions beside the map."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.one, self.two = nn.Conv2d(width, width, 3, padding=1), nn.Conv2d(width, width, 3, padding=1)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return x + self.two(functional.relu(self.one(functional.relu(x))))


class DensePrediction(nn.Module):
    """A transformer with a dense head, in the shape of Depth Anything V2 Small."""

    def __init__(self, width: int = 384, head: int = 64) -> None:
        super().__init__()
        self.transformer = Transformer(width)
        sides = [48, 96, 192, 384]
        self.projections = nn.ModuleList(nn.Conv2d(width, side, 1) for side in sides)
        self.sized = nn.ModuleList([
            nn.ConvTranspose2d(sides[0], sides[0], 4, 4),
            nn.ConvTranspose2d(sides[1], sides[1], 2, 2),
            nn.Identity(),
            nn.Conv2d(sides[3], sides[3], 3, 2, padding=1),
        ])
        self.narrowed = nn.ModuleList(nn.Conv2d(side, head, 3, padding=1, bias=False) for side in sides)
        self.own, self.joined = nn.ModuleList(Refine(head) for _ in sides), nn.ModuleList(Refine(head) for _ in sides)
        self.outs = nn.ModuleList(nn.Conv2d(head, head, 1) for _ in sides)
        self.narrow_half = nn.Conv2d(head, head // 2, 3, padding=1)
        self.last = nn.Sequential(nn.Conv2d(head // 2, 32, 3, padding=1), nn.ReLU(), nn.Conv2d(32, 1, 1), nn.Softplus())

    def features(self, image: torch.Tensor) -> torch.Tensor:
        maps = self.transformer(image)
        maps = [size(project(one)) for size, project, one in zip(self.sized, self.projections, maps, strict=True)]
        maps = [narrow(one) for narrow, one in zip(self.narrowed, maps, strict=True)]
        path = None
        for k in range(3, -1, -1):
            path = maps[k] if path is None else path + self.own[k](maps[k])
            path = self.joined[k](path)
            size = maps[k - 1].shape[-2:] if k else [2 * side for side in path.shape[-2:]]
            path = self.outs[k](functional.interpolate(path, size=size, mode="bilinear", align_corners=True))
        return self.narrow_half(path)

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        size = image.shape[-2:]
        made = functional.interpolate(self.features(image), size=size, mode="bilinear", align_corners=True)
        return self.last(made).squeeze(1)


class UNet(nn.Module):
    """A small U-Net with batch norm, as people train themselves."""

    def __init__(self, width: int = 16) -> None:
        super().__init__()
        widths = [width, 2 * width, 4 * width, 8 * width]
        self.down = nn.ModuleList(self.pair(a, b) for a, b in zip([3, *widths], widths, strict=False))
        self.up = nn.ModuleList(self.pair(a + b, b) for a, b in zip(widths[:0:-1], widths[-2::-1], strict=True))
        self.last = nn.Conv2d(width, 1, 1)

    @staticmethod
    def pair(a: int, b: int) -> nn.Module:
        layers: list[nn.Module] = []
        for inside in (a, b):
            layers += [nn.Conv2d(inside, b, 3, padding=1), nn.BatchNorm2d(b), nn.LeakyReLU(0.1)]
        return nn.Sequential(*layers)

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        kept, x = [], image
        for number, pair in enumerate(self.down):
            x = pair(functional.max_pool2d(x, 2) if number else x)
            kept.append(x)
        for pair, beside in zip(self.up, kept[-2::-1], strict=True):
            x = functional.interpolate(x, size=beside.shape[-2:], mode="nearest")
            x = pair(torch.cat([x, beside], dim=1))
        return torch.sigmoid(self.last(x))


class Several(nn.Module):
    """One that gives points, depth and a mask, as exports of MoGe do."""

    def __init__(self) -> None:
        super().__init__()
        self.transformer = Transformer(blocks=8)
        self.head = nn.ModuleList(
            nn.Sequential(nn.ConvTranspose2d(a, b, 2, 2), nn.GroupNorm(1, b), nn.ReLU(), nn.Conv2d(b, b, 3, padding=1, padding_mode="replicate"))
            for a, b in [(384, 96), (96, 48), (48, 32)]
        )
        self.points, self.mask = nn.Conv2d(32, 3, 1), nn.Conv2d(32, 1, 1)

    def forward(self, image: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        x = torch.stack(self.transformer(image)).sum(0)
        for part in self.head:
            x = part(x)
        x = functional.interpolate(x, size=image.shape[-2:], mode="bilinear", align_corners=False)
        straight, logarithm = self.points(x).split([2, 1], dim=1)
        depth = logarithm.exp()
        points = torch.cat([straight * depth, depth], dim=1).permute(0, 2, 3, 1)
        return points, depth.squeeze(1), torch.sigmoid(self.mask(x)).squeeze(1)
