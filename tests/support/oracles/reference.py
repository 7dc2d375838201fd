"""Light of an environment map that a surface reflects, in float64.

The map is taken as it is read, with bilinear interpolation, and integrated
against the BRDF by quadrature: over half vectors for the specular lobe,
which flattens its peak, over the hemisphere for the diffuse term.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.support.oracles import specular
from tests.support.oracles.directions import gauss_legendre, spherical
from tests.support.oracles.environment import around

Array = NDArray[np.float64]


def bilinear(pixels: ArrayLike, uv: Array) -> Array:
    """A map (H, W, 3) at texture coordinates (..., 2); u wraps around."""
    pixels = np.asarray(pixels, float)
    height, width, _ = pixels.shape
    x = uv[..., 0] * width - 0.5
    y = np.clip(uv[..., 1] * height - 0.5, 0.0, height - 1.0)
    left = np.floor(x).astype(int)
    top = np.minimum(np.floor(y).astype(int), max(height - 2, 0))
    fx, fy = (x - left)[..., None], (y - top)[..., None]
    right, bottom = (left + 1) % width, np.minimum(top + 1, height - 1)
    left %= width
    upper = pixels[top, left] * (1 - fx) + pixels[top, right] * fx
    lower = pixels[bottom, left] * (1 - fx) + pixels[bottom, right] * fx
    return upper * (1 - fy) + lower * fy


def radiance(pixels: ArrayLike, directions: Array) -> Array:
    """A map in directions (..., 3) of the environment's own space."""
    x, y, z = np.moveaxis(directions, -1, 0)
    u = 0.5 + np.arctan2(z, x) / (2.0 * np.pi)
    v = np.arctan2(np.hypot(x, z), y) / np.pi
    return bilinear(pixels, np.stack((u, v), axis=-1))


@dataclass(frozen=True)
class Material:
    """glTF's metallic-roughness material with one colour."""

    colour: tuple[float, float, float]
    metalness: float
    roughness: float

    @property
    def f0(self) -> Array:
        return 0.04 + self.metalness * (np.array(self.colour) - 0.04)


def reflected(
    pixels: ArrayLike,
    normal: Array,
    view: Array,
    material: Material,
    *,
    multiscatter: bool,
    nodes: int = 256,
) -> Array:
    """Radiance (3,) towards ``view``: GGX, correlated Smith, Lambert.

    With ``multiscatter`` energy compensation (Turquin 2019), and the base
    gets what the dielectric interface does not reflect; without, what glTF
    2.0, appendix B, says: 1 - F(v.h).
    """
    # A frame around n with v in the x-z plane.
    n_dot_v = float(np.clip(normal @ view, 1e-4, 1.0))
    along = view - (normal @ view) * normal
    length = np.linalg.norm(along)
    x = along / length if length > 1e-9 else around(normal)[0]
    frame = np.stack((x, np.cross(normal, x), normal))
    v = np.array([np.sqrt(1.0 - n_dot_v**2), 0.0, n_dot_v])
    table = specular.table_of_microfacets(
        n_dot_v, max(material.roughness, 1e-3), specular.smith_correlated, 96
    )
    scale = 1.0 + material.f0 * (1.0 / table.sum() - 1.0)
    light = _specular(pixels, frame, v, material, nodes)
    light = light * scale if multiscatter else light
    if material.metalness < 1.0:
        share = 1.0 - (0.04 * table[0] + table[1]) * (
            1.0 + 0.04 * (1.0 / table.sum() - 1.0)
        )
        light = light + _diffuse(
            pixels, frame, v, material, share if multiscatter else None, nodes
        )
    return light


def _specular(
    pixels: ArrayLike, frame: Array, v: Array, material: Material, nodes: int
) -> Array:
    if material.roughness == 0.0:
        mirrored = v * (-1, -1, 1)
        return specular.schlick(v[2], material.f0) * radiance(
            pixels, mirrored @ frame
        )
    alpha = np.array(material.roughness**2)
    # Over h = (theta, phi), tan(theta) = alpha tan(psi); the horizon of l
    # is a limit of theta, see the table of oracles.specular.
    unit, weight = gauss_legendre(nodes)
    clustered, density = unit**3, 3.0 * unit**2 * weight
    phi = np.concatenate((1.0 - clustered, 1.0 + clustered)) * np.pi / 2.0
    phi = np.concatenate((phi, -phi))[:, None]
    phi_weight = np.tile(density, 4)[:, None] * np.pi / 2.0
    delta = np.arctan2(v[0] * np.cos(phi), v[2])
    limit = np.arctan(np.tan((delta + np.pi / 2.0) / 2.0) / alpha)
    psi = limit * unit
    theta = np.arctan(alpha * np.tan(psi))
    h = spherical(np.cos(theta), phi)
    v_dot_h = h @ v
    l = 2.0 * v_dot_h[..., None] * h - v  # noqa: E741
    n_dot_l = np.maximum(l[..., 2], 1e-300)
    # D n.h dh = sin(2 psi) dpsi dphi / 2 pi; dl = 4 v.h dh.
    measure = np.sin(2.0 * psi) * limit * weight * phi_weight / (2.0 * np.pi)
    lobe = specular.smith_correlated(n_dot_l, v[2], alpha)
    measure = measure * lobe * n_dot_l * 4.0 * v_dot_h / h[..., 2]
    fresnel = specular.schlick(v_dot_h[..., None], material.f0)
    light = radiance(pixels, l @ frame)
    return np.einsum("ij,ijk->k", measure, fresnel * light)


def _diffuse(
    pixels: ArrayLike,
    frame: Array,
    v: Array,
    material: Material,
    share: float | None,
    nodes: int,
) -> Array:
    cosine, weight = gauss_legendre(nodes)
    azimuth = (np.arange(2 * nodes) + 0.5) / (2 * nodes) * 2.0 * np.pi
    l = spherical(cosine[:, None], azimuth[None, :])  # noqa: E741
    measure = (cosine * weight)[:, None] * (np.pi / nodes) / np.pi
    colour = np.array(material.colour) * (1.0 - material.metalness)
    if share is None:
        half = l + v
        half /= np.linalg.norm(half, axis=-1, keepdims=True)
        passed = 1.0 - specular.schlick((half @ v)[..., None], material.f0)
    else:
        passed = np.full((1, 1, 1), share)
    light = radiance(pixels, l @ frame)
    total = np.sum(measure[..., None] * passed * light, axis=(0, 1))
    return colour * total
