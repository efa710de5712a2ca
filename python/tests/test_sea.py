"""Drawn waters and the light of the other water."""

from __future__ import annotations

import pickle
import random
from pathlib import Path

import aquafuse
import cv2
import numpy as np
import pytest
from aquafuse import ArgumentError, Fuser, Water, example
from aquafuse._draws import Key, WaterSampler, library
from conftest import scene, succeed


def test_a_drawn_water_is_the_same_by_number_and_by_name() -> None:
    reef = example.reef()
    by_name = aquafuse.fuse(reef, "sea:12", model="relight")
    assert np.array_equal(by_name, Fuser(Water.sea(12), model="relight").fuse(reef))
    assert not np.array_equal(by_name, aquafuse.fuse(reef, "sea:13", model="relight"))
    assert library("sea") == [] and library(["sea", "sea:13"]) == ["sea:13"]


def test_each_draw_from_the_sea_is_another_water() -> None:
    sampler = WaterSampler("sea", theta_range=(0.0, 0.0), seed=3)
    numbers = [sampler.keyed(Key("reef.jpg", epoch)).sea for epoch in range(40)]
    assert len(set(numbers)) == 40
    again = pickle.loads(pickle.dumps(sampler))
    assert [again.keyed(Key("reef.jpg", epoch)).sea for epoch in range(40)] == numbers
    drawn = sampler.keyed(Key("reef.jpg"))
    reef = example.reef()
    assert np.array_equal(sampler.fuser(drawn).fuse(reef, theta=0.0), Fuser(f"sea:{drawn.sea}", water_map="rules").fuse(reef, theta=0.0))
    both = WaterSampler(["sea", "preset:jerlov-3C", "preset:jerlov-I"], seed=3)
    drawn_waters = [both.keyed(Key("reef.jpg", epoch)).water for epoch in range(40)]
    assert sorted(drawn_waters) == [0] * 10 + [1] * 10 + [2] * 10 + [3] * 10
    assert len({both.random(random.Random(seed)).sea for seed in range(40)}) > 10


def test_waters_of_a_dataset_are_drawn_from_the_sea_as_the_command_does(tmp_path: Path) -> None:
    (tmp_path / "fish").mkdir()
    for number in range(4):
        cv2.imwrite(str(tmp_path / "fish" / f"{number}.png"), scene(number)[..., ::-1])
    succeed("augment", tmp_path / "fish", "preset:jerlov-I", "--waters", "sea", "--keep-share", "0.4", "-o", tmp_path / "command")
    aquafuse.augment(tmp_path / "fish", ["sea", "preset:jerlov-I"], tmp_path / "python", keep_share=0.4, progress=False)
    made = [{path.name: path.read_bytes() for path in (tmp_path / by).iterdir()} for by in ("command", "python")]
    assert made[0] == made[1] and any("__sea__" in name for name in made[0])
    with pytest.raises(ArgumentError, match="keep_originals"):
        aquafuse.augment(tmp_path / "fish", "sea", tmp_path / "no", keep_share=0.4, keep_originals=True)
    with pytest.raises(ArgumentError, match="keep_share is 2"):
        aquafuse.augment(tmp_path / "fish", "sea", tmp_path / "no", keep_share=2)


@pytest.mark.parametrize("name", ["sea:", "sea:many", "sea:-1", "sea:4294967296"])
def test_what_is_no_number_is_refused(name: str) -> None:
    with pytest.raises(ArgumentError):
        aquafuse.fuse(example.reef(), name)


def test_a_water_keeps_the_light_in_its_file() -> None:
    water = Water.from_image(example.reef())
    again = Water.from_json(water.to_json())
    content = example.reef(64, 96)
    both = [aquafuse.fuse(content, one, model="relight") for one in (water, again)]
    assert np.array_equal(both[0], both[1])
