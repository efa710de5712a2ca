"""Water fusion in a data loader of torch: the same images for any number of workers, other ones in each epoch.

    python data_loader.py

Needs torch, and aquafuse with its extra `albumentations`. It is not on PyPI yet; docs/python.md says how to build it.
"""

import albumentations as A
import aquafuse
import torch
from aquafuse.albumentations import Key, WaterFusion
from torch.utils.data import DataLoader, Dataset


class Reefs(Dataset):
    """Eight synthetic images. Yours would be read from files, and their paths would be the keys."""

    def __init__(self) -> None:
        self.epoch = 0
        self.augment = A.Compose([WaterFusion(waters="presets", key="key", draw_seed=7, p=1), A.HorizontalFlip(p=0.5)])

    def __len__(self) -> int:
        return 8

    def __getitem__(self, index: int) -> torch.Tensor:
        image = aquafuse.example.reef(120, 160 + 4 * index)[:, :160]
        made = self.augment(image=image, key=Key(f"reef-{index}", epoch=self.epoch))
        return torch.from_numpy(made["image"]).permute(2, 0, 1)


if __name__ == "__main__":
    reefs = Reefs()
    for reefs.epoch in range(2):
        for batch in DataLoader(reefs, batch_size=4, num_workers=2):
            print(f"epoch {reefs.epoch}: {tuple(batch.shape)}, mean colour {batch.float().mean((0, 2, 3)).tolist()}")
