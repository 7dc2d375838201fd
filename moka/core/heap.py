"""How the C library's heap asks the kernel for memory (glibc alone).

A page that is new to a process has to be cleared by the kernel, and images
are many pages: a quarter of the CPU time of one picture went there. What
helps is to use freed blocks again, and pages of 2 MiB instead of 4 KiB.
Other C libraries than glibc are left as they are.
"""

import ctypes
import sys
from functools import cache
from typing import Any

__all__ = ["claim_heap", "keep_large_blocks"]

# Parameters of mallopt(3), as <malloc.h> numbers them.
_TRIM_THRESHOLD, _TOP_PAD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -2, -3, -8
# Of madvise(2), as <sys/mman.h> numbers it, and what it works on.
_MADV_HUGEPAGE = 14
_HUGE_PAGE = 1 << 21

# The most that glibc accepts: larger blocks always come from the kernel.
_LARGEST_KEPT = 1 << 25
# Address space of the heap; memory only where it is written.
_HEAP = 1 << 30


@cache  # once a process: a claimed heap is not trimmed afterwards
def keep_large_blocks() -> None:
    """Have freed blocks of up to 32 MiB kept for the next of their size.

    By default a block of more than 128 KiB goes back to the kernel at once,
    also the buffers that a driver in software makes in every frame: 10 000
    cubes take 16 ms a frame instead of 28. Costs a few microseconds.
    """
    libc = _glibc()
    if libc is not None:
        libc.mallopt(_MMAP_THRESHOLD, _LARGEST_KEPT)
        libc.mallopt(_TRIM_THRESHOLD, 2 * _LARGEST_KEPT)


def claim_heap() -> None:
    """Have all threads share one heap of huge pages, which only grows.

    For a process that makes one picture and ends: what one thread frees the
    next one uses, while nothing goes back to the kernel. To be called before
    there are other threads.
    """
    keep_large_blocks()
    libc = _glibc()
    if libc is None:
        return
    libc.mallopt(_ARENA_MAX, 1)
    libc.mallopt(_TRIM_THRESHOLD, (1 << 31) - 1)
    libc.mallopt(_TOP_PAD, _HEAP)
    before = libc.sbrk(0)
    libc.free(libc.malloc(_HUGE_PAGE))  # makes the heap grow, by the padding
    libc.mallopt(_TOP_PAD, _HUGE_PAGE)
    start = -(-before // _HUGE_PAGE) * _HUGE_PAGE
    size = libc.sbrk(0) - start
    if size > 0:  # where the address space is limited it did not grow
        libc.madvise(start, size, _MADV_HUGEPAGE)


def _glibc() -> Any:
    """The C library of this process, or None if it is no glibc."""
    if sys.platform != "linux":
        return None
    libc = ctypes.CDLL(None)
    if not hasattr(libc, "gnu_get_libc_version"):
        return None
    libc.mallopt.argtypes = (ctypes.c_int, ctypes.c_int)
    libc.malloc.argtypes = (ctypes.c_size_t,)
    libc.malloc.restype = ctypes.c_void_p
    libc.free.argtypes = (ctypes.c_void_p,)
    libc.sbrk.argtypes = (ctypes.c_ssize_t,)
    libc.sbrk.restype = ctypes.c_void_p
    libc.madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    return libc
