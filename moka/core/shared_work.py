"""Work in pieces, of which whoever is free takes the next."""

from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, Future
from contextlib import suppress
from typing import TypeAlias

__all__ = ["Run", "run_here", "shared_with"]

#: Calls a function with each of some numbers, in any order.
Run: TypeAlias = Callable[[Callable[[int], None], Iterable[int]], None]

# To ask for help takes as long as a piece or two.
_PIECES_PER_HELPER = 16
_MOST_HELPERS = 3


def run_here(function: Callable[[int], None], pieces: Iterable[int]) -> None:
    """Do all of ``pieces`` in this thread."""
    for piece in pieces:
        function(piece)


def shared_with(workers: Executor) -> Run:
    """What does pieces in this thread and in workers that are free.

    For pieces that let go of the interpreter's lock. May be called in a
    worker: it waits for pieces that others have begun, never for one to be
    free. An error in any of them ends it and is raised here.
    """

    def run(function: Callable[[int], None], pieces: Iterable[int]) -> None:
        left = deque(pieces)

        def work() -> None:
            while left:
                try:
                    piece = left.popleft()
                except IndexError:
                    return  # Another one was faster.
                function(piece)

        count = min(len(left) // _PIECES_PER_HELPER, _MOST_HELPERS)
        helpers: list[Future[None]] = []
        with suppress(RuntimeError):  # They are being shut down.
            helpers.extend(workers.submit(work) for _ in range(count))
        try:
            work()
        finally:
            left.clear()
            for helper in helpers:
                if not helper.cancel():
                    helper.result()

    return run
