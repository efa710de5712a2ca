"""The callbacks of Ultralytics, with stand-ins for its trainer and loader: neither Ultralytics nor torch is needed."""

from __future__ import annotations

import pickle
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from aquafuse.ultralytics import SourceWaters, add_to
from conftest import scene

OPTIONS = {"waters": ("preset:jerlov-3C", "preset:jerlov-I"), "seed": 3}


class Dataset:
    """As ``YOLODataset`` loads images: BGR, with the sizes before and after."""

    im_files = [f"{number}.jpg" for number in range(4)]

    def load_image(self, i: int, rect_mode: bool = True) -> tuple[np.ndarray, tuple[int, int], tuple[int, int]]:
        return scene(i)[..., ::-1].copy(), (120, 160), (120, 160)


def trainer(**loader: object) -> SimpleNamespace:
    return SimpleNamespace(train_loader=SimpleNamespace(dataset=Dataset(), **loader), epoch=0)


def test_source_images_are_fused_in_bgr_by_file_and_epoch() -> None:
    waters, run = SourceWaters(**OPTIONS), trainer()
    waters.on_pretrain_routine_end(run)
    dataset = run.train_loader.dataset
    image, before, after = dataset.load_image(1, rect_mode=False)
    drawn = waters.sampler.keyed("1.jpg")
    expected = waters.sampler.fusers[drawn.water].fuse(scene(1), theta=drawn.theta, alpha=drawn.alpha)
    np.testing.assert_array_equal(image[..., ::-1], expected)
    assert before == after == (120, 160)
    run.epoch = 1
    waters.on_train_epoch_start(run)
    assert (dataset.load_image(1)[0] != image).any()
    run.epoch = 0
    waters.on_train_epoch_start(run)
    np.testing.assert_array_equal(dataset.load_image(1)[0], image)


def test_a_resumed_run_does_not_fuse_twice_and_started_workers_start_again() -> None:
    waters, started = SourceWaters(**OPTIONS), []
    run = trainer(iterator=object(), reset=lambda: started.append(1))
    waters.on_pretrain_routine_end(run)
    load = run.train_loader.dataset.load_image
    waters.on_pretrain_routine_end(run)
    assert run.train_loader.dataset.load_image is load and started == [1]


def test_callbacks_are_added_to_a_model() -> None:
    added = {}
    add_to(SimpleNamespace(add_callback=added.__setitem__), **OPTIONS)
    assert set(added) == {"on_pretrain_routine_end", "on_train_epoch_start"}


def test_a_child_process_takes_the_callback_over(tmp_path: Path) -> None:
    """A process of another GPU has imported nothing: what it unpickles must bring the module."""
    cloudpickle = pytest.importorskip("cloudpickle")
    A = pytest.importorskip("albumentations")
    from aquafuse.ultralytics import transform

    (tmp_path / "callback").write_bytes(cloudpickle.dumps(SourceWaters(**OPTIONS).on_pretrain_routine_end))
    (tmp_path / "plain").write_bytes(pickle.dumps(SourceWaters(**OPTIONS)))
    (tmp_path / "transform").write_bytes(pickle.dumps(A.to_dict(transform(waters=OPTIONS["waters"], p=1))))
    script = f"""
import pickle, sys
from pathlib import Path
folder = Path({str(tmp_path)!r})
callback = pickle.loads((folder / "callback").read_bytes())
assert callback.__self__.sampler.keyed("1.jpg") == pickle.loads((folder / "plain").read_bytes()).sampler.keyed("1.jpg")
import albumentations as A
import aquafuse.albumentations
assert A.from_dict(pickle.loads((folder / "transform").read_bytes())).channels == "bgr"
"""
    subprocess.run([sys.executable, "-c", script], check=True)
