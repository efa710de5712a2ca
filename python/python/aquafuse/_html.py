"""Waters and estimates in a notebook."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from aquafuse._estimate import Estimate
    from aquafuse._water import Water

_WIDTH, _HEIGHT, _STEPS = 240, 80, 48
_STROKES = ("#c0392b", "#27ae60", "#2980b9")


def _hex(rgb: tuple[float, float, float]) -> str:
    return "#" + "".join(f"{round(255 * min(max(value, 0.0), 1.0)):02x}" for value in rgb)


def _curves(water: Water) -> str:
    """The illumination of red, green and blue by distance, as a drawing."""
    far = 20.0 if water.depth_kind == "metres" else 1.0
    distances = [far * step / _STEPS for step in range(_STEPS + 1)]
    lines: list[str] = []
    for channel, stroke in enumerate(_STROKES):
        points = " ".join(f"{_WIDTH * z / far:.1f},{_HEIGHT * (1 - water.illumination(z)[channel]):.1f}" for z in distances)
        lines.append(f'<polyline points="{points}" fill="none" stroke="{stroke}"/>')
    unit = "m" if water.depth_kind == "metres" else "of relative depth"
    title = f"<title>illumination E from 0 to {far:g} {unit}</title>"
    return f'<svg width="{_WIDTH}" height="{_HEIGHT}" style="border:1px solid #999">{title}{"".join(lines)}</svg>'


def water(shown: Water) -> str:
    """A swatch of the veiling light, the curves of the illumination, and the verdict."""
    swatch = f'<div style="width:80px;height:{_HEIGHT}px;background:{_hex(shown.colour)}"></div>'
    reasons = f" ({escape(', '.join(shown.reasons))})" if shown.reasons else ""
    text = f"{escape(', '.join(shown.sources))}: {_hex(shown.colour)}, {shown.verdict}{reasons}"
    return f'<div style="display:flex;gap:8px;align-items:center">{swatch}{_curves(shown)}<div>{text}</div></div>'


def estimate(shown: Estimate) -> str:
    """The water, and the range of depth."""
    near, far = shown.depth_range
    unit = "m" if shown.depth_kind == "metres" else "of relative depth"
    return f"{water(shown.water)}<div>depth {near:.2f} to {far:.2f} {unit} (5 % to 95 %)</div>"
