"""Maps of the sphere and integrals over them, in float64.

Cube faces follow OpenGL 3.3, section 3.8.10, from the direction to the
face; shaders need the way back.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from moka.core.solid_angle import equirectangular_texel_solid_angles
from tests.support.oracles.directions import gauss_legendre, spherical

Array = NDArray[np.float64]


def equirectangular_directions(width: int, height: int) -> Array:
    """The contract's directions (height, width, 3), top row first."""
    u = (np.arange(width) + 0.5) / width
    v = (np.arange(height) + 0.5) / height
    azimuth = (u - 0.5) * 2.0 * np.pi
    polar = (v * np.pi)[:, None]
    y = np.broadcast_to(np.cos(polar), (height, width))
    return np.stack(
        (np.sin(polar) * np.cos(azimuth), y, np.sin(polar) * np.sin(azimuth)),
        axis=-1,
    )


def equirectangular_solid_angles(width: int, height: int) -> Array:
    """The exact solid angle of each texel, (height, width); sum 4 pi."""
    return equirectangular_texel_solid_angles(height, width)


def cube_face(directions: Array) -> tuple[NDArray[np.intp], Array]:
    """The face 0..5 and its (s, t) that OpenGL reads for directions."""
    x, y, z = np.moveaxis(directions, -1, 0)
    axis = np.argmax(np.abs(directions), axis=-1)
    major = np.take_along_axis(directions, axis[..., None], -1)[..., 0]
    face = 2 * axis + (major < 0.0)
    s = np.choose(face, (-z, z, x, x, x, -x))
    t = np.choose(face, (-y, -y, z, -z, -y, -y))
    both = np.stack((s, t), axis=-1) / np.abs(major)[..., None]
    return face, (both + 1.0) / 2.0


def irradiance_over_pi(
    radiance: Callable[[Array], Array], n_directions: Array
) -> Array:
    """Mean of ``radiance`` weighted n.l around each row of directions."""
    cosine, weight = gauss_legendre(64)
    azimuth = (np.arange(128) + 0.5) / 128.0 * 2.0 * np.pi
    local = spherical(cosine[:, None], azimuth[None, :]).reshape(-1, 3)
    weights = np.repeat(2.0 * cosine * weight / 128.0, 128)
    return np.stack(
        [weights @ radiance(local @ around(n)) for n in n_directions]
    )


def prefiltered(
    radiance: Callable[[Array], Array], n_directions: Array, roughness: float
) -> Array:
    """Karis 2013: the mean over GGX at n = v = r, weighted n.l."""
    unit, weight = gauss_legendre(96)
    # tan(theta_h) = alpha tan(psi) flattens D; n.l > 0 for theta < pi / 4.
    alpha = roughness**2
    limit = np.arctan(1.0 / alpha)
    psi = limit * unit
    theta = 2.0 * np.arctan(alpha * np.tan(psi))
    measure = np.sin(2.0 * psi) * limit * weight * np.cos(theta)
    measure /= measure.sum() * 128.0
    azimuth = (np.arange(128) + 0.5) / 128.0 * 2.0 * np.pi
    local = spherical(np.cos(theta)[:, None], azimuth[None, :])
    weights = np.repeat(measure, 128)
    return np.stack(
        [
            weights @ radiance(local.reshape(-1, 3) @ around(n))
            for n in n_directions
        ]
    )


def around(n: Array) -> Array:
    """Rows: a tangent, a bitangent and ``n``, by Gram-Schmidt."""
    helper = np.eye(3)[np.argmin(np.abs(n))]
    tangent = np.cross(helper, n)
    tangent /= np.linalg.norm(tangent)
    return np.stack((tangent, np.cross(n, tangent), n))
