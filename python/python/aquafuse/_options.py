"""Options in the form in which the compiled part takes them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

from aquafuse._network import DepthModel, native_model

if TYPE_CHECKING:
    from aquafuse import _native

Model: TypeAlias = Literal["physical", "relight", "aquafuse", "exchange"]
DepthKind: TypeAlias = Literal["metres", "millimetres", "relative", "inverse", "disparity"]
WaterMap: TypeAlias = Literal["both", "network", "rules", "published"]
Smoothing: TypeAlias = Literal["none", "bilateral"]
Setting: TypeAlias = Literal["auto", "none"]
Verdict: TypeAlias = Literal["good", "doubtful", "failed"]
Depth: TypeAlias = Any | Callable[[Any], Any]
"""A map of shape (height, width), or a callable that gives one for a scene."""
Border: TypeAlias = Literal["auto", "none"] | tuple[int, int, int, int] | None


class Reading(TypedDict):
    """How depth and water of an image are estimated."""

    depth_model: str | _native.DepthNetwork
    water_map: str
    border: str
    linear: bool


def border_text(border: Border) -> str:
    """A border as the command writes it."""
    if border is None:
        return "none"
    if isinstance(border, str):
        return border
    return ",".join(str(side) for side in border)


def reading(depth_model: DepthModel, water_map: WaterMap, border: Border, linear: bool) -> Reading:
    """Checks nothing: the compiled part does."""
    return {
        "depth_model": native_model(depth_model),
        "water_map": water_map,
        "border": border_text(border),
        "linear": linear,
    }


def maps(water_map: WaterMap | None) -> tuple[WaterMap, WaterMap]:
    """What finds open water in an image that gives its water, and in those that are trained on."""
    return water_map or "both", water_map or "rules"


def levels(white: Setting, exposure: Setting, strength: float) -> dict[str, Any]:
    """How levels are set."""
    return {"white": white, "exposure": exposure, "strength": strength}
