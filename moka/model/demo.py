"""The built-in demo scene: spheres of several materials on tiled steps.

From left to right roughness grows from mirror to matt; the rows are coloured
dielectrics in front, gold in the middle and aluminium at the back. The tiles
show a base colour, a normal and an occlusion-roughness-metalness texture,
all made here, repeated through KHR_texture_transform.
"""

import colorsys
import math
import struct
import zlib
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import SamplerDescriptor
from moka.core.encoded_image import EncodedImage
from moka.core.maths import Array, look_rotation
from moka.material.material import Material, Texture, TextureTransform
from moka.model.assemble import model_of
from moka.model.cameras import CameraDescription, Perspective
from moka.model.geometry import cube, sphere
from moka.model.mesh import Primitive
from moka.model.model import Model

__all__ = ["demo_model"]

_COLUMNS = 7
_TILE = 0.6  # metres along an edge
_TILES = 2  # tiles along an edge of the texture
_TEXELS = 256
# Every sphere stands on 2 x 2 tiles, every step is one tile high.
_SPACING = 2 * _TILE
_RADIUS = 0.52
_WIDTH = _COLUMNS * _SPACING

# Reflectance at normal incidence in linear Rec.709, rounded from what the
# metals' measured refractive indices give.
_ALUMINIUM = (0.91, 0.92, 0.92)
_GOLD = (1.0, 0.77, 0.34)

Item = tuple[Primitive, Material | None, Array]


def demo_model() -> Model:
    """The demo scene, with one camera; 8.4 by 2.5 by 4.2 metres."""
    camera = CameraDescription(
        Perspective(yfov=math.radians(26), near=0.1), "demo"
    )
    eye = _placed((-2.9, 4.3, 11.3))
    eye[:3, :3] = look_rotation((2.8, -3.75, -12.2), (0, 1, 0))
    return model_of(
        [*_steps(), *_spheres()], name="demo", cameras=[(camera, eye)]
    )


def _spheres() -> list[Item]:
    shape = sphere(_RADIUS, segments=64, rings=32)
    items: list[Item] = []
    for row in range(3):
        for column in range(_COLUMNS):
            x = (column - (_COLUMNS - 1) / 2) * _SPACING
            y = _RADIUS + row * _TILE
            place = _placed((x, y, -row * _SPACING))
            items.append((shape, _sphere_material(row, column), place))
    return items


def _sphere_material(row: int, column: int) -> Material:
    share = column / (_COLUMNS - 1)
    if row == 0:
        # Hues that stop short of meeting again, in linear light.
        red, green, blue = colorsys.hsv_to_rgb(0.72 * share, 0.96, 0.55)
        return Material(
            name=f"dielectric {column}",
            base_colour_factor=(red, green, blue, 1.0),
            metallic_factor=0.0,
            roughness_factor=share,
        )
    name, colour = ("gold", _GOLD) if row == 1 else ("aluminium", _ALUMINIUM)
    return Material(
        name=f"{name} {column}",
        base_colour_factor=(*colour, 1.0),
        roughness_factor=share,
    )


def _steps() -> list[Item]:
    """A low slab for the first row, a step for each of the others."""
    material = _tile_material()
    boxes = (
        # lower, upper, back and front edge
        (-_TILE / 2, 0.0, -2.5 * _SPACING, 1.0 * _SPACING),
        (0.0, _TILE, -2.5 * _SPACING, -0.5 * _SPACING),
        (_TILE, 2 * _TILE, -2.5 * _SPACING, -1.5 * _SPACING),
    )
    return [
        (
            _box(_WIDTH, upper - lower, front - back),
            material,
            _placed((0.0, (lower + upper) / 2, (back + front) / 2)),
        )
        for lower, upper, back, front in boxes
    ]


