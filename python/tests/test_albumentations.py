"""The contract of Albumentations for transforms of others."""

from __future__ import annotations

import json
import multiprocessing
import pickle

import numpy as np
import pytest
from conftest import scene

A = pytest.importorskip("albumentations")

from aquafuse.albumentations import Key, WaterFusion  # noqa: E402

WATERS = ("preset:jerlov-3C", "preset:jerlov-I", "preset:jerlov-7C")


def make(**options: object) -> WaterFusion:
    return WaterFusion(**{"waters": WATERS, "alpha_range": (0.8, 1.2), "p": 1, **options})


def test_an_image_is_changed_and_targets_are_not() -> None:
    image, mask = scene(1), np.arange(120 * 160, dtype=np.uint8).reshape(120, 160)
    augment = A.Compose(
        [make()],
        bbox_params=A.BboxParams("pascal_voc", label_fields=["labels"]),
        keypoint_params=A.KeypointParams("xy"),
        seed=1,
    )
    boxes, points = [[3.0, 4.0, 60.0, 70.0]], [[5.0, 6.0]]
    made = augment(image=image, mask=mask, bboxes=boxes, labels=["fish"], keypoints=points)
    assert (made["image"] != image).any() and made["image"].dtype == image.dtype
    np.testing.assert_array_equal(made["mask"], mask)
    np.testing.assert_allclose(made["bboxes"], boxes, atol=1e-4)
    np.testing.assert_allclose(made["keypoints"], points, atol=1e-4)


def test_bgr_is_rgb_turned_round() -> None:
    image = scene(2)
    rgb = A.Compose([make()], seed=3)(image=image)["image"]
    bgr = A.Compose([make(channels="bgr")], seed=3)(image=image[..., ::-1].copy())["image"]
    np.testing.assert_array_equal(rgb, bgr[..., ::-1])


def test_floats_are_fused_as_bytes_are() -> None:
    image = scene(2)
    eight = A.Compose([make()], seed=3)(image=image)["image"]
    floats = A.Compose([make()], seed=3)(image=(image / 255).astype(np.float32))["image"]
    assert np.abs(floats - eight / 255).mean() < 0.02


def test_dictionaries_and_pickles_give_the_same_transform() -> None:
    original = make(theta_range=(10, 20), border=(1, 2, 3, 4), key=None, share=0.9)
    text = json.dumps(A.to_dict(original))
    for again in [A.from_dict(json.loads(text)), pickle.loads(pickle.dumps(original))]:
        assert json.dumps(A.to_dict(again)) == text
        made = [A.Compose([each], seed=5)(image=scene(1))["image"] for each in (original, again)]
        np.testing.assert_array_equal(*made)


def test_replay_makes_the_same_image() -> None:
    augment = A.ReplayCompose([make()])
    made = augment(image=scene(1))
    again = A.ReplayCompose.replay(json.loads(json.dumps(made["replay"])), image=scene(1))
    np.testing.assert_array_equal(again["image"], made["image"])


def test_seeds() -> None:
    images = [A.Compose([make()], seed=seed)(image=scene(1))["image"] for seed in (7, 7, 8)]
    np.testing.assert_array_equal(images[0], images[1])
    assert (images[0] != images[2]).any()
    augment = A.Compose([make()], seed=7)
    assert (augment(image=scene(1))["image"] != augment(image=scene(1))["image"]).any()


def test_wrong_arguments_are_refused() -> None:
    for wrong in [{"theta_range": (0, 95)}, {"alpha_range": (2, 1)}, {"share": 2}, {"waters": ()}, {"waters": ("preset:no",)}]:
        with pytest.raises(ValueError, match=r"\w"):
            make(**wrong)


def keyed(key: Key) -> bytes:
    augment = A.Compose([make(key="key", draw_seed=4)])
    return augment(image=scene(int(key.name)), key=key)["image"].tobytes()


KEYS = [Key(str(name), epoch) for epoch in range(2) for name in range(4)]


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.parametrize("workers", [2, 8])
def test_keyed_draws_are_equal_for_any_workers(method: str, workers: int) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system does not {method}")
    expected = {key: keyed(key) for key in KEYS}
    assert len(set(expected.values())) == len(KEYS)
    order = KEYS[::-1]
    with multiprocessing.get_context(method).Pool(workers) as pool:
        found = dict(zip(order, pool.map_async(keyed, order).get(timeout=240), strict=True))
    assert found == expected


def test_the_waters_of_a_key_go_round() -> None:
    sampler = make(key="key")._sampler
    waters = [sampler.keyed(Key("reef.jpg", epoch)).water for epoch in range(3)]
    assert sorted(waters) == [0, 1, 2]
    half = make(key="key", share=0.5)._sampler
    changed = sum(half.keyed(Key(str(name))).water is not None for name in range(1000))
    # Five standard deviations of a binomial of 1,000.
    assert abs(changed - 500) < 80
