"""Waters, estimates and fusers as objects."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import aquafuse
import numpy as np
import pytest
from aquafuse import Fuser, Water
from conftest import scene

WATERS = [
    Water.from_image(scene(1)),
    Water.from_image(scene(2), linear=True),
    Water.preset("jerlov-3C", below_surface=9),
    Water.preset("jerlov-I", camera="at-depth", linear=True),
]


@pytest.mark.parametrize("water", WATERS, ids=repr)
def test_a_water_comes_back_from_pickle_json_and_file(tmp_path: Path, water: Water) -> None:
    path = tmp_path / "a.water.json"
    water.save(path)
    copies = [pickle.loads(pickle.dumps(water)), copy.deepcopy(water), Water.from_json(water.to_json())]
    copies.append(Water.open(path, linear=water.encoding == "linear"))
    for other in copies:
        assert other == water and hash(other) == hash(water) and repr(other) == repr(water)
    assert pickle.dumps(water) == pickle.dumps(copies[0])
    with pytest.raises(aquafuse.FileError, match="exists"):
        water.save(path)
    assert f"{water.verdict}" in water._repr_html_() and "<svg" in water._repr_html_()


def test_a_pickled_preset_keeps_its_light() -> None:
    depth = np.full((8, 200), 2, np.float32)
    image = np.full((8, 200, 3), 200, np.uint8)
    water = Water.preset("jerlov-3C", below_surface=9)
    again = pickle.loads(pickle.dumps(water))
    made = [aquafuse.simulate(image, depth, which, depth_kind="metres") for which in (water, again)]
    np.testing.assert_array_equal(*made)


def test_waters_differ() -> None:
    assert len({water.to_json() for water in WATERS}) == len(WATERS)
    assert WATERS[0] != WATERS[2] and WATERS[0] != "water"
    assert Water.pool([WATERS[0], WATERS[0]]).veiling_light == pytest.approx(WATERS[0].veiling_light)
    with pytest.raises(aquafuse.ArgumentError):
        Water.pool([])
    with pytest.raises(aquafuse.ArgumentError):
        Water.pool(WATERS)
    with pytest.raises(TypeError):
        Water()


def test_encodings_do_not_mix() -> None:
    with pytest.raises(aquafuse.ArgumentError, match="linear"):
        Fuser(WATERS[1])
    assert Fuser(WATERS[1], linear=True).fuse(scene(3)).shape == scene(3).shape


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"model": "fusion"}, "physical"),
        ({"theta": 91}, "90"),
        ({"alpha": -1}, "0 or more"),
        ({"smooth": "very"}, "bilateral"),
        ({"depth_model": "midas"}, "FILE.toml"),
        ({"water_map": "sea"}, "rules, published, network, both|rules, published, network or both"),
        ({"border": (1, 2, 3)}, "TOP,RIGHT,BOTTOM,LEFT"),
        ({"visibility": 3}, "exchange"),
        ({"visibility": 0, "model": "exchange"}, "0.1"),
        ({"metres_at_one": -2}, "metres_at_one"),
    ],
)
def test_an_option_is_refused_with_what_to_give(options: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Fuser("preset:jerlov-3C", **options)


def test_files_that_are_no_water(tmp_path: Path) -> None:
    for name, content in [("a.png", b"abc"), ("b.water.json", b"{}")]:
        (tmp_path / name).write_bytes(content)
        with pytest.raises(OSError, match=name):
            Water.open(tmp_path / name)
    with pytest.raises(aquafuse.FileError, match="did you mean preset:jerlov-3C"):
        aquafuse.fuse(scene(1), "jerlov-3C")
    with pytest.raises(aquafuse.FileError, match="missing.jpg"):
        aquafuse.fuse(scene(1), tmp_path / "missing.jpg")


def test_a_fuser_comes_back_from_pickle() -> None:
    fuser = Fuser(scene(2), theta=20, smooth="bilateral", border=(1, 0, 1, 0))
    again = pickle.loads(pickle.dumps(fuser))
    np.testing.assert_array_equal(again.fuse(scene(1)), fuser.fuse(scene(1)))
    assert repr(again) == repr(fuser)


def test_an_estimate() -> None:
    image = np.pad(scene(1), ((24, 24), (0, 0), (0, 0)))
    found = aquafuse.inspect(image)
    assert found.border == (24, 0, 24, 0) and found.depth.shape == image.shape[:2]
    assert np.isnan(found.depth[:24]).all() and np.isfinite(found.depth[24:-24]).all()
    assert len(found.reasons) == len(found.reasons_in_words)
    low, high = found.intervals["veiling_light"][0]
    assert low <= high
    assert found.plot().ndim == 3 and "<svg" in found._repr_html_() and found.verdict in repr(found)
    depth = np.linspace(1, 9, image.shape[0] * image.shape[1]).reshape(image.shape[:2])
    depth[:, :8] = np.nan
    given = aquafuse.inspect(image, depth=depth, depth_kind="metres")
    assert given.depth_kind == "metres" and given.invalid_depth_share == pytest.approx(8 / 160)


def test_metrics() -> None:
    a, b = scene(1), scene(2)
    assert aquafuse.metrics.psnr(a, a) == float("inf") and aquafuse.metrics.psnr(a, b) > 0
    assert aquafuse.metrics.ssim(a, b) < 1
    assert aquafuse.metrics.depth_rmse(a, b) >= 0
    with pytest.raises(aquafuse.ArrayError):
        aquafuse.metrics.psnr(a, b[:4])
    with pytest.raises(aquafuse.ArrayError, match="dtype"):
        aquafuse.metrics.psnr(a, b.astype(np.uint16))
