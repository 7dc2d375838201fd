"""What is asked for of an environment, and what it then is."""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.lighting.environment import Environment, Sun
from moka.lighting.environment_maps import EnvironmentMaps

__all__ = ["EnvironmentLighting", "LightingRequest"]


class LightingRequest(Struct, frozen=True):
    """What is asked for of an environment.

    ``most_suns`` may become lights; ``irradiance_as`` is ``auto``, ``sh`` or
    ``cube``. ``specular`` and ``irradiance`` are what surfaces reflect, with
    ``radiance`` for filtered lighting; ``background`` is the map itself.
    With ``sampled`` the map and a table to sample it by are all: nothing is
    looked for in it, and the environment's own suns alone are lights. With
    ``half`` cubes have half the texels along an edge.
    """

    environment: Environment
    most_suns: int
    irradiance_as: str = "auto"
    background: bool = False
    specular: bool = False
    irradiance: bool = False
    radiance: bool = False
    sampled: bool = False
    half: bool = False


class EnvironmentLighting(Struct, frozen=True, eq=False):
    """An environment as a frame uses it.

    ``harmonics`` are coefficients (9, 3) of irradiance, where no cube of
    ``maps`` holds it. ``is_cached`` tells whether it came from the disk.
    """

    maps: EnvironmentMaps
    suns: tuple[Sun, ...] = ()
    harmonics: NDArray[np.float64] | None = None
    is_cached: bool = False
