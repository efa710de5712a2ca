"""Water fusion as a transform of torchvision (v2): images are changed, boxes and masks pass.

>>> import torch
>>> from torchvision import tv_tensors
>>> from aquafuse.torchvision import Key, WaterFusion
>>> fuse = WaterFusion(waters=("preset:jerlov-3C",), seed=7)
>>> image = tv_tensors.Image(torch.randint(0, 255, (3, 32, 48), dtype=torch.uint8))
>>> fused, key = fuse(image, Key("reef.jpg", epoch=2))
>>> fused.shape, type(fused).__name__
(torch.Size([3, 32, 48]), 'Image')
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import PIL.Image
import torch
from torchvision import tv_tensors
from torchvision.transforms import v2

from aquafuse._draws import PRESETS, Drawn, Key, WaterSampler
from aquafuse._errors import ArrayError
from aquafuse._network import DepthModel
from aquafuse._options import Border, Model, Smoothing, WaterMap

__all__ = ["Key", "WaterFusion"]


class _TorchRandom:
    """Numbers of torch's own generator, which data loaders seed for each worker."""

    def random(self) -> float:
        return float(torch.rand(()))


class WaterFusion(v2.Transform):
    """Puts an image into another water: a tensor of shape (3, height, width), uint8 or float32, or a PIL image in RGB.

    Draws come from torch's generator. If the sample holds a :class:`Key`, anywhere in it, they depend on it and on ``seed``
    alone: neither workers nor order change them. The key passes through.

    Args:
        waters: As in :class:`aquafuse.albumentations.WaterFusion`.
        model: As in :class:`aquafuse.Fuser`.
        theta_range: Least and greatest angle in degrees; 0 is the whole change, 90 none.
        alpha_range: Least and greatest gain on the colour of the water.
        share: The share of the samples that are put into another water, 0 to 1; the others stay as they are.
        seed: The seed of keyed draws.
        smooth: As in :class:`aquafuse.Fuser`.
        depth_model: As in :class:`aquafuse.Fuser`.
        water_map: As in :class:`aquafuse.Fuser`. Default: ``both`` for images that give their water, ``rules`` for those that are
            put into it, which is twice as fast.
        border: As in :class:`aquafuse.Fuser`.
        linear: As in :class:`aquafuse.Fuser`.
    """

    _transformed_types = (tv_tensors.Image, PIL.Image.Image, v2.functional.is_pure_tensor, Key)

    def __init__(
        self,
        waters: Sequence[str] | str = PRESETS,
        *,
        model: Model = "physical",
        theta_range: tuple[float, float] = (0.0, 60.0),
        alpha_range: tuple[float, float] = (1.0, 1.0),
        share: float = 1.0,
        seed: int = 0,
        smooth: Smoothing = "none",
        depth_model: DepthModel = "eq3",
        water_map: WaterMap | None = None,
        border: Border = "auto",
        linear: bool = False,
    ) -> None:
        super().__init__()
        self.sampler = WaterSampler(
            waters,
            model=model,
            theta_range=theta_range,
            alpha_range=alpha_range,
            share=share,
            seed=seed,
            smooth=smooth,
            depth_model=depth_model,
            water_map=water_map,
            border=border,
            linear=linear,
        )

    def make_params(self, flat_inputs: list[Any]) -> dict[str, Any]:
        """What is drawn for a sample."""
        keys = [each for each in flat_inputs if isinstance(each, Key)]
        drawn = self.sampler.keyed(keys[0]) if keys else self.sampler.random(_TorchRandom())
        return {"drawn": drawn}

    def transform(self, image: Any, params: dict[str, Any]) -> Any:
        """An image of the sample in the water that was drawn."""
        drawn: Drawn = params["drawn"]
        if isinstance(image, Key) or drawn.water is None:
            return image
        fuser = self.sampler.fuser(drawn)
        if isinstance(image, PIL.Image.Image):
            if image.mode != "RGB":
                raise ArrayError(f'the image has the mode {image.mode}; convert it by image.convert("RGB")')
            return PIL.Image.fromarray(fuser.fuse(np.asarray(image), theta=drawn.theta, alpha=drawn.alpha))
        plain = image.as_subclass(torch.Tensor)
        fused = fuser.fuse(plain, theta=drawn.theta, alpha=drawn.alpha).contiguous()
        return tv_tensors.wrap(fused, like=image) if isinstance(image, tv_tensors.Image) else fused
