"""Ten layouts of datasets, written as their tools write them, multiplied by `aquafuse augment`, and read by the readers that
people use: every box, outline, run-length mask, mask, key point and caption must equal the one in the source image.

    round_trip.py AQUAFUSE WORK [IMAGES]

IMAGES is the number of images to train on; a third as many are to validate by, which must stay as they are. Prints a table
in Markdown, and ends with 1 if anything differs.
"""

import io
import json
import subprocess
import sys
import tarfile
from pathlib import Path

import numpy as np
from PIL import Image
from pycocotools import mask as coco_mask
from pycocotools.coco import COCO

PROGRAM, WORK = sys.argv[1], Path(sys.argv[2])
TRAIN = int(sys.argv[3]) if len(sys.argv) > 3 else 6
WIDTH, HEIGHT = 96, 64
CLASSES = ["cod", "eel", "ray"]


def names():
    """Splits with the stems of their images; some stems end like others begin, and have dots and blanks."""
    odd = ["a", "aa", "a.b", "a b", "1", "image_mask9"]
    stems = [odd[number] if number < len(odd) else f"n{number}" for number in range(TRAIN)]
    return {"train": stems, "val": [f"v{number}" for number in range(max(1, TRAIN // 3))]}


def picture(path, rng):
    path.parent.mkdir(parents=True, exist_ok=True)
    y = np.linspace(0, 1, HEIGHT)[:, None, None]
    veil = np.array([20, 110, 130]) * (1 - y) + np.array([90, 100, 70]) * y
    noise = rng.integers(-25, 26, (HEIGHT, WIDTH, 1)) * (0.3 + y)
    Image.fromarray(np.clip(veil + noise, 0, 255).astype(np.uint8)).save(path)


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def box(rng):
    """Left, top, width, height in pixels, not whole."""
    w, h = rng.uniform(4, 40), rng.uniform(4, 30)
    return [round(float(v), 3) for v in (rng.uniform(0, WIDTH - w), rng.uniform(0, HEIGHT - h), w, h)]


def outline(rng):
    x, y, w, h = box(rng)
    return [round(v, 3) for v in (x, y, x + w, y + h / 4, x + w / 2, y + h, x, y + h / 2)]


def objects(rng):
    return [(int(rng.integers(len(CLASSES))), box(rng), outline(rng)) for _ in range(int(rng.integers(1, 5)))]


# --- writers: each makes a dataset in a folder, and says where its images are by split


def coco_file(path, files, rng, kinds=("polygon",)):
    images, annotations = [], []
    for number, name in enumerate(files):
        images.append({"id": 10 + number, "file_name": name, "width": WIDTH, "height": HEIGHT, "license": 1})
        for kind, sides, corners in objects(rng):
            form = kinds[len(annotations) % len(kinds)]
            grid = np.zeros((HEIGHT, WIDTH), np.uint8, order="F")
            x, y, w, h = (int(v) for v in sides)
            grid[y : y + h, x : x + w] = 1
            packed = coco_mask.encode(grid)
            one = {"id": 1000 + len(annotations), "image_id": 10 + number, "category_id": kind + 1, "bbox": sides,
                   "area": round(sides[2] * sides[3], 2), "iscrowd": 0}
            if form == "polygon":
                one["segmentation"] = [corners]
            elif form == "packed":
                one["segmentation"] = {"size": packed["size"], "counts": packed["counts"].decode()}
            elif form == "runs":
                flat = grid.flatten(order="F")
                edges = np.flatnonzero(np.diff(flat)) + 1
                runs = np.diff(np.concatenate([[0], edges, [flat.size]])).tolist()
                one |= {"iscrowd": 1, "segmentation": {"size": [HEIGHT, WIDTH], "counts": ([0] if flat[0] else []) + runs}}
            elif form == "keypoints":
                points = [v for _ in range(3) for v in (int(rng.integers(WIDTH)), int(rng.integers(HEIGHT)), 2)]
                one |= {"segmentation": [corners], "keypoints": points, "num_keypoints": 3}
            elif form == "caption":
                one = {"id": one["id"], "image_id": one["image_id"], "caption": "zwei Dorsche, \u00fcber Sand"}
            annotations.append(one)
    categories = [{"id": i + 1, "name": name, "supercategory": "fish"} for i, name in enumerate(CLASSES)]
    whole = {"info": {"year": 2024}, "images": images, "annotations": annotations}
    # Its reader wants no classes where annotations have none.
    write(path, json.dumps(whole if kinds == ("caption",) else whole | {"categories": categories}))


def coco_all(root, splits, rng):
    """Instances, runs, key points and captions; images in images/, a file for each split."""
    for split, stems in splits.items():
        for stem in stems:
            picture(root / f"images/{stem}.png", rng)
        files = [f"{stem}.png" for stem in stems]
        kinds = ("polygon", "packed", "runs", "keypoints")
        coco_file(root / f"annotations/instances_{split}2017.json", files, rng, kinds)
        coco_file(root / f"annotations/captions_{split}2017.json", files, rng, ("caption",))


def coco_roboflow(root, splits, rng):
    """_annotations.coco.json in each folder of images."""
    for split, stems in splits.items():
        folder = {"train": "train", "val": "valid"}[split]
        for stem in stems:
            picture(root / folder / f"{stem}.png", rng)
        coco_file(root / folder / "_annotations.coco.json", [f"{stem}.png" for stem in stems], rng)


def coco_windows(root, splits, rng):
    """Paths as Windows has them, ids of one file behind those of another."""
    for split, stems in splits.items():
        for stem in stems:
            picture(root / f"data/{split}/{stem}.png", rng)
        coco_file(root / f"labels_{split}.json", [f"data\\{split}\\{stem}.png" for stem in stems], rng)


def yolo_line(kind, sides):
    x, y, w, h = sides
    return f"{kind} {(x + w / 2) / WIDTH:.6f} {(y + h / 2) / HEIGHT:.6f} {w / WIDTH:.6f} {h / HEIGHT:.6f}"


def yolo(form, image_of, label_of):
    def make(root, splits, rng):
        for split, stems in splits.items():
            for stem in stems:
                picture(root / image_of(split, stem), rng)
                lines = []
                for kind, sides, corners in objects(rng):
                    if form == "segment":
                        shares = [v / (HEIGHT if i % 2 else WIDTH) for i, v in enumerate(corners)]
                        lines.append(f"{kind} " + " ".join(f"{min(v, 1):.6f}" for v in shares))
                    elif form == "pose":
                        points = " ".join(f"{rng.random():.6f} {rng.random():.6f} {rng.integers(3)}" for _ in range(4))
                        lines.append(f"{yolo_line(kind, sides)} {points}")
                    else:
                        lines.append(yolo_line(kind, sides))
                write(root / label_of(split, stem), "\n".join(lines) + "\n")
        first = {split: str(Path(image_of(split, "x")).parent) for split in splits}
        write(root / "data.yaml", f"train: ../{first['train']}\nval: {first['val']}\nnc: 3\nnames: {CLASSES}\n")

    return make


def voc(image_of, xml_of, lists):
    def make(root, splits, rng):
        for split, stems in splits.items():
            for stem in stems:
                name = image_of(split, stem)
                picture(root / name, rng)
                text = "<annotation>\n\t<folder>x</folder>\n\t<filename>" + Path(name).name + "</filename>\n"
                text += f"\t<size><width>{WIDTH}</width><height>{HEIGHT}</height><depth>3</depth></size>\n"
                for kind, (x, y, w, h), _ in objects(rng):
                    sides = zip(("xmin", "ymin", "xmax", "ymax"), (x, y, x + w, y + h))
                    inner = "".join(f"<{side}>{int(value)}</{side}>" for side, value in sides)
                    text += f"\t<object><name>{CLASSES[kind]}</name><pose>Left</pose><bndbox>{inner}</bndbox></object>\n"
                write(root / xml_of(split, stem), text + "</annotation>\n")
            if lists:
                write(root / f"ImageSets/Main/{split}.txt", "".join(f"{stem}\n" for stem in stems))

    return make


def masks(root, splits, rng):
    """Palettes, and for some images 16 bits with an object each."""
    for split, stems in splits.items():
        for number, stem in enumerate(stems):
            picture(root / f"images/{split}/{stem}.png", rng)
            grid = np.zeros((HEIGHT, WIDTH), np.uint16 if number % 2 else np.uint8)
            for kind, (x, y, w, h), _ in objects(rng):
                grid[int(y) : int(y + h), int(x) : int(x + w)] = kind + 1 + (1000 if number % 2 else 0)
            image = Image.fromarray(grid)
            if not number % 2:
                image.putpalette(sum(([i, 255 - i, i * 7 % 256] for i in range(256)), []))
            path = root / f"masks/{split}/{stem}.png"
            path.parent.mkdir(parents=True, exist_ok=True)
            image.save(path)


def shards(root, splits, rng):
    import webdataset

    root.mkdir(parents=True, exist_ok=True)
    for split, stems in splits.items():
        with webdataset.TarWriter(str(root / f"fish-{split}-000000.tar")) as out:
            for stem in stems:
                path = WORK / "one.png"
                picture(path, rng)
                kinds = [(kind, sides) for kind, sides, _ in objects(rng)]
                mask = io.BytesIO()
                Image.fromarray(rng.integers(0, 3, (HEIGHT, WIDTH), dtype=np.uint8)).save(mask, "PNG")
                key = stem.replace(".", "-").replace(" ", "_")
                out.write({"__key__": key, "png": path.read_bytes(), "json": {"boxes": kinds}, "cls": int(rng.integers(3)),
                           "seg.mask.png": mask.getvalue(), "txt": "cod above sand"})


# --- readers: what is said about each image, by its stem


def stem_of(name):
    return Path(name.replace("\\", "/")).stem


def by_pycocotools(root):
    found = {}
    for path in sorted(root.rglob("*.json")):
        data = COCO(str(path))
        ids = [one["id"] for one in data.dataset["annotations"]]
        assert len(ids) == len(set(ids)) and len(data.imgs) == len(data.dataset["images"]), f"{path}: an id twice"
        for image in data.loadImgs(data.getImgIds()):
            about = []
            for one in data.loadAnns(data.getAnnIds(imgIds=image["id"])):
                grid = data.annToMask(one).tobytes() if "segmentation" in one else b""
                about.append(json.dumps({k: v for k, v in one.items() if k not in ("id", "image_id")}, sort_keys=True) + str(hash(grid)))
            found.setdefault(stem_of(image["file_name"]), []).extend(about)
    return found


def detections(data):
    found = {}
    for path, _, seen in data:
        grids = seen.mask if seen.mask is not None else [None] * len(seen)
        rows = zip(seen.xyxy.tolist(), seen.class_id.tolist(), grids)
        found[Path(path).stem] = [f"{side} {data.classes[kind]} {'' if grid is None else hash(grid.tobytes())}" for side, kind, grid in rows]
    return found


def by_supervision(folders, load):
    def read(root):
        found = {}
        for folder in folders:
            found |= detections(load(root, folder))
        return found

    return read


def sv():
    import supervision

    return supervision.DetectionDataset


def coco_of(root, folder):
    return sv().from_coco(str(root / folder), str(root / folder / "_annotations.coco.json"), force_masks=True)


def yolo_of(label, force=False):
    return lambda root, folder: sv().from_yolo(str(root / folder), str(root / label(folder)), str(root / "data.yaml"), force_masks=force)


def voc_of(xml):
    return lambda root, folder: sv().from_pascal_voc(str(root / folder), str(root / xml(folder)))


def by_lines(root):
    return {path.stem: path.read_text().splitlines() for path in (root / "labels").rglob("*.txt")}


def by_pillow(root):
    found = {}
    for path in (root / "masks").rglob("*.png"):
        with Image.open(path) as image:
            found[path.stem] = [f"{image.mode} {image.size} {hash(np.asarray(image).tobytes())} {image.getpalette()}"]
    return found


def by_webdataset(root):
    import webdataset

    found = {}
    for path in sorted(root.glob("*.tar")):
        for sample in webdataset.WebDataset(str(path), shardshuffle=False):
            about = sorted((k, v) for k, v in sample.items() if not k.startswith("__") and k != "png")
            found[sample["__key__"]] = [f"{k} {v!r}" for k, v in about]
    return found


def beside(folder):
    return folder


VALID = {"train": "train", "val": "valid"}
LAYOUTS = [
    ("COCO: instances, runs, key points, captions", coco_all, "pycocotools", by_pycocotools),
    ("COCO of Roboflow", coco_roboflow, "supervision, with masks", by_supervision(["train", "valid"], coco_of)),
    ("COCO with paths of Windows", coco_windows, "pycocotools", by_pycocotools),
    ("YOLO, boxes", yolo("box", lambda p, n: f"images/{p}/{n}.png", lambda p, n: f"labels/{p}/{n}.txt"), "supervision",
     by_supervision(["images/train", "images/val"], yolo_of(lambda folder: folder.replace("images", "labels")))),
    ("YOLO, outlines, of Roboflow", yolo("segment", lambda p, n: f"{VALID[p]}/images/{n}.png", lambda p, n: f"{VALID[p]}/labels/{n}.txt"),
     "supervision, with masks", by_supervision(["train/images", "valid/images"], yolo_of(lambda folder: folder.replace("images", "labels"), True))),
    ("YOLO, poses", yolo("pose", lambda p, n: f"images/{p}/{n}.png", lambda p, n: f"labels/{p}/{n}.txt"), "lines", by_lines),
    ("Pascal VOC", voc(lambda p, n: f"JPEGImages/{n}.png", lambda p, n: f"Annotations/{n}.xml", True), "supervision",
     by_supervision(["JPEGImages"], voc_of(lambda _: "Annotations"))),
    ("Pascal VOC beside its images", voc(lambda p, n: f"{VALID[p]}/{n}.png", lambda p, n: f"{VALID[p]}/{n}.xml", False), "supervision",
     by_supervision(["train", "valid"], voc_of(beside))),
    ("Masks with palettes and in 16 bits", masks, "Pillow", by_pillow),
    ("WebDataset", shards, "webdataset", by_webdataset),
]


def variants(name):
    """The stem of the image that a variant was made from; nothing for an image itself."""
    parts = name.rsplit("__", 2)
    return parts[0] if len(parts) == 3 else None


def main():
    WORK.mkdir(parents=True, exist_ok=True)
    waters = []
    for number, tint in enumerate(([10, 120, 60], [120, 110, 40])):
        path = WORK / f"water{number}.png"
        grid = np.linspace(0.4, 1.2, HEIGHT)[:, None, None] * np.array(tint) + np.zeros((HEIGHT, WIDTH, 3))
        Image.fromarray(np.clip(grid, 0, 255).astype(np.uint8)).save(path)
        waters.append(path)
    print("| layout | read by | images | annotations | variants | annotations of variants | different |")
    print("|---|---|---|---|---|---|---|")
    wrong = 0
    for number, (title, make, reader, read) in enumerate(LAYOUTS):
        rng, splits = np.random.default_rng(number), names()
        before, after = WORK / f"{number}", WORK / f"{number}-more"
        make(before, splits, rng)
        run = [PROGRAM, "augment", before, *waters, "-o", after, "--per-image", "2", "--keep-originals", "--quiet"]
        ended = subprocess.run(run, capture_output=True, text=True)
        assert ended.returncode == 0, f"{title}: {ended.stderr}"
        ended = subprocess.run([PROGRAM, "verify", after, "--dataset", before], capture_output=True, text=True)
        assert ended.returncode == 0, f"{title}: {ended.stderr}"
        old, new = read(before), read(after)
        different, made, count = 0, 0, 0
        for stem, about in new.items():
            source = variants(stem)
            if source is None:
                different += about != old.get(stem)
                continue
            made, count = made + 1, count + len(about)
            different += sum(a != b for a, b in zip(about, old[source])) + abs(len(about) - len(old[source]))
        # Each image to train on has two variants, and those to validate by have none.
        key = (lambda stem: stem.replace(".", "-").replace(" ", "_")) if make is shards else (lambda stem: stem)
        for split, stems in splits.items():
            for stem in stems:
                own = sum(variants(name) == key(stem) for name in new)
                different += own != (2 if split == "train" else 0) or key(stem) not in new
        wrong += different
        print(f"| {title} | {reader} | {len(old)} | {sum(map(len, old.values()))} | {made} | {count} | {different} |")
    sys.exit(1 if wrong else 0)


main()
