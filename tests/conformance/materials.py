"""What materials do with light, opacity and emission."""

from functools import partial

import numpy as np

from tests.conformance.case import SIZE, Case
from tests.conformance.painting import Array, black, inside, paint
from tests.conformance.scene_file import SceneFile, png
from tests.support.bump_scenes import (
    LAYOUTS,
    bump_by_geometry,
    bump_by_normal_map,
)
from tests.support.oracles.specular import ggx, schlick, smith_correlated

__all__ = ["MATERIALS", "reflected"]

_COLUMNS = (-0.75, -0.25, 0.25, 0.75)
_RED = np.array((0.8, 0.2, 0.1))
#: How a lamp is turned that shines along (-1, 0, -1).
_SLANTED = [0.0, float(np.sin(np.pi / 8)), 0.0, float(np.cos(np.pi / 8))]


def reflected(
    colour: Array, metallic: float, roughness: float, to_light: Array
) -> Array:
    """BRDF times cosine of a plane that faces +Z, seen from there.

    ``to_light`` are unit vectors (..., 3); glTF 2.0 specification,
    appendix B.3.5, single scattering.
    """
    half = to_light + np.array((0.0, 0.0, 1.0))
    half = half / np.linalg.norm(half, axis=-1, keepdims=True)
    n_dot_l = np.maximum(to_light[..., 2], 1e-9)
    n_dot_h = np.minimum(half[..., 2], 1 - 1e-15)
    f0 = 0.04 * (1 - metallic) + colour * metallic
    fresnel = schlick(n_dot_h[..., None], f0)
    lobe = ggx(n_dot_h, roughness**2) * smith_correlated(
        n_dot_l, np.ones_like(n_dot_l), np.asarray(roughness**2)
    )
    diffuse = (1 - fresnel) * colour / np.pi
    sum_of_both = (1 - metallic) * diffuse + lobe[..., None] * fresnel
    return np.asarray(sum_of_both * n_dot_l[..., None])


def metal_and_roughness() -> bytes:
    """Under one lamp: roughness grows to the right, metalness upwards."""
    file = SceneFile()
    for metallic, y in zip((0.0, 0.5, 1.0), (-0.65, 0.0, 0.65), strict=True):
        for roughness, x in zip((0.4, 0.6, 0.8, 1.0), _COLUMNS, strict=True):
            material = file.material(
                _RED, lit=True, metallic=metallic, roughness=roughness
            )
            file.node(file.square(material, 0.2), (x, y))
    file.uses(
        KHR_lights_punctual={
            "lights": [{"type": "directional", "intensity": 3.0}]
        }
    )
    file.node(
        rotation=_SLANTED, extensions={"KHR_lights_punctual": {"light": 0}}
    )
    return file.glb()


def painted_metals(x: Array, y: Array) -> Array:
    """The BRDF of each square, times 3 lux."""
    radiance = black(x)
    light = np.array((np.sqrt(0.5), 0.0, np.sqrt(0.5)))
    for metallic, row in zip((0.0, 0.5, 1.0), (-0.65, 0.0, 0.65), strict=True):
        for roughness, column in zip(
            (0.4, 0.6, 0.8, 1.0), _COLUMNS, strict=True
        ):
            colour = 3.0 * reflected(_RED, metallic, roughness, light)
            paint(radiance, inside(x, y, (column, row), 0.2), colour)
    return radiance


def masked() -> bytes:
    """Alpha rises from left to right; cut at 0.25, at 0.5 and at 0.75."""
    file = SceneFile()
    ramp = np.full((1, 8, 4), 255, np.uint8)
    ramp[0, :, 3] = np.arange(8) * 36
    texture = file.texture(
        png(ramp), magFilter=9728, wrapS=33071, wrapT=33071, minFilter=9728
    )
    for cutoff, y in ((0.25, 0.65), (0.5, 0.0), (0.75, -0.65)):
        material = file.material(
            _RED, texture, alphaMode="MASK", alphaCutoff=cutoff
        )
        # As wide as the picture, and flat.
        file.node(file.square(material), (0, y), scale=[1, 0.25, 1])
    return file.glb()


def painted_mask(x: Array, y: Array) -> Array:
    """Eight steps of alpha, those at or above the cutoff."""
    radiance = black(x)
    alpha = np.floor((x + 1) / 2 * 8) * 36 / 255
    for cutoff, row in ((0.25, 0.65), (0.5, 0.0), (0.75, -0.65)):
        shown = inside(x, y, (0, row), (1, 0.25)) & (alpha >= cutoff)
        paint(radiance, shown, _RED)
    return radiance


_PANES = [
    ((-0.25, 0.25), 0.0, (0.9, 0.1, 0.1), 0.5),
    ((0.0, 0.0), 0.5, (0.1, 0.8, 0.1), 0.25),
    ((0.25, -0.25), 1.0, (0.1, 0.1, 0.9), 0.75),
]


def blended() -> bytes:
    """Three panes, nearest first in the file, and a wall behind."""
    file = SceneFile()
    for place, depth, colour, alpha in _PANES[::-1]:
        material = file.material((*colour, alpha), alphaMode="BLEND")
        file.node(file.square(material, 0.5), (*place, depth))
    file.node(file.square(file.material((0.5, 0.5, 0.5)), 0.75), (0, 0, -1))
    return file.glb()


