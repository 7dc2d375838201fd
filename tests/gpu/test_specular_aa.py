"""Bumps too small to be seen, against the mean of many samples a pixel."""

import numpy as np
import pytest

from moka.core.encoded_image import EncodedImage
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.description import Feature
from moka.material.material import Material, Texture
from moka.model.geometry import quad
from moka.renderer.permutation import LightingDescription, Permutation
from moka.renderer.scene_materials import SceneMaterials
from moka.renderer.texture_settings import TextureSettings
from moka.renderer.textures import TexturePool
from tests.support.pictures import (
    draw_radiance,
    encoded,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

SIDE = 256


def bumps(slope: float) -> EncodedImage:
    """Normals of random, smooth heights that repeat."""
    random = np.random.default_rng(1)
    frequency = np.fft.fftfreq(SIDE) * SIDE
    falloff = np.exp(-(frequency[:, None] ** 2 + frequency**2) / (2 * 24.0**2))
    noise = np.fft.fft2(random.normal(size=(SIDE, SIDE)))
    height = np.fft.ifft2(noise * falloff).real
    across = np.roll(height, -1, 1) - np.roll(height, 1, 1)
    along = np.roll(height, -1, 0) - np.roll(height, 1, 0)
    scale = slope / across.std()
    vectors = np.dstack([-scale * across, scale * along, np.ones_like(height)])
    vectors /= np.linalg.norm(vectors, axis=2, keepdims=True)
    return encoded(np.rint((vectors + 1) * 127.5))


def grey(level: float) -> Texture:
    return Texture(encoded(np.full((SIDE, SIDE, 3), round(255 * level))))


def metal(slope: float, roughness: float, *, textured: bool) -> Material:
    """With the roughness as a number, or in textures that carry it."""
    normal = Texture(bumps(slope))
    if not textured:
        return Material(normal_texture=normal, roughness_factor=roughness)
    texels = np.full((SIDE, SIDE, 3), (255, round(255 * roughness), 255))
    return Material(
        normal_texture=normal,
        base_colour_texture=grey(0.8),
        metallic_roughness_texture=Texture(encoded(texels)),
    )


def sky() -> Environment:
    """Bright on one side, dark on the other."""
    texels = np.full((32, 64, 3), 0.05, np.float32)
    texels[6:12, 40:50] = 6.0
    texels[:16] += 0.4
    return Environment(texels)


@pytest.mark.parametrize("textured", [False, True])
@pytest.mark.parametrize("slope", [0.1, 0.3])
def test_the_picture_is_nearer_to_the_mean_of_many_samples(
    egl_device: GraphicsDevice, slope: float, textured: bool
) -> None:
    """Squared errors of 16 x 16 pixels against 256 samples in each."""
    scene = scene_of(
        [(quad(2.0), metal(slope, 0.35, textured=textured), placed_at())],
        sky(),
    )
    options = {"suns": "off"}
    camera = square_camera()
    exact = draw_radiance(egl_device, scene, camera, (SIDE, SIDE), **options)
    exact = exact.reshape(16, SIDE // 16, 16, SIDE // 16, 4).mean(axis=(1, 3))
    errors = [
        float(np.mean((picture[:, :, :3] - exact[:, :, :3]) ** 2))
        for picture in (
            draw_radiance(
                egl_device, scene, camera, (16, 16), specular_aa=on, **options
            )
            for on in (False, True)
        )
    ]
    assert errors[1] < 0.8 * errors[0]


def test_what_is_near_stays_as_it_is(egl_device: GraphicsDevice) -> None:
    """A texel a pixel: only the finest level is read."""
    scene = scene_of(
        [(quad(2.0), metal(0.3, 0.35, textured=False), placed_at())], sky()
    )
    pictures = [
        draw_radiance(
            egl_device, scene, square_camera(), (512, 512), specular_aa=on
        )
        for on in (False, True)
    ]
    np.testing.assert_allclose(*pictures, rtol=1e-3, atol=1e-4)


def described(
    device: GraphicsDevice, material: Material, settings: TextureSettings
) -> SceneMaterials:
    scene = scene_of([(quad(), material, placed_at())])
    scene.update()
    textures = TexturePool(device, Statistics())
    try:
        return SceneMaterials(
            scene.drawables.primitives, textures, None, settings
        )
    finally:
        textures.close()


def test_it_costs_a_shader_only_where_the_normals_tell(
    egl_device: GraphicsDevice,
) -> None:
    """Nothing when off, and nothing where a texture has taken it up."""
    on, off = TextureSettings(specular_aa=True), TextureSettings()
    plain = LightingDescription(True, 0, "gltf", "lambert", True, True)
    for material, settings, flagged in (
        (metal(0.1, 0.4, textured=False), on, True),
        (metal(0.1, 0.4, textured=False), off, False),
        (metal(0.1, 0.4, textured=True), on, False),
        (Material(), on, False),
    ):
        materials = described(egl_device, material, settings)
        (description,) = materials.descriptions
        assert (Feature.NORMAL_VARIANCE in description.features) == flagged
        text = Permutation(description, plain).program().fragment.source
        assert ("#define MOKA_NORMAL_VARIANCE" in text) == flagged
