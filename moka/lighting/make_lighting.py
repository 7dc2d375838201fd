"""Lighting of an environment, made now: suns, coefficients and maps."""

import numpy as np
from numpy.typing import NDArray

from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.environment_lighting import (
    EnvironmentLighting,
    LightingRequest,
)
from moka.lighting.preintegration import Preintegrator
from moka.lighting.preintegration_passes import Told
from moka.lighting.spherical_harmonics import (
    irradiance_error,
    irradiance_harmonics,
)
from moka.lighting.suns import SplitEnvironment, split_environment

__all__ = ["make_lighting"]

# Errors of nine coefficients, relative to the mean irradiance, between which
# ``auto`` makes a cube. Below they suffice: largest errors of coefficients
# and of a cube are 3.1 and 1.2 % for a beach, 3.7 and 3.4 % for soft boxes,
# 2.2 and 0.6 % for the sky, but 5.4 and 1.6 % for the studio. Above a sun is
# in the map; of that they make 20 %, and the samples of a cube 70 to 100 %.
_HARMONICS_SUFFICE = 0.04
_HARMONICS_SEE_A_SUN = 0.12


def make_lighting(
    device: GraphicsDevice,
    passes: FullscreenPasses,
    request: LightingRequest,
    told: Told | None = None,
) -> EnvironmentLighting:
    """What ``request`` asks for, to be filled and destroyed by the caller.

    If one is ``told`` of it, on any thread, in pieces between which the
    device draws what others submit.
    """
    preintegrator = Preintegrator(device, passes, told)
    split = split_environment(
        request.environment, request.most_suns, search=not request.sampled
    )
    if request.sampled:
        maps = preintegrator.sampled(split.full)
        return EnvironmentLighting(maps, split.suns)
    harmonics = (
        _harmonics(split, request.irradiance_as) if request.irradiance else None
    )
    maps = preintegrator.prepare(
        split,
        background=request.background,
        specular=request.specular,
        irradiance=request.irradiance and harmonics is None,
        radiance=request.radiance,
        half=request.half,
    )
    return EnvironmentLighting(maps, split.suns, harmonics)


def _harmonics(
    split: SplitEnvironment, irradiance_as: str
) -> NDArray[np.float64] | None:
    """Coefficients of irradiance, unless a cube is wanted or better."""
    if irradiance_as == "cube":
        return None
    coefficients = irradiance_harmonics(split.base)
    if irradiance_as == "sh":
        return coefficients
    error = irradiance_error(split.base, coefficients)
    needs_cube = _HARMONICS_SUFFICE < error < _HARMONICS_SEE_A_SUN
    return None if needs_cube else coefficients
