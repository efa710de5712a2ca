"""The command that comes with the package."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import aquafuse
import cv2
import pytest
from conftest import command, scene


def test_version_help_and_exit_codes() -> None:
    assert command("--version").stdout.split() == ["aquafuse", aquafuse.__version__]
    assert "Usage: aquafuse" in command("--help").stdout
    ended = command("fuse", "missing.png", "preset:jerlov-I", "-o", "out.png")
    assert ended.returncode == 2 and "missing.png" in ended.stderr and "Traceback" not in ended.stderr


def test_the_script_is_installed() -> None:
    script = Path(sys.executable).parent / "aquafuse"
    if not script.exists():
        pytest.skip("the package is not installed in this environment")
    assert subprocess.run([script, "--version"], capture_output=True, check=False).returncode == 0


@pytest.mark.skipif(os.name != "posix", reason="signals are those of Unix")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_and_no_half_file_is_left(tmp_path: Path, number: signal.Signals) -> None:
    (tmp_path / "in").mkdir()
    cv2.imwrite(str(tmp_path / "one.png"), scene(1, 400, 500))
    for index in range(200):
        shutil.copy(tmp_path / "one.png", tmp_path / "in" / f"{index:03}.png")
    words = [sys.executable, "-m", "aquafuse", "fuse", tmp_path / "in", "preset:jerlov-3C", "-o", tmp_path / "out"]
    running = subprocess.Popen([*map(str, words), "--smooth", "bilateral"], stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while not list((tmp_path / "out").glob("*.png")) and time.monotonic() < deadline:
        time.sleep(0.02)
    running.send_signal(number)
    _, said = running.communicate(timeout=60)
    assert running.returncode == 128 + number, said
    assert "KeyboardInterrupt" not in said
    assert not list((tmp_path / "out").glob("*.part"))
    for path in (tmp_path / "out").glob("*.png"):
        assert cv2.imread(str(path)) is not None


def test_the_command_starts_without_numpy() -> None:
    script = "import sys, aquafuse._command; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


def test_video_finds_the_ffmpeg_of_a_package(tmp_path: Path) -> None:
    (tmp_path / "imageio_ffmpeg.py").write_text("def get_ffmpeg_exe():\n    return 'ffmpeg of the package'\n")
    (tmp_path / "clip.mp4").write_text("")
    words = [sys.executable, "-m", "aquafuse", "video", str(tmp_path / "clip.mp4"), "--enhance", "-o", str(tmp_path / "out.mp4")]
    environment = {**os.environ, "PATH": str(tmp_path), "PYTHONPATH": str(tmp_path)}
    environment.pop("AQUAFUSE_FFMPEG", None)
    ended = subprocess.run(words, capture_output=True, text=True, check=False, env=environment)
    assert ended.returncode == 1 and "cannot find ffmpeg of the package" in ended.stderr, ended.stderr
