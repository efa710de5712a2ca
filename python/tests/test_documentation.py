"""The examples of the documentation run."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import aquafuse

OPTIONAL = {"aquafuse.albumentations": "albumentations", "aquafuse.torchvision": "torchvision", "aquafuse.ultralytics": "ultralytics"}
NAMES = [f"aquafuse.{module.name}" for module in pkgutil.iter_modules(aquafuse.__path__)]


@pytest.mark.parametrize("name", ["aquafuse", *(name for name in NAMES if not name.endswith(("_native", "__main__")))])
def test_examples(name: str) -> None:
    if name in OPTIONAL:
        pytest.importorskip(OPTIONAL[name])
    threads = aquafuse.get_threads()
    try:
        assert doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS).failed == 0
    finally:
        aquafuse.set_threads(threads)
