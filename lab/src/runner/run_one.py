"""Runs one program after the other under limits, and says what became of each.

A line of standard input is the words of a command, parted by tabs. A line of standard output answers it: how it
ended, milliseconds, the most memory it held in KiB, and what it wrote to standard error. Python is used because the
peak memory of a single child, as the system counts it, needs `wait4`, which Rust offers through unsafe code alone.
"""

import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

SECONDS, ADDRESS_SPACE_KIB = float(sys.argv[1]), sys.argv[2]
# The shell sets the limits and becomes the program, so that the child waited for is the program itself.
LIMITED = ["sh", "-c", 'ulimit -v "$0" && ulimit -c 0 && exec "$@"', ADDRESS_SPACE_KIB]

for line in sys.stdin:
    with tempfile.TemporaryFile() as said:
        began = time.monotonic()
        child = subprocess.Popen(
            LIMITED + line.rstrip("\n").split("\t"),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
        )
        late = threading.Event()

        def stop(pid=child.pid, late=late):
            late.set()
            os.kill(pid, signal.SIGKILL)

        timer = threading.Timer(SECONDS, stop)
        timer.start()
        _, status, usage = os.wait4(child.pid, 0)
        timer.cancel()
        took = 1000 * (time.monotonic() - began)
        child.returncode = 0  # waited for above; Popen must not do it again
        code = os.waitstatus_to_exitcode(status)
        end = "late" if late.is_set() else f"exit {code}" if code >= 0 else f"signal {-code}"
        said.seek(0)
        text = " ".join(said.read(20_000).decode("utf-8", "replace").split())
        print(end, f"{took:.1f}", usage.ru_maxrss, text, sep="\t", flush=True)
