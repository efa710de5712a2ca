"""Depth by a callable, and by a network from a file."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from pathlib import Path

import aquafuse
import cv2
import numpy as np
import pytest
from aquafuse import DepthNetwork, Fuser, Water
from conftest import scene, succeed
from onnx_files import mean_of_channels

COAST = "preset:jerlov-3C"


def by_brightness(image: np.ndarray) -> np.ndarray:
    """A map that follows the image, as a network's does."""
    return image.astype(np.float32).mean(axis=2) / 255 + 0.1


def read(path: str) -> np.ndarray:
    return cv2.imread(path)[..., ::-1]


def write(path: Path | str, image: np.ndarray) -> None:
    cv2.imwrite(str(path), image[..., ::-1])


@pytest.mark.parametrize("kind", ["metres", "relative", "inverse", "disparity"])
def test_a_callable_is_the_map_that_it_gives(reef: np.ndarray, kind: str) -> None:
    image = reef if kind != "relative" else reef // 2

    def results(depth: object) -> list[np.ndarray]:
        given = {"depth": depth, "depth_kind": kind}
        return [
            aquafuse.fuse(image, COAST, model="exchange", **given),
            Fuser(COAST).fuse(image, **given),
            aquafuse.restore(image, **given),
            aquafuse.enhance(image, COAST, **given),
            aquafuse.simulate(image, water=COAST, **given),
            aquafuse.inspect(image, **given).depth,
            np.array(Water.from_image(image, **given).attenuation),
        ]

    other = aquafuse.fuse(image, COAST, model="exchange")
    called, given = results(by_brightness), results(by_brightness(image))
    for ours, theirs in zip(called, given, strict=True):
        np.testing.assert_array_equal(ours, theirs)
    assert (called[0] != other).any()


def test_it_is_called_with_the_scene_in_bytes_and_in_the_thread_of_the_caller() -> None:
    seen: list[tuple[tuple[int, ...], str, bool, bool]] = []

    def watched(image: np.ndarray) -> np.ndarray:
        here = threading.current_thread() is threading.main_thread()
        seen.append((image.shape, str(image.dtype), image.flags.c_contiguous and image.flags.writeable, here))
        return by_brightness(image)

    barred = np.zeros((140, 160, 3), np.uint8)
    barred[10:130] = scene(1)
    for image in (barred, barred.astype(np.float32) / 255, barred.astype(np.uint16) * 257):
        fused = aquafuse.fuse(image, COAST, depth=watched, depth_kind="relative")
        assert fused.shape == image.shape and fused.dtype == image.dtype
        np.testing.assert_array_equal(fused[:10], image[:10])
    assert seen == [((120, 160, 3), "uint8", True, True)] * 3


def test_a_small_map_is_refined_by_the_image(reef: np.ndarray) -> None:
    # Near on the left, far on the right.
    small = np.tile(np.linspace(2, 8, 16, dtype=np.float32), (12, 1))
    found = aquafuse.inspect(reef, depth=lambda _: small, depth_kind="metres")
    assert found.depth.shape == reef.shape[:2] and found.depth_kind == "metres"
    assert 2 <= found.depth.min() < found.depth.max() <= 8
    assert found.depth[:, :20].mean() + 3 < found.depth[:, -20:].mean()
    with pytest.raises(aquafuse.ArrayError, match="the map is 16x12"):
        aquafuse.inspect(reef, depth=small, depth_kind="metres")


def test_the_water_of_an_image_has_its_depth_by_the_callable_too(tmp_path: Path, reef: np.ndarray) -> None:
    other = scene(2)
    write(tmp_path / "other.png", other)
    given = {"depth": by_brightness, "depth_kind": "relative"}
    water = Water.from_image(other, **given)
    fuser = Fuser(other, model="exchange", **given)
    assert fuser.water == water
    expected = Fuser(water, model="exchange").fuse(reef, **given)
    np.testing.assert_array_equal(fuser.fuse(reef), expected)
    np.testing.assert_array_equal(aquafuse.fuse(reef, tmp_path / "other.png", model="exchange", **given), expected)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(fuser)).fuse(reef), expected)


