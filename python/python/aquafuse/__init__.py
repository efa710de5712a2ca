"""Moves the waterbody of one underwater image into another, by physics in closed form.

The scene stays the same: only the water between the camera and the objects is exchanged.

>>> import aquafuse
>>> reef = aquafuse.example.reef()
>>> fused = aquafuse.fuse(reef, "preset:jerlov-3C")
>>> fused.shape == reef.shape
True

Images are arrays of shape (height, width, 3), RGB, uint8, uint16 or float32 (0 to 1). Results are new arrays and equal those of
the ``aquafuse`` command, byte for byte. Other threads of Python run while an image is worked on; they must not write into it
meanwhile. Every error is an :class:`AquaFuseError`.
"""

from __future__ import annotations

import sys

from aquafuse import _native, evaluate, example, metrics, scene
from aquafuse._augment import Summary, augment
from aquafuse._errors import AquaFuseError, ArgumentError, ArrayError, FileError, InternalError, RunError
from aquafuse._estimate import Estimate, inspect
from aquafuse._fuser import Fuser, Report, fuse
from aquafuse._network import DepthNetwork
from aquafuse._operations import depth, enhance, restore, simulate
from aquafuse._runs import Event
from aquafuse._sequence import FrameReport, Sequence
from aquafuse._water import Water

__all__ = [
    "AquaFuseError",
    "ArgumentError",
    "ArrayError",
    "DepthNetwork",
    "Estimate",
    "Event",
    "FileError",
    "FrameReport",
    "Fuser",
    "InternalError",
    "Report",
    "RunError",
    "Sequence",
    "Summary",
    "Water",
    "augment",
    "depth",
    "enhance",
    "evaluate",
    "example",
    "fuse",
    "get_threads",
    "inspect",
    "metrics",
    "restore",
    "scene",
    "set_threads",
    "simulate",
]

__version__: str = _native.__version__


def set_threads(threads: int) -> None:
    """Sets how many threads one call uses in this process, 1 to 512. Results do not depend on it.

    The default is one for each core, and one in worker processes of ``multiprocessing`` and of data loaders.

    >>> import aquafuse
    >>> aquafuse.set_threads(1)
    >>> aquafuse.get_threads()
    1
    """
    _native.set_threads(threads)


def get_threads() -> int:
    """How many threads one call uses in this process."""
    return _native.get_threads()


# A worker that was spawned shares the cores with others, as one that was forked does.
_process = sys.modules.get("multiprocessing.process")
if _process is not None and _process.parent_process() is not None:
    _native.set_threads(1)
del _process
