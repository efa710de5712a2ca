"""Tensors, and the transform of torchvision. Torch is large: without it these are skipped."""

from __future__ import annotations

import pickle

import aquafuse
import numpy as np
import pytest
from conftest import scene

torch = pytest.importorskip("torch")
pytest.importorskip("torchvision")

from aquafuse.torchvision import Key, WaterFusion  # noqa: E402
from torchvision import tv_tensors  # noqa: E402
from torchvision.transforms import v2  # noqa: E402

FUSER = aquafuse.Fuser("preset:jerlov-3C")


def tensor(number: int = 1) -> torch.Tensor:
    return torch.from_numpy(scene(number)).permute(2, 0, 1)


def test_a_tensor_is_fused_as_its_array() -> None:
    for each in [tensor(), tensor().contiguous(), (tensor() / 255).float()]:
        fused = FUSER.fuse(each)
        expected = FUSER.fuse(np.ascontiguousarray(each.permute(1, 2, 0).numpy()))
        np.testing.assert_array_equal(fused.permute(1, 2, 0).numpy(), expected)
        out = torch.empty_like(each)
        assert FUSER.fuse(each, out=out) is out
        assert torch.equal(out, fused)


def test_other_tensors_are_refused() -> None:
    meta = torch.empty((3, 4, 5), dtype=torch.uint8, device="meta")
    for wrong in [meta, tensor()[None], tensor().permute(1, 2, 0), tensor().double(), tensor().bfloat16()]:
        with pytest.raises(aquafuse.ArrayError):
            FUSER.fuse(wrong)
    with pytest.raises(aquafuse.ArrayError, match=r"on meta.*tensor\.cpu\(\)"):
        FUSER.fuse(meta)


def test_images_are_changed_and_boxes_and_masks_pass() -> None:
    fuse = WaterFusion(waters=("preset:jerlov-3C",), seed=1)
    boxes = tv_tensors.BoundingBoxes(torch.tensor([[1, 2, 30, 40]]), format="XYXY", canvas_size=(120, 160))
    mask = tv_tensors.Mask(torch.zeros((1, 120, 160), dtype=torch.uint8))
    image = tv_tensors.Image(tensor())
    sample = {"image": image, "boxes": boxes, "mask": mask, "label": torch.tensor(3), "key": Key("a.jpg")}
    made = fuse(sample)
    assert isinstance(made["image"], tv_tensors.Image) and not torch.equal(made["image"], image)
    assert made["boxes"] is boxes and made["mask"] is mask and made["key"] == Key("a.jpg")
    assert made["label"] == 3
    pil = fuse(v2.functional.to_pil_image(image), Key("a.jpg"))[0]
    np.testing.assert_array_equal(np.asarray(pil), made["image"].permute(1, 2, 0).numpy())


class Samples(torch.utils.data.Dataset):
    def __init__(self, epoch: int) -> None:
        self.epoch, self.fuse = epoch, WaterFusion(seed=3)

    def __len__(self) -> int:
        return 6

    def __getitem__(self, index: int) -> tuple[int, torch.Tensor]:
        image, _ = self.fuse(tv_tensors.Image(tensor(index)), Key(str(index), self.epoch))
        return index, image.as_subclass(torch.Tensor)


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_draws_are_equal_for_any_workers_of_a_data_loader(method: str) -> None:
    for epoch in range(2):
        found = []
        for workers in (0, 2, 8):
            context = method if workers else None
            loader = torch.utils.data.DataLoader(
                Samples(epoch), batch_size=2, shuffle=True, num_workers=workers, multiprocessing_context=context
            )
            found.append(
                {int(i): x.numpy().tobytes() for numbers, images in loader for i, x in zip(numbers, images, strict=True)}
            )
        assert found[0] == found[1] == found[2]


def test_it_pickles() -> None:
    fuse = WaterFusion(waters=("preset:jerlov-I",), seed=9)
    again = pickle.loads(pickle.dumps(fuse))
    key = Key("a", 1)
    assert torch.equal(fuse(tensor(), key)[0], again(tensor(), key)[0])
