"""Reads a dataset and what `aquafuse augment` made of it with the readers that people use, and compares annotations.

    read_datasets.py yolo|coco|voc|masks|shards|parquet|kinds BEFORE AFTER

Every image of BEFORE must be in AFTER with its variants, STEM__WATER__NUMBER, of the same size, and each with the
annotations of its image.
"""

import io
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

PICTURES = {".png", ".jpg", ".jpeg", ".tif", ".bmp", ".webp"}


def source(name):
    """The stem of the image that an image of this stem was made from."""
    return name.rsplit("__", 2)[0]


def size(path):
    with Image.open(path) as image:
        return image.size


def pictures(folder):
    return sorted(path for path in Path(folder).rglob("*") if path.suffix.lower() in PICTURES)


def by_supervision(load):
    """Boxes and classes of each image, by its stem."""
    data = load()
    found = {}
    for path, _, detections in data:
        rows = zip(detections.xyxy.tolist(), detections.class_id.tolist())
        found[Path(path).stem] = sorted((tuple(box), data.classes[kind]) for box, kind in rows)
    return found


def yolo(root):
    import supervision as sv

    found = {}
    config = root / "data.yaml"
    if not config.exists():
        # The reader asks for one.
        config = Path(tempfile.mkdtemp()) / "data.yaml"
        config.write_text("names: [fish]\n")
    for folder in sorted({path.parent for path in pictures(root / "images")}):
        labels = root / "labels" / folder.relative_to(root / "images")
        found |= by_supervision(lambda: sv.DetectionDataset.from_yolo(str(folder), str(labels), str(config)))
    return found


def voc(root):
    import supervision as sv

    names = {path.stem for path in (root / "Annotations").glob("*.xml")}
    listed = (root / "ImageSets/Main/train.txt").read_text().split()
    assert set(listed) == names and len(listed) == len(names), "the list does not name every image once"
    return by_supervision(
        lambda: sv.DetectionDataset.from_pascal_voc(str(root / "JPEGImages"), str(root / "Annotations"))
    )


def coco(root):
    from pycocotools.coco import COCO

    (path,) = [path for path in root.rglob("*.json") if not path.name.startswith(".")]
    data = COCO(str(path))
    ids = [annotation["id"] for annotation in data.dataset["annotations"]]
    assert len(ids) == len(set(ids)), "an id twice"
    assert len(data.imgs) == len(data.dataset["images"]), "an id of an image twice"
    found = {}
    for image in data.loadImgs(data.getImgIds()):
        (file,) = list(root.rglob(Path(image["file_name"]).name))
        assert size(file) == (image["width"], image["height"]), file
        own = data.loadAnns(data.getAnnIds(imgIds=image["id"]))
        for annotation in own:
            data.annToMask(annotation) if annotation.get("segmentation") else None
        rest = [{k: v for k, v in one.items() if k not in ("id", "image_id")} for one in own]
        about = {k: v for k, v in image.items() if k not in ("id", "file_name")}
        found[Path(image["file_name"]).stem] = (about, rest)
    return found


def masks(root):
    found = {}
    for path in pictures(root / "images"):
        (mask,) = [m for m in pictures(root / "masks") if m.stem == path.stem]
        with Image.open(mask) as image:
            assert image.size == size(path), mask
            found[path.stem] = np.asarray(image).tobytes()
    return found


def shards(root):
    import webdataset

    found = {}
    for path in sorted(root.glob("*.tar")):
        for sample in webdataset.WebDataset(str(path), shardshuffle=False):
            with Image.open(io.BytesIO(sample.pop("png"))) as image:
                about = {kind: bytes for kind, bytes in sample.items() if not kind.startswith("__")}
                found[sample["__key__"]] = (image.size, about)
    return found


def parquet(root):
    os.environ["HF_HUB_OFFLINE"] = "1"
    import datasets

    files = sorted(str(path) for path in root.glob("t*.parquet"))
    data = datasets.load_dataset("parquet", data_files=files, split="train", cache_dir=tempfile.mkdtemp())
    assert isinstance(data.features["image"], datasets.Image), data.features
    names = [row["path"] for row in data.cast_column("image", datasets.Image(decode=False))["image"]]
    found = {}
    for name, row in zip(names, data):
        picture = row.pop("image")
        found[Path(name).stem] = (picture.size, row)
    manifest = root / "manifest.parquet"
    if manifest.exists():
        import pyarrow.parquet

        variants = pyarrow.parquet.read_table(manifest).to_pylist()
        assert {Path(one["output"]).stem for one in variants} == {name for name in found if "__" in name}
        assert all(len(one["sha256"]) == 64 and one["seed"] == 0 for one in variants)
    return found


def kinds(root):
    import pyarrow.parquet

    found = {}
    for path in sorted(root.glob("[0-9]*.parquet")):
        for row in pyarrow.parquet.read_table(path).to_pylist():
            found[Path(row.pop("image")["path"]).stem] = row
    return found


def main():
    layout, before, after = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    readers = {"yolo": yolo, "coco": coco, "voc": voc, "masks": masks, "shards": shards, "parquet": parquet, "kinds": kinds}
    read = readers[layout]
    old, new = read(before), read(after)
    sizes = {path.stem: size(path) for path in pictures(before)}
    for path in pictures(after):
        if path == after / "preview.jpg":
            continue  # a sheet to look at
        assert size(path) == sizes[source(path.stem)], f"{path} has another size"
    counts = {}
    for stem, annotations in new.items():
        assert annotations == old[source(stem)], f"{stem}: {annotations} is not {old[source(stem)]}"
        counts[source(stem)] = counts.get(source(stem), 0) + 1
    # A split that is not multiplied has each image once.
    assert counts.keys() == old.keys() and set(counts.values()) <= {1, max(counts.values())}, counts
    assert len(new) > len(old), "nothing was made"
    print(f"{layout}: {len(old)} images became {len(new)}, annotations equal")


main()
