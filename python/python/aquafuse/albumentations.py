"""Water fusion as a transform of Albumentations: 2.0.8, and the later line with its changed hooks.

>>> import albumentations as A
>>> from aquafuse import example
>>> from aquafuse.albumentations import WaterFusion
>>> augment = A.Compose([WaterFusion(waters=("preset:jerlov-3C",), theta_range=(0, 45), p=1)], seed=7)
>>> augment(image=example.reef())["image"].shape
(96, 128, 3)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import albumentations as A
import numpy as np
from albumentations.core.transforms_interface import BaseTransformInitSchema

from aquafuse._draws import PRESETS, Drawn, Key, WaterSampler
from aquafuse._options import Border, Model, Smoothing, WaterMap

__all__ = ["Key", "WaterFusion"]


class WaterFusion(A.ImageOnlyTransform):
    """Puts an image into another water. Boxes, masks and key points stay as they are.

    Args:
        waters: Waters to draw from: ``presets`` (all of them), ``preset:NAME``, ``sea`` (a new water each time), ``sea:NUMBER``,
            images, ``*.water.json`` files, and folders of both. They are read once, when the transform is made.
        model: As in :class:`aquafuse.Fuser`.
        theta_range: Least and greatest angle in degrees; 0 is the whole change, 90 none.
        alpha_range: Least and greatest gain on the colour of the water.
        channels: The order of colours: ``bgr`` for images of OpenCV and Ultralytics.
        key: The name of an entry of the data which is a name of the sample, or a :class:`Key` with an epoch. Draws then depend on
            it and on ``draw_seed`` alone: neither workers nor order change them. Leave ``p`` at 1 and use ``share``.
        draw_seed: The seed of keyed draws.
        share: The share of the samples that are put into another water, 0 to 1; the others stay as they are. ``aquafuse augment``
            keeps a quarter by default (``--keep-share``), which is ``share=0.75``.
        smooth: As in :class:`aquafuse.Fuser`.
        depth_model: As in :class:`aquafuse.Fuser`.
        water_map: As in :class:`aquafuse.Fuser`. Default: ``both`` for images that give their water, ``rules`` for those that are
            put into it, which is twice as fast.
        border: As in :class:`aquafuse.Fuser`.
        linear: As in :class:`aquafuse.Fuser`.
        p: The probability that the transform is applied.

    Image types: uint8, float32 (0 to 1), of shape (height, width, 3).
    """

    class InitSchema(BaseTransformInitSchema):
        """The arguments, checked."""

        waters: tuple[str, ...] | str
        model: Literal["physical", "relight", "aquafuse", "exchange"]
        theta_range: tuple[float, float]
        alpha_range: tuple[float, float]
        channels: Literal["rgb", "bgr"]
        key: str | None
        draw_seed: int
        share: float
        smooth: Literal["none", "bilateral"]
        depth_model: str
        water_map: Literal["both", "network", "rules", "published"] | None
        border: str | tuple[int, int, int, int]
        linear: bool

    def __init__(
        self,
        waters: Sequence[str] | str = PRESETS,
        model: Model = "physical",
        theta_range: tuple[float, float] = (0.0, 60.0),
        alpha_range: tuple[float, float] = (1.0, 1.0),
        channels: Literal["rgb", "bgr"] = "rgb",
        key: str | None = None,
        draw_seed: int = 0,
        share: float = 1.0,
        smooth: Smoothing = "none",
        depth_model: str = "eq3",
        water_map: WaterMap | None = None,
        border: Border = "auto",
        linear: bool = False,
        p: float = 0.5,
    ) -> None:
        super().__init__(p=p)
        self.waters = waters if isinstance(waters, str) else tuple(map(str, waters))
        self.model = model
        self.theta_range = tuple(theta_range)
        self.alpha_range = tuple(alpha_range)
        self.channels = channels
        self.key = key
        self.draw_seed = draw_seed
        self.share = share
        self.smooth = smooth
        self.depth_model = depth_model
        self.water_map = water_map
        self.border = border
        self.linear = linear
        self._sampler = WaterSampler(
            self.waters,
            model=model,
            theta_range=theta_range,
            alpha_range=alpha_range,
            share=share,
            seed=draw_seed,
            smooth=smooth,
            depth_model=depth_model,
            water_map=water_map,
            border=border,
            linear=linear,
        )

    @property
    def targets_as_params(self) -> list[str]:
        """The entry of the data that draws depend on."""
        return [] if self.key is None else [self.key]

    def _draw(self, data: dict[str, Any], random: Any) -> dict[str, Any]:
        drawn = self._sampler.random(random) if self.key is None else self._sampler.keyed(data[self.key])
        return drawn._asdict()

    # The later line refuses a class that has the old hook, and 2.0.8 does not know the new one.
    if hasattr(A.BasicTransform, "sample_parameters"):

        def sample_parameters(self, params: Any, data: Any, targets: Any, sampling: Any) -> Any:
            """What is drawn for an image."""
            from albumentations.core.transform_params import SampledParams

            drawn = self._draw(data, sampling.py_random)
            if drawn["water"] is not None:
                # So that the applied configuration is one that makes the same image again.
                overrides = sampling.applied_overrides
                overrides["theta_range"] = (drawn["theta"],) * 2
                overrides["alpha_range"] = (drawn["alpha"],) * 2
            return SampledParams(params=drawn)

    else:

        def get_params_dependent_on_data(self, params: dict[str, Any], data: dict[str, Any]) -> dict[str, Any]:
            """What is drawn for an image."""
            return self._draw(data, self.py_random)

    def apply(
        self, img: np.ndarray, water: int | None, theta: float, alpha: float, sea: int, **params: Any
    ) -> np.ndarray:
        """The image in the water that was drawn."""
        if water is None:
            return img
        fuser = self._sampler.fuser(Drawn(water, theta, alpha, sea))
        if self.channels == "rgb":
            return fuser.fuse(img, theta=theta, alpha=alpha)
        fused = fuser.fuse(img[..., ::-1], theta=theta, alpha=alpha)
        return np.ascontiguousarray(fused[..., ::-1])
