"""Writes pictures as tables of Parquet in the way of Hugging Face.

    write_tables.py FOLDER PICTURE...
"""

import os
import sys
from pathlib import Path

os.environ["HF_HUB_OFFLINE"] = "1"
import datasets

folder, pictures = Path(sys.argv[1]), sys.argv[2:]
folder.mkdir(parents=True)
features = datasets.Features(
    {
        "image": datasets.Image(),
        "label": datasets.ClassLabel(names=["fish", "reef"]),
        "objects": datasets.Sequence({"bbox": datasets.Sequence(datasets.Value("float32"), length=4), "id": datasets.Value("int64")}),
        "caption": datasets.Value("string"),
    }
)
for split, chosen in (("train", pictures[1:]), ("test", pictures[:1])):
    rows = {
        "image": [{"bytes": Path(path).read_bytes(), "path": Path(path).name} for path in chosen],
        "label": [number % 2 for number in range(len(chosen))],
        "objects": [{"bbox": [[1.5, 2, 3, 4]] * number, "id": list(range(number))} for number in range(len(chosen))],
        "caption": [None if number % 2 else f"picture {number}" for number in range(len(chosen))],
    }
    datasets.Dataset.from_dict(rows, features=features).to_parquet(folder / f"{split}-00000-of-00001.parquet")
