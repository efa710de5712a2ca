"""Scenes in 3D, as ``aquafuse scene`` makes them: splats trained on a CPU, with the water in them.

A scene is a folder of images (in ``images/``, or directly in it) and their cameras, as COLMAP or nerfstudio writes them.
``aquafuse scene sfm`` finds cameras; ``scene view`` and ``scene compare`` write pages.

All runs stop at Ctrl-C, or at an exception of ``on_event``: every file that was written is complete, and the same call continues
the run. The files are those of the command, byte for byte.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias, cast

from aquafuse import _native
from aquafuse._network import DepthModel, shared_model
from aquafuse._options import Model, Smoothing, reading
from aquafuse._runs import Listener, OnEvent
from aquafuse._water import SEA, WaterSource, as_water

__all__ = ["Fused", "Rendered", "Scores", "Trained", "fuse", "render", "train"]

Name: TypeAlias = str | os.PathLike[str]


class Scores(NamedTuple):
    """How near renderings come to the images that were held out."""

    images: int
    """Images that were held out."""
    psnr: float
    """Their mean PSNR, dB."""
    ssim: float
    """Their mean SSIM."""


class Trained(NamedTuple):
    """How training ended."""

    splats: int
    """Splats in the file."""
    held_out: Scores | None
    """Scores on the images that were held out, if any were."""


class Rendered(NamedTuple):
    """How a rendering ended."""

    done: int
    """Views that this run rendered."""
    skipped: int
    """Views that a run before this one rendered."""


class Fused(NamedTuple):
    """How the fusion of a scene ended."""

    done: int
    """Images that this run fused."""
    skipped: int
    """Images that a run before this one fused."""
    unit: float | None
    """Relative depth 1 in units of the scene; none where the scene has no points."""


def train(
    scene: Name,
    output: Name,
    *,
    water: Literal["none", "learn"] = "none",
    iterations: int = 2000,
    seed: int = 0,
    sh_degree: int = 0,
    splats: int = 100_000,
    longest: int = 400,
    hold: int | None = None,
    images: Name | None = None,
    skip_missing: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
    max_memory: int | None = None,
    on_event: OnEvent | None = None,
    progress: bool = True,
) -> Trained:
    """Trains splats on a scene's images.

    Args:
        scene: A folder with cameras and images.
        output: FILE.ply; a learned water goes to FILE.water.json.
        water: ``none`` leaves the water in the colours, ``learn`` estimates it.
        iterations: Training steps, each of one image, 1 to 1,000,000.
        seed: Random seed.
        sh_degree: Spherical-harmonics degree, 0 to 3; 0 for no view dependence.
        splats: Maximum number of splats. Time and memory grow with it.
        longest: Images are scaled down to this many pixels on their longer side, 16 to 65,535.
        hold: Hold every Nth image out of training, and score the result on them.
        images: The folder of the images; by default ``images`` in the scene, or the scene itself.
        skip_missing: Train without the images that are not there.
        overwrite: Replace the output, and start from the beginning.
        threads: Number of threads; by default as many as :func:`aquafuse.get_threads` says. No byte depends on it.
        max_memory: Bytes that training may take; by default 2 GiB.
        on_event: Called with an :class:`aquafuse.Event` for each step, in this thread.
        progress: Show progress by ``tqdm``, if it is installed.

    Raises:
        RunError: The scene cannot be trained: its cameras, its images or its size do not fit.
        FileError: A file cannot be read, or exists and may not be replaced.
        ArgumentError: An option has a value that it cannot have.

    >>> from aquafuse import scene
    >>> scene.train("no folder", "reef.ply")
    Traceback (most recent call last):
    ...
    aquafuse._errors.RunError: ...
    """
    asked = {
        "scene": os.fspath(scene),
        "output": os.fspath(output),
        "images": None if images is None else os.fspath(images),
        "skip_missing": skip_missing,
        "iterations": iterations,
        "seed": seed,
        "sh_degree": sh_degree,
        "water": water,
        "splats": splats,
        "longest": longest,
        "hold": hold,
        "overwrite": overwrite,
    }
    with Listener(on_event, progress, "step") as listener:
        made, scores = _native.train_scene(asked, _limits(threads, max_memory), listener)
    return Trained(made, None if scores is None else Scores(*scores))


def render(
    splats: Name,
    scene: Name,
    output: Name,
    *,
    water: WaterSource | Literal["none"] | None = None,
    visibility: float | None = None,
    metres_per_unit: float = 1.0,
    orbit: int | None = None,
    depth: bool = False,
    longest: int = 400,
    overwrite: bool = False,
    threads: int | None = None,
    max_memory: int | None = None,
    on_event: OnEvent | None = None,
    progress: bool = True,
) -> Rendered:
    """Renders a trained scene from its cameras, or from an orbit around it, and writes the cameras beside the views.

    Args:
        splats: A trained scene, FILE.ply.
        scene: The folder with its cameras.
        output: A folder, for NAME.png of each camera.
        water: What the scene is seen through: ``none`` for air, or a water; by default the learned one.
        visibility: How far one sees in that water, in metres.
        metres_per_unit: Metres in one unit of the scene, which a water per metre needs.
        orbit: So many views of an orbit instead of those of the cameras.
        depth: Also write distances, NAME.depth.tiff, in units of the scene; 0 where nothing is opaque.
        longest: Pixels on the longer side, 16 to 16,384.
        overwrite: Replace images that exist.
        max_memory: Bytes that a view may take; by default 2 GiB.

    The other options are those of :func:`train`.

    Raises:
        RunError: The scene cannot be rendered.
        FileError: A file cannot be read, or exists and may not be replaced.
        ArgumentError: An option has a value that it cannot have.

    >>> from aquafuse import scene
    >>> scene.render("missing.ply", "no folder", "views")
    Traceback (most recent call last):
    ...
    aquafuse._errors.RunError: ...
    """
    is_air = isinstance(water, str) and water == "none"
    through = None if water is None or is_air else as_water(water, border="none", water_map="rules")
    asked = {
        "splats": os.fspath(splats),
        "scene": os.fspath(scene),
        "output": os.fspath(output),
        "air": is_air,
        "water": None if through is None else through._water,  # pyright: ignore[reportPrivateUsage]
        "visibility": visibility,
        "metres_per_unit": metres_per_unit,
        "orbit": orbit,
        "depth": depth,
        "longest": longest,
        "overwrite": overwrite,
    }
    with Listener(on_event, progress, "view") as listener:
        return Rendered(*_native.render_scene(asked, _limits(threads, max_memory), listener))


def fuse(
    scene: Name,
    water: WaterSource,
    output: Name,
    *,
    model: Model = "physical",
    theta: float | None = None,
    alpha: float | None = None,
    smooth: Smoothing = "none",
    depth_model: DepthModel = "eq3",
    metres_at_one: float | None = None,
    visibility: float | None = None,
    skip_missing: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
    max_memory: int | None = None,
    on_event: OnEvent | None = None,
    progress: bool = True,
) -> Fused:
    """Fuses all images of a scene with another water, by the one water that they share.

    Depth is scaled by the sparse points, so that the result is consistent across views. The cameras are copied: the new folder is a
    scene like the old one.

    Args:
        scene: A folder with cameras and images.
        water: A :class:`aquafuse.Water`, ``preset:NAME``, ``sea:NUMBER``, the path of an image or of a ``*.water.json``, or an image.
        output: A folder that is new, empty, or of a run to continue.
        overwrite: Write into a folder that is not empty, and replace images of the same names.
        threads: Images in work at once; by default one for each core.
        max_memory: Bytes that all images in work share; by default 2 GiB.

    The other options are those of :class:`aquafuse.Fuser` and of :func:`train`.

    Raises:
        RunError: The scene cannot be fused.
        FileError: A file cannot be read, or exists and may not be replaced.
        ArgumentError: An option has a value that it cannot have.

    >>> from aquafuse import scene
    >>> scene.fuse("no folder", "preset:jerlov-3C", "green")
    Traceback (most recent call last):
    ...
    aquafuse._errors.RunError: ...
    """
    model_of_depth = shared_model(depth_model)
    source = as_water(water, depth_model=model_of_depth, border="none", water_map="rules")
    asked = {
        "scene": os.fspath(scene),
        "water": source._water,  # pyright: ignore[reportPrivateUsage]
        "water_file": _file_of(water),
        "output": os.fspath(output),
        "model": model,
        "theta": theta,
        "alpha": alpha,
        "smooth": smooth,
        "metres_at_one": metres_at_one,
        "visibility": visibility,
        "skip_missing": skip_missing,
        "overwrite": overwrite,
    }
    how = reading(model_of_depth, "rules", "none", False)
    with Listener(on_event, progress) as listener:
        return Fused(*_native.fuse_scene(asked, how, _limits(threads, max_memory), listener))


def _file_of(water: WaterSource) -> str | None:
    """The file that a water is read from, if it is."""
    if isinstance(water, str):
        return None if water.startswith(("preset:", SEA)) else water
    return str(Path(cast("os.PathLike[str]", water))) if isinstance(water, os.PathLike) else None


def _limits(threads: int | None, max_memory: int | None) -> dict[str, Any]:
    return {"threads": threads, "max_memory": max_memory}
