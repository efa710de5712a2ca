"""Small datasets of every kind, each varied in the ways of users, given to `aquafuse augment`: what is lost without a word.
Folders of photographs are given to `aquafuse fuse`, and scenes to `aquafuse scene fuse`.

    variations.py AQUAFUSE WORK [NAME]

An annotation or a mask must go with the variants, or the run must name it or fail; a mask must never be fused; an image
must have variants or be named. NAME is a part of the names of the sets that are tried; all are, without it. Prints a table
in Markdown, names each loss, and ends with 1 if there is one.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path, PurePosixPath

sys.path.insert(0, str(Path(__file__).parent / "variations"))

from exports import exports
from photos import photographs, scenes
from sets import cases, picture
from ways import WAYS

PROGRAM, WORK = sys.argv[1], Path(sys.argv[2]).resolve()
CHOSEN = sys.argv[3] if len(sys.argv) > 3 else ""
VARIANT = "__water__"


def tried(command, judge, name, way, whole):
    """The outcome of one set, and what it lost."""
    folder = WORK / f"{command} {name}, {way}".replace(" ", "_")
    for path, content in whole.files.items():
        (folder / "in" / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / "in" / path).write_bytes(content)
    arguments = [PROGRAM, *command.split(), folder / "in", WORK / "water.png", "-o", folder / "out", "--threads", "1"]
    run = subprocess.run(arguments, capture_output=True, check=False)
    said = (run.stdout + run.stderr).decode(errors="replace")
    if run.returncode not in (0, 1, 2):
        return "lost", [f"it ended with {run.returncode}"], said
    if run.returncode == 2 or not (folder / "out").exists():
        losses = [] if said.strip() else ["it failed without a word"]
        return ("lost" if losses else "refused"), losses, said
    losses, is_named = judge(folder / "out", whole, said)
    shutil.rmtree(folder)
    return ("lost" if losses else "named" if is_named or run.returncode == 1 else "carried"), losses, said


def photographed(out, whole, said):
    """Judges a folder of fused photographs: each must be there, or be named, or be counted among those left out."""
    made = [path.name for path in out.rglob("*") if path.is_file()]
    stem = lambda path: PurePosixPath(path).stem
    lacking = [path for path in sorted(whole.images) if not any(name.startswith(stem(path)) for name in made)]
    count = re.search(r"formats are not read: (\d+)", said)
    is_counted = count and int(count[1]) == len(lacking)
    losses = [] if is_counted else [f"{path} is passed over" for path in lacking if PurePosixPath(path).name not in said]
    touched = [path for path in whole.masks if (out / path).is_file() and (out / path).read_bytes() != whole.files[path]]
    return losses + [f"the mask {path} is fused" for path in touched], bool(lacking)


def lines(out):
    return [json.loads(line) for line in (out / "manifest.jsonl").read_text().splitlines()]


def judged(out, whole, said):
    keys = {line["key"] for line in lines(out) if "key" in line}
    fused = {line["key"] for line in lines(out) if line["line"] == "variant"}
    files = [str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()]
    stems = {PurePosixPath(path).stem.lower() for path in whole.images}
    losses, named = [], False

    def is_said(path):
        return PurePosixPath(path).name in said or path in said

    for path in sorted(whole.images):
        if path not in keys and path not in files:
            named |= is_said(path)
            losses += [] if is_said(path) else [f"{path} has no variant"]
    for path in sorted(whole.masks):
        if path in fused:
            losses.append(f"the mask {path} is fused")
        elif not [file for file in files if about(file, path)]:
            named |= is_said(path)
            losses += [] if is_said(path) else [f"the mask {path} is left out"]
    for path in sorted(whole.labels):
        own = PurePosixPath(path)
        is_about_one = any(own.name.lower().startswith(stem) for stem in stems) and not own.name.lower().endswith(".tar")
        there = (out / path).is_file()
        carried = there and (not is_about_one or any(about(file, path) for file in files))
        # A file about many images must name the variants if it names the images.
        if carried and not is_about_one and names_images(whole.files[path], whole.images):
            carried = VARIANT.encode() in (out / path).read_bytes()
        if not carried:
            named |= is_said(path)
            losses += [] if is_said(path) else [f"{path} is {'not of the variants' if there else 'left out'}"]
    return losses, named


def names_images(content, images):
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return False
    return any(PurePosixPath(image).name in text for image in images)


def about(file, path):
    """Whether a file of the output is a variant's copy of a file of the dataset."""
    file, path = PurePosixPath(file), PurePosixPath(path)
    return file.parent == path.parent and VARIANT in file.name and file.name.split(VARIANT)[0] and path.name.startswith(file.name.split(VARIANT)[0]) and file.suffix == path.suffix


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    (WORK / "water.png").write_bytes(picture("water.png"))
    augment = "augment --keep-originals --splits all"
    kinds = [
        ("cases of bug reports", augment, judged, cases()),
        ("exports and published datasets", augment, judged, exports()),
        ("folders of photographs", "fuse", photographed, photographs()),
        ("scenes", "scene fuse", photographed, scenes()),
    ]
    rows, all_losses = [], []
    for kind, command, judge, sets in kinds:
        varied = [
            (name, way, other)
            for name, whole in sets.items()
            if CHOSEN in name
            for way, change in WAYS.items()
            if (other := change(whole)) is not None
        ]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            outcomes = list(pool.map(lambda one: tried(command, judge, *one), varied))
        count = Counter(outcome for outcome, _, _ in outcomes)
        row = [kind, len(sets), len(varied), *(count[outcome] for outcome in ("carried", "named", "refused", "lost"))]
        rows.append(f"| {' | '.join(map(str, row))} |")
        for (name, way, _), (outcome, losses, said) in zip(varied, outcomes):
            if outcome == "lost":
                all_losses.append(f"{name}, {way}: {'; '.join(losses)}\n    {' '.join(said.split())[-300:]}")
    print("| kind | different | variations | all carried | the rest is named | refused, with the cause | lost without a word |")
    print("|---|---|---|---|---|---|---|")
    print("\n".join(rows))
    print("\n".join(all_losses), file=sys.stderr)
    sys.exit(1 if all_losses else 0)


main()
