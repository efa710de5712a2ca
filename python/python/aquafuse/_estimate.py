"""Depth and water of an image, estimated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, final

from aquafuse import _native
from aquafuse._network import DepthModel
from aquafuse._options import Border, Depth, DepthKind, Verdict, WaterMap, reading
from aquafuse._water import Interval, Water

# The command starts without numpy, which takes longer to import than a small image takes to fuse.
if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


@final
class Estimate:
    """What :func:`inspect` finds: depth and water of an image, and how far they can be relied on."""

    __slots__ = ("_estimate",)
    _estimate: _native.Estimate

    def __init__(self) -> None:
        raise TypeError("make an estimate by aquafuse.inspect(image)")

    @classmethod
    def _of(cls, estimate: _native.Estimate) -> Estimate:
        made = object.__new__(cls)
        made._estimate = estimate
        return made

    @property
    def verdict(self) -> Verdict:
        """``good``, ``doubtful`` (look at the image) or ``failed`` (the numbers are a guess)."""
        return self._estimate.verdict

    @property
    def reasons(self) -> list[str]:
        """What speaks against the estimate, by name; empty for a good one."""
        return self._estimate.reasons

    @property
    def reasons_in_words(self) -> list[str]:
        """The same for people."""
        return self._estimate.reasons_in_words

    @property
    def water(self) -> Water:
        """The water, for :func:`fuse` and for files."""
        return Water._of(self._estimate.water)  # pyright: ignore[reportPrivateUsage]

    @property
    def intervals(self) -> dict[str, tuple[Interval, Interval, Interval]]:
        """How far off the water may be."""
        return self.water.intervals

    @property
    def depth(self) -> npt.NDArray[np.float32]:
        """z of each pixel, of shape (height, width); NaN outside the scene."""
        return self._estimate.depth

    @property
    def depth_kind(self) -> Literal["metres", "relative"]:
        """The unit of z; relative depth is 0 at the camera and at most 1."""
        return self._estimate.depth_kind

    @property
    def depth_range(self) -> Interval:
        """The 5th and the 95th percentile of z."""
        return self._estimate.depth_range

    @property
    def invalid_depth_share(self) -> float | None:
        """The share of supplied depth that was not valid and was filled from the rest and from colour; ``None`` for depth from colour."""
        return self._estimate.invalid_depth_share

    @property
    def border(self) -> tuple[int, int, int, int]:
        """Rows and columns that surround the scene: top, right, bottom, left."""
        return self._estimate.border

    @property
    def open_water(self) -> tuple[float, float]:
        """The mean share of open water in the pixels, and how likely it is that open water is in view; both 0 to 1."""
        return self._estimate.open_water

    def plot(self) -> npt.NDArray[np.uint8]:
        """The sheet of ``aquafuse inspect --plots``, of shape (height, width, 3)."""
        return self._estimate.plot()

    def __repr__(self) -> str:
        near, far = self.depth_range
        reasons = f" ({', '.join(self.reasons)})" if self.reasons else ""
        return f"<Estimate: {self.verdict}{reasons}, depth {near:.2f} to {far:.2f} {self.depth_kind}, {self.water!r}>"

    def _repr_html_(self) -> str:
        from aquafuse._html import estimate

        return estimate(self)


def inspect(
    image: Any,
    *,
    depth: Depth = None,
    depth_kind: DepthKind | None = None,
    depth_model: DepthModel = "eq3",
    water_map: WaterMap = "both",
    border: Border = "auto",
    name: str = "array",
) -> Estimate:
    """Estimates depth and water of an image.

    Args:
        image: An array of shape (height, width, 3) and dtype uint8, uint16 or float32 (0 to 1).
        depth: As in :func:`fuse`.
        depth_kind: As in :func:`fuse`.
        depth_model: As in :class:`Fuser`.
        water_map: As in :class:`Fuser`.
        border: What surrounds the scene: ``auto``, ``none`` or (top, right, bottom, left).
        name: How the water names its source.

    Raises:
        ArrayError: The image or its depth has a wrong shape, dtype or value.
        FileError: A network cannot be read, or gives no depth.

    >>> from aquafuse import example, inspect
    >>> found = inspect(example.reef())
    >>> found.depth.shape, found.verdict in ("good", "doubtful")
    ((96, 128), True)
    """
    settings = reading(depth_model, water_map, border, linear=False)
    return Estimate._of(  # pyright: ignore[reportPrivateUsage]
        _native.inspect(image, depth, depth_kind, settings, name)
    )
