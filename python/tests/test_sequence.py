"""Frames of a video: steady, and byte for byte those of the command."""

from __future__ import annotations

import pickle
import subprocess
import sys
import threading
from pathlib import Path

import aquafuse
import numpy as np
import pytest
from aquafuse import ArgumentError, ArrayError, Sequence, Water
from conftest import scene

GREEN = "preset:jerlov-3C"


def clip(frames: int = 6) -> list[np.ndarray]:
    """A camera that moves and has noise."""
    wide = scene(3, 130, 240).astype(float)
    noise = np.random.default_rng(5).normal(0, 6, (frames, 120, 160, 3))
    moved = (wide[5 : 5 + 120, 4 * i : 4 * i + 160] + noise[i] for i in range(frames))
    return [np.clip(frame, 0, 255).astype(np.uint8) for frame in moved]


@pytest.mark.parametrize(
    ("words", "sequence"),
    [
        ([GREEN], lambda: Sequence(GREEN)),
        ([GREEN, "--model", "exchange", "--theta", "30"], lambda: Sequence(GREEN, model="exchange", theta=30)),
        (["--restore"], lambda: Sequence.restoring()),
        (["--enhance", "--strength", "0.5"], lambda: Sequence.enhancing(strength=0.5)),
    ],
)
def test_bytes_are_those_of_the_command(words: list[str], sequence: object) -> None:
    frames = clip()
    # Raw frames pass through the command without a codec.
    arguments = [sys.executable, "-m", "aquafuse", "video", "-", *words, "-o", "-", "--raw", "160x120@25"]
    ended = subprocess.run(arguments, input=b"".join(map(np.ndarray.tobytes, frames)), capture_output=True)
    assert ended.returncode == 0, ended.stderr.decode()
    steady = sequence()  # type: ignore[operator]
    ours = b"".join(steady.next(frame).tobytes() for frame in frames)
    assert ours == ended.stdout


def test_a_first_frame_is_the_image_by_itself() -> None:
    frames = clip()
    steady = Sequence(GREEN)
    first, second = (steady.next(frame) for frame in frames[:2])
    assert np.array_equal(first, aquafuse.fuse(frames[0], GREEN))
    assert not np.array_equal(second, aquafuse.fuse(frames[1], GREEN))
    steady.reset()
    assert np.array_equal(steady.next(frames[1]), aquafuse.fuse(frames[1], GREEN))


def test_over_one_frame_each_is_by_itself() -> None:
    steady = Sequence(GREEN, steady_over=1)
    for frame in clip():
        assert np.array_equal(steady.next(frame), aquafuse.fuse(frame, GREEN))


def test_it_flickers_less_than_its_frames_one_by_one() -> None:
    frames = clip(12)
    steady = Sequence(GREEN)

    def flicker(outputs: list[np.ndarray]) -> float:
        means = np.array([output.mean((0, 1)) for output in outputs])
        return float(np.abs(np.diff(means, axis=0)).mean())

    assert flicker([steady.next(frame) for frame in frames]) < flicker([aquafuse.fuse(f, GREEN) for f in frames])


def test_a_known_water_of_the_content_is_taken() -> None:
    frame = clip(1)[0]
    known = Sequence(GREEN, content_water=Water.from_image(scene(9))).next(frame)
    assert not np.array_equal(known, Sequence(GREEN).next(frame))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_types_stay_and_out_may_be_the_frame(dtype: type) -> None:
    most = 1 if dtype is np.float32 else np.iinfo(dtype).max
    frame = (clip(1)[0].astype(float) / 255 * most).astype(dtype)
    changed, report = Sequence(GREEN).next_with_report(frame)
    assert changed.dtype == dtype and report is not None and report.verdict in ("good", "doubtful", "failed")
    assert Sequence(GREEN).next(frame, out=frame) is frame and np.array_equal(frame, changed)
    assert Sequence.enhancing().next_with_report(frame)[1] is None


def test_what_is_no_next_frame_is_refused() -> None:
    steady = Sequence(GREEN)
    steady.next(scene(1))
    with pytest.raises(ArrayError, match="dtype"):
        steady.next(scene(1).astype(np.float32) / 255)
    assert steady.next(scene(1, 60, 80)).shape == (60, 80, 3)
    with pytest.raises(TypeError, match="state"):
        pickle.dumps(steady)
    for over in (0, 100_001):
        with pytest.raises(ArgumentError, match="steady_over"):
            Sequence(GREEN, steady_over=over)
    with pytest.raises(ArgumentError, match="max_gain"):
        Sequence.restoring(max_gain=0)


def test_two_threads_at_once_are_an_error_or_in_turn() -> None:
    steady = Sequence(GREEN)
    said: list[str] = []

    def many() -> None:
        for _ in range(20):
            try:
                steady.next(scene(2))
            except ArgumentError as error:
                said.append(str(error))

    threads = [threading.Thread(target=many) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all("one after another" in message for message in said)
    assert steady.next(scene(2)).shape == scene(2).shape


def test_the_water_may_be_a_file(tmp_path: Path) -> None:
    Water.from_image(scene(4)).save(tmp_path / "sea.water.json")
    assert Sequence(tmp_path / "sea.water.json").next(scene(1)).shape == scene(1).shape
