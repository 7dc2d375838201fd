"""Environments: what surrounds a scene, infinitely far away, and lights it.

An environment is a base map of radiance and a few suns. A sun in the map
would be a handful of texels, thousands of times as bright as the others,
from which every approximation that follows would suffer; as a light it is
exact.
"""

import math
import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr
from numpy.typing import NDArray

from moka.core.errors import EnvironmentMapError, ImageFileError
from moka.core.log import get_logger

__all__ = [
    "AUTO_SUNS",
    "BRIGHTEST",
    "Environment",
    "Sun",
    "is_map_file",
    "load_environment",
    "read_map",
]

_LOGGER = get_logger(__name__)

#: Suns that ``auto`` makes at most: each is a light in every pixel.
AUTO_SUNS = 4

#: Infinite radiance is mostly an overflow of half floats, of which this is
#: the largest.
_INFINITE = 65504.0

#: The largest radiance of a texel: sums over all texels of a large map are
#: still finite in float32. A Radiance file can hold more, for no light.
BRIGHTEST = 1e30

BUILT_IN = ("studio", "sky", "furnace", "none")


class Sun(Struct, frozen=True):
    """A small bright disc of the sky, as a light.

    ``direction`` is a unit vector towards it, ``irradiance`` linear Rec.709,
    on a surface that faces it, in the unit of the map's radiance times
    steradians. ``angular_radius`` is in radians. ``in_map`` tells that the
    environment's map shows it as well, as it does those found there.
    """

    direction: tuple[float, float, float]
    irradiance: tuple[float, float, float]
    angular_radius: float = 0.00465
    in_map: bool = False

    def __post_init__(self) -> None:
        if not math.isclose(math.hypot(*self.direction), 1.0, abs_tol=1e-6):
            raise ValueError("the direction of a sun is a unit vector")


class Environment(Struct, frozen=True, eq=False, dict=True):
    """The radiance that comes from every direction.

    ``pixels`` is an equirectangular map, float32 (H, 2H, 3), top row first,
    linear Rec.709, laid out as :mod:`moka.lighting.equirectangular` says;
    or one texel (1, 1, 3) for all directions. Texels that are no radiance
    are replaced, and reported once through logging: NaN and negative values
    by 0, infinite ones by 65504, and those above 1e30 by that. ``suns``
    shine in addition to the map. ``name`` stands in messages. Raises
    EnvironmentMapError for other shapes.
    """

    pixels: NDArray[np.float32]
    suns: tuple[Sun, ...] = ()
    name: str = "environment"

    def __post_init__(self) -> None:
        pixels = np.asarray(self.pixels)
        if pixels.ndim != 3 or pixels.shape[2] != 3 or not pixels.size:
            raise EnvironmentMapError(
                f"{self.name}: an environment map is an array of shape "
                f"(H, 2H, 3), not {pixels.shape}"
            )
        height, width, _ = pixels.shape
        if width != 2 * height and (height, width) != (1, 1):
            raise EnvironmentMapError(
                f"{self.name}: {width} x {height} is no equirectangular map; "
                "it has to be twice as wide as high"
            )
        with np.errstate(over="ignore"):  # becomes infinite, and is replaced
            pixels = np.ascontiguousarray(pixels, dtype=np.float32)
        pixels = _sanitised(pixels, self.name).view()
        pixels.flags.writeable = False
        force_setattr(self, "pixels", pixels)

    @classmethod
    def uniform(
        cls, radiance: Sequence[float], name: str = "uniform"
    ) -> "Environment":
        """The same linear Rec.709 ``radiance`` from everywhere."""
        return cls(np.array([[radiance]], np.float32), name=name)

    @classmethod
    def known(
        cls, pixels: NDArray[np.float32], digest: bytes, name: str
    ) -> "Environment":
        """A map whose :attr:`digest` is known, so that none is computed."""
        environment = cls(pixels, name=name)
        environment.__dict__["digest"] = digest
        return environment

    @cached_property
    def digest(self) -> bytes:
        """SHA-256 of all the light it sends; computed when first asked for.

        Processors have instructions for it, with which it reads 2 GB/s.
        """
        from hashlib import sha256

        state = sha256(repr((self.pixels.shape, self.suns)).encode())
        state.update(self.pixels.data.cast("B"))
        return state.digest()

    @property
    def is_uniform(self) -> bool:
        """Whether one texel stands for all directions."""
        return self.pixels.shape[:2] == (1, 1)


def load_environment(
    source: str | os.PathLike[str] | NDArray[Any],
) -> Environment | None:
    """An environment from a file, an array, or a built-in one by its name.

    Files are equirectangular .hdr, .pic (Radiance) or .exr. An array is one
    as :class:`Environment` takes. Built in are ``studio`` (soft boxes before
    a grey backdrop), ``sky`` (a clear day), ``furnace`` (a radiance of 1
    from everywhere) and ``none``, which is None. Raises EnvironmentMapError
    for what cannot be read or is no equirectangular map.
    """
    if isinstance(source, np.ndarray):
        return Environment(source)
    # Each import is needed for one kind of source only.
    match os.fspath(source):
        case "none":
            return None
        case "furnace":
            return Environment.uniform((1.0, 1.0, 1.0), "furnace")
        case "studio":
            from moka.lighting.studio import studio

            return studio()
        case "sky":
            from moka.lighting.sky import sky

            return sky()
        case name:
            pixels = read_map(Path(name))
            height, width = pixels.shape[:2]
            _LOGGER.info("%s: read, %d x %d texels", name, width, height)
            return Environment(pixels, name=name)


def is_map_file(source: object) -> bool:
    """Whether ``source`` is the path of a file, and not a built-in name."""
    return (
        isinstance(source, str | os.PathLike)
        and os.fspath(source) not in BUILT_IN
    )


def read_map(path: Path) -> NDArray[np.float32]:
    """The texels (H, W, 3) of a file; raises EnvironmentMapError."""
    match path.suffix.lower():
        case ".hdr" | ".pic":
            from moka.core.radiance_hdr import read_radiance_hdr

            return read_radiance_hdr(path)
        case ".exr":
            from moka.core.exr import read_exr

            try:
                return read_exr(path)[0][:, :, :3]
            except ImageFileError as error:
                raise EnvironmentMapError(str(error)) from error
        case _:
            raise EnvironmentMapError(
                f"{path}: an environment is a .hdr, .pic or .exr file, or "
                f"one of {', '.join(BUILT_IN)}"
            )


def _sanitised(pixels: NDArray[np.float32], name: str) -> NDArray[np.float32]:
    # NaN fails both comparisons.
    if pixels.min() >= 0.0 and pixels.max() <= BRIGHTEST:
        return pixels
    wrong = ~((pixels >= 0.0) & (pixels <= BRIGHTEST)).all(axis=2)
    _LOGGER.warning(
        "%s: %d of %d texels are no radiance; NaN and negative values are "
        "taken for 0, infinite ones for %g, those above %g for that",
        name,
        np.count_nonzero(wrong),
        wrong.size,
        _INFINITE,
        BRIGHTEST,
    )
    positive = np.fmax(pixels, np.float32(0.0))
    positive[np.isinf(positive)] = _INFINITE
    return np.minimum(positive, np.float32(BRIGHTEST))
