"""Evaluations give the figures of the command, and can be stopped."""

from __future__ import annotations

import json
from pathlib import Path

import aquafuse
import cv2
import numpy as np
import pytest
from aquafuse import evaluate
from conftest import command, scene, succeed


@pytest.fixture
def images(tmp_path: Path) -> Path:
    """Three images of two groups, a darker copy of each, and its depth."""
    for folder in ("images", "darker", "pairs/rgb", "pairs/depth", "tool"):
        (tmp_path / folder).mkdir(parents=True)
    names = ["blue_1", "blue_2", "green_1"]
    for number, name in enumerate(names):
        image = scene(number)
        cv2.imwrite(str(tmp_path / "images" / f"{name}.png"), image[..., ::-1])
        cv2.imwrite(str(tmp_path / "darker" / f"{name}.png"), image[..., ::-1] // 2)
        cv2.imwrite(str(tmp_path / "pairs" / "rgb" / f"{name}.png"), image[..., ::-1])
        metres = np.linspace(900 + number, 100, image[..., 0].size).reshape(image.shape[:2]).astype(np.uint16)
        cv2.imwrite(str(tmp_path / "pairs" / "depth" / f"{name}.png"), metres)
        for other in names:
            cv2.imwrite(str(tmp_path / "tool" / f"{name}__{other}.png"), image[..., ::-1])
    return tmp_path


def figures(*arguments: str | Path) -> dict[str, object]:
    """What the command says, without what the paper printed."""
    said = json.loads(command("evaluate", *arguments, "--json", "--quiet").stdout)
    said["tables"] = [table for table in said["tables"] if not table["name"].startswith("published")]
    return said


def test_figures_of_fused_images_are_those_of_the_command(images: Path) -> None:
    folder = images / "images"
    options = ["--contents", folder, "--references", folder, "--group-by", "prefix", "--rivals", "--theta", "20"]
    events: list[aquafuse.Event] = []
    report = evaluate.fusion(
        folder,
        folder,
        images / "out",
        group_by="prefix",
        rivals=True,
        theta=20,
        methods={"my": images / "tool"},
        on_event=events.append,
        progress=False,
    )
    assert json.loads(report.to_json()) == figures("fusion", *options, "--method", f"my={images / 'tool'}")
    assert report.failed == [] and len(report.items) == 4 * 6 and "my" in str(report.tables)
    assert (images / "out" / "report.html").is_file() and "| my |" in report.to_markdown()
    assert events[0].kind == "started" and events[0].total == len(events) - 1


def test_figures_of_enhanced_images_are_those_of_the_command(images: Path) -> None:
    report = evaluate.enhancement(
        images / "images", references=images / "darker", clear="preset:jerlov-I", theta=10, progress=False
    )
    options = ["--reference", images / "darker", "--clear", "preset:jerlov-I", "--theta", "10"]
    assert json.loads(report.to_json()) == figures("enhancement", images / "images", *options)


def test_figures_of_depth_are_those_of_the_command(images: Path) -> None:
    maps = {"same": evaluate.Maps(images / "pairs" / "depth", "millimetres")}
    report = evaluate.depth(images / "pairs", "millimetres", maps=maps, progress=False)
    options = ["--depth-kind", "millimetres", "--maps", f"same=millimetres:{images / 'pairs' / 'depth'}"]
    assert json.loads(report.to_json()) == figures("depth", images / "pairs", *options)


def test_figures_of_synthetic_scenes_are_those_of_the_command() -> None:
    report = evaluate.truth(exchanges=1, places="wall", lit="sea", seed=3, progress=False)
    assert json.loads(report.to_json()) == figures("truth", "--exchanges", "1", "--places", "wall", "--lit=sea", "--seed", "3")


def test_an_exception_stops_an_evaluation_and_leaves_no_report(images: Path) -> None:
    class Enough(Exception):
        pass

    def stop(event: aquafuse.Event) -> None:
        raise Enough

    with pytest.raises(Enough):
        evaluate.enhancement(images / "images", images / "report.md", on_event=stop, progress=False)
    assert not (images / "report.md").exists()


def test_what_fails_is_listed_and_the_rest_is_scored(images: Path) -> None:
    (images / "images" / "blue_1.png").write_bytes(b"broken")
    events: list[aquafuse.Event] = []
    report = evaluate.enhancement(images / "images", on_event=events.append, progress=False)
    assert sorted(event.kind for event in events) == ["done"] * 3 + ["failed", "started"]
    assert [failed["name"] for failed in report.failed] == ["blue_1.png"] and "blue_1.png" in report.failed[0]["error"]
    assert {item["picture"] for item in report.items} == {"blue_2.png", "green_1.png"}


def test_what_cannot_be_asked_is_refused_before_any_work(images: Path) -> None:
    (images / "report.md").write_text("mine")
    with pytest.raises(aquafuse.FileError, match="exists"):
        evaluate.enhancement(images / "images", images / "report.md", progress=False)
    assert (images / "report.md").read_text() == "mine"
    with pytest.raises(aquafuse.ArgumentError, match="Reinhard"):
        evaluate.fusion(images / "images", images / "images", rivals=True, methods={"Reinhard": images / "tool"})
    with pytest.raises(aquafuse.ArgumentError, match="exchanges is 0; give 1 to 100000"):
        evaluate.truth(exchanges=0)
    with pytest.raises(aquafuse.ArgumentError, match="pairs"):
        evaluate.fusion(images / "images", images / "images", pairs=0)
    with pytest.raises(aquafuse.RunError, match="group_by"):
        evaluate.fusion(images / "images", images / "images", group_by="folder", progress=False)
    succeed("evaluate", "enhancement", images / "images", "-o", images / "report.md", "--overwrite", "--quiet")
