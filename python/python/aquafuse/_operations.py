"""Restoration, enhancement, simulation, and depth from colour."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aquafuse import _native
from aquafuse._errors import ArgumentError
from aquafuse._fuser import Fuser, ImageT
from aquafuse._network import DepthModel, native_model, shared_model
from aquafuse._options import Border, Depth, DepthKind, Model, Setting, WaterMap, border_text, levels, reading
from aquafuse._water import WaterSource, as_water

# The command starts without numpy, which takes longer to import than a small image takes to fuse.
if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


def depth(image: Any, *, model: DepthModel = "eq3") -> npt.NDArray[np.float32]:
    """Estimates depth: from colour relative, 0 at the camera, at most 1; by a network of kind ``metric`` in metres.

    Args:
        image: An array of shape (height, width, 3) and dtype uint8, uint16 or float32 (0 to 1).
        model: As ``depth_model`` of :class:`Fuser`.

    Returns:
        An array of shape (height, width). It is a guess: do not pass it back as measured depth.

    Raises:
        ArrayError: The image has a wrong shape or dtype.
        FileError: A network cannot be read, or gives no depth.

    >>> from aquafuse import depth, example
    >>> z = depth(example.reef())
    >>> z.shape, bool(0 <= z.min() <= z.max() <= 1)
    ((96, 128), True)
    """
    return _native.estimate_depth(image, native_model(model))


def restore(
    image: ImageT,
    *,
    depth: Depth = None,
    depth_kind: DepthKind | None = None,
    out: ImageT | None = None,
    max_gain: float = 2.0,
    white: Setting = "auto",
    exposure: Setting = "auto",
    strength: float = 1.0,
    depth_model: DepthModel = "eq3",
    water_map: WaterMap = "both",
    border: Border = "auto",
    linear: bool = False,
) -> ImageT:
    """Removes the water: Eq. 2, then levels. The bytes are those of ``aquafuse restore``.

    Args:
        image: As in :func:`fuse`.
        depth: As in :func:`fuse`.
        depth_kind: As in :func:`fuse`.
        out: As in :func:`fuse`.
        max_gain: Upper limit of the gain on the light of the scene, 1 to 100.
        white: White balance, ``auto`` or ``none``.
        exposure: Exposure, ``auto`` or ``none``.
        strength: How much of the levels is applied, 0 to 1.
        depth_model: As in :class:`Fuser`.
        water_map: As in :class:`Fuser`.
        border: As in :class:`Fuser`.
        linear: As in :class:`Fuser`.

    Raises:
        ArrayError: An array has a wrong shape, dtype or value.
        ArgumentError: An option has a value that it cannot have.

    >>> from aquafuse import example, restore
    >>> restore(example.reef(), white="none", exposure="none").shape
    (96, 128, 3)
    """
    settings = reading(depth_model, water_map, border, linear)
    how = levels(white, exposure, strength)
    return _native.restore(image, depth, depth_kind, settings, how, max_gain, out)


def enhance(
    image: ImageT,
    clear: WaterSource | None = None,
    *,
    out: ImageT | None = None,
    white: Setting = "auto",
    exposure: Setting = "auto",
    strength: float = 1.0,
    border: Border = "auto",
    depth: Depth = None,
    depth_kind: DepthKind | None = None,
    model: Model = "physical",
    theta: float = 0.0,
    alpha: float = 0.5,
    depth_model: DepthModel = "eq3",
    water_map: WaterMap = "both",
    linear: bool = False,
    metres_at_one: float | None = None,
    visibility: float | None = None,
) -> ImageT:
    """Makes an image clearer. The bytes are those of ``aquafuse enhance``.

    Without ``clear`` the levels of each channel are stretched, and no water is estimated: ``white``, ``exposure`` and
    ``strength`` as in :func:`restore`. With ``clear``, a clear water as in :func:`fuse`, the image is fused with it and keeps its
    lightness: the other options are those of :class:`Fuser`.

    Raises:
        ArrayError: An array has a wrong shape, dtype or value.
        ArgumentError: An option has a value that it cannot have, or ``depth`` is given without ``clear``.

    >>> from aquafuse import enhance, example
    >>> enhance(example.reef()).shape, enhance(example.reef(), "preset:jerlov-I").shape
    ((96, 128, 3), (96, 128, 3))
    """
    if clear is None:
        if depth is not None or depth_kind is not None:
            raise ArgumentError("depth has no effect without a clear water; pass clear=WATER")
        return _native.enhance(image, border_text(border), levels(white, exposure, strength), out)
    depth_model = shared_model(depth_model)
    called = depth if callable(depth) else None
    water = as_water(
        clear,
        depth=called,
        depth_kind=None if called is None else depth_kind,
        depth_model=depth_model,
        water_map=water_map,
        border=border,
        linear=linear,
    )
    fuser = Fuser._of(  # pyright: ignore[reportPrivateUsage]
        water,
        {
            "model": model,
            "theta": theta,
            "alpha": alpha,
            "smooth": "none",
            "depth_model": depth_model,
            "water_map": water_map,
            "border": border_text(border),
            "linear": linear,
            "metres_at_one": metres_at_one,
            "visibility": visibility,
            "keep_lightness": True,
            "depth": None,
            "depth_kind": None,
        },
    )
    return fuser.fuse(image, depth=depth, depth_kind=depth_kind, out=out)


def simulate(
    image: ImageT,
    depth: Depth,
    water: WaterSource,
    *,
    depth_kind: DepthKind,
    out: ImageT | None = None,
    linear: bool = False,
    keep_light: bool = False,
    metres_at_one: float | None = None,
    visibility: float | None = None,
) -> ImageT:
    """Puts an image that was taken in air under water: Eq. 1. The bytes are those of ``aquafuse simulate``.

    Args:
        image: As in :func:`fuse`.
        depth: Its depth, as in :func:`fuse`.
        water: As in :func:`fuse`. A preset also lights the scene by the daylight that reaches it.
        depth_kind: What the values of ``depth`` are.
        out: As in :func:`fuse`.
        linear: Work in linear light, which is physically more accurate.
        keep_light: Keep the light on the scene; add only the water between camera and scene.
        metres_at_one: As in :class:`Fuser`.
        visibility: As in :class:`Fuser`.

    Raises:
        ArrayError: An array has a wrong shape, dtype or value.
        ArgumentError: An option has a value that it cannot have.

    >>> import numpy as np
    >>> from aquafuse import simulate
    >>> grey = np.full((2, 200, 3), 128, np.uint8)
    >>> z = np.linspace(0.5, 10, 400, dtype=np.float32).reshape(2, 200)
    >>> dived = simulate(grey, z, "preset:jerlov-3C", depth_kind="metres")
    >>> dived.shape, dived.dtype
    ((2, 200, 3), dtype('uint8'))
    """
    found = as_water(water, border="none", linear=linear)
    native = found._water  # pyright: ignore[reportPrivateUsage]
    return _native.simulate(image, depth, depth_kind, native, metres_at_one, visibility, keep_light, out)
