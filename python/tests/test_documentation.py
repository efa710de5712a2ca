"""The examples of the documentation run."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import aquafuse
import pytest

OPTIONAL = {
    "aquafuse.albumentations": "albumentations",
    "aquafuse.torchvision": "torchvision",
    "aquafuse.ultralytics": "ultralytics",
}
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


def test_the_page_about_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = Path(__file__).parents[2] / "docs" / "python.md"
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) >= 6
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in blocks:
        if "albumentations" in block:
            pytest.importorskip("albumentations")
        exec(compile(block, page.name, "exec"), names)
