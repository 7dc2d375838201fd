"""Environments that are hardly any: hot, black, tiny, huge or broken.

Whatever a map holds, the sky shows it, and its light is finite and never
negative; where an integral can be written down, light is close to it.
"""

import logging
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.core.errors import OptionError
from moka.core.radiance_hdr import parse_radiance_hdr
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import Material
from moka.model.geometry import quad, sphere
from moka.scene.scene import Scene
from tests.support.oracles.environment import (
    equirectangular_directions,
    equirectangular_solid_angles,
)
from tests.support.pictures import (
    draw_radiance,
    draw_with_display,
    looking,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

Pixels = NDArray[np.float32]

MODES = {
    "split-sum": {},
    "without suns": {"suns": "off", "irradiance": "cube"},
    "filtered": {"ibl": "filtered"},
    "reference": {"ibl": "reference", "reference_samples": 16},
}


def noise(height: int = 16) -> Pixels:
    generator = np.random.default_rng(4)
    return generator.uniform(0.2, 1.0, (height, 2 * height, 3)).astype("f4")


def with_texel(value: float, height: int = 16) -> Pixels:
    pixels = noise(height)
    pixels[height // 3, height // 2] = value
    return pixels


def black_but_for(value: float) -> Pixels:
    pixels = np.zeros((16, 32, 3), np.float32)
    pixels[5, 9] = value
    return pixels


MAPS = {
    "a texel of 1e9": with_texel(1e9),
    "a texel of 1e30": with_texel(1e30),
    "a texel of 3e38": with_texel(3e38),
    "nothing but 3e38": np.full((16, 32, 3), 3e38, np.float32),
    "nothing but 1e-30": np.full((16, 32, 3), 1e-30, np.float32),
    "nothing but 1e-45": np.full((16, 32, 3), 1e-45, np.float32),
    "black": np.zeros((16, 32, 3), np.float32),
    "black but for 1e9": black_but_for(1e9),
    "black but for 1e-30": black_but_for(1e-30),
    "blue only": noise() * np.array([0, 0, 1], np.float32),
    "two texels": noise(1),
    "two texels, one hot": np.array([[[1e9] * 3, [0.5] * 3]], np.float32),
    "one texel": np.full((1, 1, 3), 0.7, np.float32),
    "one hot texel": np.full((1, 1, 3), 3e38, np.float32),
    "an odd height": noise(7),
}


def balls(environment: Environment | None) -> Scene:
    """Spheres of every kind: black and white, dielectric and metal."""
    items = []
    for index in range(16):
        colour, metal = index & 1, index >> 1 & 1
        material = Material(
            base_colour_factor=(colour, colour, colour, 1),
            metallic_factor=float(metal),
            roughness_factor=(0.0, 1e-3, 0.3, 1.0)[index >> 2],
        )
        x, y = index % 4 / 2 - 0.75, index // 4 / 2 - 0.75
        items.append((sphere(0.22, 24, 12), material, placed_at(x, y)))
    return scene_of(items, environment)


@pytest.fixture(autouse=True)
def _no_warnings(caplog: pytest.LogCaptureFixture) -> None:
    """Texels that are no radiance are reported, which is right here."""
    caplog.set_level(logging.ERROR, "moka")


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES.keys())
@pytest.mark.parametrize("name", MAPS)
def test_light_is_finite_and_never_negative(
    egl_device: GraphicsDevice, name: str, mode: dict
) -> None:
    scene = balls(Environment(MAPS[name]))
    for float_output in (True, False):
        picture = draw_radiance(
            egl_device,
            scene,
            square_camera(),
            (48, 48),
            samples=1 if float_output else 4,
            float_output=float_output,
            **mode,
        )
        assert np.isfinite(picture).all()
        assert (picture >= 0.0).all()


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES.keys())
def test_texels_that_are_no_radiance_are_taken_for_some(
    egl_device: GraphicsDevice, mode: dict
) -> None:
    broken, mended = noise(), noise()
    for place, (value, instead) in enumerate(
        [(np.nan, 0), (np.inf, 65504), (-np.inf, 0), (-3, 0), (3e38, 1e30)]
    ):
        broken[3 + place, 4 * place], mended[3 + place, 4 * place] = (
            value,
            instead,
        )
    pictures = [
        draw_radiance(
            egl_device,
            balls(Environment(pixels)),
            square_camera(),
            (32, 32),
            **mode,
        )
        for pixels in (broken, mended)
    ]
    assert np.array_equal(*pictures)


def irradiance(pixels: Pixels, normal: NDArray[np.float64]) -> float:
    """E / pi of a map of even texels, in float64."""
    height, width, _ = pixels.shape
    cosine = equirectangular_directions(width, height) @ normal
    weights = equirectangular_solid_angles(width, height)
    light = pixels[..., 0].astype(np.float64)
    return float((np.maximum(cosine, 0.0) * weights * light).sum() / math.pi)


