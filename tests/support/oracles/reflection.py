"""What a surface reflects of an environment map, integrated in float64.

The map is what a texture lookup makes of it, bilinear between the centres
of texels. It is cut at a limit: what is below varies little, and a product
quadrature over half vectors is accurate; what is above are few texels, each
of which is integrated over its own tent.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.support.oracles.directions import gauss_legendre
from tests.support.oracles.environment import (
    around,
    equirectangular_directions,
    equirectangular_solid_angles,
)
from tests.support.oracles.specular import ggx, schlick, smith_correlated

Array = NDArray[np.float64]


class MapOracle:
    """Specular reflection of a map (H, W, 3) by glTF 2.0's BRDF."""

    def __init__(
        self, pixels: NDArray[np.float32], limit: float = 8.0, tent: int = 4
    ) -> None:
        pixels = pixels.astype(np.float64)
        height, width, _ = pixels.shape
        edges = np.cos(np.linspace(0.0, np.pi, height + 1))
        areas = (edges[:-1] - edges[1:]) * 2.0 * np.pi / width
        mean = np.einsum("h,hwc->", areas, pixels) / (12.0 * np.pi)
        brightness = pixels.mean(axis=2, keepdims=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = np.where(
                brightness > limit * mean, limit * mean / brightness, 1.0
            )
        self._below = pixels * scale
        excess = pixels - self._below
        row, column = np.nonzero(excess.any(axis=2))
        # Points in the square of two texels over which a texel is felt.
        offset = (np.arange(2 * tent) + 0.5) / tent - 1.0
        dy, dx = (a.ravel() for a in np.meshgrid(offset, offset))
        weight = (1.0 - np.abs(dx)) * (1.0 - np.abs(dy)) / tent**2
        v = (row[:, None] + 0.5 + dy) / height * np.pi
        u = ((column[:, None] + 0.5 + dx) / width - 0.5) * 2.0 * np.pi
        sine = np.sin(v)
        self.directions = np.stack(
            (sine * np.cos(u), np.cos(v), sine * np.sin(u)), axis=-1
        ).reshape(-1, 3)
        # |sin|: over a pole a texel goes on with the other side.
        measure = np.abs(sine) * weight * 2.0 * np.pi**2 / (height * width)
        self.flux = (measure[..., None] * excess[row, column][:, None]).reshape(
            -1, 3
        )

    def radiance(self, directions: Array) -> Array:
        """The cut map in ``directions`` (..., 3), bilinear."""
        height, width, _ = self._below.shape
        x, y, z = np.moveaxis(directions, -1, 0)
        u = (0.5 + np.arctan2(z, x) / (2.0 * np.pi)) * width - 0.5
        v = np.arctan2(np.hypot(x, z), y) / np.pi * height - 0.5
        left, top = np.floor(u).astype(int), np.floor(v).astype(int)
        s, t = (u - left)[..., None], (v - top)[..., None]
        rows = [np.clip(top + i, 0, height - 1) for i in (0, 1)]
        columns = [(left + i) % width for i in (0, 1)]
        upper, lower = (
            (1.0 - s) * self._below[row, columns[0]]
            + s * self._below[row, columns[1]]
            for row in rows
        )
        return (1.0 - t) * upper + t * lower

    def specular(
        self,
        normals: Array,
        views: Array,
        roughness: ArrayLike,
        f0: ArrayLike,
        nodes: int = 64,
    ) -> Array:
        """Radiance (N, 3) towards ``views``; ``roughness`` (N,) or one."""
        rough = np.broadcast_to(np.asarray(roughness, float), len(normals))
        return np.stack(
            [
                self._of_map(n, v, r**2, np.asarray(f0), nodes)
                + self._of_excess(n, v, r**2, np.asarray(f0))
                for n, v, r in zip(normals, views, rough, strict=True)
            ]
        )

    def diffuse(
        self, normals: Array, views: Array, colour: ArrayLike, f0: float
    ) -> Array:
        """Radiance (N, 3) of a Lambert base under 1 - F(v.h)."""
        height, width, _ = self._below.shape
        directions = equirectangular_directions(width, height).reshape(-1, 3)
        areas = equirectangular_solid_angles(width, height).reshape(-1, 1)
        directions = np.concatenate((directions, self.directions))
        flux = np.concatenate((areas * self._below.reshape(-1, 3), self.flux))
        rows = []
        for n, v in zip(normals, views, strict=True):
            half = directions + v
            size = np.maximum(np.linalg.norm(half, axis=-1), 1e-12)
            share = 1.0 - schlick(half @ v / size, f0)
            cosine = np.maximum(directions @ n, 0.0)
            rows.append((share * cosine) @ flux / np.pi)
        return np.stack(rows) * np.asarray(colour)

    def _of_map(
        self, n: Array, v: Array, alpha: float, f0: Array, nodes: int
    ) -> Array:
        """tan(theta_h) = alpha tan(psi) flattens D, as in specular._table."""
        unit, weight = gauss_legendre(nodes)
        psi = unit * np.pi / 2.0
        tangent = alpha * np.tan(psi)
        cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
        azimuth = (np.arange(2 * nodes) + 0.5) / nodes * np.pi
        sine = tangent * cosine
        half = np.stack(
            (
                sine[:, None] * np.cos(azimuth),
                sine[:, None] * np.sin(azimuth),
                np.broadcast_to(cosine[:, None], (nodes, 2 * nodes)),
            ),
            axis=-1,
        )
        frame = around(n)
        view = frame @ v
        v_dot_h = half @ view
        light = 2.0 * v_dot_h[..., None] * half - view
        n_dot_l, n_dot_h = light[..., 2], half[..., 2]
        ok = (n_dot_l > 0.0) & (v_dot_h > 0.0)
        light, n_dot_l = light[ok], n_dot_l[ok]
        v_dot_h, n_dot_h = v_dot_h[ok], n_dot_h[ok]
        measure = np.sin(2.0 * psi) * weight * np.pi / 4.0 / nodes
        measure = np.broadcast_to(measure[:, None], ok.shape)[ok]
        visibility = smith_correlated(
            n_dot_l, np.full_like(n_dot_l, view[2]), np.asarray(alpha)
        )
        factor = visibility * n_dot_l * 4.0 * v_dot_h / n_dot_h * measure
        fresnel = schlick(v_dot_h[:, None], f0)
        radiance = self.radiance(light @ frame)
        return np.sum(factor[:, None] * fresnel * radiance, axis=0)

    def _of_excess(self, n: Array, v: Array, alpha: float, f0: Array) -> Array:
        n_dot_l = self.directions @ n
        above = n_dot_l > 0.0
        light, n_dot_l = self.directions[above], n_dot_l[above]
        half = light + v
        half /= np.linalg.norm(half, axis=-1, keepdims=True)
        n_dot_v = np.full_like(n_dot_l, n @ v)
        lobe = (
            ggx(half @ n, alpha)
            * smith_correlated(n_dot_l, n_dot_v, np.asarray(alpha))
            * n_dot_l
        )
        fresnel = schlick((half @ v)[:, None], f0)
        return np.sum(lobe[:, None] * fresnel * self.flux[above], axis=0)


def sphere_points(count: int, seed: int = 1) -> tuple[Array, Array]:
    """Normals and views (count, 3) of pixels of a sphere, seen from +Z.

    Even over the disc that a parallel camera sees: stratified by a Vogel
    spiral, without the outermost two per cent of the radius.
    """
    turn = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi)
    index = np.arange(count) + 0.5
    radius = 0.98 * np.sqrt(index / count)
    angle = turn + index * np.pi * (3.0 - np.sqrt(5.0))
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    normals = np.stack((x, y, np.sqrt(1.0 - x * x - y * y)), axis=-1)
    return normals, np.tile([0.0, 0.0, 1.0], (count, 1))


def errors(values: Array, truth: Array) -> tuple[float, float]:
    """Relative RMSE of a sphere, and the median relative error a pixel."""
    difference = np.linalg.norm(values - truth, axis=-1)
    size = np.linalg.norm(truth, axis=-1)
    return (
        float(np.sqrt(np.mean(difference**2) / np.mean(size**2))),
        float(np.median(difference / size)),
    )
