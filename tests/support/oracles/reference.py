"""Light of an environment map that a surface reflects, in float64.

The map is taken as it is read, with bilinear interpolation, and integrated
against the BRDF by quadrature: over the pieces of the map between texel
centres, in which it is a polynomial, and for lobes narrower than these over
half vectors, which flattens their peak.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.support.oracles import specular
from tests.support.oracles.directions import (
    gauss_legendre,
    half_vectors,
    spherical,
)
from tests.support.oracles.environment import around

Array = NDArray[np.float64]


def bilinear(pixels: ArrayLike, uv: Array) -> Array:
    """A map (H, W, C) at texture coordinates (..., 2); u wraps around."""
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
    """glTF's metallic-roughness material with one colour.

    Its dielectric is that of KHR_materials_ior and KHR_materials_specular.
    """

    colour: tuple[float, float, float]
    metalness: float
    roughness: float
    ior: float = 1.5
    specular: float = 1.0
    specular_colour: tuple[float, float, float] = (1.0, 1.0, 1.0)

    @property
    def dielectric(self) -> tuple[Array, float]:
        return specular.dielectric(
            self.ior, self.specular, self.specular_colour
        )

    @property
    def f0(self) -> Array:
        return self._mixed(self.dielectric[0], np.array(self.colour))

    @property
    def f90(self) -> float:
        return float(self._mixed(self.dielectric[1], 1.0))

    def fresnel(self, cosine: ArrayLike) -> Array:
        """What the interface reflects (..., 3) at cosines v.h (..., 1)."""
        return specular.schlick(cosine, self.f0, self.f90)

    def covered(self, cosine: ArrayLike) -> Array:
        """What it takes from the base: of a dielectric the most coloured.

        fresnel_mix of KHR_materials_specular, in appendix B.3.5's place.
        """
        most = np.full(3, self.dielectric[0].max())
        f0 = self._mixed(most, np.array(self.colour))
        return specular.schlick(cosine, f0, self.f90)

    def albedo(self, table: Array) -> Array:
        """Of the lobe under uniform light, with energy compensation."""
        return _compensated(self.f0, self.f90, table)

    def passed(self, table: Array) -> float:
        """The part of it that a dielectric's interface lets through."""
        return 1.0 - float(_compensated(*self.dielectric, table).max())

    def _mixed(self, dielectric: ArrayLike, metal: ArrayLike) -> Array:
        share = self.metalness
        return np.asarray(dielectric) * (1.0 - share) + np.multiply(
            metal, share
        )


def _compensated(f0: Array, f90: float, table: Array) -> Array:
    scale = 1.0 / table.sum() - 1.0
    return np.asarray((f0 * table[0] + f90 * table[1]) * (1.0 + f0 * scale))


class Surroundings:
    """A map and its pieces: what comes from (N,) directions."""

    def __init__(self, pixels: ArrayLike, nodes: int = 6) -> None:
        self.pixels = np.asarray(pixels, float)
        height, width, _ = self.pixels.shape
        u, u_weight = _pieces((np.arange(width + 1) + 0.5) / width, nodes)
        edges = (np.arange(height) + 0.5) / height
        v, v_weight = _pieces(np.concatenate(([0], edges, [1])), nodes)
        uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
        polar, azimuth = uv[:, 1] * np.pi, (uv[:, 0] - 0.5) * 2.0 * np.pi
        self.directions = np.stack(
            (
                np.sin(polar) * np.cos(azimuth),
                np.cos(polar),
                np.sin(polar) * np.sin(azimuth),
            ),
            axis=-1,
        )
        solid_angle = 2.0 * np.pi**2 * np.sin(polar)
        weights = np.outer(v_weight, u_weight).ravel() * solid_angle
        self.light = bilinear(self.pixels, uv) * weights[:, None]


def reflected(
    surroundings: Surroundings,
    normal: Array,
    view: Array,
    material: Material,
    *,
    multiscatter: bool,
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
    l = surroundings.directions @ frame.T  # noqa: E741
    above = l[:, 2] > 0.0
    l = l[above]  # noqa: E741
    light = surroundings.light[above] * l[:, 2:]
    h = half_vectors(np.broadcast_to(v, l.shape), l)
    fresnel = material.fresnel((h @ v)[:, None])
    if material.roughness < 0.3:
        total = _narrow_lobe(surroundings.pixels, frame, v, material)
    else:
        alpha = np.array(material.roughness**2)
        lobe = specular.ggx(h[:, 2], alpha)
        lobe = lobe * specular.smith_correlated(l[:, 2], v[2], alpha)
        total = np.sum(lobe[:, None] * fresnel * light, axis=0)
    scale = 1.0 / table.sum() - 1.0
    if multiscatter:
        total = total * (1.0 + material.f0 * scale)
    passed = (
        np.full(3, material.passed(table))
        if multiscatter
        else 1.0 - material.covered((h @ v)[:, None])
    )
    colour = np.array(material.colour) * (1.0 - material.metalness)
    return total + colour / np.pi * np.sum(passed * light, axis=0)


def _pieces(edges: Array, nodes: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights in each interval of ``edges``."""
    unit, weight = gauss_legendre(nodes)
    length = np.diff(edges)
    places = edges[:-1, None] + length[:, None] * unit
    return places.ravel(), (length[:, None] * weight).ravel()


def _narrow_lobe(
    pixels: Array, frame: Array, v: Array, material: Material, nodes: int = 256
) -> Array:
    if material.roughness == 0.0:
        mirrored = v * (-1, -1, 1)
        return material.fresnel(v[2]) * radiance(pixels, mirrored @ frame)
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
    fresnel = material.fresnel(v_dot_h[..., None])
    light = radiance(pixels, l @ frame)
    return np.einsum("ij,ijk->k", measure, fresnel * light)
