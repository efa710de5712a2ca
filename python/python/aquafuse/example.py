"""A small synthetic scene, for documentation and first steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

__all__ = ["reef"]


def reef(height: int = 96, width: int = 128) -> npt.NDArray[np.uint8]:
    """A textured bottom that fades into blue water above, of shape (height, width, 3).

    >>> from aquafuse import example
    >>> example.reef().shape
    (96, 128, 3)
    """
    import numpy as np

    rows, columns = np.mgrid[0:height, 0:width]
    distance = 1.0 - rows / max(height - 1, 1)
    texture = 0.5 + 0.3 * np.sin(columns / 3.0) * np.cos(rows / 4.0)
    clear = np.stack([0.9 * texture, 0.7 * texture, 0.5 * texture], axis=-1)
    light = np.exp(-distance[..., None] * np.array([3.5, 1.6, 1.2]))
    water = np.array([0.08, 0.42, 0.55]) * (1.0 - np.exp(-4.0 * distance[..., None]))
    seen: npt.NDArray[np.float64] = np.minimum(clear * light + water, 1.0)
    return np.round(255.0 * seen).astype(np.uint8)
