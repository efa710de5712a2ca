"""Scenes are trained, rendered and fused as the command does it, and runs can be stopped and continued."""

from __future__ import annotations

from pathlib import Path

import aquafuse
import cv2
import numpy as np
import pytest
from aquafuse import scene
from conftest import command, succeed
from conftest import scene as image_of
from test_augment import files as all_files

VIEWS = 4


def files(folder: Path) -> dict[str, bytes]:
    """All files but the list of a run, which holds times."""
    return {name: content for name, content in all_files(folder).items() if not name.endswith(".jsonl")}


@pytest.fixture
def reef(tmp_path: Path) -> Path:
    """A scene of four cameras in a row, as COLMAP writes it."""
    folder = tmp_path / "reef"
    (folder / "images").mkdir(parents=True)
    random = np.random.default_rng(1)
    points = random.uniform([-2, -1, 4], [2, 1, 8], (60, 3))
    (folder / "cameras.txt").write_text("1 PINHOLE 64 48 60 60 32 24\n")
    lines = []
    for number in range(VIEWS):
        cv2.imwrite(str(folder / "images" / f"{number}.png"), image_of(number, 48, 64)[..., ::-1])
        lines += [f"{number + 1} 1 0 0 0 {-0.1 * number} 0 0 1 {number}.png", ""]
    (folder / "images.txt").write_text("\n".join(lines) + "\n")
    text = [f"{i + 1} {x} {y} {z} 90 120 130 0.5" for i, (x, y, z) in enumerate(points)]
    (folder / "points3D.txt").write_text("\n".join(text) + "\n")
    return folder


QUICK = {"iterations": 30, "longest": 64, "splats": 2000, "progress": False}
QUICK_WORDS = ["--iterations", "30", "--longest", "64", "--splats", "2000"]


def test_splats_are_those_of_the_command(reef: Path, tmp_path: Path) -> None:
    events: list[aquafuse.Event] = []
    made = scene.train(reef, tmp_path / "p.ply", water="learn", hold=4, on_event=events.append, **QUICK)
    succeed("scene", "train", reef, "-o", tmp_path / "c.ply", "--water", "learn", "--hold", "4", *QUICK_WORDS)
    for end in (".ply", ".water.json"):
        assert (tmp_path / f"p{end}").read_bytes() == (tmp_path / f"c{end}").read_bytes()
    assert made.splats > 0 and made.held_out is not None and made.held_out.images == 1 and made.held_out.psnr > 5
    assert [event.kind for event in events] == ["started"] + ["done"] * 30 and "splats, loss" in events[-1].message


def test_training_that_was_stopped_goes_on_to_the_same_bytes(reef: Path, tmp_path: Path) -> None:
    class Enough(Exception):
        pass

    def stop(event: aquafuse.Event) -> None:
        if event.kind == "done":
            raise Enough

    # So many steps that the run does not end before this thread hears of the first.
    how = {**QUICK, "iterations": 400}
    with pytest.raises(Enough):
        scene.train(reef, tmp_path / "a.ply", on_event=stop, threads=1, **how)
    assert not (tmp_path / "a.ply").exists() and (tmp_path / "a.ply.checkpoint").is_file()
    events: list[aquafuse.Event] = []
    scene.train(reef, tmp_path / "a.ply", on_event=events.append, **how)
    assert events[1].kind == "skipped"
    scene.train(reef, tmp_path / "b.ply", **how)
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_views_are_those_of_the_command(reef: Path, tmp_path: Path) -> None:
    scene.train(reef, tmp_path / "reef.ply", **QUICK)
    for name, options, words in [
        ("air", {"water": "none", "depth": True}, ["--water", "none", "--depth"]),
        (
            "coast",
            {"water": "preset:jerlov-5C", "visibility": 4, "metres_per_unit": 0.5, "orbit": 3},
            ["--water", "preset:jerlov-5C", "--visibility", "4", "--metres-per-unit", "0.5", "--orbit", "3"],
        ),
    ]:
        made = scene.render(tmp_path / "reef.ply", reef, tmp_path / "p" / name, longest=64, progress=False, **options)
        succeed("scene", "render", tmp_path / "reef.ply", reef, "-o", tmp_path / "c" / name, "--longest", "64", *words)
        views = files(tmp_path / "p" / name)
        assert views == files(tmp_path / "c" / name)
        assert made.done == sum(path.endswith(".png") for path in views) and made.skipped == 0
        again = scene.render(tmp_path / "reef.ply", reef, tmp_path / "p" / name, longest=64, progress=False, **options)
        assert again == (0, made.done)


def test_a_fused_scene_is_that_of_the_command(reef: Path, tmp_path: Path) -> None:
    for place, water in enumerate(["preset:jerlov-3C", str(reef / "images" / "2.png")]):
        made = scene.fuse(reef, water, tmp_path / f"p{place}", theta=10, progress=False)
        succeed("scene", "fuse", reef, water, "-o", tmp_path / f"c{place}", "--theta", "10")
        assert files(tmp_path / f"p{place}") == files(tmp_path / f"c{place}")
        assert (made.done, made.skipped) == (VIEWS, 0)
        again = scene.fuse(reef, water, tmp_path / f"p{place}", theta=10, progress=False)
        assert (again.done, again.skipped) == (0, VIEWS)


def test_what_cannot_be_done_is_refused_by_name(reef: Path, tmp_path: Path) -> None:
    with pytest.raises(aquafuse.ArgumentError, match="iterations is 0; give 1 to 1000000"):
        scene.train(reef, tmp_path / "a.ply", iterations=0)
    for wrong in ({"threads": 0}, {"threads": 513}, {"sh_degree": -1}, {"iterations": 2**32}, {"max_memory": -1}, {"hold": 1}):
        with pytest.raises(aquafuse.ArgumentError, match=next(iter(wrong))):
            scene.train(reef, tmp_path / "a.ply", **{**QUICK, **wrong})
    (reef / "images" / "3.png").rename(tmp_path / "3.png")
    with pytest.raises(aquafuse.RunError, match="skip_missing") as raised:
        scene.train(reef, tmp_path / "a.ply", **QUICK)
    assert "--" not in str(raised.value)
    (tmp_path / "3.png").rename(reef / "images" / "3.png")
    with pytest.raises(aquafuse.RunError, match="max_memory") as raised:
        scene.train(reef, tmp_path / "a.ply", max_memory=1000, progress=False)
    assert "--" not in str(raised.value)
    (tmp_path / "a.ply").write_bytes(b"mine")
    with pytest.raises(aquafuse.FileError, match="exists"):
        scene.train(reef, tmp_path / "a.ply", **QUICK)
    assert (tmp_path / "a.ply").read_bytes() == b"mine"
    with pytest.raises(aquafuse.ArgumentError, match="metres_per_unit"):
        scene.render(tmp_path / "a.ply", reef, tmp_path / "v", water="preset:jerlov-I", metres_per_unit=0)
    assert command("scene", "train", reef, "-o", tmp_path / "a.ply").returncode == 2