def test_what_a_callable_may_not_do_is_named(reef: np.ndarray) -> None:
    def raises(_: np.ndarray) -> np.ndarray:
        raise KeyError("weights")

    with pytest.raises(KeyError, match="weights"):
        aquafuse.restore(reef, depth=raises, depth_kind="inverse")
    with pytest.raises(aquafuse.ArgumentError, match="depth_kind"):
        aquafuse.restore(reef, depth=by_brightness)
    for bad, word in [
        (None, "NoneType"),
        (np.zeros((2, 120, 160), np.float32), r"\(height, width\)"),
        (np.zeros((120, 160), np.int64), "float"),
        (np.full((120, 160), np.nan, np.float32), "valid"),
        (np.ones((120, 160), np.float32), "scale"),
    ]:
        with pytest.raises(aquafuse.ArrayError, match=word):
            aquafuse.restore(reef, depth=lambda _, bad=bad: bad, depth_kind="inverse")
    with pytest.raises(aquafuse.ArgumentError, match="depth of one image"):
        Fuser(COAST, depth=np.ones((120, 160)), depth_kind="metres")  # type: ignore[arg-type]
    with pytest.raises(aquafuse.ArgumentError, match="calls nothing"):
        aquafuse.augment(".", [COAST], "more", depth=by_brightness)  # type: ignore[arg-type]


def test_tensors_are_maps(reef: np.ndarray) -> None:
    torch = pytest.importorskip("torch")
    weight = torch.ones(1, requires_grad=True)
    fused = aquafuse.fuse(
        reef, COAST, depth=lambda image: weight * torch.from_numpy(image).float().mean(2) / 255 + 0.1, depth_kind="relative"
    )
    expected = aquafuse.fuse(reef, COAST, depth=by_brightness, depth_kind="relative")
    np.testing.assert_allclose(fused.astype(int), expected.astype(int), atol=1)


def test_a_network_has_the_bytes_of_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, reef: np.ndarray) -> None:
    monkeypatch.chdir(tmp_path)
    mean_of_channels(Path("net.onnx"), output="depths")
    write("reef.png", reef)
    write("other.png", scene(2))
    words = ["--depth-model", "net.onnx", "--depth-model-kind", "inverse", "--depth-model-size", "98"]
    succeed("fuse", "reef.png", "other.png", "-o", "fused.png", "--model", "exchange", *words)
    succeed("restore", "reef.png", "-o", "restored.png", *words)
    network = DepthNetwork("net.onnx", kind="inverse", size=98)
    fused = aquafuse.fuse(reef, "other.png", model="exchange", depth_model=network)
    np.testing.assert_array_equal(fused, read("fused.png"))
    np.testing.assert_array_equal(aquafuse.restore(reef, depth_model=network), read("restored.png"))
    assert (fused != aquafuse.fuse(reef, "other.png", model="exchange")).any()


def test_what_is_wrong_with_a_network_is_said_in_the_words_of_python(tmp_path: Path, reef: np.ndarray) -> None:
    path = mean_of_channels(tmp_path / "net.onnx", output="depths")
    with pytest.raises(aquafuse.FileError, match="kind=inverse"):
        DepthNetwork(path)
    with pytest.raises(aquafuse.FileError, match="negative.*kind=inverse"):
        aquafuse.depth(reef, model=DepthNetwork(path, kind="relative"))


