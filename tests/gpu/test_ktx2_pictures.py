"""KTX2 textures on the GPU: as blocks, as texels, and in a picture."""

from collections.abc import Iterator

import numpy as np
import pytest

from moka.backend import gl_info
from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    PixelFormat,
    SamplerDescriptor,
    TextureDescriptor,
)
from moka.core.encoded_image import EncodedImage
from moka.core.errors import DeviceError
from moka.core.ktx2 import open_ktx2
from moka.graphics.device import GraphicsDevice
from moka.material.material import Material, Texture
from moka.model import quad
from moka.renderer.basis_textures import choose_format
from tests.gpu.conftest import open_device
from tests.support.ktx2_files import KTX2_PICTURE, ktx2_file
from tests.support.pictures import (
    draw_radiance,
    encoded,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

# Mesa cannot read back the others.
READABLE = [each for each in PixelFormat if each.value.startswith("bc")]
FAMILIES = {
    "texels": [],
    **{
        name: [each for each in PixelFormat if each.value.startswith(starts)]
        for name, starts in (
            ("BC7", "bc7"),
            ("S3TC", ("bc1", "bc3")),
            ("ETC2", "etc2"),
            ("ASTC", "astc"),
        )
    },
}


@pytest.mark.parametrize("pixels", READABLE, ids=lambda each: each.value)
def test_blocks_hold_the_picture(
    egl_device: GraphicsDevice, pixels: PixelFormat
) -> None:
    has_alpha = pixels.channels == 4
    name = "etc1s alpha" if has_alpha else "uastc"
    texture = open_ktx2(ktx2_file(name), "test")
    chosen, target = choose_format(
        texture, {pixels}, is_colour="srgb" in pixels.value
    )
    assert chosen is pixels
    handle = egl_device.create_texture(
        TextureDescriptor(pixels, *texture.size), [texture.level(target, 0)]
    )
    found = egl_device.read_texture(handle).astype(int)
    expected = KTX2_PICTURE[:, :, : found.shape[2]].astype(int)
    # ETC1S has five bits for a channel, BC1 and BC3 five and six.
    np.testing.assert_allclose(found, expected, atol=9)


def test_blocks_need_their_data() -> None:
    with open_device("egl") as device:
        device.create_texture(TextureDescriptor(PixelFormat.BC7, 4, 4))
        with pytest.raises(DeviceError, match="bc7 needs the data of level 0"):
            device.finish()


@pytest.fixture(params=FAMILIES)
def sampling_device(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> Iterator[GraphicsDevice]:
    """A device that takes its driver for one of a GPU with some formats."""
    formats = frozenset(FAMILIES[request.param])
    monkeypatch.setattr(gl_info, "compressed_formats", lambda *_: formats)
    with open_device("egl") as device:
        assert device.info.compressed_formats == formats
        yield device
        device.finish()


def test_a_picture_of_it_is_one_of_the_png(
    sampling_device: GraphicsDevice,
) -> None:
    def picture(
        image: EncodedImage, mipmap: MipmapMode
    ) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
        sampler = SamplerDescriptor(
            magnify=Filter.NEAREST, minify=Filter.NEAREST, mipmap=mipmap
        )
        material = Material(
            base_colour_texture=Texture(image, sampler), unlit=True
        )
        scene = scene_of([(quad(), material, placed_at())])
        return draw_radiance(sampling_device, scene, square_camera(0.5))

    wanted = picture(encoded(KTX2_PICTURE[:, :, :3]), MipmapMode.NONE)
    assert len(np.unique(wanted[:, :, 0])) >= 4
    for name, mipmap in (
        ("etc1s", MipmapMode.LINEAR),  # it has levels
        ("uastc zstandard", MipmapMode.NONE),
        ("uastc zstandard", MipmapMode.LINEAR),  # they are made
    ):
        image = EncodedImage("test", data=ktx2_file(name))
        # In linear light: five bits, and the two roundings of BC7 or BC1.
        np.testing.assert_allclose(picture(image, mipmap), wanted, atol=0.03)
