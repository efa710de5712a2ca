"""Scenes that every test may use, and the command beside them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import aquafuse
import numpy as np
import pytest


def scene(number: int, height: int = 120, width: int = 160) -> np.ndarray:
    """A numbered scene: the example in another water, with noise of its own."""
    random = np.random.default_rng(number)
    image = aquafuse.example.reef(height, width).astype(float)
    tint = random.uniform(0.6, 1.0, 3)
    noise = random.normal(0, 4, image.shape)
    return np.clip(image * tint + noise, 0, 255).astype(np.uint8)


@pytest.fixture
def reef() -> np.ndarray:
    return scene(1)


def command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """The command of this package, in a process of its own."""
    words = [sys.executable, "-m", "aquafuse", *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, check=False)


def succeed(*arguments: str | Path) -> None:
    ended = command(*arguments)
    assert ended.returncode == 0, ended.stderr
