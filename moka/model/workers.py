"""Work on parts of a model in several threads at once."""

import os
from collections.abc import Callable, Sequence
from typing import TypeVar

__all__ = ["map_in_workers"]

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")


def map_in_workers(
    function: Callable[[_Item], _Result], items: Sequence[_Item]
) -> list[_Result]:
    """``function`` of each item, in their order.

    For functions that release the interpreter's lock. Raises what the first
    item that failed raised; no thread is left.
    """
    if len(items) < 2:
        return [function(item) for item in items]
    from concurrent.futures import ThreadPoolExecutor

    threads = min(len(items), os.cpu_count() or 1)
    with ThreadPoolExecutor(threads, "moka-decompress") as workers:
        try:
            return list(workers.map(function, items))
        except BaseException:
            workers.shutdown(cancel_futures=True)
            raise
