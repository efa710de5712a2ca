"""Any array is fused or refused by an exception of the family; the process never ends."""

from __future__ import annotations

import os
import pathlib

import aquafuse
import numpy as np
import pytest
from conftest import scene
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

EXAMPLES = int(os.environ.get("AQUAFUSE_EXAMPLES", "1000"))
FUSER = aquafuse.Fuser("preset:jerlov-3C", model="exchange", border="none")
DTYPES = st.sampled_from(["u1", "<u2", ">u2", "f4", ">f4", "f8", "i4", "?", "c8", "U3", "O"])
SHAPES = st.one_of(
    st.tuples(st.integers(0, 40), st.integers(0, 40), st.integers(0, 4)),
    st.tuples(st.integers(1, 40), st.integers(1, 40), st.just(3)),
    st.lists(st.integers(0, 6), max_size=5).map(tuple),
)


def fill(shape: tuple[int, ...], dtype: str, seed: int) -> np.ndarray:
    """Values of a dtype; floats also hold what is no number."""
    random = np.random.default_rng(seed)
    kind = np.dtype(dtype).kind
    if kind == "f":
        values = random.uniform(-0.5, 1.5, shape)
        odd = random.choice([np.nan, np.inf, -np.inf, 1e30], shape)
        return np.where(random.random(shape) < 0.05, odd, values).astype(dtype)
    if kind in "ui":
        return random.integers(0, 256 ** min(np.dtype(dtype).itemsize, 2), shape).astype(dtype)
    return random.random(shape).astype(dtype)


@st.composite
def arranged(draw: st.DrawFn) -> np.ndarray:
    """An array in some order in memory: strided, mirrored, Fortran, broadcast, read-only, misaligned."""
    image = fill(draw(SHAPES), draw(DTYPES), draw(st.integers(0, 2**32)))
    how = draw(st.sampled_from(["plain", "fortran", "mirrored", "strided", "read-only", "broadcast", "misaligned"]))
    if how == "fortran":
        image = np.asfortranarray(image)
    elif how == "mirrored" and image.ndim:
        image = image[..., ::-1]
    elif how == "strided" and image.ndim:
        image = np.repeat(image, 2, axis=0)[::2]
    elif how == "broadcast" and image.ndim and image.shape[0]:
        image = np.broadcast_to(image[:1], image.shape)
    elif how == "misaligned" and image.dtype.kind != "O":
        memory = np.empty(image.nbytes + 1, np.uint8)[1:]
        copy = memory.view(image.dtype).reshape(image.shape) if image.size else image
        copy[...] = image
        image = copy
    if how == "read-only":
        image.flags.writeable = False
    return image


def is_image(array: np.ndarray) -> bool:
    shape = array.ndim == 3 and array.shape[2] == 3 and array.size > 0
    return shape and array.dtype in (np.dtype("u1"), np.dtype("=u2"), np.dtype("=f4"))


@settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck), database=None)
@given(arranged())
def test_any_array(image: np.ndarray) -> None:
    before = image.copy()
    if not is_image(image):
        with pytest.raises(aquafuse.ArrayError):
            FUSER.fuse(image)
        return
    fused = FUSER.fuse(image)
    assert fused.shape == image.shape and fused.dtype == image.dtype and fused.flags.writeable
    assert np.isfinite(fused).all()
    np.testing.assert_array_equal(fused, FUSER.fuse(np.ascontiguousarray(image)))
    np.testing.assert_array_equal(image, before)


@settings(max_examples=EXAMPLES // 4, deadline=None, suppress_health_check=list(HealthCheck), database=None)
@given(arranged(), st.sampled_from(["metres", "millimetres", "relative", "inverse", "disparity", "fathoms"]))
def test_any_depth(depth: np.ndarray, kind: str) -> None:
    image = fill((*(depth.shape[:2] if depth.ndim >= 2 else (4, 4)), 3), "u1", 1)
    try:
        fused = FUSER.fuse(image, depth=depth, depth_kind=kind)
    except aquafuse.AquaFuseError:
        return
    assert fused.shape == image.shape


@settings(max_examples=EXAMPLES // 4, deadline=None, suppress_health_check=list(HealthCheck), database=None)
@given(
    arrays.arrays("u1", (8, 9, 3)),
    st.dictionaries(
        st.sampled_from(["theta", "alpha", "metres_at_one", "visibility"]),
        st.one_of(st.floats(), st.floats(0, 90)),
    ),
)
def test_any_number(image: np.ndarray, options: dict[str, float]) -> None:
    try:
        fused = aquafuse.fuse(image, "preset:jerlov-I", model="exchange", **options)
    except aquafuse.ArgumentError:
        return
    assert fused.shape == image.shape


@pytest.mark.parametrize("image", [None, 3, "reef.jpg", [1, 2], {}, b"abc", object(), np.float32(1)], ids=repr)
def test_other_objects_are_refused(image: object) -> None:
    with pytest.raises(aquafuse.AquaFuseError):
        FUSER.fuse(image)


def test_a_refusal_says_what_to_do() -> None:
    image = scene(1)
    cases = [
        (image[..., 0], "repeat grey"),
        (np.dstack([image, image[..., :1]]), "drop the opacity"),
        (image.transpose(2, 0, 1), "transpose(1, 2, 0)"),
        (image[None], "one image of the batch"),
        (image.astype(float), "astype(numpy.float32)"),
        (image[:0], "empty"),
        ("reef.jpg", "read the file first"),
        (pathlib.Path("reef.jpg"), "read the file first"),
        (np.broadcast_to(image[:1, :1], (100_000, 100_000, 3)), "limit"),
    ]
    for array, said in cases:
        with pytest.raises(aquafuse.ArrayError, match=said.replace("(", r"\(").replace(")", r"\)")):
            FUSER.fuse(array)
    with pytest.raises(aquafuse.ArrayError, match="limit"):
        FUSER.fuse(image, depth=np.broadcast_to(np.float32(1), (100_000, 100_000)), depth_kind="metres")
    with pytest.raises(ValueError, match="depth_kind"):
        FUSER.fuse(image, depth=image[..., 0])


def test_out() -> None:
    image = scene(1)
    fused = FUSER.fuse(image)
    for out in [np.empty_like(image), np.empty(image.shape[::-1], np.uint8).T, np.zeros((240, 160, 3), np.uint8)[::2]]:
        assert FUSER.fuse(image, out=out) is out
        np.testing.assert_array_equal(out, fused)
    in_place = image.copy()
    FUSER.fuse(in_place, out=in_place)
    np.testing.assert_array_equal(in_place, fused)
    read_only = np.empty_like(image)
    read_only.flags.writeable = False
    for wrong in [read_only, np.empty_like(image, np.uint16), np.empty((4, 4, 3), np.uint8), 3]:
        with pytest.raises(aquafuse.ArrayError):
            FUSER.fuse(image, out=wrong)


def test_a_panic_is_an_exception() -> None:
    with pytest.raises(aquafuse.InternalError, match=r"asked for.*report"):
        aquafuse._native.panic("asked for")
    assert FUSER.fuse(scene(1)).shape == scene(1).shape