def painted_panes(x: Array, y: Array) -> Array:
    """Each over what is behind it."""
    radiance = black(x)
    paint(radiance, inside(x, y, (0, 0), 0.75), (0.5, 0.5, 0.5))
    for place, _, colour, alpha in _PANES:
        over = alpha * np.array(colour) + (1 - alpha) * radiance
        paint(radiance, inside(x, y, place, 0.5), over)
    return radiance


def two_sided() -> bytes:
    """Two squares from behind, the right one of a material of two sides."""
    file = SceneFile()
    for place, both in (((-0.5, 0), False), ((0.5, 0), True)):
        material = file.material(_RED, doubleSided=both)
        file.node(file.square(material, 0.4), place, rotation=[0, 1, 0, 0])
    return file.glb()


def emission() -> bytes:
    """Lamps of radiance 0.2, 0.4, 0.8 and 1.6, by strength."""
    file = SceneFile()
    for number, x in enumerate(_COLUMNS):
        extensions = {}
        if number:
            file.uses("KHR_materials_emissive_strength")
            extensions = {
                "KHR_materials_emissive_strength": {
                    "emissiveStrength": 2.0**number
                }
            }
        material = file.material(
            (0, 0, 0),
            lit=True,
            emissiveFactor=[0.2, 0.1, 0.05],
            extensions=extensions,
        )
        file.node(file.square(material, 0.2), (x, 0))
    return file.glb()


def painted_emission(x: Array, y: Array) -> Array:
    """Twice the radiance of the one before."""
    radiance = black(x)
    for number, column in enumerate(_COLUMNS):
        colour = 2.0**number * np.array((0.2, 0.1, 0.05))
        paint(radiance, inside(x, y, (column, 0), 0.2), colour)
    return radiance


def by_texture(texel: tuple[int, int, int], **strength: float) -> bytes:
    """Occlusion, roughness and metalness in one image."""
    file = SceneFile()
    texture = file.texture(png(np.full((4, 4, 3), texel)))
    material = file.material(
        _RED,
        lit=True,
        metallic=1.0,
        occlusionTexture={"index": texture, **strength},
    )
    pbr = file.gltf.materials[material].pbrMetallicRoughness
    pbr.metallicRoughnessTexture = {"index": texture}
    file.node(file.square(material, 0.8))
    return file.glb()


def by_factors() -> bytes:
    """The same by factors, with occlusion by another texture and strength."""
    file = SceneFile()
    texture = file.texture(png(np.full((4, 4, 3), (51, 0, 0))))
    material = file.material(
        _RED,
        lit=True,
        metallic=0.4,
        roughness=0.6,
        occlusionTexture={"index": texture, "strength": 0.5},
    )
    file.node(file.square(material, 0.8))
    return file.glb()


def unlit_in_light() -> bytes:
    """A red square."""
    file = SceneFile()
    file.node(file.square(file.material(_RED), 0.5))
    return file.glb()


_LAYOUTS = ("upright", "stretched", "mirrored", "mirrored and sheared")
_LIT = {"environment": "studio", "background": "#000000"}

MATERIALS = [
    Case(
        "Metalness and roughness",
        "twelve squares: roughness grows to the right, metalness upwards",
        "painted: appendix B of the specification under a slanted lamp",
        metal_and_roughness,
        painted_metals,
        options={"multiscatter": False},
    ),
    Case(
        "Textures of numbers",
        "one grey of red metal, as its factors would make it",
        "the same by factors; occlusion 0.2 at strength 0.5 is 0.6",
        lambda: by_texture((153, 153, 102)),
        plain=by_factors,
        options=_LIT,
    ),
    Case(
        "alphaMode MASK",
        "steps of alpha from left to right, cut at 0.25, 0.5 and 0.75",
        "painted",
        masked,
        painted_mask,
    ),
    Case(
        "alphaMode BLEND",
        "red, green and blue panes over grey, blue in front",
        "painted: each pane over what is behind it",
        blended,
        painted_panes,
    ),
    Case(
        "doubleSided",
        "one of two squares that turn their backs to us",
        "painted",
        two_sided,
        lambda x, y: paint(black(x), inside(x, y, (0.5, 0), 0.4), _RED),
    ),
    Case(
        "KHR_materials_emissive_strength",
        "four lamps, each twice as bright as the one before",
        "painted",
        emission,
        painted_emission,
    ),
    Case(
        "KHR_materials_unlit",
        "a red square, whatever shines on it",
        "painted: the base colour",
        unlit_in_light,
        lambda x, y: paint(black(x), inside(x, y, (0, 0), 0.5), _RED),
        options=_LIT,
    ),
    *(
        Case(
            f"Normal map, {name} texture",
            "a bump with its shadow below and to the left",
            "the bump as geometry",
            partial(bump_by_normal_map, layout),
            plain=bump_by_geometry,
            options={"environment": "studio", "environment_intensity": 0.4},
            # 8 bits of a map; and between mirrored halves, and where a map
            # ends, columns of pixels whose texels are mixed.
            tolerance=0.01,
            allowed=3 / SIZE,
        )
        for name, layout in LAYOUTS.items()
        if name in _LAYOUTS
    ),
]
