"""Samplers, transforms and the forms in which images come."""

import io
import struct
from typing import Any

import numpy as np
from PIL import Image, ImageCms
from PIL.PngImagePlugin import PngInfo

from tests.conformance.case import SLANTED_EDGES, Case
from tests.conformance.painting import (
    Array,
    black,
    inside,
    paint,
    srgb_to_linear,
)
from tests.conformance.scene_file import SceneFile, png

__all__ = ["TEXTURES"]

_NEAREST: dict[str, Any] = {"magFilter": 9728, "minFilter": 9728}
_WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071}
_CLAMPED: dict[str, Any] = {"wrapS": 33071, "wrapT": 33071}
_PLACES = [(x, y) for y in (0.65, 0.0, -0.65) for x in (-0.65, 0.0, 0.65)]
_HALF = 0.25


def _picture(height: int = 4, width: int = 4) -> Array:
    """Texels (H, W, 3) that are all different."""
    row, column = np.mgrid[0:height, 0:width]
    channels = [
        40 + 200 * column // width,
        240 - 200 * row // height,
        60 + 90 * ((row + column) % 3),
    ]
    return np.stack(channels, axis=-1).astype(np.uint8)


_TEXELS = _picture()


def _texel(u: Array, v: Array, texels: Array = _TEXELS) -> Array:
    """Radiance of the nearest texel, for u and v from 0 to 1."""
    height, width, _ = texels.shape
    column = np.clip(np.floor(u * width), 0, width - 1).astype(int)
    row = np.clip(np.floor(v * height), 0, height - 1).astype(int)
    return np.asarray(srgb_to_linear(texels[row, column, :3] / 255))


def _wrapped(t: Array, wrap: str) -> Array:
    if wrap == "repeat":
        return np.asarray(t % 1)
    if wrap == "mirror":
        return np.asarray(1 - abs(t % 2 - 1))
    return np.asarray(np.clip(t, 0, 1))


_UV_OF_THREE = np.array([(-1, 2), (2, 2), (2, -1), (-1, -1)], float)


def wraps() -> bytes:
    """Nine squares that show a texture three times in both directions."""
    file = SceneFile()
    image = png(_TEXELS)
    modes = [(s, t) for t in _WRAPS.values() for s in _WRAPS.values()]
    for place, (s, t) in zip(_PLACES, modes, strict=True):
        texture = file.texture(image, wrapS=s, wrapT=t, **_NEAREST)
        material = file.material(texture=texture)
        file.node(file.square(material, _HALF, _UV_OF_THREE), place)
    return file.glb()


def painted_wraps(x: Array, y: Array) -> Array:
    """Columns wrap u, rows wrap v."""
    radiance = black(x)
    modes = [(s, t) for t in _WRAPS for s in _WRAPS]
    for (left, top), (s, t) in zip(_PLACES, modes, strict=True):
        u = _wrapped(3 * ((x - left) / _HALF + 1) / 2 - 1, s)
        v = _wrapped(2 - 3 * ((y - top) / _HALF + 1) / 2, t)
        where = inside(x, y, (left, top), _HALF)
        paint(radiance, where, _texel(u, v))
    return radiance


def filters() -> bytes:
    """Two texels, enlarged by the nearest above and linearly below."""
    file = SceneFile()
    image = png(np.array([[(0, 0, 0), (255, 188, 60)]]))
    for code, y in ((9728, 0.5), (9729, -0.5)):
        texture = file.texture(
            image, magFilter=code, minFilter=code, **_CLAMPED
        )
        file.node(
            file.square(file.material(texture=texture)),
            (0, y),
            scale=[1, 0.4, 1],
        )
    return file.glb()


def painted_filters(x: Array, y: Array) -> Array:
    """Mixed after sRGB is decoded."""
    radiance = black(x)
    bright = srgb_to_linear(np.array((255, 188, 60)) / 255)
    mix = np.clip(x + 0.5, 0, 1)[..., None]
    above = inside(x, y, (0, 0.5), (1, 0.4))
    paint(radiance, above, (x > 0)[..., None] * bright)
    return paint(radiance, inside(x, y, (0, -0.5), (1, 0.4)), mix * bright)


def mips() -> bytes:
    """A board of black and white texels, sixteen to a pixel each way."""
    file = SceneFile()
    board = np.indices((256, 256)).sum(axis=0) % 2 * 255
    texture = file.texture(png(board), magFilter=9729, minFilter=9987)
    uv = np.array([(0, 8), (8, 8), (8, 0), (0, 0)], float)
    file.node(file.square(file.material(texture=texture), 0.8, uv))
    return file.glb()


_TRANSFORMS: list[dict[str, Any]] = [
    {},
    {"offset": [0.25, 0.0]},
    {"offset": [0.0, 0.5]},
    {"scale": [0.5, 1.0]},
    {"scale": [2.0, 2.0]},
    {"rotation": np.pi / 6},
    {"rotation": -np.pi / 2, "offset": [0.25, 0.0]},
    {"rotation": 0.4, "scale": [0.5, 1.5], "offset": [0.1, 0.3]},
    {"texCoord": 1, "scale": [1.0, -1.0]},
]


def transforms() -> bytes:
    """Nine squares of one texture, placed differently."""
    file = SceneFile()
    file.uses("KHR_texture_transform")
    texture = file.texture(png(_TEXELS), **_NEAREST)
    for place, transform in zip(_PLACES, _TRANSFORMS, strict=True):
        material = file.material(
            texture={
                "index": texture,
                "extensions": {"KHR_texture_transform": transform},
            }
        )
        # The second set is the first one turned about.
        other = np.array([(1, 0), (0, 0), (0, 1), (1, 1)], float)
        file.node(file.square(material, _HALF, TEXCOORD_1=other), place)
    return file.glb()


