"""Drawn waters and the light of the other water."""

from __future__ import annotations

import numpy as np
import pytest

import aquafuse
from aquafuse import ArgumentError, Fuser, Water, example
from aquafuse._draws import library


def test_a_drawn_water_is_the_same_by_number_and_by_name() -> None:
    reef = example.reef()
    by_name = aquafuse.fuse(reef, "sea:12", model="relight")
    assert np.array_equal(by_name, Fuser(Water.sea(12), model="relight").fuse(reef))
    assert not np.array_equal(by_name, aquafuse.fuse(reef, "sea:13", model="relight"))
    assert len(set(library("sea"))) == 32


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
