"""The frames of a video: what they have in common changes smoothly."""

from __future__ import annotations

from typing import Any, NamedTuple, final

from aquafuse import _native
from aquafuse._fuser import Fuser, ImageT
from aquafuse._network import DepthModel
from aquafuse._options import Border, Model, Setting, Smoothing, Verdict, WaterMap, border_text, levels, reading
from aquafuse._water import WaterSource, as_water

STEADY_OVER = 8


class FrameReport(NamedTuple):
    """What is known of the water that a frame was taken in."""

    verdict: Verdict
    """The verdict on its estimate."""
    reasons: list[str]
    """What speaks against it."""


@final
class Sequence:
    """Puts the frames of a video into one water, in their order. The bytes are those of ``aquafuse video``.

    Each frame would have an estimate of its own, and a video would flicker. Here water and levels are means over about
    ``steady_over`` frames; at a cut they begin again. No frame is delayed. Frames are arrays as in :func:`aquafuse.fuse`, all of one
    dtype. Depth by a network (``depth_model``) is found for each of them, which takes long and may flicker.

    Args:
        water: As in :class:`aquafuse.Fuser`, with the options after it.
        content_water: The water that the frames were taken in, if it is known. Default: estimated.
        steady_over: Over how many frames means are taken, 1 to 100000; with 1 each frame is by itself.
        water_map: As in :class:`aquafuse.Fuser`; the network looks at every eighth frame, and at a new scene.

    Raises:
        ArgumentError: An option has a value that it cannot have.
        FileError: The file of a water cannot be read.

    A sequence has a state: make one for each video, and give its frames from one thread at a time.

    >>> from aquafuse import Sequence, example
    >>> steady = Sequence("preset:jerlov-3C")
    >>> frames = [steady.next(frame) for frame in (example.reef(), example.reef())]
    >>> frames[1].shape
    (96, 128, 3)
    """

    __slots__ = ("_sequence",)
    _sequence: _native.Sequence

    def __init__(
        self,
        water: WaterSource,
        *,
        content_water: WaterSource | None = None,
        steady_over: int = STEADY_OVER,
        model: Model = "physical",
        theta: float | None = None,
        alpha: float | None = None,
        smooth: Smoothing = "none",
        depth_model: DepthModel = "eq3",
        water_map: WaterMap = "both",
        border: Border = "auto",
        metres_at_one: float | None = None,
        visibility: float | None = None,
    ) -> None:
        fuser = Fuser(
            water,
            model=model,
            theta=theta,
            alpha=alpha,
            smooth=smooth,
            depth_model=depth_model,
            water_map=water_map,
            border=border,
            metres_at_one=metres_at_one,
            visibility=visibility,
        )
        content = None
        if content_water is not None:
            given = as_water(content_water, depth_model=depth_model, water_map=water_map, border=border)
            content = given._water
        self._sequence = _native.Sequence.fused(fuser._fuser, content, steady_over)

    @classmethod
    def restoring(
        cls,
        *,
        max_gain: float = 2.0,
        white: Setting = "auto",
        exposure: Setting = "auto",
        strength: float = 1.0,
        steady_over: int = STEADY_OVER,
        depth_model: DepthModel = "eq3",
        water_map: WaterMap = "both",
        border: Border = "auto",
    ) -> Sequence:
        """A sequence whose frames are restored, as by :func:`aquafuse.restore`.

        >>> from aquafuse import Sequence, example
        >>> Sequence.restoring(strength=0.5).next(example.reef()).shape
        (96, 128, 3)
        """
        settings, how = reading(depth_model, water_map, border, False), levels(white, exposure, strength)
        return cls._of(_native.Sequence.restored(settings, how, max_gain, steady_over))

    @classmethod
    def enhancing(
        cls,
        *,
        white: Setting = "auto",
        exposure: Setting = "auto",
        strength: float = 1.0,
        steady_over: int = STEADY_OVER,
        border: Border = "auto",
    ) -> Sequence:
        """A sequence whose levels are set, as by :func:`aquafuse.enhance` without a clear water.

        >>> from aquafuse import Sequence, example
        >>> Sequence.enhancing().next(example.reef()).shape
        (96, 128, 3)
        """
        how = levels(white, exposure, strength)
        return cls._of(_native.Sequence.enhanced(border_text(border), how, steady_over))

    @classmethod
    def _of(cls, sequence: _native.Sequence) -> Sequence:
        made = object.__new__(cls)
        made._sequence = sequence
        return made

    def next(self, frame: ImageT, *, out: ImageT | None = None) -> ImageT:
        """The next frame, changed: a new array, or ``out``, which may be ``frame`` itself.

        Raises:
            ArrayError: The frame has a wrong shape, or another dtype than those before it.
            ArgumentError: Another thread is at work on a frame of this sequence.
        """
        return self._sequence.next(frame, out)[0]

    def next_with_report(
        self, frame: ImageT, *, out: ImageT | None = None
    ) -> tuple[ImageT, FrameReport | None]:
        """As :meth:`next`, with what is known of the frame's own water; ``None`` where no water is estimated."""
        changed, report = self._sequence.next(frame, out)
        return changed, None if report is None else FrameReport(*report)

    def reset(self) -> None:
        """Forgets the frames before: the next one is a first one."""
        self._sequence.reset()

    def __reduce__(self) -> Any:
        raise TypeError("a sequence has a state and is not pickled; make one in each process")
