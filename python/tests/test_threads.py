"""Threads, forked and spawned processes: the same bytes, and none waits for ever."""

from __future__ import annotations

import hashlib
import multiprocessing
import threading
from concurrent.futures import ThreadPoolExecutor

import aquafuse
import numpy as np
import pytest
from conftest import scene

FUSER = aquafuse.Fuser("preset:jerlov-3C")


def digest(number: int) -> str:
    return hashlib.sha256(FUSER.fuse(scene(number, 480, 640)).tobytes()).hexdigest()


def threads_and_digest(number: int) -> tuple[int, str]:
    return aquafuse.get_threads(), digest(number)


def test_the_number_of_threads_changes_no_byte() -> None:
    before = aquafuse.get_threads()
    try:
        digests = set()
        for threads in (1, 2, 3, 1):
            aquafuse.set_threads(threads)
            assert aquafuse.get_threads() == threads
            digests.add(digest(1))
        assert len(digests) == 1
        for wrong in (0, -1, 513):
            with pytest.raises(aquafuse.ArgumentError):
                aquafuse.set_threads(wrong)
    finally:
        aquafuse.set_threads(before)


def test_threads_of_python_share_a_fuser() -> None:
    with ThreadPoolExecutor(4) as pool:
        digests = list(pool.map(digest, [1, 2] * 8))
    assert digests == [digest(1), digest(2)] * 8


def test_other_threads_run_meanwhile() -> None:
    """With the GIL held, a thread that counts would not move while an image is worked on."""
    image = scene(1, 1000, 1500)
    counted, stop = [0], threading.Event()

    def count() -> None:
        while not stop.wait(0.0005):
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    FUSER.fuse(image, out=np.empty_like(image))
    reached = counted[0]
    stop.set()
    thread.join()
    assert reached > 3


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.parametrize("workers", [2, 8])
def test_workers(method: str, workers: int) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system does not {method}")
    before = aquafuse.get_threads()
    # The parent has threads of its own when it is forked.
    aquafuse.set_threads(2)
    try:
        expected = [digest(number) for number in range(4)]
        with multiprocessing.get_context(method).Pool(workers) as pool:
            found = pool.map_async(threads_and_digest, list(range(4)) * 2).get(timeout=120)
    finally:
        aquafuse.set_threads(before)
    assert found == [(1, each) for each in expected * 2]


def in_two_threads() -> str:
    aquafuse.set_threads(2)
    return digest(1)


def test_a_forked_worker_may_ask_for_threads() -> None:
    if "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("this system does not fork")
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply_async(in_two_threads).get(timeout=120) == digest(1)