def _box(width: float, height: float, depth: float) -> Primitive:
    """A box around the origin, its texture coordinates in metres."""
    base = cube().attributes
    corners = (base["POSITION"] * (width, height, depth)).reshape(6, 4, 3)
    extent = np.stack(
        [
            np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1),
            np.linalg.norm(corners[:, 2] - corners[:, 1], axis=1),
        ],
        axis=-1,
    )
    uv = base["TEXCOORD_0"].reshape(6, 4, 2) * extent[:, None]
    return Primitive(
        {
            "POSITION": corners.reshape(-1, 3),
            "NORMAL": base["NORMAL"],
            "TEXCOORD_0": uv.reshape(-1, 2),
        },
        cube().indices,
    )


def _tile_material() -> Material:
    """Polished and honed stone, for texture coordinates in metres."""
    repeat = 1 / (_TILES * _TILE)
    base_colour, surface, normal = (
        Texture(
            EncodedImage(f"demo: {name}", data=data),
            SamplerDescriptor(anisotropy=8.0),
            transform=TextureTransform(scale=(repeat, repeat)),
        )
        for name, data in _tile_images().items()
    )
    return Material(
        name="tiles",
        base_colour_texture=base_colour,
        metallic_roughness_texture=surface,
        occlusion_texture=surface,
        normal_texture=normal,
    )


@cache
def _tile_images() -> dict[str, bytes]:
    """PNG files that repeat without a seam: tiles, grout and bevels."""
    texel = (np.arange(_TEXELS) + 0.5) / _TEXELS
    u, v = texel[None, :], texel[:, None]
    veins = _veins(u, v)
    # Distance from the nearest edge of the tile, 0 to 0.5.
    edge = np.minimum(*(0.5 - np.abs(_TILES * x % 1 - 0.5) for x in (u, v)))
    inside = np.clip((edge - 0.008) / 0.012, 0, 1)
    bevel = np.sqrt(np.clip((edge - 0.008) / 0.04, 0, 1))
    dark = (np.floor(_TILES * u) + np.floor(_TILES * v)) % 2
    tone = np.where(dark, 0.30, 0.62) + 0.05 * veins
    grey = inside * tone + (1 - inside) * 0.2
    roughness = inside * (0.22 + 0.2 * dark + 0.06 * veins)
    roughness += (1 - inside) * 0.9
    occlusion = 0.5 + 0.5 * inside
    height = 0.02 * bevel + 0.0004 * veins
    return {
        "base colour": _png(np.stack([grey, 0.98 * grey, 0.94 * grey], -1)),
        "surface": _png(
            np.stack([occlusion, roughness, np.zeros_like(grey)], -1)
        ),
        "normal": _png(0.5 + 0.5 * _normals(height)),
    }


def _veins(u: Array, v: Array) -> Array:
    """A cloudy pattern of mean 0 and period 1: waves that bend waves."""
    turn = 2 * np.pi
    bend = np.sin(turn * (u + 2 * v)) + 0.5 * np.sin(turn * (3 * v - 2 * u))
    coarse = np.sin(turn * (2 * u - v) + 1.7 * bend)
    fine = np.sin(turn * (5 * v + 3 * u) + 2.3 * bend + coarse)
    return np.asarray(0.6 * coarse + 0.4 * fine)


def _normals(height: Array) -> Array:
    """Tangent-space normals (H, W, 3), +Y up, of a height in tiles."""
    step = _TEXELS / (2 * _TILES)
    right = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * step
    down = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) * step
    normals = np.stack([-right, down, np.ones_like(height)], -1)
    return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True))


def _png(colours: NDArray[Any]) -> bytes:
    """A PNG of colours (H, W, 3) in 0..1, as they are to be stored.

    Written here, because it is 10 lines and an image library takes longer
    to import than the whole demo to build. Source: ISO/IEC 15948.
    """
    texels = np.round(255 * np.clip(colours, 0, 1)).astype(np.uint8)
    height, width, _ = texels.shape
    # Each row begins with its filter, Sub: the difference to the left.
    rows = np.zeros((height, 1 + 3 * width), np.uint8)
    rows[:, 0] = 1
    rows[:, 1:] = np.diff(texels, axis=1, prepend=0).reshape(height, -1)
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows.tobytes(), 1)),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data))
        + kind
        + data
        + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )


def _placed(position: tuple[float, float, float]) -> Array:
    matrix = np.eye(4)
    matrix[:3, 3] = position
    return matrix
