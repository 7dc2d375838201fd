"""Buffer textures: rows of texels that are read by their numbers."""

import numpy as np
import pytest

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BufferDescriptor,
    BufferUsage,
    FramebufferDescriptor,
    PixelFormat,
    ProgramDescriptor,
    ShaderText,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
)
from moka.core.errors import DeviceError
from moka.graphics.device import GraphicsDevice
from tests.support.drawing import (
    NUMBER_FRAGMENT,
    PLACED_VERTEX,
    Canvas,
    square,
    tiles,
)

pytestmark = pytest.mark.gpu

# The number of a tile is looked up twice, once in each texture.
VERTEX = PLACED_VERTEX.replace(
    "void main",
    "uniform samplerBuffer first;\nuniform samplerBuffer second;\nvoid main",
).replace(
    "number = instance_data.x;",
    "int place = int(texelFetch(first, int(instance_data.x)).y);\n"
    "    number = uint(texelFetch(second, place).x);",
)


def buffer_texture(texels: np.ndarray) -> TextureDescriptor:
    return TextureDescriptor(
        PixelFormat.RGBA32F, len(texels), 1, TextureKind.BUFFER
    )


def test_texels_are_read_by_number_and_written_from_a_place_on(
    device: GraphicsDevice,
) -> None:
    first, second = np.zeros((2, 8, 4), np.float32)
    first[:, 1] = [3, 1, 4, 1, 5, 2, 6, 0]
    second[:, 0] = np.arange(10, 18)
    textures = [
        device.create_texture(buffer_texture(each), [each])
        for each in (first, second)
    ]
    program = device.create_program(
        ProgramDescriptor(ShaderText(VERTEX), ShaderText(NUMBER_FRAGMENT)),
        wait=True,
    )
    group = device.create_bind_group(
        BindGroupDescriptor(
            tuple(
                TextureBinding(name, texture)
                for name, texture in zip(
                    ("first", "second"), textures, strict=True
                )
            )
        )
    )
    canvas = Canvas(device, (8, 1))
    mesh = square(device)

    def drawn(commands: CommandList) -> list[float]:
        canvas.begin(commands)
        commands.draw(program, mesh, group, None, tiles(range(8), 8))
        return canvas.finish(commands)[0, :, 0].tolist()

    expected = second[first[:, 1].astype(int), 0]
    assert drawn(CommandList()) == expected.tolist()
    second[2:4, 0] = 70, 71
    commands = CommandList()
    commands.fill_texture(textures[1], second[2:4], 2)
    expected = second[first[:, 1].astype(int), 0]
    assert drawn(commands) == expected.tolist()
    assert np.array_equal(device.read_texture(textures[1])[0], second)


def test_one_over_a_buffer_reads_what_draws_read(
    device: GraphicsDevice,
) -> None:
    numbers = np.arange(12, dtype=np.uint16)
    buffer = device.create_buffer(
        BufferDescriptor(BufferUsage.INDEX, numbers.nbytes), numbers
    )
    view = device.create_texture(
        TextureDescriptor(
            PixelFormat.R16UI, 12, 1, TextureKind.BUFFER, over=buffer
        )
    )
    read = device.read_texture(view)
    assert read.dtype == np.uint16
    assert read.ravel().tolist() == list(range(12))
    device.destroy(view)
    # The buffer is still there.
    again = device.create_texture(
        TextureDescriptor(
            PixelFormat.R16UI, 12, 1, TextureKind.BUFFER, over=buffer
        )
    )
    np.testing.assert_array_equal(device.read_texture(again), read)
    device.destroy(again, buffer)


@pytest.mark.parametrize("samples", [1, 4])
def test_targets_of_whole_numbers_are_cleared_to_them(
    device: GraphicsDevice, samples: int
) -> None:
    numbers = device.create_texture(
        TextureDescriptor(PixelFormat.R32UI, 4, 4, samples=samples)
    )
    target = device.create_framebuffer(
        FramebufferDescriptor((Attachment(numbers),))
    )
    commands = CommandList()
    commands.bind_framebuffer(target)
    commands.clear((70000, 0, 0, 0))
    device.submit(commands).wait()
    if samples == 1:
        assert (device.read_texture(numbers) == 70000).all()
    device.finish()


def test_one_that_is_too_long_is_an_error() -> None:
    device = GraphicsDevice.open("egl", debug=True)
    long = TextureDescriptor(
        PixelFormat.R32F,
        device.info.max_buffer_texels + 1,
        1,
        TextureKind.BUFFER,
        label="long",
    )
    device.create_texture(long)
    with pytest.raises(DeviceError, match=r"texture long: .* is larger than"):
        device.finish()
    device.close()
