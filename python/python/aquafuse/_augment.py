"""Datasets multiplied: each image in other waters, with its annotations."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal, NamedTuple

from aquafuse import _native
from aquafuse._draws import has_sea, library
from aquafuse._errors import ArgumentError
from aquafuse._network import DepthModel, shared_model
from aquafuse._options import Border, DepthKind, Model, Smoothing, WaterMap, reading
from aquafuse._runs import Listener, OnEvent
from aquafuse._water import SEA, as_water

Layout = Literal["folder", "coco", "yolo", "voc", "masks", "shards"]


class Summary(NamedTuple):
    """How a run ended."""

    done: int
    """Images whose variants were made."""
    skipped: int
    """Images whose variants a run before this one made."""
    failed: int
    """Images that failed."""
    left: int
    """Images that were not tried."""
    failures: list[str]
    """The messages of the failures."""


def augment(
    dataset: str | os.PathLike[str],
    waters: Sequence[str | os.PathLike[str]] | str,
    output: str | os.PathLike[str],
    *,
    per_image: int = 1,
    keep_share: float | None = None,
    keep_originals: bool = False,
    seed: int = 0,
    with_replacement: bool = False,
    theta_range: tuple[float, float] | None = None,
    alpha_range: tuple[float, float] | None = None,
    on_doubtful: str = "flag",
    on_bad_annotation: Literal["refuse", "skip", "keep"] = "refuse",
    layout: Layout | None = None,
    splits: str | None = None,
    sidecars: Sequence[str] = (),
    preview: int = 4,
    shard: tuple[int, int] = (1, 1),
    overwrite: bool = False,
    quality: int = 95,
    threads: int | None = None,
    max_errors: int | None = None,
    depth: str | os.PathLike[str] | None = None,
    depth_kind: DepthKind | None = None,
    depth_resize: bool = False,
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
    on_event: OnEvent | None = None,
    progress: bool = True,
) -> Summary:
    """Multiplies a dataset; the files are those of ``aquafuse augment``, byte for byte.

    Ctrl-C, or an exception of ``on_event``, stops the run: all written files are complete, and the same call continues it.

    Args:
        dataset: Its folder: images, COCO, YOLO, VOC, masks or WebDataset shards; see ``aquafuse augment --help``.
        waters: ``presets``, ``preset:NAME``, ``sea`` (a water drawn for each variant), ``sea:NUMBER``, images,
            ``*.water.json`` files, and folders of both.
        output: A folder that is new, empty, or of a run to continue.
        per_image: Number of variants of each image, 1 to 10,000.
        keep_share: The share of the images written that are copies of originals, 0 to 1, each copied at most once; 0.25 by
            default.
        keep_originals: Copy all original images; not with ``keep_share``.
        seed: Draws depend only on it, the image's path and the number of the variant.
        with_replacement: One image may get one water twice.
        theta_range: Least and greatest angle in degrees, instead of ``theta``.
        alpha_range: Least and greatest gain, instead of ``alpha``.
        on_doubtful: ``flag``, ``skip`` or ``preset:NAME``, for doubtful estimates.
        on_bad_annotation: What to do about bad annotations.
        layout: The layout of the dataset; by default it is detected.
        splits: ``all``, or some of ``train,val,test``; by default the training split, if there is one beside others. Images of
            other splits are copied.
        sidecars: Extensions of further files that belong to the images of the same name.
        preview: Images on the sheet ``preview.jpg``, 0 to 100; 0 for no sheet.
        shard: Part I of N, as (I, N), for several machines.
        overwrite: Delete what a run with other settings wrote, and start over.
        quality: JPEG quality, 1 to 100.
        threads: Number of threads; by default one for each core.
        max_errors: Stop when more images than this have failed.
        depth: A folder of depth maps with the same stems. A network is ``depth_model``.
        depth_kind: What the values of those maps are.
        depth_resize: Accept maps of another size and the same proportions.
        on_event: Called with an :class:`Event` for each image, in this thread.
        progress: Show progress by ``tqdm``, if it is installed.

    The other options are those of :class:`Fuser`.

    Raises:
        RunError: The run cannot begin: the dataset, the waters or the output do not fit.
        ArgumentError: An option has a value that it cannot have.

    >>> import tempfile
    >>> import aquafuse
    >>> with tempfile.TemporaryDirectory() as empty:
    ...     aquafuse.augment(empty, "presets", empty + "/more")
    Traceback (most recent call last):
    ...
    aquafuse._errors.RunError: ...
    """
    if keep_originals and keep_share is not None:
        raise ArgumentError("keep_originals copies all originals; leave keep_share out, or keep_originals")
    if keep_share is not None and not 0.0 <= keep_share <= 1.0:
        raise ArgumentError(f"keep_share is {keep_share}; give a number from 0 to 1")
    if callable(depth):
        raise ArgumentError(
            "augment runs in threads of its own and calls nothing for depth; pass depth_model=\"FILE.onnx\", or write maps "
            "first and pass their folder as depth"
        )
    # Once for all waters and images.
    depth_model = shared_model(depth_model)
    how = reading(depth_model, water_map, border, linear)
    named = [_named(name, depth_model, water_map, border, linear) for name in library(_texts(waters))]
    instead = _named(on_doubtful, depth_model, water_map, border, linear) if on_doubtful.startswith("preset:") else None
    _native.Draws(seed, theta_range or (0.0, 0.0), alpha_range or (0.0, 0.0), with_replacement)
    with Listener(on_event, progress, failures_end_items=True) as listener:
        counts = _native.augment(
            os.fspath(dataset),
            named,
            os.fspath(output),
            how,
            {
                "layout": layout,
                "splits": splits,
                "sidecars": list(sidecars),
                "preview": preview,
                "per_image": per_image,
                "keep_originals": keep_originals,
                "keep_share": 0.0 if keep_originals else 0.25 if keep_share is None else keep_share,
                "sea": has_sea(_texts(waters)),
                "seed": seed,
                "with_replacement": with_replacement,
                "theta_range": theta_range,
                "alpha_range": alpha_range,
                "on_doubtful": on_doubtful,
                "instead": instead,
                "on_bad_annotation": on_bad_annotation,
                "shard": shard,
                "overwrite": overwrite,
                "quality": quality,
                "threads": threads,
                "max_errors": max_errors,
                "depth": None if depth is None else os.fspath(depth),
                "depth_kind": depth_kind,
                "depth_resize": depth_resize,
                "model": model,
                "theta": theta,
                "alpha": alpha,
                "smooth": smooth,
                "metres_at_one": metres_at_one,
                "visibility": visibility,
            },
            listener,
        )
    return Summary(*counts, listener.failures)


def _texts(waters: Sequence[str | os.PathLike[str]] | str) -> list[str]:
    return [waters] if isinstance(waters, str) else [os.fspath(name) for name in waters]


def _named(
    name: str, depth_model: DepthModel, water_map: WaterMap, border: Border, linear: bool
) -> tuple[str, _native.Water, str | None]:
    """A water by its name, and its file if it has one."""
    water = as_water(name, depth_model=depth_model, water_map=water_map, border=border, linear=linear)
    path = None if name.startswith(("preset:", SEA)) else str(Path(name))
    return name, water._water, path  # pyright: ignore[reportPrivateUsage]
