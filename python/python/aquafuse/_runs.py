"""What runs over many images report, and how their progress is shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple

Kind = Literal["started", "done", "skipped", "failed"]


class Event(NamedTuple):
    """What a run reports."""

    kind: Kind
    """``started``, then for each item ``done``, ``skipped`` (a run before this one made it) or ``failed``. In an evaluation what fails
    is ``done`` after that."""
    item: str
    """The item: an image by its path within the dataset, or the number of a step."""
    message: str
    """Of a failure: the file, the cause, and what to do. Of a step of training: how many splats there are, and the loss."""
    total: int
    """Of the start: how many items there are."""


OnEvent = Callable[[Event], object]


class Listener:
    """Passes events on, counts, and shows progress by tqdm if it is installed."""

    def __init__(
        self, on_event: OnEvent | None, progress: bool, unit: str = "image", failures_end_items: bool = False
    ) -> None:
        self.on_event = on_event
        self._ends = ("done", "skipped", "failed") if failures_end_items else ("done", "skipped")
        self.failures: list[str] = []
        self._bar: Any = None
        self._progress = progress
        self._unit = unit

    def __call__(self, kind: Kind, item: str, message: str, total: int) -> None:
        if kind == "started" and self._progress:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                pass
            else:
                self._bar = tqdm(total=total, unit=self._unit)
        if kind == "failed":
            self.failures.append(message)
        if kind in self._ends and self._bar is not None:
            self._bar.update(1)
        if self.on_event is not None:
            self.on_event(Event(kind, item, message, total))

    def __enter__(self) -> Listener:
        return self

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.close()
