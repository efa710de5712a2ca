"""Waters: from images, files and published tables."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal, TypeAlias, cast, final

from aquafuse import _native
from aquafuse._errors import ArgumentError, FileError
from aquafuse._network import DepthModel
from aquafuse._options import Border, Depth, DepthKind, Verdict, WaterMap, reading

Rgb: TypeAlias = tuple[float, float, float]
Interval: TypeAlias = tuple[float, float]
Camera: TypeAlias = Literal["daylight", "at-depth", "at-surface"]


@final
class Water:
    """A waterbody: veiling light, backscatter and attenuation, with intervals and a verdict.

    Make one by :meth:`from_image`, :meth:`open`, :meth:`preset`, :meth:`from_json` or :meth:`pool`. A water cannot be changed.
    Two waters are equal if their files are. Waters pickle as their JSON text.

    >>> water = Water.preset("jerlov-3C")
    >>> water.depth_kind, water.verdict
    ('metres', 'good')
    >>> Water.from_json(water.to_json()) == water
    True
    """

    __slots__ = ("_water",)
    _water: _native.Water

    def __init__(self) -> None:
        raise TypeError("make a water by Water.from_image, Water.open, Water.preset or Water.from_json")

    @classmethod
    def _of(cls, water: _native.Water) -> Water:
        made = object.__new__(cls)
        made._water = water
        return made

    @classmethod
    def from_image(
        cls,
        image: Any,
        *,
        depth: Depth = None,
        depth_kind: DepthKind | None = None,
        depth_model: DepthModel = "eq3",
        water_map: WaterMap = "both",
        border: Border = "auto",
        linear: bool = False,
        name: str = "array",
    ) -> Water:
        """The water that an image was taken in. Best with open water in view.

        Args:
            image: An array of shape (height, width, 3) and dtype uint8, uint16 or float32 (0 to 1).
            depth: As in :func:`aquafuse.fuse`.
            depth_kind: As in :func:`aquafuse.fuse`.
            depth_model: As in :class:`aquafuse.Fuser`.
            water_map: As in :class:`aquafuse.Fuser`.
            border: What surrounds the scene; rows and columns in numbers are then found instead.
            linear: Work in linear light instead of encoded values.
            name: How the water names its source.

        Raises:
            ArrayError: The image or its depth has a wrong shape, dtype or value.

        >>> import numpy as np
        >>> from aquafuse import example
        >>> Water.from_image(example.reef()).depth_kind
        'relative'
        """
        settings = reading(depth_model, water_map, border, linear)
        return cls._of(_native.Water.of_array(image, depth, depth_kind, settings, name))

    @classmethod
    def open(
        cls,
        path: str | os.PathLike[str],
        *,
        depth: Depth = None,
        depth_kind: DepthKind | None = None,
        depth_model: DepthModel = "eq3",
        water_map: WaterMap = "both",
        border: Border = "auto",
        linear: bool = False,
    ) -> Water:
        """The water of a file: an image (PNG, JPEG, TIFF, WebP, BMP, GIF) or a ``*.water.json``. Options as for :meth:`from_image`.

        Raises:
            FileError: The file cannot be read, or is neither.
        """
        settings = reading(depth_model, water_map, border, linear)
        return cls._of(_native.Water.of_file(os.fspath(path), depth, depth_kind, settings))

    @classmethod
    def preset(cls, name: str, *, below_surface: float = 5.0, camera: Camera = "daylight", linear: bool = False) -> Water:
        """A water of a published table, per metre.

        Args:
            name: One of :meth:`presets`, for example ``jerlov-3C``.
            below_surface: Depth of the scene below the surface in metres, 0 to 100.
            camera: White balance and exposure: ``daylight``, ``at-depth`` or ``at-surface``.
            linear: A water for linear light instead of encoded values.

        Raises:
            ArgumentError: There is no such preset or camera, or the depth is outside its range.

        >>> Water.preset("jerlov-I").colour[2] > Water.preset("jerlov-9C").colour[2]
        True
        """
        return cls._of(_native.Water.of_preset(name, below_surface, camera, linear))

    @classmethod
    def sea(cls, number: int, *, linear: bool = False) -> Water:
        """A water as the sea may show it, per metre: type, depth below the surface, camera, balance and exposure are drawn together.

        Args:
            number: Which one, 0 to 4294967295; the same number is the same water on every machine.
            linear: A water for linear light instead of encoded values.

        Raises:
            ArgumentError: The number is outside its range.

        >>> Water.sea(1) == Water.sea(1), Water.sea(1) == Water.sea(2)
        (True, False)
        """
        if not 0 <= number < 2**32:
            raise ArgumentError(f"number is {number}, but must be from 0 to {2**32 - 1}")
        return cls._of(_native.Water.of_sea(number, linear))

    @staticmethod
    def presets() -> list[str]:
        """The names of the presets, the ocean from clear to turbid, then the coast.

        >>> Water.presets()[:2]
        ['jerlov-I', 'jerlov-IA']
        """
        return _native.Water.preset_names()

    @classmethod
    def from_json(cls, text: str) -> Water:
        """The water in the text of a ``*.water.json``.

        Raises:
            FileError: The text is no water.
        """
        return cls._of(_native.Water.of_json(text))

    @classmethod
    def pool(cls, waters: Iterable[Water]) -> Water:
        """One water from several images of one place.

        Raises:
            ArgumentError: There is none, or they are per different units or of different encodings.
        """
        return cls._of(_native.Water.of_many([water._water for water in waters]))

    def to_json(self) -> str:
        """The text of a ``*.water.json``, as ``aquafuse water extract`` writes it."""
        return self._water.to_json()

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes a ``*.water.json``, whole or not at all.

        Raises:
            FileError: The name has another end, the file exists, or the system refuses.
        """
        self._water.save(os.fspath(path), overwrite)

    def with_visibility(self, distance: float) -> Water:
        """The same colours, with another distance at which 2 % of the contrast are left, in the unit of depth.

        Raises:
            ArgumentError: The water has no visibility, or a coefficient does not fit into a number.
        """
        return self._of(self._water.with_visibility(distance))

    @property
    def sources(self) -> list[str]:
        """The names of what it was made from."""
        return self._water.sources

    @property
    def depth_kind(self) -> Literal["metres", "relative"]:
        """The unit of z that the coefficients are per."""
        return self._water.depth_kind

    @property
    def encoding(self) -> Literal["encoded", "linear"]:
        """The values that it belongs to."""
        return self._water.encoding

    @property
    def verdict(self) -> Verdict:
        """``good``, ``doubtful`` or ``failed``."""
        return self._water.verdict

    @property
    def reasons(self) -> list[str]:
        """What speaks against the estimate; empty for a good one."""
        return self._water.reasons

    @property
    def veiling_light(self) -> Rgb:
        """B∞ of red, green and blue, 0 to 1, in the encoding of the water."""
        return self._water.veiling_light

    @property
    def colour(self) -> Rgb:
        """B∞ as it looks: encoded, 0 to 1."""
        return self._water.colour

    @property
    def backscatter_coefficient(self) -> Rgb:
        """β_B per unit of z."""
        return self._water.backscatter_coefficient

    @property
    def attenuation(self) -> tuple[tuple[float, float, float, float], ...]:
        """μ5 to μ8 of β_D for red, green and blue."""
        return self._water.attenuation

    @property
    def attenuation_held_beyond(self) -> Rgb:
        """The distances beyond which β_D is constant."""
        return self._water.attenuation_held_beyond

    @property
    def intervals(self) -> dict[str, tuple[Interval, Interval, Interval]]:
        """How far off ``veiling_light`` and ``backscatter_coefficient`` may be, for red, green and blue."""
        return {
            "veiling_light": self._water.veiling_light_interval,
            "backscatter_coefficient": self._water.backscatter_coefficient_interval,
        }

    @property
    def visibility(self) -> float | None:
        """How far one sees, in the unit of z; ``None`` if farther than can be said."""
        return self._water.visibility

    def illumination(self, z: float) -> Rgb:
        """What is left of the direct signal at distance z (Eq. 6)."""
        return self._water.illumination(z)

    def backscatter(self, z: float) -> Rgb:
        """The backscatter at distance z (Eq. 5)."""
        return self._water.backscatter(z)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Water):
            return NotImplemented
        return self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(self.to_json())

    def __reduce__(self) -> tuple[Any, ...]:
        preset = self._water.preset
        if preset is not None:
            name, below_surface, camera = preset
            return _preset, (name, below_surface, camera, self.encoding == "linear")
        return Water.from_json, (self.to_json(),)

    def __repr__(self) -> str:
        colour = ", ".join(f"{value:.3f}" for value in self.colour)
        return f"<Water of {', '.join(self.sources)}: colour ({colour}), per {self.depth_kind}, {self.verdict}>"

    def _repr_html_(self) -> str:
        from aquafuse._html import water

        return water(self)


