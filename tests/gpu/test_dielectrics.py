"""KHR_materials_ior and KHR_materials_specular, against float64.

The oracle has the extensions' formulas, the lobe and its table in float64;
patches of one material and one normal are the GPU's answer to each.
"""

import re
from itertools import product

import numpy as np
import pytest
from msgspec.structs import replace

from moka.commands.descriptors import Filter, MipmapMode, SamplerDescriptor
from moka.core.colour import encode_srgb8
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.description import describe_material
from moka.material.material import Material, Texture, TextureTransform
from moka.model.geometry import quad
from moka.model.lights import LightKind, PunctualLight
from moka.renderer.permutation import LightingDescription, Permutation
from tests.support.glsl import preprocessed
from tests.support.oracles import reference as oracle
from tests.support.oracles import specular
from tests.support.patches import (
    VIEW,
    draw_patches,
    expected_patches,
    sunny,
    tilted,
)
from tests.support.pictures import (
    draw_radiance,
    encoded,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

CLAY = (0.8, 0.3, 0.2)
WHITE = (1.0, 1.0, 1.0)
NORMALS = tilted([1.0, 0.6, 0.2])
# ior, specular factor, specular colour: the last is beyond 1 and clamped.
DIELECTRICS = [
    (1.0, 1.0, WHITE),
    (1.33, 0.5, (1.0, 0.2, 0.1)),
    (1.5, 0.0, WHITE),
    (2.4, 1.0, (0.2, 1.0, 3.0)),
    (0.0, 0.75, WHITE),
    (3.0, 1.0, (9.0, 1.0, 0.0)),
]


def materials(
    colour: tuple[float, float, float] = CLAY,
    roughnesses: tuple[float, ...] = (0.25, 0.6, 1.0),
    metalnesses: tuple[float, ...] = (0.0, 0.5, 1.0),
) -> list[oracle.Material]:
    return [
        oracle.Material(colour, metalness, roughness, *dielectric)
        for dielectric, metalness, roughness in product(
            DIELECTRICS, metalnesses, roughnesses
        )
    ]


def table_of(cosine: float, roughness: float) -> np.ndarray:
    return specular.table_of_microfacets(
        min(cosine, 1 - 1e-9), roughness, specular.smith_correlated, 96
    )


def test_uniform_light_gives_the_albedo_of_the_table(
    egl_device: GraphicsDevice,
) -> None:
    tried = materials()
    drawn = draw_patches(
        egl_device, Environment.uniform(WHITE), NORMALS, tried
    ).mean(axis=2)
    for material, row in zip(tried, drawn, strict=True):
        base = np.array(material.colour) * (1.0 - material.metalness)
        for normal, value in zip(NORMALS, row, strict=True):
            table = table_of(normal @ VIEW, material.roughness)
            expected = material.albedo(table) + base * material.passed(table)
            assert value == pytest.approx(expected, abs=2e-3), material


def test_no_dielectric_returns_more_than_it_gets(
    egl_device: GraphicsDevice,
) -> None:
    normals = tilted([1.0, 0.7, 0.4, 0.15, 0.05])
    returned = draw_patches(
        egl_device,
        Environment.uniform(WHITE),
        normals,
        materials(WHITE, (0.0, 0.1, 0.5, 1.0)),
    )
    # The cubes are of half floats; without the extensions it is as much.
    assert returned.max() <= 1.0 + 2e-4
    # Nor does one that is grey swallow anything.
    grey = draw_patches(
        egl_device,
        Environment.uniform(WHITE),
        normals,
        [oracle.Material(WHITE, 0.0, 0.5, 2.0, 0.7)],
    )
    assert grey == pytest.approx(1.0, abs=2e-4)


@pytest.mark.parametrize("multiscatter", [False, True])
def test_a_lamp_is_reflected_as_the_formula_says(
    egl_device: GraphicsDevice, multiscatter: bool
) -> None:
    turn = 0.8
    towards = np.array([np.sin(turn), 0.0, np.cos(turn)])
    place = np.eye(4)
    place[:3, 0] = np.cos(turn), 0.0, -np.sin(turn)
    place[:3, 2] = towards
    lamp = PunctualLight(LightKind.DIRECTIONAL, intensity=2.0)
    tried = materials()
    drawn = draw_patches(
        egl_device,
        None,
        NORMALS,
        tried,
        lights=[(lamp, place)],
        multiscatter=multiscatter,
    ).mean(axis=2)
    half = (towards + VIEW) / np.linalg.norm(towards + VIEW)
    for material, row in zip(tried, drawn, strict=True):
        alpha = np.array(material.roughness**2)
        base = np.array(material.colour) * (1.0 - material.metalness) / np.pi
        for normal, value in zip(NORMALS, row, strict=True):
            n_dot_l = max(float(normal @ towards), 0.0)
            lobe = material.fresnel(VIEW @ half) * 0.0
            if n_dot_l > 0.0:
                lobe = (
                    specular.ggx(normal @ half, alpha)
                    * specular.smith_correlated(
                        np.array(n_dot_l), normal @ VIEW, alpha
                    )
                    * material.fresnel(VIEW @ half)
                )
            table = table_of(normal @ VIEW, material.roughness)
            if multiscatter:
                lobe = lobe * (1.0 + material.f0 * (1.0 / table.sum() - 1.0))
                share = material.passed(table)
            else:
                share = 1.0 - material.covered(VIEW @ half)
            expected = 2.0 * n_dot_l * (lobe + base * share)
            assert value == pytest.approx(expected, rel=3e-3, abs=1e-4)


@pytest.mark.parametrize("multiscatter", [False, True])
def test_the_reference_integrates_the_same_surface(
    egl_device: GraphicsDevice, multiscatter: bool
) -> None:
    pixels = sunny(sun=0.0)
    tried = materials(roughnesses=(0.0, 0.4), metalnesses=(0.0, 0.5))
    drawn = draw_patches(
        egl_device,
        Environment(pixels),
        NORMALS,
        tried,
        ibl="reference",
        reference_samples=512,
        multiscatter=multiscatter,
    )
    expected = expected_patches(
        pixels, NORMALS, tried, multiscatter=multiscatter
    )
    assert drawn.mean(axis=2) == pytest.approx(expected, rel=0.012, abs=1e-3)


@pytest.mark.parametrize("ibl", ["split-sum", "filtered"])
def test_without_compensation_environments_agree_with_their_integral(
    egl_device: GraphicsDevice, ibl: str
) -> None:
    """Uniform light has no shape that filtering could lose."""
    tried = materials(roughnesses=(0.4, 1.0), metalnesses=(0.0, 0.5))
    pixels = np.ones((8, 16, 3), np.float32)
    drawn = draw_patches(
        egl_device,
        Environment(pixels),
        NORMALS,
        tried,
        ibl=ibl,
        multiscatter=False,
    ).mean(axis=2)
    expected = expected_patches(pixels, NORMALS, tried, multiscatter=False)
    assert drawn == pytest.approx(expected, abs=5e-3)


def picture(
    device: GraphicsDevice, material: Material, **settings: object
) -> np.ndarray:
    scene = scene_of(
        [(quad(2.0), material, np.eye(4))],
        Environment(sunny(sun=0.0)),
        lights=[(PunctualLight(LightKind.POINT, intensity=5.0), LAMP)],
    )
    return draw_radiance(device, scene, square_camera(), (16, 16), **settings)


LAMP = np.eye(4)
LAMP[:3, 3] = 0.5, 0.5, 1.0
PLAIN = Material(
    base_colour_factor=(*CLAY, 1.0), metallic_factor=0.2, roughness_factor=0.4
)


@pytest.mark.parametrize("multiscatter", [False, True])
def test_the_default_is_the_default(
    egl_device: GraphicsDevice, multiscatter: bool
) -> None:
    """To the bit, and to rounding where the shader of others draws it."""
    settings = {"multiscatter": multiscatter}
    plain = picture(egl_device, PLAIN, **settings)
    said = replace(
        PLAIN, ior=1.5, specular_factor=1.0, specular_colour_factor=(1, 1, 1)
    )
    assert (picture(egl_device, said, **settings) == plain).all()
    moving = replace(PLAIN, animated=frozenset({"ior"}))
    through = picture(egl_device, moving, **settings)
    assert through == pytest.approx(plain, rel=1e-5)


def test_textures_say_what_factors_say(egl_device: GraphicsDevice) -> None:
    """Alpha as it is; colour as sRGB; each with coordinates of its own."""
    nearest = SamplerDescriptor(
        magnify=Filter.NEAREST, minify=Filter.NEAREST, mipmap=MipmapMode.NONE
    )
    tint = np.array([0.9, 0.3, 0.05], np.float32)
    texels = np.zeros((1, 2, 4), np.uint8)
    texels[0, 0] = (*encode_srgb8(tint[None, None])[0, 0], 128)
    image = encoded(texels)
    # The left texel everywhere, once by a transform that stays in it.
    still = TextureTransform((0.25, 0.0), 0.0, (0.0, 1.0))
    texture = Texture(image, nearest, transform=still)
    drawn = picture(
        egl_device,
        replace(
            PLAIN,
            ior=2.0,
            specular_factor=0.8,
            specular_texture=texture,
            specular_colour_factor=(1.0, 2.0, 1.0),
            specular_colour_texture=texture,
        ),
    )
    by_factors = picture(
        egl_device,
        replace(
            PLAIN,
            ior=2.0,
            specular_factor=0.8 * 128 / 255,
            specular_colour_factor=(0.9, 0.6, 0.05),
        ),
    )
    assert drawn == pytest.approx(by_factors, rel=3e-3)
    assert np.abs(drawn - picture(egl_device, PLAIN)).max() > 0.01


WORDS = re.compile(r"dielectric_f0|specular_factor|covering_f0|\.dielectric")


@pytest.mark.parametrize("ibl", ["split-sum", "filtered", "reference"])
@pytest.mark.parametrize("multiscatter", [False, True])
def test_a_plain_shader_has_no_word_of_it(ibl: str, multiscatter: bool) -> None:
    lighting = LightingDescription(
        True, 2, "gltf", "lambert", multiscatter, False, ibl=ibl
    )
    plain, other = (
        preprocessed(
            Permutation(describe_material(material, ["NORMAL"]), lighting)
            .program()
            .fragment.source
        )
        for material in (PLAIN, replace(PLAIN, ior=1.4))
    )
    assert "void main" in plain
    assert not WORDS.search(plain)
    # The test would see them.
    assert WORDS.search(other)
