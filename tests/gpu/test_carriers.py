"""Values in the alphas of other textures: the same picture, a sample less."""

from functools import partial

import numpy as np
import pytest

from moka.core.encoded_image import EncodedImage
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.description import describe_material
from moka.material.material import AlphaMode, Material, Texture
from moka.model.geometry import quad
from moka.renderer import scene_materials
from moka.renderer.textures import TexturePool
from tests.support.pictures import (
    draw_radiance,
    encoded,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

SKY = Environment.uniform((1.0, 0.5, 0.25))


def noise(seed: int, channels: int = 3) -> EncodedImage:
    """Texels (48, 64, C) no two channels of which are alike."""
    generator = np.random.default_rng(seed)
    return encoded(generator.integers(0, 256, (48, 64, channels)))


def material(**fields: object) -> Material:
    return Material(
        base_colour_texture=Texture(noise(1, 4)),
        normal_texture=Texture(noise(2)),
        metallic_roughness_texture=Texture(noise(3)),
        roughness_factor=0.9,
        metallic_factor=0.8,
        **fields,
    )


@pytest.mark.parametrize(
    ("fields", "slots"),
    [
        ({}, ["base_colour", "normal"]),
        (
            {
                "occlusion_texture": Texture(noise(4, 1)),
                "occlusion_strength": 0.7,
                "emissive_texture": Texture(noise(5)),
                "emissive_factor": (0.5, 0.5, 0.5),
            },
            ["base_colour", "normal", "emissive"],
        ),
        (
            {
                "alpha_mode": AlphaMode.MASK,
                "emissive_texture": Texture(noise(5)),
                "emissive_factor": (0.5, 0.5, 0.5),
            },
            ["base_colour", "normal", "emissive"],
        ),
    ],
)
def test_the_picture_is_the_same_with_a_sample_less(
    egl_device: GraphicsDevice,
    monkeypatch: pytest.MonkeyPatch,
    fields: dict[str, object],
    slots: list[str],
) -> None:
    """At full size and, in a small picture, at the lower mip levels."""
    surface = material(**fields)
    shape = quad(2.0)
    described = describe_material(surface, shape.attributes)
    assert [use.slot for use in described.textures] == slots
    assert described.carriers
    scene = scene_of([(shape, surface, np.eye(4))], SKY)

    def pictures() -> list[np.ndarray]:
        return [
            draw_radiance(egl_device, scene, square_camera(), (side, side))
            for side in (96, 12)
        ]

    carried = pictures()
    monkeypatch.setattr(
        scene_materials,
        "describe_material",
        lambda *given, **_: describe_material(*given, carries=False),
    )
    for with_carriers, without in zip(carried, pictures(), strict=True):
        assert with_carriers.std() > 0.02
        # A step of a display, between neighbours that have nothing in
        # common: drivers may filter colours with finer weights than data.
        assert np.abs(with_carriers - without).max() < 1 / 255


def test_images_of_several_materials_carry_nothing(
    egl_device: GraphicsDevice,
) -> None:
    """Or a texture that they share would be decoded for each of them."""
    first = material()
    second = Material(
        base_colour_texture=first.base_colour_texture,
        metallic_roughness_texture=Texture(noise(6)),
    )
    described = partial(describe_material, attributes=quad().attributes)
    assert described(first).carriers
    scene = scene_of(
        [(quad(), first, np.eye(4)), (quad(), second, np.eye(4))], SKY
    )
    textures = TexturePool(egl_device, Statistics())
    try:
        materials = scene_materials.SceneMaterials(
            scene.drawables.primitives, textures
        )
    finally:
        textures.close()
    assert not any(each.carriers for each in materials.descriptions)
