"""Environment maps of files, decoded once and from then on read from disk."""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from moka.core.log import get_logger
from moka.core.rgbe import decode_rgbe, encode_rgbe
from moka.lighting.code_digest import code_digest
from moka.lighting.disk_cache import Arrays, DiskCache
from moka.lighting.environment import Environment, read_map

__all__ = ["load_map"]

_LOGGER = get_logger(__name__)


def load_map(
    path: str | os.PathLike[str], cache: DiskCache
) -> tuple[Environment, Callable[[], None] | None]:
    """The environment of a file, and what keeps it in ``cache``, if new.

    The file is known by its bytes, wherever it lies. What comes from the
    cache is what decoding gave, to the last bit, with its digest. Raises
    EnvironmentMapError for what cannot be read.
    """
    name = os.fspath(path)
    key = _key(Path(path))
    arrays = None if key is None else cache.load(key)
    if arrays is not None:
        _LOGGER.info("%s: its texels are in the cache", name)
        digest = arrays["digest"].tobytes()
        return Environment.known(_unpacked(arrays), digest, name), None
    pixels = read_map(Path(path))
    height, width = pixels.shape[:2]
    _LOGGER.info("%s: read, %d x %d texels", name, width, height)
    environment = Environment(pixels, name=name)
    # By which its lighting is found; whoever calls does so beside others.
    digest = environment.digest

    def keep() -> None:
        assert key is not None
        known = np.frombuffer(digest, np.uint8)
        cache.store(key, {**_packed(pixels), "digest": known})

    return environment, None if key is None else keep


def _key(path: Path) -> str | None:
    """The key of a file's bytes, None if it cannot be read."""
    from hashlib import sha256

    try:
        state = sha256(path.read_bytes())
    except OSError:
        return None
    state.update(f"{path.suffix.lower()} {code_digest()}".encode())
    return state.hexdigest()


def _packed(pixels: NDArray[np.float32]) -> Arrays:
    """Texels (H, W, 3) in a third of their bytes, if that is exact."""
    rgbe = encode_rgbe(pixels)
    # As bits: a negative zero is another texel, and equal to itself is NaN.
    same = decode_rgbe(rgbe).view(np.uint32) == pixels.view(np.uint32)
    return {"rgbe": rgbe} if same.all() else {"pixels": pixels}


def _unpacked(arrays: Arrays) -> NDArray[np.float32]:
    rgbe = arrays.get("rgbe")
    return arrays["pixels"] if rgbe is None else decode_rgbe(rgbe)
