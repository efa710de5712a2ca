"""The network: from a small image to the share of open water, and the distance of things with its doubt."""

import torch
from torch import nn
from torch.nn import functional as F

WIDTHS = (16, 32, 48, 56)
GROUPS = 4
OUTPUTS = 3  # logit of the share of water; ln of distance up to a constant; ln of the doubt about it


class Layer(nn.Module):
    """A convolution, group normalisation, ReLU."""

    def __init__(self, into, out):
        super().__init__()
        self.conv = nn.Conv2d(into, out, 3, padding=1, bias=False)
        self.norm = nn.GroupNorm(GROUPS, out)

    def forward(self, x):
        return F.relu(self.norm(self.conv(x)))


class Network(nn.Module):
    """Down three times and up again; what was seen on the way down is added on the way up. Maps have half the image's sides."""

    def __init__(self):
        super().__init__()
        a, b, c, d = WIDTHS
        self.stem = Layer(12, a)
        self.down = nn.ModuleList(nn.Sequential(Layer(i, o), Layer(o, o)) for i, o in ((a, b), (b, c), (c, d)))
        self.narrow = nn.ModuleList(nn.Conv2d(i, o, 1, bias=False) for i, o in ((d, c), (c, b), (b, a)))
        self.up = nn.ModuleList(Layer(o, o) for o in (c, b, a))
        self.head = nn.Conv2d(a, OUTPUTS, 1)

    def forward(self, images):
        x = self.stem(F.pixel_unshuffle(2 * images - 1, 2))
        kept = [x]
        for block in self.down:
            x = block(F.avg_pool2d(x, 2))
            kept.append(x)
        kept.pop()
        for narrow, block in zip(self.narrow, self.up):
            x = block(F.interpolate(narrow(x), scale_factor=2) + kept.pop())
        return self.head(x)


def losses(found, share, ln_z, valid, known):
    """Mean losses: of the share of water where it is known, of distances up to a factor where things are, by their doubt."""
    of_share = F.binary_cross_entropy_with_logits(found[:, 0], share, reduction="none")
    of_share = (of_share * known).sum() / known.sum().clamp(min=1)
    off = found[:, 1] - ln_z
    count = valid.sum((1, 2), keepdim=True).clamp(min=1)
    off = (off - (off * valid).sum((1, 2), keepdim=True) / count).abs()
    doubt = found[:, 2].clamp(-4, 3)
    by_doubt = off * torch.exp(-doubt) + doubt
    enough = (count > 0.05 * valid[0].numel()).float() * valid
    total = enough.sum().clamp(min=1)
    return of_share, (by_doubt * enough).sum() / total, (off * enough).sum() / total
