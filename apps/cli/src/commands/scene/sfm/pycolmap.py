"""One step of structure from motion by pycolmap: features, matches or poses.

python pycolmap.py STEP IMAGES WORK CAMERAS PAIRS

IMAGES holds the images that WORK/images.txt lists; CAMERAS is SINGLE (one lens took all) or AUTO; PAIRS is all or
neighbours. Models go to WORK/models.
"""

import sys
from pathlib import Path

import pycolmap


def main(step: str, images: Path, work: Path, cameras: str, pairs: str) -> None:
    database = work / "database.db"
    if step == "features":
        names = (work / "images.txt").read_text(encoding="utf-8").splitlines()
        mode = getattr(pycolmap.CameraMode, cameras)
        pycolmap.extract_features(database, images, image_names=names, camera_mode=mode)
    elif step == "matches":
        (pycolmap.match_exhaustive if pairs == "all" else pycolmap.match_sequential)(database)
    else:
        models = work / "models"
        models.mkdir(exist_ok=True)
        # Of one stroke, where it can: step by step, Debian's COLMAP loses half of a small scene.
        mapping = getattr(pycolmap, "global_mapping", pycolmap.incremental_mapping)
        if not mapping(database, images, models):
            sys.exit("no two images see enough of the same things from different places")


main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), *sys.argv[4:])
