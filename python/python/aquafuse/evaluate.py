"""Scores of methods, as ``aquafuse evaluate`` gives them: on your images, or on synthetic scenes whose truth is known.

>>> from aquafuse import evaluate
>>> report = evaluate.truth(exchanges=1, progress=False)
>>> sorted(report.tables), len(report.items)
(['truth'], 46)

Means have a variance and a 95 % bootstrap interval over images. Figures do not depend on the number of threads, and equal those of
the command.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, NamedTuple, TypeAlias, TypedDict, final

from aquafuse import _native
from aquafuse._network import DepthModel, DepthNetwork, native_model, shared_model
from aquafuse._options import Border, DepthKind, Model, Smoothing, WaterMap, reading
from aquafuse._runs import Listener, OnEvent
from aquafuse._water import WaterSource, as_water

__all__ = ["Failure", "Maps", "Report", "depth", "enhancement", "fusion", "truth"]

Name: TypeAlias = str | os.PathLike[str]


class Failure(TypedDict):
    """What failed, and is missing from the figures."""

    name: str
    """What it was about."""
    error: str
    """The file, the cause, and what to do."""


class Maps(NamedTuple):
    """A folder of depth maps with the stems of the images."""

    folder: Name
    """Where they are."""
    kind: DepthKind
    """What their values are."""


@final
class Report:
    """The figures of an evaluation, with its settings and the score of each result."""

    __slots__ = ("_content", "_report")
    _report: _native.Report
    _content: dict[str, Any]

    def __init__(self) -> None:
        raise TypeError("make a report by evaluate.fusion, evaluate.enhancement, evaluate.depth or evaluate.truth")

    @classmethod
    def _of(cls, report: _native.Report) -> Report:
        made = object.__new__(cls)
        made._report = report
        made._content = json.loads(report.to_json())
        return made

    @property
    def title(self) -> str:
        """What was measured."""
        return self._report.title

    @property
    def settings(self) -> dict[str, Any]:
        """Everything except the images that determines the figures."""
        return dict(self._content["settings"])

    @property
    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """The tables by name: each row has its labels, and of each score a number or its mean, variance and interval."""
        return {table["name"]: table["rows"] for table in self._content["tables"]}

    @property
    def items(self) -> list[dict[str, Any]]:
        """The scores of each result, a row each: ``pandas.DataFrame(report.items)`` takes them."""
        return list(self._content["items"])

    @property
    def failed(self) -> list[Failure]:
        """What failed, and is missing from the figures."""
        return list(self._content["failed"])

    def to_json(self) -> str:
        """All but the images, as ``aquafuse evaluate --json`` prints it."""
        return self._report.to_json()

    def to_markdown(self) -> str:
        """The tables, for people."""
        return self._report.to_markdown()

    def save(self, path: Name, *, overwrite: bool = False) -> None:
        """Writes the report: .md, .csv, .json or .html (with plots) by the name, or all of them into a folder.

        Raises:
            FileError: The name says no format, a file exists and may not be replaced, or the system refuses.
        """
        self._report.save(os.fspath(path), overwrite)

    def _repr_markdown_(self) -> str:
        return self.to_markdown()

    def __repr__(self) -> str:
        return f"<Report: {self.title}, {len(self.items)} results, {len(self.failed)} failed>"


def fusion(
    contents: Name,
    references: Name,
    output: Name | None = None,
    *,
    group_by: Literal["folder", "prefix"] | None = None,
    pairs: int | None = None,
    rivals: bool = False,
    methods: Mapping[str, Name] | None = None,
    depth: Maps | None = None,
    water_depth: Maps | None = None,
    model: Model = "physical",
    theta: float | None = None,
    alpha: float | None = None,
    smooth: Smoothing = "none",
    depth_model: DepthModel = "eq3",
    water_map: WaterMap = "both",
    border: Border = "auto",
    linear: bool = False,
    seed: int = 0,
    overwrite: bool = False,
    threads: int | None = None,
    max_memory: int | None = None,
    on_event: OnEvent | None = None,
    progress: bool = True,
) -> Report:
    """Scores fused images against their contents: the tables of the paper on your images.

    Args:
        contents: A folder of images.
        references: A folder of images that give their water; may be the same folder.
        output: Where the report is written too, as by :meth:`Report.save`.
        group_by: ``folder`` or ``prefix`` (of the name, before the first ``_``): a content then meets the references of other groups.
        pairs: So many references for each content, drawn; by default all.
        rivals: Also score colour transfer: Reinhard, Monge-Kantorovich, histogram matching, gray world.
        methods: Also score outputs of other tools: a folder for each name, with images named CONTENT__REFERENCE (stems).
        depth: Depth maps of the contents. The scores take the far and the near region from them; no method sees them.
        water_depth: The same for the references.
        seed: The seed of pairs and of the bootstrap.
        overwrite: Replace an existing report.
        threads: Number of threads; by default one for each core.
        max_memory: Bytes that all images in work share; by default 2 GiB.
        on_event: Called with an :class:`aquafuse.Event` for each step, in this thread.
        progress: Show progress by ``tqdm``, if it is installed.

    The other options are those of :class:`aquafuse.Fuser`. What the paper prints is not in the report; the command adds it.

    Raises:
        RunError: No content has a reference, or outputs of other tools cannot be matched.
        FileError: A folder cannot be read, or the report not be written. An image that fails is in :attr:`Report.failed`.
        ArgumentError: An option has a value that it cannot have.

    >>> from aquafuse import evaluate
    >>> evaluate.fusion("no folder", "no folder")
    Traceback (most recent call last):
    ...
    aquafuse._errors.FileError: ...
    """
    asked = {
        "contents": os.fspath(contents),
        "references": os.fspath(references),
        "group_by": group_by,
        "pairs": pairs,
        "rivals": rivals,
        "methods": _folders(methods),
        "depth": _maps(depth),
        "water_depth": _maps(water_depth),
        "model": model,
        "theta": theta,
        "alpha": alpha,
        "smooth": smooth,
    }
    how = reading(shared_model(depth_model), water_map, border, linear)
    with Listener(on_event, progress, "step") as listener:
        run = _run(output, overwrite, seed, threads, max_memory, listener)
        return Report._of(_native.evaluate_fusion(asked, how, run))  # pyright: ignore[reportPrivateUsage]


def enhancement(
    images: Name,
    output: Name | None = None,
    *,
    references: Name | None = None,
    clear: WaterSource | None = None,
    methods: Mapping[str, Name] | None = None,
    model: Model = "physical",
    theta: float = 0.0,
    alpha: float = 0.5,
    metres_at_one: float | None = None,
    depth_model: DepthModel = "eq3",
    water_map: WaterMap = "both",
    border: Border = "auto",
    linear: bool = False,
    seed: int = 0,
    overwrite: bool = False,
    threads: int | None = None,
    max_memory: int | None = None,
    on_event: OnEvent | None = None,
    progress: bool = True,
) -> Report:
    """Scores images before and after ``enhance`` and ``restore``, simple rivals, and other tools.

    UCIQE and UIQM need no reference, and rise with oversaturation and noise. With ``references``, PSNR and SSIM say how near each
    method comes to images that people preferred.

    Args:
        images: A folder of images.
        output: Where the report is written too.
        references: A folder of references with the same stems and sizes.
        clear: Also score fusion with this clear water, with ``model``, ``theta``, ``alpha`` and ``metres_at_one``.
        methods: Also score outputs of other tools: a folder for each name, with images of the same stems.

    The other options are those of :func:`fusion`.

    Raises:
        RunError, FileError, ArgumentError: As :func:`fusion`.

    >>> from aquafuse import evaluate
    >>> evaluate.enhancement("no folder")
    Traceback (most recent call last):
    ...
    aquafuse._errors.FileError: ...
    """
    model_of_depth = shared_model(depth_model)
    named = None
    if clear is not None:
        water = as_water(clear, depth_model=model_of_depth, water_map=water_map, border=border, linear=linear)
        name = os.fspath(clear) if isinstance(clear, (str, os.PathLike)) else ", ".join(water.sources)
        named = (name, water._water)  # pyright: ignore[reportPrivateUsage]
    asked = {
        "images": os.fspath(images),
        "references": None if references is None else os.fspath(references),
        "clear": named,
        "methods": _folders(methods),
        "model": model,
        "theta": theta,
        "alpha": alpha,
        "metres_at_one": metres_at_one,
    }
    how = reading(model_of_depth, water_map, border, linear)
    with Listener(on_event, progress) as listener:
        run = _run(output, overwrite, seed, threads, max_memory, listener)
        return Report._of(_native.evaluate_enhancement(asked, how, run))  # pyright: ignore[reportPrivateUsage]


def depth(
    pairs: Name,
    depth_kind: DepthKind,
    output: Name | None = None,
    *,
    depth_models: Sequence[DepthModel] = (),
    maps: Mapping[str, Maps] | None = None,
    seed: int = 0,
    overwrite: bool = False,
    threads: int | None = None,
    max_memory: int | None = None,
    on_event: OnEvent | None = None,
    progress: bool = True,
) -> Report:
    """Scores depth from colour, and other depth maps, against known depth.

    Scores use the pixels with known depth, after a fit of scale and shift to each image, because relative depth has neither.

    Args:
        pairs: A folder that contains ``rgb`` and ``depth``, with the same stems and sizes.
        depth_kind: What the values of the maps in ``depth`` are.
        output: Where the report is written too.
        depth_models: Also score these: files of ``aquafuse fit``, and networks. Those of the package are always scored.
        maps: Also score these maps, a folder and a kind for each name.

    The other options are those of :func:`fusion`.

    Raises:
        RunError, FileError, ArgumentError: As :func:`fusion`.

    >>> from aquafuse import evaluate
    >>> evaluate.depth("no folder", "metres")
    Traceback (most recent call last):
    ...
    aquafuse._errors.RunError: ...
    """
    asked = {
        "pairs": os.fspath(pairs),
        "depth_kind": depth_kind,
        "depth_models": [(_name(model), native_model(model)) for model in depth_models],
        "maps": [(name, kind, os.fspath(folder)) for name, (folder, kind) in (maps or {}).items()],
    }
    with Listener(on_event, progress) as listener:
        run = _run(output, overwrite, seed, threads, max_memory, listener)
        return Report._of(_native.evaluate_depth(asked, run))  # pyright: ignore[reportPrivateUsage]


def truth(
    output: Name | None = None,
    *,
    exchanges: int = 120,
    places: Literal["reef", "harbour", "wall", "open-water"] = "harbour",
    lit: Literal["jerlov", "sea"] | None = None,
    linear: bool = False,
    seed: int = 0,
    overwrite: bool = False,
    threads: int | None = None,
    max_memory: int | None = None,
    on_event: OnEvent | None = None,
    progress: bool = True,
) -> Report:
    """Scores how much of the true change each method achieves, on synthetic scenes that are the same on every machine.

    1 is the truth, 0 the content, below 0 farther from the truth than the content.

    Args:
        output: Where the report is written too.
        exchanges: Number of exchanges, each a content and a reference in another water, 1 to 100,000.
        places: Which family of places.
        lit: Scenes that are lit by their own water: the types of Jerlov, or waters drawn as ``sea:NUMBER`` is.
        linear: Form scenes, estimate and fuse in linear light.

    The other options are those of :func:`fusion`.

    Raises:
        FileError, ArgumentError: As :func:`fusion`.

    >>> from aquafuse import evaluate
    >>> evaluate.truth(exchanges=1, places="reef", progress=False).failed
    []
    """
    asked = {"exchanges": exchanges, "places": places, "lit": lit, "linear": linear}
    with Listener(on_event, progress, "exchange") as listener:
        run = _run(output, overwrite, seed, threads, max_memory, listener)
        return Report._of(_native.evaluate_truth(asked, run))  # pyright: ignore[reportPrivateUsage]


def _run(
    output: Name | None, overwrite: bool, seed: int, threads: int | None, max_memory: int | None, listener: Listener
) -> dict[str, Any]:
    return {
        "output": None if output is None else os.fspath(output),
        "overwrite": overwrite,
        "seed": seed,
        "limits": {"threads": threads, "max_memory": max_memory},
        "listener": listener,
    }


def _folders(methods: Mapping[str, Name] | None) -> list[tuple[str, str]]:
    return [(name, os.fspath(folder)) for name, folder in (methods or {}).items()]


def _maps(maps: Maps | None) -> tuple[str, str] | None:
    return None if maps is None else (os.fspath(maps[0]), maps[1])


def _name(model: DepthModel) -> str:
    return model.path if isinstance(model, DepthNetwork) else os.fspath(model)
