"""The ways in which users' copies of a dataset differ: names, order, capitals, separators, nesting, encodings, further files.

Each takes a `Set` and gives another, or nothing where it would change nothing.
"""

import re
from pathlib import PurePosixPath

from sets import LABEL, Set, picture

TEXTS = (".txt", ".json", ".xml", ".csv", ".yaml", ".tsv", ".jsonl", ".names", ".data", ".labels", ".manifest", ".ndjson")
BOMS = (b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff")


def is_text(path):
    return path.lower().endswith(TEXTS)


def moved(whole, rename, contents=lambda path, content: content):
    """The set with other paths and contents."""
    names = {path: rename(path) for path in whole.files}
    if len(set(names.values())) < len(names):
        return None
    files = {names[path]: contents(path, content) for path, content in whole.files.items()}
    if files == whole.files:
        return None
    of = lambda paths: {names[path] for path in paths}
    return Set(files, of(whole.images), of(whole.labels), of(whole.masks))


def in_texts(change):
    """The same set, whose files hold something else."""
    return lambda whole: moved(whole, lambda path: path, lambda path, content: change(content) if is_text(path) else content)


def stems_of(whole):
    pictures = whole.images | whole.masks
    return sorted({PurePosixPath(path).stem for path in pictures}, key=len, reverse=True)


def renamed(change):
    """Images have other names, and with them whatever has their names or names them."""

    def way(whole):
        names = stems_of(whole)
        if not names:
            return None
        pattern = re.compile("|".join(re.escape(name) for name in names))
        swap = lambda text: pattern.sub(lambda found: change(found[0]), text)
        path_of = lambda path: str(PurePosixPath(path).parent / swap(PurePosixPath(path).name))

        def contents(path, content):
            if not is_text(path) or content.startswith(BOMS):
                return content
            try:
                return swap(content.decode()).encode()
            except UnicodeDecodeError:
                return content

        return moved(whole, path_of, contents)

    return way


def parts(change):
    return lambda whole: moved(whole, lambda path: "/".join([*map(change, path.split("/")[:-1]), path.split("/")[-1]]))


def extension(paths_of, change):
    def way(whole):
        chosen = paths_of(whole)
        other = lambda path: str(PurePosixPath(path).with_suffix(change(PurePosixPath(path).suffix)))
        return moved(whole, lambda path: other(path) if path in chosen and PurePosixPath(path).suffix else path)

    return way


def within(folder):
    return lambda whole: moved(whole, lambda path: f"{folder}/{path}")


def with_files(**files):
    def way(whole):
        made = Set(dict(whole.files), set(whole.images), set(whole.labels), set(whole.masks))
        for path, content in files.items():
            made.files.setdefault(path, content)
        return made

    return way


def with_clutter(whole):
    """What systems and people leave in folders."""
    made = Set(dict(whole.files), set(whole.images), set(whole.labels), set(whole.masks))
    apple = b"\0\x05\x16\x07" + b"\0" * 60
    for path in list(whole.files):
        folder, name = PurePosixPath(path).parent, PurePosixPath(path).name
        made.files[str(folder / f"._{name}")] = apple
        made.files[str(folder / ".DS_Store")] = b"\0\0\0\1Bud1"
        made.files[str(folder / "Thumbs.db")] = b"\xd0\xcf\x11\xe0"
        made.files[str(folder / "desktop.ini")] = b"[.ShellClassInfo]\r\n"
    made.files["README.md"] = b"# Fish\n"
    made.files["LICENSE"] = b"CC BY 4.0\n"
    return made


def with_background(whole):
    """One image more, without annotations, beside each folder's first image."""
    made = Set(dict(whole.files), set(whole.images), set(whole.labels), set(whole.masks))
    for folder in {PurePosixPath(path).parent for path in whole.images}:
        made.image(str(folder / "zz_background.jpg"))
    return made


def with_an_orphan(whole):
    """One file of annotations or one mask more, whose image is missing."""
    made = Set(dict(whole.files), set(whole.images), set(whole.labels), set(whole.masks))
    stems = set(stems_of(whole))
    about_one = [path for path in sorted(whole.labels) if PurePosixPath(path).stem in stems]
    for path in about_one[:1]:
        made.label(whole.files[path], str(PurePosixPath(path).with_stem("zz_missing")))
    for path in sorted(whole.masks)[:1]:
        made.files[(orphan := str(PurePosixPath(path).with_stem("zz_missing")))] = whole.files[path]
        made.masks.add(orphan)
    return made if len(made.files) > len(whole.files) else None


def hidden(whole):
    """Annotations in a hidden folder."""
    if not whole.labels:
        return None
    at = lambda path: str(PurePosixPath(path).parent / ".labels" / PurePosixPath(path).name)
    return moved(whole, lambda path: at(path) if path in whole.labels else path)


def doubled(whole):
    """The whole as two parts, each in a folder of its own."""
    one, two = within("part1")(whole), within("part2")(whole)
    return Set(one.files | two.files, one.images | two.images, one.labels | two.labels, one.masks | two.masks)


def windows(content):
    """Paths with backslashes, where a path ends in the name of an image."""
    path = re.compile(rb"(?<![<\w])([\w.-]+/)+[\w.-]+\.(?:jpg|png|bmp)", re.IGNORECASE)
    slashes = lambda found: found[0].replace(b"/", b"\\\\" if content.lstrip(b"\xef\xbb\xbf").startswith((b"{", b"[")) else b"\\")
    return path.sub(slashes, content)


def flat(whole):
    """All in one folder."""
    return moved(whole, lambda path: PurePosixPath(path).name)


def utf16(content):
    if content.startswith(BOMS):
        return content
    try:
        text = content.decode()
    except UnicodeDecodeError:
        return content
    return text.replace("UTF-8", "UTF-16").encode("utf-16")


def marked(content):
    return content if content.startswith(BOMS) else BOMS[0] + content


LOOSE = {"labels": "labels_v2", "annotations": "annotations (1)", "annotation": "ann_final", "box": "boxes2", "masks": "masks_new", "images": "images_all"}

WAYS = {
    "as it is": lambda whole: whole,
    "in a folder": within("My dataset (v1)"),
    "in two folders": within("data/fish"),
    "in a split": within("train"),
    "in two parts": doubled,
    "all in one folder": flat,
    "folders in capitals": parts(str.upper),
    "folders in small letters": parts(str.lower),
    "folders with a blank": parts(lambda part: f"{part} 1"),
    "folders of other names": parts(lambda part: LOOSE.get(part.lower(), part)),
    "folders in German": parts(lambda part: {"images": "Bilder", "labels": "Beschriftungen", "masks": "Masken", "annotations": "Annotationen"}.get(part.lower(), part)),
    "images in capitals": extension(lambda whole: whole.images, str.upper),
    "labels in capitals": extension(lambda whole: whole.labels, str.upper),
    "jpeg instead of jpg": extension(lambda whole: {path for path in whole.images if path.endswith(".jpg")}, lambda _: ".jpeg"),
    "names with blanks": renamed(lambda name: f"{name} copy (2)"),
    "names with accents": renamed(lambda name: f"r\u00e9cif \u6c34 {name}"),
    "names with dots": renamed(lambda name: f"{name}.rf.v1.0"),
    "names in capitals": renamed(str.upper),
    "names that are numbers": renamed(lambda name: str(1000 + sum(name.encode()) % 997)),
    "names that say masks": renamed(lambda name: f"{name}_mask"),
    "byte order marks": in_texts(marked),
    "lines as Windows ends them": in_texts(lambda content: content.replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")),
    "UTF-16": in_texts(utf16),
    "paths of Windows": in_texts(windows),
    "cut short": in_texts(lambda content: content[: len(content) * 2 // 3]),
    "empty": in_texts(lambda content: b""),
    "blank lines at the end": in_texts(lambda content: content + b"\n\n  \n"),
    "clutter of systems": with_clutter,
    "an image without annotations": with_background,
    "annotations without an image": with_an_orphan,
    "annotations hidden": hidden,
    "a checkpoint beside": with_files(**{"runs/weights/best.pt": b"PK\x03\x04", "train.py": b"import torch\n", "requirements.txt": b"torch\n"}),
    "a note beside": with_files(**{"notes.txt": b"images/x.jpg was bad\n", "todo.md": b"- label\n"}),
    "a preview beside": with_files(**{"sample.gif": b"GIF89a", "figures/plot.pdf": b"%PDF", "train_batch0.jpg": picture("t.jpg")}),
    "a list beside": with_files(**{"classes.txt": b"fish\n"}),
    "one label more": with_files(**{"labels/zz_missing.txt": LABEL}),
}
