"""What samplers, sizes and alphas of textures make of a picture."""

import itertools
import logging
import math

import numpy as np
import pytest

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    Wrap,
)
from moka.core import decode as decode_module
from moka.core.colour import decode_srgb
from moka.core.encoded_image import EncodedImage
from moka.core.mip_levels import reduce_levels
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import AlphaMode, Material, Texture
from moka.model.cameras import Perspective
from moka.model.geometry import quad
from moka.model.mesh import Primitive
from moka.renderer.renderer import Renderer
from moka.renderer.texture_settings import levels_beyond
from moka.scene.camera import Camera
from tests.support.pictures import (
    draw_radiance,
    encoded,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

RANDOM = np.random.default_rng(4)
WRAPS = {
    Wrap.REPEAT: lambda i, n: i % n,
    Wrap.CLAMP_TO_EDGE: lambda i, n: np.clip(i, 0, n - 1),
    Wrap.MIRRORED_REPEAT: lambda i, n: np.minimum(
        i % (2 * n), 2 * n - 1 - i % (2 * n)
    ),
}


def spread(texture: Texture, first: float, last: float, **fields) -> Material:
    """A quad whose coordinates go from ``first`` to ``last``, and material."""
    square = quad(2.0)
    uv = square.attributes["TEXCOORD_0"]
    shape = Primitive(
        {
            "POSITION": square.attributes["POSITION"],
            "TEXCOORD_0": first + (last - first) * uv,
        },
        square.indices,
    )
    return shape, Material(base_colour_texture=texture, unlit=True, **fields)


def read(
    texels: np.ndarray, u: np.ndarray, v: np.ndarray, sampler: SamplerDescriptor
) -> np.ndarray:
    """One level of linear texels at coordinates (N,), in float64."""
    height, width = texels.shape[:2]
    x, y = u * width, v * height
    linear = sampler.magnify is Filter.LINEAR
    wrap = WRAPS[sampler.wrap_s], WRAPS[sampler.wrap_t]
    if not linear:
        column = wrap[0](np.floor(x).astype(int), width)
        return texels[wrap[1](np.floor(y).astype(int), height), column]
    left, top = np.floor(x - 0.5).astype(int), np.floor(y - 0.5).astype(int)
    right, bottom = (x - 0.5 - left)[:, None], (y - 0.5 - top)[:, None]
    result = np.zeros((len(u), texels.shape[2]))
    for dx, dy in itertools.product((0, 1), (0, 1)):
        weight = (right if dx else 1 - right) * (bottom if dy else 1 - bottom)
        row = wrap[1](top + dy, height)
        result += weight * texels[row, wrap[0](left + dx, width)]
    return result


@pytest.mark.parametrize("filter_", list(Filter))
@pytest.mark.parametrize(
    ("wrap_s", "wrap_t"), list(itertools.product(Wrap, Wrap))
)
def test_wraps_of_both_axes_and_filters(
    egl_device: GraphicsDevice, wrap_s: Wrap, wrap_t: Wrap, filter_: Filter
) -> None:
    """Of a size that is no power of two, magnified, to 8 bits of weight."""
    texels = RANDOM.integers(0, 256, (5, 6, 3))
    sampler = SamplerDescriptor(
        wrap_s, wrap_t, filter_, filter_, MipmapMode.NONE
    )
    shape, material = spread(Texture(encoded(texels), sampler), -1.3, 1.9)
    scene = scene_of([(shape, material, placed_at())])
    picture = draw_radiance(egl_device, scene, square_camera(), (64, 64))
    steps = -1.3 + 3.2 * (np.arange(64) + 0.5) / 64
    u, v = (axis.reshape(-1) for axis in np.meshgrid(steps, steps))
    exact = read(decode_srgb(texels / 255.0), u, v, sampler)
    difference = np.abs(picture[:, :, :3].reshape(-1, 3) - exact)
    assert difference.max() < 8e-3


@pytest.mark.parametrize("minify", list(Filter))
@pytest.mark.parametrize("mipmap", list(MipmapMode))
@pytest.mark.parametrize("exponent", [1, 2])
def test_minification_reads_the_levels_that_it_names(
    egl_device: GraphicsDevice,
    minify: Filter,
    mipmap: MipmapMode,
    exponent: int,
) -> None:
    """At a whole level, whichever of them are mixed: one pixel, one texel."""
    texels = RANDOM.integers(0, 256, (64, 64, 3)).astype(np.uint8)
    sampler = SamplerDescriptor(minify=minify, mipmap=mipmap)
    shape, material = spread(Texture(encoded(texels), sampler), 0.0, 1.0)
    scene = scene_of([(shape, material, placed_at())])
    side = 64 >> exponent
    picture = draw_radiance(egl_device, scene, square_camera(), (side, side))
    if mipmap is not MipmapMode.NONE:
        level = reduce_levels(texels, srgb=True)[exponent]
        allowed = [decode_srgb(level / 255.0)]
    else:
        # The centre of a pixel is the corner of four texels.
        step = 1 << exponent
        ends = slice(step // 2, None, step), slice(step // 2 - 1, None, step)
        linear = decode_srgb(texels / 255.0)
        allowed = [linear[rows, columns] for rows in ends for columns in ends]
        if minify is Filter.LINEAR:
            allowed = [np.mean(allowed, axis=0)]
    # Between four texels any of them is the nearest.
    off = [np.abs(picture[:, :, :3] - each).max(axis=2) for each in allowed]
    assert np.min(off, axis=0).max() < 8e-3


def test_anisotropic_filtering_is_nearer_to_what_a_pixel_covers(
    egl_device: GraphicsDevice,
) -> None:
    """Stripes along the line of sight, on a floor, against 16 x 16 samples."""
    texels = np.zeros((256, 256, 3), np.uint8)
    texels[:, ::8] = texels[:, 1::8] = texels[:, 2::8] = 255
    shape, material = spread(Texture(encoded(texels)), 0.0, 4.0)
    floor = placed_at(y=-0.25, z=-4)
    floor[:3, :3] = 3 * np.array([(1, 0, 0), (0, 0, 1), (0, -1, 0)])
    scene = scene_of([(shape, material, floor)])
    camera = Camera(Perspective(math.radians(40)))
    exact = draw_radiance(
        egl_device, scene, camera, (1024, 1024), anisotropy=16
    )[:, :, 0]
    exact = exact.reshape(64, 16, 64, 16).mean(axis=(1, 3))
    errors = [
        float(np.sqrt(np.mean((picture[:, :, 0] - exact) ** 2)))
        for picture in (
            draw_radiance(
                egl_device, scene, camera, (64, 64), anisotropy=samples
            )
            for samples in (1, 4, 16)
        )
    ]
    assert errors[1] < 0.7 * errors[0]
    assert errors[2] < 0.6 * errors[0]


def test_textures_keep_to_the_largest_size(
    egl_device: GraphicsDevice, caplog: pytest.LogCaptureFixture
) -> None:
    """As if the image were that small; a line says so."""
    texels = RANDOM.integers(0, 256, (64, 96, 4)).astype(np.uint8)
    texels[:, :, 3] = 255
    small = reduce_levels(texels, srgb=True)[2]
    pictures = []
    for image, size in ((texels, 24), (small, None)):
        shape, material = spread(Texture(encoded(image, "a.glb")), 0.0, 1.0)
        scene = scene_of([(shape, material, placed_at())])
        with caplog.at_level(logging.INFO):
            pictures.append(
                draw_radiance(
                    egl_device,
                    scene,
                    square_camera(),
                    (40, 40),
                    max_texture_size=size,
                )
            )
    assert np.array_equal(*pictures)
    assert [record.getMessage() for record in caplog.records] == [
        "a.glb: 96 x 64 texels are reduced to 24 x 16; asked for are 24 along "
        "a side"
    ]


def test_what_the_driver_does_not_take_is_reduced(
    caplog: pytest.LogCaptureFixture,
) -> None:
    assert levels_beyond((4096, 64), 4096, None, "a") == 0
    assert not caplog.records
    assert levels_beyond((5000, 64), 4096, 8192, "a.png") == 1
    (record,) = caplog.records
    assert record.levelno == logging.WARNING
    assert "the driver takes 4096" in record.getMessage()


def leaves(side: int) -> np.ndarray:
    """Thin, opaque strokes of green on a transparent, red ground."""
    texels = np.full((side, side, 4), (255, 0, 0, 0), np.uint8)
    for shift in range(3):
        rows = np.arange(side)
        texels[rows, (5 * rows // 3 + shift) % side] = (0, 200, 0, 255)
        texels[rows, (-rows + side // 3 + shift) % side] = (0, 200, 0, 255)
    return texels


@pytest.mark.parametrize("factor", [1.0, 0.7])
def test_masks_keep_their_area_with_distance(
    egl_device: GraphicsDevice, factor: float
) -> None:
    """Thirty times too few pixels pass, or hardly fewer than close by."""
    shape, material = spread(
        Texture(encoded(leaves(256))),
        0.0,
        1.0,
        alpha_mode=AlphaMode.MASK,
        base_colour_factor=(1, 1, 1, factor),
    )
    scene = scene_of([(shape, material, placed_at())])
    covered = []
    for side in (256, 32, 16):
        picture = draw_radiance(
            egl_device, scene, square_camera(), (side, side)
        )
        covered.append(float((picture[:, :, 1] > 0).mean()))
        # Nothing of the red shines through where leaves are.
        assert picture[:, :, 0].max() < 0.01
    assert covered[0] > 0.02
    assert covered[1:] == pytest.approx([covered[0]] * 2, rel=0.35)


def test_blended_edges_have_the_colour_of_what_is_there(
    egl_device: GraphicsDevice,
) -> None:
    shape, material = spread(
        Texture(encoded(leaves(256))), 0.0, 1.0, alpha_mode=AlphaMode.BLEND
    )
    scene = scene_of([(shape, material, placed_at())], background=(0, 0, 0))
    picture = draw_radiance(egl_device, scene, square_camera(), (32, 32))
    assert picture[:, :, 1].mean() > 0.01
    assert picture[:, :, 0].max() < 0.01


def test_opaque_colours_do_not_depend_on_their_alpha(
    egl_device: GraphicsDevice,
) -> None:
    texels = RANDOM.integers(0, 256, (64, 64, 4))
    pictures = []
    for image in (texels, texels[:, :, :3]):
        shape, material = spread(Texture(encoded(image)), 0.0, 1.0)
        scene = scene_of([(shape, material, placed_at())])
        pictures.append(
            draw_radiance(egl_device, scene, square_camera(), (8, 8))
        )
    assert np.array_equal(*pictures)


def test_colour_and_data_of_one_image_are_decoded_once(
    egl_device: GraphicsDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And uploaded as either."""
    decoded = []
    decode = decode_module.decode_image

    def counted(image: EncodedImage) -> np.ndarray:
        decoded.append(image.where)
        return decode(image)

    monkeypatch.setattr(decode_module, "decode_image", counted)
    texture = Texture(encoded(np.tile(RANDOM.integers(0, 256, (8, 8, 1)), 3)))
    shape, _ = spread(texture, 0.0, 1.0)
    material = Material(
        base_colour_texture=texture,
        metallic_roughness_texture=texture,
        roughness_factor=0.7,
    )
    scene = scene_of(
        [(shape, material, placed_at())], Environment.uniform((1, 1, 1))
    )
    picture = draw_radiance(egl_device, scene, square_camera(), (16, 16))
    assert len(decoded) == 1
    assert picture[:, :, 0].std() > 0.01


@pytest.mark.parametrize("side", [64, 65])
def test_an_image_of_one_colour_is_one_texel(
    egl_device: GraphicsDevice, side: int
) -> None:
    """And another is not, even if it differs in one texel."""
    texels = np.full((side, side, 3), (200, 100, 50), np.uint8)
    sizes = []
    for changed in (False, True):
        if changed:
            texels[side - 2, side - 3, 1] += 1
        shape, material = spread(Texture(encoded(texels)), 0.0, 1.0)
        scene = scene_of([(shape, material, placed_at())])
        statistics = Statistics()
        renderer = Renderer(egl_device, (64, 64), statistics=statistics)
        commands = CommandList()
        renderer.draw(scene, square_camera(), commands)
        read = renderer.read_radiance(commands)
        egl_device.submit(commands).wait()
        renderer.close()
        sizes.append(statistics.counts.get("textures_of_one_colour", 0))
        exact = decode_srgb(np.array([200, 100, 50]) / 255)
        assert np.abs(read.data[:, :, :3] - exact).max() < 8e-3
    assert sizes == [1, 0]