def _preset(name: str, below_surface: float, camera: Camera, linear: bool) -> Water:
    return Water.preset(name, below_surface=below_surface, camera=camera, linear=linear)


WaterSource: TypeAlias = Water | str | os.PathLike[str] | Any


SEA = "sea:"


def as_water(
    source: WaterSource,
    *,
    depth: Depth = None,
    depth_kind: DepthKind | None = None,
    depth_model: DepthModel = "eq3",
    water_map: WaterMap = "both",
    border: Border = "auto",
    linear: bool = False,
) -> Water:
    """A water, ``preset:NAME``, ``sea:NUMBER``, the path of an image or of a ``*.water.json``, or an image, as a water."""
    if isinstance(source, Water):
        return source
    if isinstance(source, str) and source.startswith("preset:"):
        return Water.preset(source.removeprefix("preset:"), linear=linear)
    if isinstance(source, str) and source.startswith(SEA):
        number = source.removeprefix(SEA)
        if not number.isdecimal():
            raise ArgumentError(f"{source} is no water; write sea:NUMBER, as sea:12")
        return Water.sea(int(number), linear=linear)
    if isinstance(source, (str, os.PathLike)):
        path = Path(cast("str | os.PathLike[str]", source))
        if str(path) in Water.presets() and not path.exists():
            raise FileError(f"there is no file {path}; did you mean preset:{path}?")
        return Water.open(
            path, depth=depth, depth_kind=depth_kind, depth_model=depth_model, water_map=water_map, border=border, linear=linear
        )
    return Water.from_image(
        source, depth=depth, depth_kind=depth_kind, depth_model=depth_model, water_map=water_map, border=border, linear=linear
    )
