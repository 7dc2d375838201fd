"""Where the shaders and the assets that ship with moka lie on disk.

An installed wheel carries them inside the package; in a checkout they lie
beside it, at the top level, where a reader looks for them.
"""

from functools import cache
from pathlib import Path

from moka.core.errors import MokaError

__all__ = ["asset_folder", "shader_folder"]


def shader_folder() -> Path:
    """The folder of the GLSL sources."""
    return _folder("shaders")


def asset_folder() -> Path:
    """The folder of the built-in scene and environments."""
    return _folder("assets")


@cache
def _folder(name: str) -> Path:
    package = Path(__file__).resolve().parent.parent
    for candidate in (package / name, package.parent / name):
        if candidate.is_dir():
            return candidate
    raise MokaError(
        f"{package / name}: the folder is missing from this installation; "
        "install moka-pbr again"
    )
