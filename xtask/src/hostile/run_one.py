"""Runs one program after the other under limits, and says what became of each.

A line of standard input is the words of a command, parted by tabs. A line of standard output answers it: how it
ended, milliseconds, the most memory it held in KiB, and what it wrote to standard error. Python is used because the
peak memory of a single child, as the system counts it, needs `wait4`, which Rust offers through unsafe code alone.
"""

import os
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time

SECONDS, ADDRESS_SPACE = float(sys.argv[1]), int(sys.argv[2])


def limit():
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


for line in sys.stdin:
    with tempfile.TemporaryFile() as said:
        began = time.monotonic()
        child = subprocess.Popen(
            line.rstrip("\n").split("\t"),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
            preexec_fn=limit,
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
