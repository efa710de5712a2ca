"""``python -m aquafuse`` is the ``aquafuse`` command."""

from aquafuse._command import main

main()