@pytest.mark.parametrize(
    "mode", [MODES["split-sum"], MODES["filtered"]], ids=["auto", "filtered"]
)
@pytest.mark.parametrize("value", [1e3, 1e6, 1e9])
def test_one_hot_texel_gives_a_surface_its_own_irradiance(
    egl_device: GraphicsDevice, mode: dict, value: float
) -> None:
    """White minus black is the base; under uniform light its share is known."""
    pixels = np.full((128, 256, 3), 0.5, np.float32)
    pixels[20, 60] = value
    normal = equirectangular_directions(256, 128)[40, 60]
    camera = looking(-normal, math.radians(2), 3 * normal)
    facing = np.array(camera.transform.world_matrix)
    facing[:3, 3] = 0

    def base(environment: Environment) -> float:
        shades = []
        for colour in (1.0, 0.0):
            matte = Material(
                base_colour_factor=(colour, colour, colour, 1),
                metallic_factor=0.0,
                roughness_factor=1.0,
            )
            scene = scene_of([(quad(1.0), matte, facing)], environment)
            picture = draw_radiance(egl_device, scene, camera, (4, 4), **mode)
            shades.append(float(picture[2, 2, 0]))
        return shades[0] - shades[1]

    share = base(Environment.uniform((1.0, 1.0, 1.0)))
    # The specular part is larger than the base's rounding.
    assert base(Environment(pixels)) / share == pytest.approx(
        irradiance(pixels, normal), rel=0.02
    )


def test_a_black_map_is_dark(egl_device: GraphicsDevice) -> None:
    for mode in MODES.values():
        picture = draw_radiance(
            egl_device,
            balls(Environment(MAPS["black"])),
            square_camera(),
            (32, 32),
            **mode,
        )
        assert not picture[..., :3].any()
        assert (picture[..., 3] == 1.0).all()


def test_every_exponent_of_a_radiance_file(egl_device: GraphicsDevice) -> None:
    """The sky shows mantissa * 2^(e - 136), from underflow to 1e30."""
    height, width = 128, 256
    codes = np.zeros((height, width, 4), np.uint8)
    codes[..., :3] = (255, 128, 1)
    codes[..., 3] = np.arange(width)
    header = f"#?RADIANCE\n\n-Y {height} +X {width}\n".encode()
    pixels = parse_radiance_hdr(header + codes.tobytes(), "every exponent")
    exponent = np.arange(width) - 136.0
    expected = np.array([255, 128, 1]) * 2.0 ** exponent[:, None]
    expected[0] = 0.0  # the format's black
    assert np.isfinite(pixels).all()
    # Some readers add half a step to a mantissa; a step is what we allow.
    step = 2.0 ** exponent[:, None]
    tiny = float(np.finfo(np.float32).tiny)
    assert (np.abs(pixels[0] - expected) <= np.maximum(step, tiny)).all()
    environment = Environment(pixels)
    scene = scene_of([], environment)
    # Not the first, beside which the last lies.
    for column in (1, 20, 100, 128, 136, 180, 235, 255):
        azimuth = ((column + 0.5) / width - 0.5) * 2 * math.pi
        towards = (math.cos(azimuth), 0.0, math.sin(azimuth))
        camera = looking(towards, math.radians(0.01))
        picture, display = draw_with_display(egl_device, scene, camera, (2, 2))
        shown = np.minimum(pixels[0, column], 1e30)
        # Between the texel and its neighbour, which may be twice as bright.
        assert np.allclose(picture[0, 0, :3], shown, rtol=0.05, atol=tiny)
        assert (picture >= 0.0).all()
        if column > 150:
            assert (display[..., :3] > 250).all()
    for mode in MODES.values():
        picture = draw_radiance(
            egl_device, balls(environment), square_camera(), (32, 32), **mode
        )
        assert np.isfinite(picture).all()
        assert (picture >= 0.0).all()


@pytest.mark.parametrize("intensity", [0.0, 1e-30, 1e30])
@pytest.mark.parametrize("mode", MODES.values(), ids=MODES.keys())
def test_any_intensity(
    egl_device: GraphicsDevice, intensity: float, mode: dict
) -> None:
    hot = np.full((128, 256, 3), 1e20, np.float32)
    hot[40, 100] = 1e30
    scene = balls(Environment(hot))
    scene.environment_intensity = intensity
    picture = draw_radiance(
        egl_device, scene, square_camera(), (32, 32), **mode
    )
    assert np.isfinite(picture).all()
    assert (picture >= 0.0).all()


@pytest.mark.parametrize("intensity", [-1.0, math.nan, math.inf, 1e31])
def test_an_intensity_that_is_none_is_refused(intensity: float) -> None:
    with pytest.raises(OptionError, match="environment_intensity"):
        Scene().environment_intensity = intensity


def test_a_map_of_eight_thousand_texels(
    egl_device: GraphicsDevice,
) -> None:
    """32 million texels, one of them a sun; sky and light are those of it."""
    height, width = 4096, 8192
    rows = np.linspace(1.0, 0.2, height, dtype=np.float32)
    pixels = np.empty((height, width, 3), np.float32)
    pixels[:] = rows[:, None, None]
    pixels[1500:1504, 4000:4004] = 1e6
    environment = Environment(pixels)
    scene = balls(environment)
    picture = draw_radiance(egl_device, scene, square_camera(), (32, 32))
    assert np.isfinite(picture).all()
    assert (picture >= 0.0).all()
    matte = picture[29, 11, :3]  # the lowest row's white dielectric
    assert 0.3 < matte.min() <= matte.max() < 1e6
    # Between the balls is what a parallel camera sees of the sky: one point.
    horizon = pixels[height // 2, 0]
    assert np.allclose(picture[0, 0, :3], horizon, rtol=1e-3)
