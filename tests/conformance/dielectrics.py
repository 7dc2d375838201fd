"""How much dielectrics reflect: KHR_materials_ior, KHR_materials_specular."""

from typing import Any

import numpy as np

from moka.core.colour import encode_srgb8
from tests.conformance.case import Case
from tests.conformance.painting import Array, black, inside, paint
from tests.conformance.scene_file import SceneFile, png
from tests.support.oracles.specular import ggx, smith_correlated

__all__ = ["DIELECTRICS"]

_BASE = np.array((0.02, 0.05, 0.2))
_ROUGHNESS = 0.5
#: How a lamp is turned that shines along (-1, 0, -1), and where it stands.
_SLANTED = [0.0, float(np.sin(np.pi / 8)), 0.0, float(np.cos(np.pi / 8))]
_TO_LIGHT = np.array((np.sqrt(0.5), 0.0, np.sqrt(0.5)))
_COLUMNS = (-0.75, -0.25, 0.25, 0.75)
_WHITE = (1.0, 1.0, 1.0)
#: By row: ior, specularFactor and specularColorFactor of each column.
_ROWS = {
    0.65: [(ior, 1.0, _WHITE) for ior in (1.0, 1.5, 2.4, 0.0)],
    0.0: [(2.4, factor, _WHITE) for factor in (0.0, 0.3, 0.6, 1.0)],
    -0.65: [
        (2.4, 1.0, colour)
        for colour in ((1, 0.1, 0.1), (0.1, 1, 0.1), (1, 0.8, 0), (5, 9, 1))
    ],
}


def _extensions(
    ior: float, factor: float, colour: tuple[float, ...], **textures: Any
) -> dict[str, Any]:
    return {
        "KHR_materials_ior": {"ior": ior},
        "KHR_materials_specular": {
            "specularFactor": factor,
            "specularColorFactor": [float(each) for each in colour],
            **textures,
        },
    }


def _lit_file() -> SceneFile:
    """An empty file with a lamp of 6 lux."""
    file = SceneFile()
    file.uses(
        "KHR_materials_ior",
        "KHR_materials_specular",
        KHR_lights_punctual={
            "lights": [{"type": "directional", "intensity": 6.0}]
        },
    )
    file.node(
        rotation=_SLANTED, extensions={"KHR_lights_punctual": {"light": 0}}
    )
    return file


def squares() -> bytes:
    """Twelve dielectrics."""
    file = _lit_file()
    for y, row in _ROWS.items():
        for x, (ior, factor, colour) in zip(_COLUMNS, row, strict=True):
            material = file.material(
                _BASE,
                lit=True,
                roughness=_ROUGHNESS,
                extensions=_extensions(ior, factor, colour),
            )
            file.node(file.square(material, 0.2), (x, y))
    return file.glb()


def painted_squares(x: Array, y: Array) -> Array:
    """``fresnel_mix`` as KHR_materials_specular writes it."""
    half = _TO_LIGHT + np.array((0.0, 0.0, 1.0))
    half /= np.linalg.norm(half)
    alpha = np.array(_ROUGHNESS**2)
    lobe = ggx(half[2], alpha) * smith_correlated(
        _TO_LIGHT[2], np.array(1.0), alpha
    )
    radiance = black(x)
    for row, dielectrics in _ROWS.items():
        for column, (ior, weight, colour) in zip(
            _COLUMNS, dielectrics, strict=True
        ):
            f0 = ((1 - ior) / (1 + ior)) ** 2 * np.array(colour)
            f0 = np.minimum(f0, 1.0)
            fresnel = f0 + (1 - f0) * (1 - half[2]) ** 5
            base = (1 - weight * fresnel.max()) * _BASE / np.pi
            value = base + weight * fresnel * lobe
            place = inside(x, y, (column, row), 0.2)
            paint(radiance, place, 6.0 * _TO_LIGHT[2] * value)
    return radiance


_TINTS = np.array([(1, 0.1, 0.1), (0.1, 1, 0.1), (0.2, 0.2, 1), (1, 1, 1)])
_ALPHAS = np.array((64, 128, 192, 255))


def by_textures() -> bytes:
    """A square whose four stripes are texels of one image."""
    file = _lit_file()
    texels = np.zeros((1, 4, 4), np.uint8)
    texels[..., :3] = encode_srgb8(_TINTS[None].astype(np.float32))
    texels[..., 3] = _ALPHAS
    texture = file.texture(
        png(texels), magFilter=9728, minFilter=9728, wrapS=33071, wrapT=33071
    )
    material = file.material(
        _BASE,
        lit=True,
        roughness=_ROUGHNESS,
        extensions=_extensions(
            2.4,
            0.8,
            (1, 2, 1),
            specularTexture={"index": texture},
            specularColorTexture={"index": texture},
        ),
    )
    file.node(file.square(material, 0.8))
    return file.glb()


def by_factors() -> bytes:
    """The same as four squares with factors."""
    file = _lit_file()
    for x, tint, alpha in zip(
        (-0.6, -0.2, 0.2, 0.6), _TINTS, _ALPHAS, strict=True
    ):
        material = file.material(
            _BASE,
            lit=True,
            roughness=_ROUGHNESS,
            extensions=_extensions(
                2.4, 0.8 * float(alpha) / 255, tuple(tint * (1, 2, 1))
            ),
        )
        file.node(file.square(material), (x, 0), scale=[0.2, 0.8, 1])
    return file.glb()


DIELECTRICS = [
    Case(
        "KHR_materials_ior and KHR_materials_specular",
        "twelve blue squares: above of more and more refraction, the last "
        "reflecting everything; in the middle of more and more reflection; "
        "below with highlights in colour",
        "painted: the formulas of the extensions under a slanted lamp",
        squares,
        painted_squares,
        options={"multiscatter": False},
    ),
    Case(
        "Textures of KHR_materials_specular",
        "four stripes: red, green, blue and white highlights, each stronger "
        "than the one before",
        "the same by factors; colour in sRGB, strength in alpha",
        by_textures,
        plain=by_factors,
        tolerance=4e-3,
        options={"multiscatter": False},
    ),
]
