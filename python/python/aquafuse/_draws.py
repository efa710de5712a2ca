"""Which water, theta and alpha a sample gets."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

from aquafuse import _native
from aquafuse._errors import ArgumentError
from aquafuse._fuser import Fuser
from aquafuse._network import DepthModel, shared_model
from aquafuse._options import Border, Model, Smoothing, WaterMap, maps
from aquafuse._water import SEA, Water, as_water

PRESETS = "presets"
"""The name of the library of all presets."""
DRAWN = "sea"
"""What asks for waters drawn from the sea."""
_ENDS = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp", ".water.json")


@dataclass(frozen=True)
class Key:
    """What a draw depends on, beside the seed: neither workers nor order change it.

    Args:
        name: The name of the sample, for example its path within the dataset.
        epoch: The epoch. Over epochs each water comes once before any comes again.
        draw: The number of the draw, where one sample is drawn several times in an epoch.
    """

    name: str
    epoch: int = 0
    draw: int = 0


class Drawn(NamedTuple):
    """What a sample gets; ``water`` is ``None`` where the sample stays as it is."""

    water: int | None
    theta: float
    alpha: float
    sea: int = 0
    """The number of the water, where ``water`` is behind all named ones: one of the sea."""


class _Random(Protocol):
    def random(self) -> float: ...


def library(waters: Sequence[str] | str) -> list[str]:
    """Each named water: ``presets`` and folders are replaced by what they hold, in order; ``sea`` names none.

    >>> library("presets")[:2]
    ['preset:jerlov-I', 'preset:jerlov-IA']
    """
    found: list[str] = []
    for name in _listed(waters):
        if name == PRESETS:
            found += [f"preset:{preset}" for preset in Water.presets()]
        elif name == DRAWN:
            continue
        elif not name.startswith(("preset:", SEA)) and Path(name).is_dir():
            inside = sorted(str(path) for path in Path(name).iterdir() if path.name.lower().endswith(_ENDS))
            if not inside:
                raise ArgumentError(f"{name} holds no images and no *.water.json files; name a folder that does")
            found += inside
        else:
            found.append(name)
    if not found and not has_sea(waters):
        raise ArgumentError('there is no water to draw from; give at least one, for example "presets"')
    return found


def has_sea(waters: Sequence[str] | str) -> bool:
    """Whether waters are drawn from the sea, a new one each time.

    >>> has_sea("sea"), has_sea(["sea", "presets"]), has_sea("sea:3")
    (True, True, False)
    """
    return DRAWN in _listed(waters)


def _listed(waters: Sequence[str] | str) -> list[str]:
    return [str(name) for name in ([waters] if isinstance(waters, (str, os.PathLike)) else waters)]


class WaterSampler:
    """Waters, and how one of them is drawn for a sample. What :mod:`aquafuse.albumentations` and others share."""

    def __init__(
        self,
        waters: Sequence[str] | str = PRESETS,
        *,
        model: Model = "physical",
        theta_range: tuple[float, float] = (0.0, 60.0),
        alpha_range: tuple[float, float] = (1.0, 1.0),
        share: float = 1.0,
        seed: int = 0,
        smooth: Smoothing = "none",
        depth_model: DepthModel = "eq3",
        water_map: WaterMap | None = None,
        border: Border = "auto",
        linear: bool = False,
    ) -> None:
        if not 0.0 <= share <= 1.0:
            raise ArgumentError(f"share is {share}; give a number from 0 (none) to 1 (every sample)")
        # A list where it was read from JSON.
        self.theta_range = (theta_range[0], theta_range[1])
        self.alpha_range = (alpha_range[0], alpha_range[1])
        self.share = share
        self._seed = seed
        self._draws = self._make_draws()
        self._model, self._smooth, self._border, self._linear = model, smooth, border, linear
        self._depth_model, self._maps = shared_model(depth_model), maps(water_map)
        self.fusers = [self._make_fuser(water) for water in library(waters)]
        # As `aquafuse augment`: every second water is one of the sea if there are others.
        self._choices = len(self.fusers) + (max(1, len(self.fusers)) if has_sea(waters) else 0)

    def _make_fuser(self, water: str) -> Fuser:
        of_stills, of_samples = self._maps
        return Fuser(
            as_water(
                water, depth_model=self._depth_model, water_map=of_stills, border=self._border, linear=self._linear
            ),
            model=self._model,
            smooth=self._smooth,
            depth_model=self._depth_model,
            water_map=of_samples,
            border=self._border,
            linear=self._linear,
        )

    def fuser(self, drawn: Drawn) -> Fuser:
        """What puts an image into the water that was drawn."""
        if drawn.water is None:
            raise ArgumentError("no water was drawn: the sample stays as it is")
        return self.fusers[drawn.water] if drawn.water < len(self.fusers) else self._make_fuser(f"{SEA}{drawn.sea}")

    def _make_draws(self) -> tuple[_native.Draws, _native.Draws]:
        seed = self._seed % 2**64
        return (
            _native.Draws(seed, self.theta_range, self.alpha_range, False),
            _native.Draws(seed, (0.0, 1.0), (0.0, 1.0), False),
        )

    def keyed(self, key: Key | str) -> Drawn:
        """The draw of a key."""
        key = key if isinstance(key, Key) else Key(str(key))
        name = key.name if key.draw == 0 else f"{key.name}\n{key.draw}"
        ours, shares = self._draws
        _, at, *_ = shares.draw(f"{name}\nshare", key.epoch, 1)
        if at >= self.share:
            return Drawn(None, 0.0, 0.0)
        return Drawn(*ours.draw(name, key.epoch, self._choices))

    def random(self, random: _Random) -> Drawn:
        """A draw by a random generator of somebody else."""
        at, which, theta, alpha = (random.random() for _ in range(4))
        if at >= self.share:
            return Drawn(None, 0.0, 0.0)

        def between(range: tuple[float, float], share: float) -> float:
            return range[0] + (range[1] - range[0]) * share

        water = min(int(which * self._choices), self._choices - 1)
        sea = int(random.random() * 2**32) if water >= len(self.fusers) else 0
        return Drawn(water, between(self.theta_range, theta), between(self.alpha_range, alpha), sea)

    def __getstate__(self) -> dict[str, object]:
        return {name: value for name, value in self.__dict__.items() if name != "_draws"}

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self._draws = self._make_draws()
