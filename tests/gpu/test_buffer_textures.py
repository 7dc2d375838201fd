"""Buffer textures: rows of texels that are read by their numbers."""

import numpy as np
import pytest

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    BindGroupDescriptor,
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
