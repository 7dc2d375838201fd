"""A digest of the code that decides what lies in the cache of lighting."""

from functools import cache
from pathlib import Path

import numpy as np

from moka import core
from moka.core.resources import shader_folder
from moka.version import __version__

__all__ = ["code_digest"]

# Of moka.core, what environment maps are read and measured with.
_OF_CORE = (
    "colour.py",
    "exr.py",
    "radiance_hdr.py",
    "radiance_scanlines.py",
    "rgbe.py",
    "solid_angle.py",
)


@cache
def code_digest() -> str:
    """The digest of all code whose constants and formulas shape lighting.

    Coarse on purpose: an edit too many costs a preintegration, one that was
    missed would be a wrong picture.
    """
    from hashlib import blake2b

    digest = blake2b(f"{__version__} {np.__version__}".encode())
    core_folder = Path(core.__file__).parent
    modules = (
        *Path(__file__).parent.glob("*.py"),
        *(core_folder / name for name in _OF_CORE),
        *shader_folder().rglob("*.*"),
    )
    for path in sorted(modules):
        digest.update(path.read_bytes())
    return digest.hexdigest()
