"""Options in the form in which the compiled part takes them."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias, TypedDict

Model: TypeAlias = Literal["physical", "relight", "aquafuse", "exchange"]
DepthKind: TypeAlias = Literal["metres", "millimetres", "relative", "inverse", "disparity"]
Smoothing: TypeAlias = Literal["none", "bilateral"]
Setting: TypeAlias = Literal["auto", "none"]
Verdict: TypeAlias = Literal["good", "doubtful", "failed"]
Border: TypeAlias = Literal["auto", "none"] | tuple[int, int, int, int] | None


class Reading(TypedDict):
    """How depth and water of an image are estimated."""

    depth_model: str
    border: str
    linear: bool


def border_text(border: Border) -> str:
    """A border as the command writes it."""
    if border is None:
        return "none"
    if isinstance(border, str):
        return border
    return ",".join(str(side) for side in border)


def reading(depth_model: str, border: Border, linear: bool) -> Reading:
    """Checks nothing: the compiled part does."""
    return {"depth_model": str(depth_model), "border": border_text(border), "linear": linear}


def levels(white: Setting, exposure: Setting, strength: float) -> dict[str, Any]:
    """How levels are set."""
    return {"white": white, "exposure": exposure, "strength": strength}
