"""Small datasets in the layouts of tools and of published datasets, made here: no file of theirs is in them.

Each is a `Set`: its files, and what some of them are. An *image* must have variants or be named; a *label* must go with the
variants or be named; a *mask* too, and must never be fused. Other files may be left out without a word.
"""

import io
import json
import tarfile
from dataclasses import dataclass, field

import numpy as np
from PIL import Image

WIDTH, HEIGHT = 96, 72
LABEL = b"0 0.5 0.5 0.2 0.2\n"


@dataclass
class Set:
    files: dict = field(default_factory=dict)
    images: set = field(default_factory=set)
    labels: set = field(default_factory=set)
    masks: set = field(default_factory=set)

    def image(self, *paths):
        for path in paths:
            self.files[path] = picture(path)
            self.images.add(path)
        return self

    def label(self, content, *paths):
        for path in paths:
            self.files[path] = content
            self.labels.add(path)
        return self

    def mask(self, *paths, colours=False):
        for path in paths:
            self.files[path] = mask(path, colours)
            self.masks.add(path)
        return self

    def other(self, path, content=b"x\n"):
        self.files[path] = content
        return self


def encoded(image, path):
    extension = path.rsplit(".", 1)[1].lower()
    format = {"jpg": "JPEG", "jpeg": "JPEG", "jfif": "JPEG", "mpo": "JPEG", "tif": "TIFF"}.get(extension, extension.upper())
    buffer = io.BytesIO()
    image.save(buffer, format)
    return buffer.getvalue()


def picture(path):
    rng = np.random.default_rng(sum(path.encode()))
    y = np.linspace(0, 1, HEIGHT)[:, None, None]
    veil = np.array([20, 110, 130]) * (1 - y) + np.array([90, 100, 70]) * y
    noise = rng.integers(-25, 26, (HEIGHT, WIDTH, 1)) * (0.3 + y)
    return encoded(Image.fromarray(np.clip(veil + noise, 0, 255).astype(np.uint8)), path)


def mask(path, colours=False):
    grid = np.zeros((HEIGHT, WIDTH), np.uint8)
    grid[20:40, 30:60] = 1
    if path.lower().endswith((".jpg", ".jpeg")):
        return encoded(Image.fromarray(grid * 255), path)
    image = Image.fromarray(grid, "P")
    image.putpalette([0, 0, 0, 200, 60, 60] + [0] * 750)
    return encoded(image.convert("RGB") if colours else image, path)


def coco(names, id_of=lambda number: number, **more):
    """A file of COCO with an object an image; `more` is put into each annotation."""
    images = [{"id": id_of(n + 1), "file_name": name, "width": WIDTH, "height": HEIGHT} for n, name in enumerate(names)]
    one = lambda n: {"id": n + 1, "image_id": id_of(n + 1), "category_id": 1, "bbox": [1, 2, 30, 20], "area": 600, "iscrowd": 0}
    annotations = [one(n) | more for n in range(len(names))]
    return json.dumps({"images": images, "annotations": annotations, "categories": [{"id": 1, "name": "fish"}]}).encode()


def voc(name, label="fish", head="", folder="images"):
    box = "<bndbox><xmin>1</xmin><ymin>1</ymin><xmax>30</xmax><ymax>20</ymax></bndbox>"
    size = f"<size><width>{WIDTH}</width><height>{HEIGHT}</height><depth>3</depth></size>"
    return (
        f"{head}<annotation><folder>{folder}</folder><filename>{name}</filename>{size}"
        f"<object><name>{label}</name><difficult>0</difficult>{box}</object></annotation>"
    )


def labelme(name):
    shape = {"label": "fish", "points": [[1, 1], [20, 20], [1, 20]], "shape_type": "polygon"}
    return json.dumps({"version": "5.4", "shapes": [shape], "imagePath": name, "imageData": None}).encode()


def tar(members):
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w") as archive:
        for name, content in members:
            header = tarfile.TarInfo(name)
            header.size = len(content)
            archive.addfile(header, io.BytesIO(content))
    return buffer.getvalue()


