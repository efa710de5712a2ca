"""The ``aquafuse`` command."""

from __future__ import annotations

import sys

from aquafuse import _native


def main() -> None:
    """Runs the command with the arguments of this process, and ends the process with its exit code."""
    sys.exit(_native.main(["aquafuse", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
