"""The ``aquafuse`` command."""

from __future__ import annotations

import os
import shutil
import sys

from aquafuse import _native


def main() -> None:
    """Runs the command with the arguments of this process, and ends the process with its exit code."""
    if "video" in sys.argv[1:]:
        _name_ffmpeg()
    sys.exit(_native.main(["aquafuse", *sys.argv[1:]]))


def _name_ffmpeg() -> None:
    """Names the ffmpeg of the package ``imageio-ffmpeg``, if that is installed and there is no other."""
    if os.environ.get("AQUAFUSE_FFMPEG") or shutil.which("ffmpeg"):
        return
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        os.environ["AQUAFUSE_FFMPEG"] = get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        # The command says how ffmpeg is installed.
        pass


if __name__ == "__main__":
    main()
