"""Fusion: an image in another water."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar, final

from aquafuse import _native
from aquafuse._errors import ArgumentError
from aquafuse._network import DepthModel, native_model, shared_model
from aquafuse._options import Border, Depth, DepthKind, Model, Smoothing, Verdict, WaterMap, border_text
from aquafuse._water import Water, WaterSource, as_water

ImageT = TypeVar("ImageT")


class Report(NamedTuple):
    """What a fusion did to an image."""

    verdict: Verdict
    """The verdict on the estimate of the content."""
    reasons: list[str]
    """What speaks against that estimate."""
    contrast_left: float
    """The share of the contrast that is left: thick water hides a scene."""
    change: float
    """How much the image changed: the mean distance of colours in CIELab (ΔE 1976)."""
    limited: bool
    """Whether a safety bound acted."""
    vanished: bool
    """Whether the water hides the scene."""


@final
class Fuser:
    """Puts images into one water, which is estimated once.

    Args:
        water: A :class:`Water`, ``"preset:NAME"``, the path of an image or of a ``*.water.json``, or an image.
        model: ``physical`` adds the whole veil, ``relight`` also changes the light on near things, ``aquafuse`` is the paper to
            the letter and subtle, ``exchange`` replaces the whole water.
        theta: Angle of incidence in degrees, 0 (all) to 90 (no change). Default: 0; 45 for ``aquafuse``.
        alpha: Gain on the colour of the water, 0 or more. Default: 1.
        smooth: ``none`` or ``bilateral``.
        depth: A callable that gives the depth of each image, and of ``water`` if that is an image; as in :func:`fuse`.
        depth_kind: What the values of its maps are; required with it.
        depth_model: How depth is estimated otherwise: from colour by ``eq3``, ``ratio``, ``ulap``, ``udepth``, ``layout``,
            ``network`` or FILE.toml of ``aquafuse fit``; or by a network, FILE.onnx or a :class:`DepthNetwork`.
        water_map: What says where open water is: ``rules``, ``network`` (a network of 145 kB that is part of this package and was
            trained on synthetic scenes alone), ``both`` together, which is best and takes 2 ms more an image, or ``published``, the
            paper's way.
        border: What surrounds the scene and is left as it is: ``auto``, ``none`` or (top, right, bottom, left).
        linear: Work in linear light instead of encoded values.
        metres_at_one: Distance in metres of relative depth 1, where a water per metre meets relative depth.
        visibility: How far one sees in the water, 0.1 to 1000 metres; for ``exchange`` alone.

    Raises:
        ArgumentError: An option has a value that it cannot have.
        FileError: The file of the water or of a network cannot be read.

    A fuser pickles if its callable does, so it can be sent to worker processes. It may be used by several threads at once.

    >>> from aquafuse import Fuser, example
    >>> fuser = Fuser("preset:jerlov-3C", theta=30)
    >>> fuser.fuse(example.reef()).shape
    (96, 128, 3)
    """

    __slots__ = ("_fuser", "_settings", "_water")
    _fuser: _native.Fuser
    _water: Water
    _settings: dict[str, Any]

    def __init__(
        self,
        water: WaterSource,
        *,
        model: Model = "physical",
        theta: float | None = None,
        alpha: float | None = None,
        smooth: Smoothing = "none",
        depth: Callable[[Any], Any] | None = None,
        depth_kind: DepthKind | None = None,
        depth_model: DepthModel = "eq3",
        water_map: WaterMap = "both",
        border: Border = "auto",
        linear: bool = False,
        metres_at_one: float | None = None,
        visibility: float | None = None,
    ) -> None:
        if depth is not None and not callable(depth):
            raise ArgumentError("an array is the depth of one image; pass it to fuse(image, depth=...), or pass a callable")
        # The same for the water and for all images.
        depth_model = shared_model(depth_model)
        found = as_water(
            water, depth=depth, depth_kind=depth_kind, depth_model=depth_model, water_map=water_map, border=border, linear=linear
        )
        self._set(
            found,
            {
                "model": model,
                "theta": theta,
                "alpha": alpha,
                "smooth": smooth,
                "depth_model": depth_model,
                "water_map": water_map,
                "border": border_text(border),
                "linear": linear,
                "metres_at_one": metres_at_one,
                "visibility": visibility,
                "keep_lightness": False,
                "depth": depth,
                "depth_kind": depth_kind,
            },
        )

    def _set(self, water: Water, settings: dict[str, Any]) -> None:
        self._water = water
        self._settings = settings
        native = settings | {"depth_model": native_model(settings["depth_model"])}
        self._fuser = _native.Fuser(water._water, native)  # pyright: ignore[reportPrivateUsage]

    @classmethod
    def _of(cls, water: Water, settings: dict[str, Any]) -> Fuser:
        made = object.__new__(cls)
        made._set(water, settings)
        return made

    @property
    def water(self) -> Water:
        """The water that images are put into."""
        return self._water

    def fuse(
        self,
        image: ImageT,
        *,
        depth: Depth = None,
        depth_kind: DepthKind | None = None,
        theta: float | None = None,
        alpha: float | None = None,
        out: ImageT | None = None,
    ) -> ImageT:
        """The image in the water; as :func:`fuse`, with ``theta`` and ``alpha`` for this image alone."""
        return self.fuse_with_report(image, depth=depth, depth_kind=depth_kind, theta=theta, alpha=alpha, out=out)[0]

    def fuse_with_report(
        self,
        image: ImageT,
        *,
        depth: Depth = None,
        depth_kind: DepthKind | None = None,
        theta: float | None = None,
        alpha: float | None = None,
        out: ImageT | None = None,
    ) -> tuple[ImageT, Report]:
        """As :meth:`fuse`, with what was done."""
        if depth is None and depth_kind is None:
            depth, depth_kind = self._settings["depth"], self._settings["depth_kind"]
        fused, report = self._fuser.fuse(image, depth, depth_kind, theta, alpha, out)
        return fused, Report(*report)

    def __reduce__(self) -> tuple[Any, ...]:
        return Fuser._of, (self._water, self._settings)

    def __repr__(self) -> str:
        model, theta, alpha = (self._settings[name] for name in ("model", "theta", "alpha"))
        return f"<Fuser model={model} theta={theta} alpha={alpha} {self._water!r}>"


def fuse(
    image: ImageT,
    water: WaterSource,
    *,
    depth: Depth = None,
    depth_kind: DepthKind | None = None,
    out: ImageT | None = None,
    model: Model = "physical",
    theta: float | None = None,
    alpha: float | None = None,
    smooth: Smoothing = "none",
    depth_model: DepthModel = "eq3",
    water_map: WaterMap = "both",
    border: Border = "auto",
    linear: bool = False,
    metres_at_one: float | None = None,
    visibility: float | None = None,
) -> ImageT:
    """Puts an image into another water. The bytes are those of ``aquafuse fuse``.

    Args:
        image: An array of shape (height, width, 3) and dtype uint8, uint16 or float32 (0 to 1), of any strides; or a tensor of
            torch on the CPU of shape (3, height, width).
        water: A :class:`Water`, ``"preset:NAME"``, the path of an image or of a ``*.water.json``, or an image.
        depth: Depth of the image, of shape (height, width) and a float or unsigned dtype; by default it is estimated from colour.
            Or a callable that estimates it: it is called in this thread with the scene, an array of shape (height, width, 3) and
            dtype uint8 without borders, and gives a map of any size (an array or a tensor), which the scene refines. It gives
            the depth of ``water`` too, if that is an image.
        depth_kind: What the values of ``depth`` are; required with it. Larger is farther in ``metres``, ``millimetres`` and
            ``relative`` (0 to 1), nearer in ``inverse`` (monocular networks) and ``disparity``.
        out: Where the result goes, of the same shape and dtype; it may be ``image`` itself.

    The other options are those of :class:`Fuser`, which keeps the water for the next image.

    Returns:
        A new array of the same shape and dtype, or ``out``.

    Raises:
        ArrayError: An array has a wrong shape, dtype or value.
        ArgumentError: An option has a value that it cannot have.
        FileError: The file of the water cannot be read.

    >>> import numpy as np
    >>> from aquafuse import example, fuse
    >>> reef = example.reef()
    >>> fused = fuse(reef, "preset:jerlov-3C")
    >>> fused.dtype, bool((fused != reef).any())
    (dtype('uint8'), True)
    >>> bool(np.array_equal(fuse(reef, "preset:jerlov-3C", theta=90), reef))
    True
    """
    fuser = Fuser(
        water,
        model=model,
        theta=theta,
        alpha=alpha,
        smooth=smooth,
        depth=depth if callable(depth) else None,
        depth_kind=depth_kind if callable(depth) else None,
        depth_model=depth_model,
        water_map=water_map,
        border=border,
        linear=linear,
        metres_at_one=metres_at_one,
        visibility=visibility,
    )
    return fuser.fuse(image, depth=depth, depth_kind=depth_kind, out=out)