def painted_transforms(x: Array, y: Array) -> Array:
    """Translation times rotation times scale, as the extension says."""
    radiance = black(x)
    for (left, top), transform in zip(_PLACES, _TRANSFORMS, strict=True):
        u = ((x - left) / _HALF + 1) / 2
        v = 1 - ((y - top) / _HALF + 1) / 2
        if "texCoord" in transform:
            u, v = 1 - u, 1 - v
        across, down = transform.get("scale", (1, 1))
        u, v = u * across, v * down
        angle = transform.get("rotation", 0.0)
        sine, cosine = np.sin(angle), np.cos(angle)
        # Counter-clockwise for an origin at the top left.
        u, v = cosine * u + sine * v, cosine * v - sine * u
        right, below = transform.get("offset", (0, 0))
        u, v = (u + right) % 1, (v + below) % 1
        where = inside(x, y, (left, top), _HALF)
        paint(radiance, where, _texel(u, v))
    return radiance


_BLOCKS = _picture().repeat(16, axis=0).repeat(16, axis=1)
_GREY = np.repeat(_BLOCKS[..., 1:2], 3, axis=2)
_TURNED = 6  # EXIF: the first row is the right side


def _saved(image: Any, kind: str, **options: Any) -> bytes:
    buffer = io.BytesIO()
    image.save(buffer, kind, **options)
    return buffer.getvalue()


def _with_profile(texels: Array) -> bytes:
    """A PNG whose chunks say that it is linear and in another space."""
    chunks = PngInfo()
    chunks.add(b"gAMA", struct.pack(">I", 100_000))
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("XYZ"))
    return _saved(
        Image.fromarray(texels),
        "PNG",
        pnginfo=chunks,
        icc_profile=profile.tobytes(),
    )


def images() -> list[tuple[bytes, str, Array]]:
    """The forms of nine images, their media types, and what they show."""
    colour, odd = Image.fromarray(_BLOCKS), _picture(3, 5)
    grey = Image.fromarray(_GREY[..., 0])
    clear = np.dstack([_GREY[..., 0], np.full(_GREY.shape[:2], 128)])
    exif = Image.Exif()
    exif[0x0112] = _TURNED
    jpeg = {"quality": 98, "subsampling": 0}
    forms = [
        (_saved(grey, "PNG"), "png", _GREY),
        (png(clear.astype(np.uint8)), "png", _GREY),
        (
            _saved(colour.quantize(16, dither=Image.Dither.NONE), "PNG"),
            "png",
            _BLOCKS,
        ),
        (png(_GREY[..., 0].astype(np.uint16) * 257), "png", _GREY),
        (_with_profile(odd), "png", odd),
        (_saved(colour, "JPEG", **jpeg), "jpeg", _BLOCKS),
        (
            _saved(colour, "JPEG", progressive=True, **jpeg),
            "jpeg",
            _BLOCKS,
        ),
        (_saved(colour.convert("CMYK"), "JPEG", **jpeg), "jpeg", _BLOCKS),
        # The decoder turns it back, by a quarter clockwise.
        (
            _saved(
                Image.fromarray(np.ascontiguousarray(np.rot90(_BLOCKS))),
                "JPEG",
                exif=exif,
                **jpeg,
            ),
            "jpeg",
            _BLOCKS,
        ),
    ]
    return [(data, f"image/{kind}", shown) for data, kind, shown in forms]


def formats() -> bytes:
    """One square for every form."""
    file = SceneFile()
    for place, (data, mime, _) in zip(_PLACES, images(), strict=True):
        texture = file.texture(data, mime, **_NEAREST)
        material = file.material(texture=texture)
        file.node(file.square(material, _HALF), place)
    return file.glb()


def painted_formats(x: Array, y: Array) -> Array:
    """What was encoded; alpha is nothing to opaque materials."""
    radiance = black(x)
    for (left, top), (_, _, shown) in zip(_PLACES, images(), strict=True):
        u = ((x - left) / _HALF + 1) / 2
        v = 1 - ((y - top) / _HALF + 1) / 2
        where = inside(x, y, (left, top), _HALF)
        paint(radiance, where, _texel(u, v, shown))
    return radiance


TEXTURES = [
    Case(
        "Wrap modes",
        "a texture three times each way: repeated, mirrored, clamped",
        "painted: u wraps by column, v by row",
        wraps,
        painted_wraps,
    ),
    Case(
        "Filters",
        "two texels with an edge between them above, a ramp below",
        "painted: sRGB is decoded before texels are mixed",
        filters,
        painted_filters,
        tolerance=3e-3,
    ),
    Case(
        "Mip levels in linear light",
        "one grey, of a board of black and white that is too fine",
        "painted: half of the radiance of white, not half of its code",
        mips,
        lambda x, y: paint(black(x), inside(x, y, (0, 0), 0.8), (0.5,) * 3),
        tolerance=3e-3,
    ),
    Case(
        "KHR_texture_transform",
        "one texture plain, moved, scaled, turned, and by other coordinates",
        "painted",
        transforms,
        painted_transforms,
        allowed=SLANTED_EDGES,
    ),
    Case(
        "Forms of images",
        "PNG: grey, grey with alpha, palette, 16 bits, 5 x 3 texels with a "
        "profile and a gamma that mean nothing; "
        "JPEG: baseline, progressive, CMYK, turned by EXIF",
        "painted: what was encoded; JPEG loses a few steps of 255",
        formats,
        painted_formats,
        tolerance=0.02,
    ),
]
