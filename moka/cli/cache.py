"""Say what the cache of preintegrated lighting holds, or clear it."""

import argparse

__all__ = ["add_arguments", "execute"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka cache``."""
    parser.add_argument(
        "action",
        choices=("info", "clear"),
        help="info: folder, entries and size; clear: delete the entries",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print what there is, or what has been deleted."""
    from moka.lighting.disk_cache import DiskCache

    cache = DiskCache()
    is_clear = arguments.action == "clear"
    usage = cache.clear() if is_clear else cache.usage()
    size = f"{usage.size / (1 << 20):.1f} MiB"
    if is_clear:
        print(f"deleted {usage.entries} entries, {size}, of {cache.folder}")
        left = cache.usage()
        if left.entries:
            print(f"{left.entries} entries cannot be deleted")
        return int(left.entries > 0)
    print(f"folder   {cache.folder}")
    print(f"entries  {usage.entries}")
    print(f"size     {size} of at most {cache.limit >> 20} MiB")
    return 0
