"""One image for several uses, and masks from afar."""

import numpy as np

from tests.conformance.case import Case
from tests.conformance.materials import reflected
from tests.conformance.painting import (
    Array,
    black,
    inside,
    paint,
    srgb_to_linear,
)
from tests.conformance.scene_file import SceneFile, png

__all__ = ["TEXTURE_USE"]

_TEXELS = np.array(
    [[(0, 100, 0), (0, 180, 255)], [(0, 255, 120), (0, 140, 60)]]
)
_COLOUR = np.array((0.8, 0.5, 0.3))


def colour_and_data() -> bytes:
    """An image that is a colour at the left, and numbers at the right."""
    file = SceneFile()
    texture = file.texture(png(_TEXELS), magFilter=9728, minFilter=9728)
    file.node(file.square(file.material(texture=texture), 0.4), (-0.5, 0))
    material = file.material(_COLOUR, lit=True, metallic=1.0)
    pbr = file.gltf.materials[material].pbrMetallicRoughness
    pbr.metallicRoughnessTexture = {"index": texture}
    file.node(file.square(material, 0.4), (0.5, 0))
    file.uses(
        KHR_lights_punctual={
            "lights": [{"type": "directional", "intensity": 2.0}]
        }
    )
    file.node(None, (0, 0, 3), extensions={"KHR_lights_punctual": {"light": 0}})
    return file.glb()


def painted_uses(x: Array, y: Array) -> Array:
    """Texels decoded from sRGB, and as they are."""
    radiance = black(x)
    light = np.array((0.0, 0.0, 1.0))
    for row, down in enumerate((0.2, -0.2)):
        for column, across in enumerate((-0.2, 0.2)):
            texel = _TEXELS[row, column] / 255
            where = inside(x, y, (across - 0.5, down), 0.2)
            paint(radiance, where, srgb_to_linear(texel))
            seen = 2.0 * reflected(_COLOUR, texel[2], texel[1], light)
            paint(radiance, inside(x, y, (across + 0.5, down), 0.2), seen)
    return radiance


_SHARE = 0.3


def leaves() -> bytes:
    """A thicket of crosses of five texels, five texels to a pixel."""
    file = SceneFile()
    random = np.random.default_rng(3)
    texels = np.full((800, 800, 4), 255, np.uint8)
    # Until so many are covered; others may lie in the way.
    count = int(-np.log(1 - _SHARE) / 5 * 800**2)
    row, column = random.integers(0, 800, (2, count))
    texels[..., 3] = 0
    for down, right in ((0, 0), (0, 1), (1, 0), (0, -1), (-1, 0)):
        texels[(row + down) % 800, (column + right) % 800, 3] = 255
    texture = file.texture(png(texels), minFilter=9987)
    material = file.material(
        (0.2, 0.7, 0.1), texture, alphaMode="MASK", alphaCutoff=0.5
    )
    file.node(file.square(material))
    return file.glb()


def fence() -> bytes:
    """Upright stripes, ten pixels each, on a wall leaning away by 80 degrees.

    A texel is a hundredth of a stripe, so that across them there are ten to
    a pixel, and eight times as many along them.
    """
    file = SceneFile()
    texels = np.zeros((1600, 1600), np.uint8)
    texels[:, (np.arange(1600) // 100) % 2 == 0] = 255
    texture = file.texture(png(texels), minFilter=9987, wrapS=33071)
    uv = np.array([(0, 6), (1, 6), (1, 0), (0, 0)], float)
    half = np.radians(80) / 2
    file.node(
        file.square(file.material(texture=texture), uv=uv),
        rotation=[float(-np.sin(half)), 0, 0, float(np.cos(half))],
        scale=[1, 4, 1],
    )
    return file.glb()


def painted_fence(x: Array, y: Array) -> Array:
    """Stripes, and no grey but at their edges."""
    stripes = np.floor((x + 1) * 8) % 2 == 0
    shown = inside(x, y, (0, 0), (1, 4 * np.cos(np.radians(80))))
    return paint(black(x), shown & stripes, (1, 1, 1))


TEXTURE_USE = [
    Case(
        "Anisotropic filtering",
        "stripes on a wall that leans away, sharp although it does",
        "painted; the two columns of pixels beside each edge are mixed",
        fence,
        painted_fence,
        tolerance=0.05,
        allowed=0.14,
        options={"anisotropy": 16},
    ),
    Case(
        "One image as colour and as data",
        "four colours; four metals of other roughnesses",
        "painted: decoded from sRGB at the left, as it is at the right",
        colour_and_data,
        painted_uses,
        options={"multiscatter": False},
    ),
    Case(
        "Coverage of masks from afar",
        "a thicket that is as dense as its texture, although smaller",
        "painted: the share that is opaque, as means of 40 by 40 pixels",
        leaves,
        lambda x, _: np.full((*x.shape, 3), _SHARE) * (0.2, 0.7, 0.1),
        # Of 0.3, 0.23 to 0.37: mixing two levels takes a little away. Levels
        # that do not keep their coverage leave less than 0.1.
        tolerance=0.05,
        block=40,
    ),
]
