"""From directions to maps, and from maps to light."""

from collections.abc import Callable

import moderngl
import numpy as np

from moka.core.solid_angle import cube_texel_solid_angles
from moka.lighting.environment import load_environment
from moka.lighting.specular_cube import level_roughness
from moka.lighting.spherical_harmonics import (
    irradiance_error,
    irradiance_harmonics,
)
from moka.lighting.suns import split_environment
from tests.support.cube_passes import (
    convolve,
    prefilter,
    smooth,
    texel_directions,
)
from tests.support.gpu import gpu
from tests.support.oracles import environment as oracle
from tests.support.oracles.directions import random_directions
from tests.support.stated_errors.grids import absolute, grid, relative, single


def equirectangular() -> float:
    d = single(random_directions(20000, 1, -1.0))
    value = gpu().evaluate(
        "equirectangular_from_direction(d)", "environment", d=d
    )
    u = 0.5 + np.arctan2(d[:, 2], d[:, 0]) / (2.0 * np.pi)
    v = np.arctan2(np.hypot(d[:, 0], d[:, 2]), d[:, 1]) / np.pi
    # The map repeats in u: whole turns don't matter.
    value[:, 0] -= np.rint(value[:, 0] - u)
    return absolute(value, np.stack((u, v), axis=-1))


def relative_solid_angle() -> float:
    """The differential at a texel's centre in place of its integral."""
    size = 64
    centre = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    x, y = grid(centre, centre)
    value = gpu().evaluate(
        "relative_solid_angle(d)",
        "environment",
        d=np.stack((x, y, np.ones_like(x)), axis=-1),
    )
    exact = cube_texel_solid_angles(size).ravel() / (2.0 / size) ** 2
    return relative(value, exact)


def smooth_cube() -> moderngl.TextureCube:
    """Radiance of 0 to 3 without an edge, 64 texels to a face's side."""
    faces = smooth(texel_directions(64))
    alpha = np.ones((6, 64, 64, 1))
    return gpu().cube(np.concatenate((faces, alpha), axis=-1), mipmaps=True)


def prefiltered() -> float:
    """The rough levels of a cube of 256 texels, and their samples."""
    cube = smooth_cube()
    directions = texel_directions(8).reshape(-1, 3)[::7]
    roughnesses = [level_roughness(level, 6) for level in range(1, 6)]
    return max(
        absolute(
            prefilter(cube, roughness, 32 << level).reshape(-1, 3)[::7],
            oracle.prefiltered(smooth, directions, roughness),
        )
        for level, roughness in enumerate(roughnesses)
    )


def irradiance() -> float:
    directions = texel_directions(8).reshape(-1, 3)[::7]
    return absolute(
        convolve(smooth_cube(), 512).reshape(-1, 3)[::7],
        oracle.irradiance_over_pi(smooth, directions),
    )


def harmonics(name: str) -> float:
    """Irradiance of nine coefficients, where the mean over normals is 1."""
    source = load_environment(name)
    assert source is not None
    base = split_environment(source).base
    return irradiance_error(base, irradiance_harmonics(base))


MEASURES: dict[str, Callable[[], float]] = {
    "equirectangular_from_direction": equirectangular,
    "relative_solid_angle": relative_solid_angle,
    "prefilter_specular.frag": prefiltered,
    "prefilter_irradiance.frag": irradiance,
    **{
        f"irradiance_harmonics {name}": lambda name=name: harmonics(name)
        for name in ("sky", "studio")
    },
}
