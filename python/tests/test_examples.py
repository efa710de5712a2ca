"""The example scripts run, where what they need is installed, and stay short."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))
NEEDS = {
    "fuse_arrays": ["PIL"],
    "depth_from_network": ["PIL"],
    "data_loader": ["albumentations", "torch"],
    "train_yolo": ["ultralytics"],
    "ray_augment": ["ray"],
}


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_it_is_short(script: Path) -> None:
    most = 60 if script.stem == "ray_augment" else 40
    assert len(script.read_text().splitlines()) <= most


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_it_runs(tmp_path: Path, script: Path) -> None:
    if script.stem not in NEEDS:
        pytest.skip(f"{script.name} serves a page until it is stopped")
    missing = [name for name in NEEDS[script.stem] if importlib.util.find_spec(name) is None]
    if missing:
        pytest.skip(f"{script.name} needs {', '.join(missing)}")
    subprocess.run([sys.executable, script], cwd=tmp_path, check=True, timeout=600)
