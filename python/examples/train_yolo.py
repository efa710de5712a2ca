"""A detector of Ultralytics that sees half of its images in other waters, each epoch in others.

    python train_yolo.py [DATA.yaml] [EPOCHS]

Needs aquafuse with its extra `ultralytics`. It is not on PyPI yet; docs/python.md says how to build it.
Without DATA.yaml it makes a dataset of eight synthetic images. For a paper, multiply the dataset first: see aquafuse.augment.
"""

import sys
from pathlib import Path

import aquafuse
import aquafuse.ultralytics
import cv2
from ultralytics import YOLO


def synthetic(folder: Path) -> str:
    """Eight images with one box each."""
    for name in ("images", "labels"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for number in range(8):
        image = aquafuse.example.reef(128, 160 + 8 * number)
        cv2.imwrite(str(folder / "images" / f"{number}.png"), image[..., ::-1])
        (folder / "labels" / f"{number}.txt").write_text("0 0.5 0.7 0.3 0.3\n")
    data = folder / "data.yaml"
    data.write_text(f"path: {folder.resolve()}\ntrain: images\nval: images\nnames: {{0: rock}}\n")
    return str(data)


if __name__ == "__main__":
    data = sys.argv[1] if len(sys.argv) > 1 else synthetic(Path("synthetic"))
    epochs = int(sys.argv[2]) if len(sys.argv) > 2 else 2
    model = YOLO("yolo11n.yaml")
    aquafuse.ultralytics.add_to(model, waters="presets", theta_range=(0, 60), share=0.5, seed=7)
    model.train(data=data, epochs=epochs, imgsz=128, batch=4, workers=2, plots=False)
