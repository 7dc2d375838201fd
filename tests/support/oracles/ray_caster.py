"""What a camera sees of a glTF file, pixel by pixel in float64.

Triangles are read with pygltflib, posed by the oracles of keyframes, skins
and morph targets, and hit by one ray for each pixel. Nothing is shared with
the renderer, neither code nor the way of doing it.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from tests.support.oracles.gltf_file import FileOracle
from tests.support.oracles.skinning import deform

__all__ = ["Seen", "Surface", "cast", "surfaces"]

Array = NDArray[Any]
#: Texels are averaged over so many places a side of a pixel.
_TAPS = 4
_TILE = 16
_CLAMP, _MIRROR = 33071, 33648


class Surface(Struct, frozen=True):
    """Triangles (T, 3, ...) of one material in the world."""

    corners: Array
    uv: Array
    colours: Array
    factor: Array
    texels: Array | None
    wraps: tuple[int, int]
    cutoff: float
    double_sided: bool

    def texel(self, uv: Array) -> Array:
        """The nearest texels (P, 4) at ``uv`` (P, 2), linear."""
        assert self.texels is not None
        height, width, _ = self.texels.shape
        column = _index(uv[:, 0], width, self.wraps[0])
        row = _index(uv[:, 1], height, self.wraps[1])
        encoded = self.texels[row, column] / 255
        linear = np.where(
            encoded <= 0.04045,
            encoded / 12.92,
            ((encoded + 0.055) / 1.055) ** 2.4,
        )
        linear[:, 3] = encoded[:, 3]
        return linear


def _index(t: Array, count: int, wrap: int) -> Array:
    index = np.floor(t * count).astype(int)
    if wrap == _CLAMP:
        return np.clip(index, 0, count - 1)
    if wrap == _MIRROR:
        index = index % (2 * count)
        return np.minimum(index, 2 * count - 1 - index)
    return index % count


class Seen(Struct, frozen=True):
    """Depth (N, N), infinite where nothing is, and base colour (N, N, 3)."""

    depth: Array
    colour: Array


def surfaces(
    oracle: FileOracle, animation: int | None, time: float
) -> Iterator[Surface]:
    """All primitives of the default scene at one moment."""
    gltf = oracle.gltf
    moved = {}
    if animation is not None:
        moved = oracle.moved(gltf.animations[animation], time)
    world = oracle.world(moved)
    for index, matrix in world.items():
        node = gltf.nodes[index]
        if node.mesh is None:
            continue
        mesh = gltf.meshes[node.mesh]
        weights = moved.get((index, "weights"), mesh.weights or ())
        for primitive in mesh.primitives:
            placed: dict[str, Any] = {"node_world": matrix}
            if node.skin is not None:
                placed = _skinned(oracle, primitive, node.skin, world)
            yield _surface(oracle, primitive, weights, placed)


def _skinned(
    oracle: FileOracle, primitive: Any, skin: int, world: dict[int, Any]
) -> dict[str, Any]:
    read = oracle.elements
    joints = oracle.gltf.skins[skin].joints
    inverse = read(oracle.gltf.skins[skin].inverseBindMatrices)
    return {
        "joints": read(primitive.attributes.JOINTS_0),
        "influences": read(primitive.attributes.WEIGHTS_0),
        "joint_world": [world[joint] for joint in joints],
        "inverse_bind": inverse.reshape(-1, 4, 4).transpose(0, 2, 1),
    }


def _surface(
    oracle: FileOracle, primitive: Any, weights: Any, placed: dict[str, Any]
) -> Surface:
    read, gltf = oracle.elements, oracle.gltf
    attributes = primitive.attributes
    positions = deform(
        {"POSITION": read(attributes.POSITION)},
        targets=[
            {"POSITION": read(target["POSITION"])}
            for target in (primitive.targets or ())
        ],
        weights=weights,
        **placed,
    )["POSITION"]
    order = np.arange(len(positions))
    if primitive.indices is not None:
        order = read(primitive.indices)[:, 0]
    order = order.reshape(-1, 3)
    mirrors = "node_world" in placed and (
        np.linalg.det(placed["node_world"][:3, :3]) < 0
    )
    if mirrors:
        order = order[:, ::-1]
    colours = np.ones((len(positions), 4))
    if attributes.COLOR_0 is not None:
        stored = read(attributes.COLOR_0)
        colours[:, : stored.shape[1]] = stored
    uv = np.zeros((len(positions), 2))
    factor, texels, cutoff, double_sided = np.ones(4), None, -1.0, False
    wraps = (0, 0)
    if primitive.material is not None:
        material = gltf.materials[primitive.material]
        double_sided = bool(material.doubleSided)
        if material.alphaMode == "MASK":
            given = material.alphaCutoff
            cutoff = 0.5 if given is None else given
        elif material.alphaMode == "BLEND":
            # A surface from half coverage on, as moka's layers have it.
            cutoff = 0.5
        pbr = material.pbrMetallicRoughness
        if pbr is not None:
            factor = np.array(pbr.baseColorFactor, float)
        if pbr is not None and pbr.baseColorTexture is not None:
            info = pbr.baseColorTexture
            texture = gltf.textures[info.index]
            texels = oracle.image(texture.source)
            if texture.sampler is not None:
                sampler = gltf.samplers[texture.sampler]
                wraps = sampler.wrapS, sampler.wrapT
            uv = read(getattr(attributes, f"TEXCOORD_{info.texCoord or 0}"))
            uv = _transformed(uv, info.extensions)
    return Surface(
        positions[order],
        uv[order].astype(float),
        colours[order],
        factor,
        texels,
        wraps,
        cutoff,
        double_sided,
    )


def _transformed(uv: Array, extensions: dict[str, Any]) -> Array:
    """KHR_texture_transform, in its own words: T R S."""
    given = (extensions or {}).get("KHR_texture_transform")
    if given is None:
        return uv
    angle = given.get("rotation", 0.0)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([(cosine, sine), (-sine, cosine)])
    scaled = uv * np.array(given.get("scale", (1, 1)))
    return np.asarray(scaled @ turn.T + np.array(given.get("offset", (0, 0))))


def cast(parts: list[Surface], view: Array, slope: float, size: int) -> Seen:
    """See ``parts`` with a square perspective of tan(yfov / 2) = slope.

    ``view`` (4, 4) takes the world to the camera.
    """
    seen = Seen(np.full((size, size), np.inf), np.zeros((size, size, 3)))
    for part in parts:
        _cast(part, _project(part, view, slope, size), seen)
    return seen


class _Outlines(Struct, frozen=True):
    """Triangles (T, ...) that face the camera, as the picture has them.

    ``x`` and ``y`` (T, 3) are in pixels, rows downwards, the centre of the
    first one at 0; ``away`` is depth.
    """

    x: Array
    y: Array
    away: Array
    uv: Array
    colours: Array

    def chosen(self, which: Array) -> "_Outlines":
        return _Outlines(
            self.x[which],
            self.y[which],
            self.away[which],
            self.uv[which],
            self.colours[which],
        )

    def shares(self, px: Array, py: Array) -> Array:
        """Barycentric coordinates (..., T, 3) in the picture."""
        x, y = self.x, self.y
        whole = _area(x[:, 0], y[:, 0], x[:, 1], y[:, 1], x[:, 2], y[:, 2])
        parts = [
            _area(px, py, x[:, i], y[:, i], x[:, j], y[:, j])
            for i, j in ((1, 2), (2, 0), (0, 1))
        ]
        return np.stack([each / whole for each in parts], axis=-1)


def _project(part: Surface, view: Array, slope: float, size: int) -> _Outlines:
    placed = part.corners @ view[:3, :3].T + view[:3, 3]
    away = -placed[..., 2]
    assert away.min() > 0, "a triangle reaches behind the camera"
    x = (placed[..., 0] / away / slope + 1) / 2 * size - 0.5
    y = (1 - placed[..., 1] / away / slope) / 2 * size - 0.5
    outlines = _Outlines(x, y, away, part.uv, part.colours)
    area = _area(x[:, 0], y[:, 0], x[:, 1], y[:, 1], x[:, 2], y[:, 2])
    # Counter-clockwise is negative, because rows run downwards.
    return outlines.chosen(area != 0 if part.double_sided else area < 0)


def _area(ax: Any, ay: Any, bx: Any, by: Any, cx: Any, cy: Any) -> Array:
    """Twice that of a triangle."""
    return np.asarray((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))


def _cast(part: Surface, outlines: _Outlines, seen: Seen) -> None:
    """Tile by tile, each with the triangles that reach into it."""
    size = len(seen.depth)
    first = np.stack([outlines.x.min(axis=1), outlines.y.min(axis=1)])
    last = np.stack([outlines.x.max(axis=1), outlines.y.max(axis=1)])
    for top in range(0, size, _TILE):
        for left in range(0, size, _TILE):
            near = (
                (first[0] < left + _TILE)
                & (last[0] >= left)
                & (first[1] < top + _TILE)
                & (last[1] >= top)
            )
            if near.any():
                y, x = np.mgrid[top : top + _TILE, left : left + _TILE]
                pixels = np.stack([x.ravel(), y.ravel()], axis=-1)
                _cast_tile(part, outlines.chosen(near), pixels, seen)


def _cast_tile(
    part: Surface, outlines: _Outlines, pixels: Array, seen: Seen
) -> None:
    """One ray for each of ``pixels`` (P, 2), column and row."""
    shares = outlines.shares(pixels[:, :1], pixels[:, 1:])
    with np.errstate(divide="ignore"):
        distance = 1 / (shares / outlines.away).sum(axis=-1)
    distance[(shares < 0).any(axis=-1)] = np.inf
    while True:
        nearest = distance.argmin(axis=1)
        found = distance[np.arange(len(pixels)), nearest]
        column, row = pixels.T
        closer = found < seen.depth[row, column]
        if not closer.any():
            return
        column, row = column[closer], row[closer]
        hit = outlines.chosen(nearest[closer])
        rgba = _base_colour(part, hit, column, row)
        shown = rgba[:, 3] >= part.cutoff
        seen.depth[row[shown], column[shown]] = found[closer][shown]
        seen.colour[row[shown], column[shown]] = rgba[shown, :3]
        # Where a surface is cut out a ray goes on to the next one.
        cut = np.flatnonzero(closer)[~shown]
        distance[cut, nearest[cut]] = np.inf


def _base_colour(
    part: Surface, hit: _Outlines, column: Array, row: Array
) -> Array:
    """RGBA (P, 4) of the planes of P triangles, over the areas of pixels."""
    offset = (np.arange(_TAPS) + 0.5) / _TAPS - 0.5
    total = np.zeros((len(column), 4))
    for across in offset:
        for down in offset:
            shares = hit.shares(column + across, row + down) / hit.away
            shares /= shares.sum(axis=-1, keepdims=True)
            rgba = np.einsum("pk,pkc->pc", shares, hit.colours) * part.factor
            if part.texels is not None:
                uv = np.einsum("pk,pkc->pc", shares, hit.uv)
                rgba = rgba * part.texel(uv)
            total += rgba
    return total / _TAPS**2