def test_a_network_is_the_callable_that_does_the_same(tmp_path: Path, reef: np.ndarray) -> None:
    network = DepthNetwork(mean_of_channels(tmp_path / "net.onnx", *reef.shape[:2]))
    mean, deviation = np.float32([0.485, 0.456, 0.406]), np.float32([0.229, 0.224, 0.225])

    def same(image: np.ndarray) -> np.ndarray:
        values = ((image / np.float32(255) - mean) / deviation).mean(axis=2, dtype=np.float32)
        return values - values.min()

    ours = aquafuse.restore(reef, depth_model=network)
    theirs = aquafuse.restore(reef, depth=same, depth_kind="inverse")
    assert np.abs(ours.astype(int) - theirs).max() <= 1
    z = aquafuse.inspect(reef, depth=same, depth_kind="inverse").depth
    np.testing.assert_allclose(aquafuse.depth(reef, model=network), z, atol=1e-5)


def test_a_network_is_an_object(tmp_path: Path, reef: np.ndarray) -> None:
    path = mean_of_channels(tmp_path / "net.onnx")
    network = DepthNetwork(path, size=98)
    assert (network.path, network.kind, network.size) == (str(path), "inverse", 98)
    assert network == DepthNetwork(path, kind="inverse", size=98) and network != DepthNetwork(path)
    fuser = Fuser(COAST, depth_model=network)
    again = pickle.loads(pickle.dumps(fuser))
    np.testing.assert_array_equal(again.fuse(reef), fuser.fuse(reef))
    packed = pickle.dumps(network)
    mean_of_channels(path, output="disparity")
    with pytest.raises(aquafuse.FileError, match="changed"):
        pickle.loads(packed)
    with pytest.raises(aquafuse.ArgumentError, match="inverse, metric or relative"):
        DepthNetwork(path, kind="near")  # type: ignore[arg-type]
    with pytest.raises(aquafuse.FileError, match="size"):
        DepthNetwork(path, size=5)
    path.write_bytes(b"no network")
    with pytest.raises(aquafuse.FileError, match="ONNX"):
        aquafuse.depth(reef, model=str(path))
    mean_of_channels(path)
    with pytest.raises(aquafuse.FileError, match="0 s"):
        DepthNetwork(path, seconds=0)


def test_the_first_frame_of_a_sequence_by_a_network_is_that_image(tmp_path: Path, reef: np.ndarray) -> None:
    network = DepthNetwork(mean_of_channels(tmp_path / "net.onnx"), size=98)
    frames = aquafuse.Sequence(COAST, depth_model=network)
    fused = Fuser(COAST, depth_model=network).fuse(reef)
    np.testing.assert_array_equal(frames.next(reef), fused)
    assert not np.array_equal(fused, Fuser(COAST).fuse(reef)) and frames.next(reef).shape == reef.shape


def test_a_dataset_is_multiplied_with_a_network(tmp_path: Path) -> None:
    photos = tmp_path / "photos"
    photos.mkdir()
    for number in range(2):
        write(photos / f"{number}.png", scene(number))
    path = mean_of_channels(tmp_path / "net.onnx")
    made = aquafuse.augment(photos, [COAST], tmp_path / "ours", keep_originals=False, keep_share=0, depth_model=path)
    assert (made.done, made.failed) == (2, 0)
    succeed(
        "augment", photos, COAST, "-o", tmp_path / "theirs", "--keep-share", "0", "--depth-model", path
    )
    for file in sorted((tmp_path / "theirs").glob("**/*.png")):
        assert file.read_bytes() == (tmp_path / "ours" / file.relative_to(tmp_path / "theirs")).read_bytes()
    assert len(list((tmp_path / "ours").glob("**/*.png"))) == 2


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_a_network_that_was_read_works_in_a_forked_process(tmp_path: Path) -> None:
    path = mean_of_channels(tmp_path / "net.onnx")
    script = f"""
import os, sys
import aquafuse
reef = aquafuse.example.reef()
network = aquafuse.DepthNetwork({str(path)!r})
expected = aquafuse.depth(reef, model=network)
child = os.fork()
if child == 0:
    same = (aquafuse.depth(reef, model=network) == expected).all()
    try:
        aquafuse.DepthNetwork({str(path)!r})
    except aquafuse.ArgumentError as error:
        os._exit(0 if same and "forked" in str(error) else 1)
    os._exit(2)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=120)
