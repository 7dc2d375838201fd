"""Where the memory of large blocks comes from; in processes of their own."""

import os
import platform
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(
    platform.libc_ver()[0] != "glibc", reason="the heap of glibc"
)

# The pages that the kernel has to give to blocks that are written and freed
# one after another, as images are: 1 to 16 MiB here, or again in a thread.
PAGES = """
import resource, threading
import numpy as np
from moka.core import heap

heap.{call}()

def blocks():
    for size in range(1, 17):
        np.full(size << 20, 1, np.uint8)

def in_a_thread():
    thread = threading.Thread(target=blocks)
    thread.start()
    thread.join()

def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt

before = faults()
blocks()
print(faults() - before)
before = faults()
in_a_thread()
print(faults() - before)
"""

PAGES_OF_LARGEST = (16 << 20) // 4096
PAGES_OF_ALL = sum(range(1, 17)) * (1 << 20) // 4096


def _page_faults(call: str) -> list[int]:
    """Of the first thread and of another one."""
    result = subprocess.run(
        [sys.executable, "-c", PAGES.format(call=call)],
        # NumPy asks for huge pages for itself, which would hide ours.
        env={**os.environ, "NUMPY_MADVISE_HUGEPAGE": "0"},
        capture_output=True,
        text=True,
        check=True,
    )
    return [int(line) for line in result.stdout.split()]


def test_left_alone_blocks_are_fresh_pages_again_and_again() -> None:
    first, other = _page_faults("_glibc")
    assert first > 0.8 * PAGES_OF_ALL
    assert other > 0.8 * PAGES_OF_LARGEST


def test_kept_blocks_are_used_again() -> None:
    first, _ = _page_faults("keep_large_blocks")
    assert first < 2 * PAGES_OF_LARGEST


def test_a_claimed_heap_is_shared_by_threads() -> None:
    first, other = _page_faults("claim_heap")
    assert first < 2 * PAGES_OF_LARGEST
    assert other < 0.1 * PAGES_OF_LARGEST


def test_a_driver_that_keeps_blocks_does_not_shrink_a_claimed_heap() -> None:
    size = (
        "from moka.core import heap; heap.claim_heap();"
        "heap.keep_large_blocks(); libc = heap._glibc(); before = libc.sbrk(0);"
        "libc.free(libc.malloc(1 << 24)); print(before == libc.sbrk(0))"
    )
    result = subprocess.run(
        [sys.executable, "-c", size], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "True"


def test_a_limited_address_space_is_no_error() -> None:
    limited = (
        "import resource; from moka.core import heap;"
        "resource.setrlimit(resource.RLIMIT_AS, (1 << 29, 1 << 29));"
        "heap.claim_heap(); print(len(bytearray(1 << 24)))"
    )
    result = subprocess.run(
        [sys.executable, "-c", limited],
        capture_output=True,
        text=True,
        check=True,
    )
    assert int(result.stdout) == 1 << 24
