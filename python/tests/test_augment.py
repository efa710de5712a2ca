"""A dataset is multiplied as the command does it, and a run can be stopped and continued."""

from __future__ import annotations

import json
import multiprocessing
import shutil
from pathlib import Path

import aquafuse
import cv2
import pytest
from conftest import command, scene, succeed


def dataset(folder: Path, images: int = 4) -> Path:
    """A small YOLO dataset."""
    for name in ("images", "labels"):
        (folder / name).mkdir(parents=True)
    for number in range(images):
        cv2.imwrite(str(folder / "images" / f"{number}.jpg"), scene(number)[..., ::-1])
        (folder / "labels" / f"{number}.txt").write_text("0 0.5 0.5 0.2 0.2\n")
    return folder


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_the_files_are_those_of_the_command(tmp_path: Path) -> None:
    data = dataset(tmp_path / "data")
    (tmp_path / "waters").mkdir()
    cv2.imwrite(str(tmp_path / "waters" / "a.png"), scene(9))
    waters = [str(tmp_path / "waters"), "preset:jerlov-3C"]
    options = ["--per-image", "3", "--seed", "5", "--theta-range", "0,60", "--keep-originals"]
    succeed("augment", data, *waters, "-o", tmp_path / "command", *options)
    events: list[aquafuse.Event] = []
    summary = aquafuse.augment(
        data,
        waters,
        tmp_path / "python",
        per_image=3,
        seed=5,
        theta_range=(0, 60),
        keep_originals=True,
        on_event=events.append,
        progress=False,
    )
    assert summary == (4, 0, 0, 0, [])
    assert [event.kind for event in events] == ["started"] + ["done"] * 4 and events[0].total == 4
    assert files(tmp_path / "python") == files(tmp_path / "command")
    again = aquafuse.augment(data, waters, tmp_path / "python", per_image=3, seed=5, theta_range=(0, 60), keep_originals=True)
    assert (again.done, again.skipped) == (0, 4)
    assert command("verify", tmp_path / "python").returncode == 0


def test_an_exception_stops_a_run_and_the_same_call_continues_it(tmp_path: Path) -> None:
    data = dataset(tmp_path / "data", 12)

    class Enough(Exception):
        pass

    def stop(event: aquafuse.Event) -> None:
        if event.kind == "done":
            raise Enough

    with pytest.raises(Enough):
        aquafuse.augment(data, "presets", tmp_path / "stopped", on_event=stop, threads=1, progress=False)
    assert not list((tmp_path / "stopped").rglob("*.part"))
    rest = aquafuse.augment(data, "presets", tmp_path / "stopped", progress=False)
    assert rest.done + rest.skipped == 12 and rest.failed == 0
    aquafuse.augment(data, "presets", tmp_path / "whole", progress=False)
    assert files(tmp_path / "stopped") == files(tmp_path / "whole")


def test_a_bad_image_spoils_nothing_and_is_named(tmp_path: Path) -> None:
    data = dataset(tmp_path / "data")
    (data / "images" / "2.jpg").write_bytes(b"\xff\xd8\xffbroken")
    summary = aquafuse.augment(data, ["preset:jerlov-I"], tmp_path / "more", progress=False)
    assert (summary.done, summary.failed) == (3, 1) and "2.jpg" in summary.failures[0]
    lines = (tmp_path / "more" / "manifest.jsonl").read_text().splitlines()
    assert all(json.loads(line) for line in lines)


def test_what_cannot_begin_is_refused(tmp_path: Path) -> None:
    data = dataset(tmp_path / "data")
    with pytest.raises(aquafuse.RunError, match="contains the other"):
        aquafuse.augment(data, "presets", data / "more")
    with pytest.raises(aquafuse.ArgumentError, match="layout"):
        aquafuse.augment(data, "presets", tmp_path / "more", layout="cocoa")
    with pytest.raises(aquafuse.ArgumentError, match="smaller number first"):
        aquafuse.augment(data, "presets", tmp_path / "more", theta_range=(60, 0))
    with pytest.raises(aquafuse.ArgumentError, match="I from 1 to N"):
        aquafuse.augment(data, "presets", tmp_path / "more", shard=(3, 2))
    (data / "labels" / "1.txt").write_text("0 7 7 7 7\n")
    with pytest.raises(aquafuse.RunError, match="on_bad_annotation"):
        aquafuse.augment(data, "presets", tmp_path / "more")
    assert not (tmp_path / "more").exists()
    shutil.rmtree(data / "images")
    with pytest.raises(aquafuse.RunError):
        aquafuse.augment(data, "presets", tmp_path / "more")


def forked(data: Path) -> str:
    try:
        aquafuse.augment(data, "presets", data.parent / "more")
    except aquafuse.RunError as error:
        return str(error)
    return "done"


def test_a_forked_process_is_refused_and_does_not_hang(tmp_path: Path) -> None:
    if "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("this system does not fork")
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert "spawn" in pool.apply_async(forked, [dataset(tmp_path / "data")]).get(timeout=60)
