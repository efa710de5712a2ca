"""Scores: how alike two images are, and how good one looks.

As in the paper, a fused image is compared with its content: a high score says that little was lost, not that the water is
right.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from aquafuse import _native

__all__ = ["Scores", "depth_rmse", "psnr", "scores", "ssim"]


class Scores(NamedTuple):
    """Scores of one image; for each but lightness, more is held to be better. All are fooled by oversaturation and noise."""

    uciqe: float
    """UCIQE."""
    uiqm: float | None
    """UIQM; ``None`` for images smaller than 10 x 10."""
    colour: float
    """Deviation of chroma, the first part of UCIQE."""
    contrast: float
    """Contrast of lightness, the second part of UCIQE."""
    sharpness: float | None
    """UISM, the second part of UIQM."""
    lightness: float
    """Mean of all values, 0 to 1."""


def psnr(a: Any, b: Any) -> float:
    """The peak signal-to-noise ratio of two images of one shape and dtype, in decibels; infinite for equal images.

    >>> from aquafuse import example, metrics
    >>> metrics.psnr(example.reef(), example.reef())
    inf
    """
    return _native.psnr(a, b)


def ssim(a: Any, b: Any) -> float | None:
    """The structural similarity of luma, 1 for equal images; ``None`` for images smaller than its window.

    >>> from aquafuse import example, metrics
    >>> round(metrics.ssim(example.reef(), example.reef()), 6)
    1.0
    """
    return _native.ssim(a, b)


def depth_rmse(a: Any, b: Any, *, model: str = "eq3") -> float:
    """How far the depths differ that are estimated from two images, in percent of their range; 0 is best.

    >>> from aquafuse import example, metrics
    >>> metrics.depth_rmse(example.reef(), example.reef())
    0.0
    """
    return _native.depth_rmse(a, b, str(model))


def scores(image: Any) -> Scores:
    """Scores of an image that need no other one.

    >>> from aquafuse import example, metrics
    >>> 0 < metrics.scores(example.reef()).lightness < 1
    True
    """
    return Scores(*_native.scores(image))
