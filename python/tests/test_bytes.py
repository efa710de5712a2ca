"""Arrays come out byte for byte as the files of the command."""

from __future__ import annotations

import itertools
import os
from pathlib import Path

import aquafuse
import cv2
import numpy as np
import pytest
from conftest import scene, succeed

BORDERED = np.pad(scene(5), ((20, 20), (0, 0), (0, 0)))


def write(path: Path, image: np.ndarray) -> Path:
    """A PNG or TIFF of 8, 16 or 32 bits."""
    assert cv2.imwrite(str(path), image[..., ::-1])
    return path


def read(path: Path) -> np.ndarray:
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED | cv2.IMREAD_IGNORE_ORIENTATION)
    assert image is not None, path
    return image[..., ::-1]


def images() -> list[np.ndarray]:
    words = scene(6).astype(np.uint16) * 257 + 3
    floats = (scene(7) / 255).astype(np.float32)
    return [scene(2), scene(3), words, floats, BORDERED]


DEPTHS = {
    "colour": None,
    "metres": np.linspace(1, 9, 120 * 160, dtype=np.float32).reshape(120, 160)[::-1].copy(),
    "inverse": np.linspace(0, 1, 120 * 160, dtype=np.float32).reshape(120, 160),
}


@pytest.mark.parametrize("model", ["physical", "aquafuse", "exchange"])
@pytest.mark.parametrize("kind", DEPTHS)
def test_fuse(tmp_path: Path, model: str, kind: str) -> None:
    reference = scene(4)
    water = write(tmp_path / "water.png", reference)
    for number, image in enumerate(images()):
        extension = "tiff" if image.dtype == np.float32 else "png"
        content = write(tmp_path / f"{number}.{extension}", image)
        output = tmp_path / f"{number}.fused.{extension}"
        options: dict[str, object] = {}
        arguments: list[str | Path] = []
        depth = DEPTHS[kind]
        if depth is not None:
            depth = np.pad(depth, ((20, 20), (0, 0)), constant_values=1) if image is BORDERED else depth
            np.save(tmp_path / "z.npy", depth)
            arguments = ["--depth", tmp_path / "z.npy", "--depth-kind", kind]
            options = {"depth": depth, "depth_kind": kind}
        succeed("fuse", content, water, "-o", output, "--overwrite", "--model", model, *arguments)
        fused = aquafuse.fuse(image, reference, model=model, **options)
        np.testing.assert_array_equal(fused, read(output))


def option_sets() -> list[dict[str, object]]:
    return [
        {"theta": 30, "alpha": 1.5},
        {"smooth": "bilateral"},
        {"depth_model": "ratio"},
        {"water_map": "rules"},
        {"water_map": "network"},
        {"border": "none"},
        {"border": (3, 4, 5, 6)},
        {"linear": True},
    ]


@pytest.mark.parametrize("options", option_sets(), ids=str)
def test_options_of_fuse(tmp_path: Path, options: dict[str, object]) -> None:
    arguments: list[str] = []
    for name, value in options.items():
        words = ",".join(map(str, value)) if isinstance(value, tuple) else str(value)
        arguments += [f"--{name.replace('_', '-')}"] + ([] if value is True else [words])
    content, water = write(tmp_path / "a.png", BORDERED), write(tmp_path / "b.png", scene(4))
    succeed("fuse", content, water, "-o", tmp_path / "c.png", *arguments)
    np.testing.assert_array_equal(aquafuse.fuse(BORDERED, scene(4), **options), read(tmp_path / "c.png"))


def test_waters_from_files_and_presets(tmp_path: Path) -> None:
    content, water = write(tmp_path / "a.png", scene(2)), write(tmp_path / "b.png", scene(4))
    succeed("water", "extract", water, "-o", tmp_path / "b.water.json")
    assert aquafuse.Water.open(tmp_path / "b.water.json").to_json() == (tmp_path / "b.water.json").read_text()
    for source in ["preset:jerlov-3C", str(tmp_path / "b.water.json"), str(water)]:
        for extra in [{}, {"model": "exchange", "visibility": 12.0}]:
            arguments = [f"--{name}={value}" for name, value in extra.items()]
            succeed("fuse", content, source, "-o", tmp_path / "c.png", "--overwrite", *arguments)
            np.testing.assert_array_equal(aquafuse.fuse(scene(2), source, **extra), read(tmp_path / "c.png"))


def test_restore_and_enhance(tmp_path: Path) -> None:
    for number, image in enumerate(images()[:3]):
        content = write(tmp_path / f"{number}.png", image)
        output = tmp_path / "out.png"
        succeed("restore", content, "-o", output, "--overwrite")
        np.testing.assert_array_equal(aquafuse.restore(image), read(output))
        succeed("restore", content, "-o", output, "--overwrite", "--max-gain", "5", "--white", "none")
        np.testing.assert_array_equal(aquafuse.restore(image, max_gain=5, white="none"), read(output))
        succeed("enhance", content, "-o", output, "--overwrite", "--strength", "0.7")
        np.testing.assert_array_equal(aquafuse.enhance(image, strength=0.7), read(output))
        succeed("enhance", content, "preset:jerlov-I", "-o", output, "--overwrite")
        np.testing.assert_array_equal(aquafuse.enhance(image, "preset:jerlov-I"), read(output))


def test_simulate(tmp_path: Path) -> None:
    depth = DEPTHS["metres"]
    np.save(tmp_path / "z.npy", depth)
    content, output = write(tmp_path / "a.png", scene(2)), tmp_path / "out.png"
    for linear, keep in itertools.product([False, True], repeat=2):
        flags = ["--linear"] * linear + ["--keep-light"] * keep
        words = ["simulate", content, tmp_path / "z.npy", "preset:jerlov-3C", "-o", output, "--overwrite"]
        succeed(*words, "--depth-kind", "metres", *flags)
        made = aquafuse.simulate(scene(2), depth, "preset:jerlov-3C", depth_kind="metres", linear=linear, keep_light=keep)
        np.testing.assert_array_equal(made, read(output))


def test_depth(tmp_path: Path) -> None:
    content = write(tmp_path / "a.png", scene(2))
    for model in ["eq3", "ratio", "layout"]:
        succeed("depth", content, "-o", tmp_path / "z.npy", "--overwrite", "--depth-model", model)
        np.testing.assert_array_equal(aquafuse.depth(scene(2), model=model), np.load(tmp_path / "z.npy"))


def test_real_images(tmp_path: Path) -> None:
    folder = os.environ.get("AQUAFUSE_TEST_DATA")
    if not folder:
        pytest.skip("AQUAFUSE_TEST_DATA names no folder of images")
    found = sorted(path for path in Path(folder).rglob("*") if path.suffix in (".jpg", ".png"))
    photos = [image for path in found[:400:50] if (image := cv2.imread(str(path), cv2.IMREAD_COLOR)) is not None]
    photos = [np.ascontiguousarray(image[:768, :1024, ::-1]) for image in photos if min(image.shape[:2]) > 16]
    if not photos:
        pytest.skip("the folder holds no images")
    water = write(tmp_path / "water.png", photos[0])
    for number, (image, model) in enumerate(itertools.product(photos, ["physical", "exchange"])):
        content, output = write(tmp_path / f"{number}.png", image), tmp_path / f"{number}.fused.png"
        succeed("fuse", content, water, "-o", output, "--model", model)
        np.testing.assert_array_equal(aquafuse.fuse(image, photos[0], model=model), read(output))
