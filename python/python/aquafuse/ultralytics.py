"""Water fusion while Ultralytics trains: each source image, before mosaics are made of several.

>>> from ultralytics import YOLO  # doctest: +SKIP
>>> import aquafuse.ultralytics
>>> model = YOLO("yolo11n.pt")  # doctest: +SKIP
>>> aquafuse.ultralytics.add_to(model, waters="presets", share=0.5, seed=7)  # doctest: +SKIP
>>> model.train(data="reef.yaml", epochs=10)  # doctest: +SKIP

For a paper, ``aquafuse augment`` is the better way: the images lie on the disk, with a manifest, and every run sees the same
ones. With ``augmentations=[...]`` of Ultralytics the transform would come after the mosaic, whose water is that of four
images and of grey padding; :func:`transform` is for those who want that all the same.
"""

from __future__ import annotations

import ctypes
import multiprocessing
from typing import TYPE_CHECKING, Any

import numpy as np

from aquafuse._draws import Key, WaterSampler

if TYPE_CHECKING:
    from aquafuse.albumentations import WaterFusion

__all__ = ["SourceWaters", "add_to", "transform"]


class SourceWaters:
    """Callbacks that put the source images of a training run into other waters; validation images stay as they are.

    Draws depend on the seed, the image's file and the epoch. Ultralytics loads some batches ahead: those at the end of an epoch
    belong to the next one, and still get its draws of the epoch before.

    A callback pickles by name: the process of each GPU imports this module when it takes it over.

    Args:
        options: Those of :class:`aquafuse.torchvision.WaterFusion`.
    """

    def __init__(self, **options: Any) -> None:
        self.sampler = WaterSampler(**options)

    def on_pretrain_routine_end(self, trainer: Any) -> None:
        """Wraps the loading of images; worker processes start after it."""
        loader = trainer.train_loader
        dataset = getattr(loader.dataset, "dataset", loader.dataset)
        if isinstance(dataset.load_image, _Load):
            return
        epoch = multiprocessing.get_context("spawn").Value(ctypes.c_int, 0)
        dataset.load_image = _Load(dataset.load_image, dataset.im_files, self.sampler, epoch)
        if getattr(loader, "iterator", None) is not None:
            loader.reset()

    def on_train_epoch_start(self, trainer: Any) -> None:
        """Says which epoch it is."""
        dataset = getattr(trainer.train_loader.dataset, "dataset", trainer.train_loader.dataset)
        if isinstance(dataset.load_image, _Load):
            dataset.load_image.epoch.value = trainer.epoch

    def callbacks(self) -> dict[str, Any]:
        """The callbacks by the events of Ultralytics."""
        return {
            "on_pretrain_routine_end": self.on_pretrain_routine_end,
            "on_train_epoch_start": self.on_train_epoch_start,
        }


class _Load:
    """``load_image`` of a dataset, with another water."""

    def __init__(self, load: Any, files: list[str], sampler: WaterSampler, epoch: Any) -> None:
        self.load, self.files, self.sampler, self.epoch = load, files, sampler, epoch

    def __call__(self, i: int, *args: Any, **kwargs: Any) -> Any:
        image, *sizes = self.load(i, *args, **kwargs)
        drawn = self.sampler.keyed(Key(str(self.files[i]), epoch=self.epoch.value))
        if drawn.water is None:
            return (image, *sizes)
        # Images are BGR there.
        fuser = self.sampler.fuser(drawn)
        fused = fuser.fuse(image[..., ::-1], theta=drawn.theta, alpha=drawn.alpha)
        return (np.ascontiguousarray(fused[..., ::-1]), *sizes)


def add_to(model: Any, **options: Any) -> SourceWaters:
    """Adds :class:`SourceWaters` to a model, for ``model.train(...)``.

    Args:
        model: A model of Ultralytics, for example ``YOLO("yolo11n.pt")``.
        options: Those of :class:`aquafuse.torchvision.WaterFusion`.
    """
    waters = SourceWaters(**options)
    for event, callback in waters.callbacks().items():
        model.add_callback(event, callback)
    return waters


def transform(**options: Any) -> WaterFusion:
    """A transform for ``augmentations=[...]``, which is applied after the mosaic, in BGR.

    Args:
        options: Those of :class:`aquafuse.albumentations.WaterFusion`.
    """
    from aquafuse.albumentations import WaterFusion

    options.setdefault("channels", "bgr")
    return WaterFusion(**options)