def cases():
    """The datasets among the cases that other people's bug reports gave, by name."""
    bom = b"\xef\xbb\xbf"
    two = ["i0.jpg", "i1.jpg"]
    beside = lambda end, content: Set().image(*two).label(content(two[0]), f"i0{end}").label(content(two[1]), f"i1{end}")
    nan = coco(two).replace(b'"area": 600', b'"area": NaN')
    odd = json.dumps({
        "images": [{"id": 2**62, "file_name": "i0.jpg"}, {"id": "b", "file_name": "i1.jpg"}],
        "annotations": [{"id": 1, "image_id": 2**62, "bbox": []}, {"id": "x", "image_id": "b", "bbox": [1, 2, 3, 4]}],
        "categories": [],
    }).encode()
    in_images = lambda content: Set().image("images/i0.jpg", "images/i1.jpg").label(content, "annotations/instances.json")
    floats = json.loads(coco(two))
    for annotation in floats["annotations"]:
        annotation["image_id"] = float(annotation["image_id"])
    gb = voc("i0.jpg", "\u9c7c", '<?xml version="1.0" encoding="gb2312"?>').encode("gb2312")
    cvat = Set().image("obj_train_data/i0.jpg", "obj_train_data/i1.jpg")
    cvat.label(LABEL, "obj_train_data/i0.txt", "obj_train_data/i1.txt").label(b"fish\n", "obj.names")
    cvat.label(b"classes = 1\ntrain = data/train.txt\nnames = data/obj.names\n", "obj.data")
    cvat.label(b"data/obj_train_data/i0.jpg\ndata/obj_train_data/i1.jpg\n", "train.txt")
    track = f'<annotations><image id="0" name="i0.jpg" width="{WIDTH}" height="{HEIGHT}"><box label="fish" xtl="1" ytl="1" xbr="9" ybr="9"/></image></annotations>'
    shard = [("sample0.input.jpg", picture("a.jpg")), ("sample0.outputs.txt", b"two fish")]
    return {
        "coco_bom": in_images(bom + coco(two)),
        "coco_nan": in_images(nan),
        "coco_truncated": in_images(coco(two)[:100]),
        "coco_odd_values": in_images(odd),
        "coco_backslash": Set().image("images/a/i0.jpg", "images/a/i1.jpg").label(coco(["a\\i0.jpg", "images\\a\\i1.jpg"]), "result.json"),
        "coco_float_ids": in_images(json.dumps(floats).encode()),
        "coco_trashcan": Set().image("instance_version/train/i0.jpg", "instance_version/val/i1.jpg")
        .label(coco(["i0.jpg"]), "instance_version/instances_train_trashcan.json")
        .label(coco(["i1.jpg"]), "instance_version/instances_val_trashcan.json"),
        "coco_ruod": Set().image("RUOD/RUOD_pic/train/i0.jpg", "RUOD/RUOD_pic/test/i1.jpg")
        .label(coco(["i0.jpg"]), "RUOD/RUOD_ANN/instances_train.json").label(coco(["i1.jpg"]), "RUOD/RUOD_ANN/instances_test.json"),
        "yolo_labels_uppercase": Set().image("Images/i0.jpg", "Images/i1.jpg").label(LABEL, "Labels/i0.txt", "Labels/i1.txt"),
        "yolo_jpg_txt": Set().image("images/i0.jpg").label(LABEL, "labels/i0.jpg.txt"),
        "yolo_bom": Set().image("images/i0.jpg").label(bom + LABEL, "labels/i0.txt"),
        "yolo_overhang": Set().image("images/i0.jpg").label(b"0 0.9 0.5 0.2062 0.2\n", "labels/i0.txt"),
        "cvat_yolo11": cvat,
        "voc_beside_pictures": beside(".xml", lambda name: voc(name).encode()),
        "voc_urpc": Set().image("train/image/i0.jpg").label(voc("i0").encode(), "train/box/i0.xml"),
        "voc_gb2312": Set().image("JPEGImages/i0.jpg").label(gb, "Annotations/i0.xml"),
        "labelme": beside(".json", labelme),
        "cvat_xml": Set().image("images/i0.jpg").label(track.encode(), "annotations.xml"),
        "csv_boxes": Set().image("images/i0.jpg").label(b"filename,xmin,ymin,xmax,ymax,class\ni0.jpg,1,1,9,9,fish\n", "annotations.csv"),
        "masks_deepfish": Set().image("Segmentation/images/valid/i0.jpg").mask("Segmentation/masks/valid/i0.png"),
        "masks_in_labels": Set().image("images/i0.jpg").mask("labels/i0.png"),
        "masks_beside_pictures": Set().image("i0.jpg", "i1.jpg").mask("i0.png", "i1.png"),
        "suim_class_masks": Set().image("TEST/images/i0.jpg").mask("TEST/masks/i0.bmp", colours=True).mask("TEST/masks/FV/i0.bmp", "TEST/masks/RO/i0.bmp"),
        "shards_input_jpg": Set().label(tar(shard), "s0.tar"),
    }
