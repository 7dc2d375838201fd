"""Small things to draw in tests of the device."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BufferDescriptor,
    BufferUsage,
    FramebufferDescriptor,
    IndexType,
    MeshDescriptor,
    PixelFormat,
    ProgramDescriptor,
    ShaderText,
    TextureDescriptor,
    Topology,
    VertexAttribute,
    VertexLayout,
)
from moka.commands.draws import INSTANCE
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice

# Places a unit square by the instance; its colour is the material's number.
PLACED_VERTEX = """#version 330 core
in vec3 position;
in vec4 instance_row_0;
in vec4 instance_row_1;
in vec4 instance_row_2;
in uvec4 instance_data;
flat out uint number;
void main() {
    vec4 p = vec4(position, 1.0);
    number = instance_data.x;
    gl_Position = vec4(
        dot(instance_row_0, p), dot(instance_row_1, p),
        dot(instance_row_2, p), 1.0);
}
"""

NUMBER_FRAGMENT = """#version 330 core
flat in uint number;
out vec4 colour;
void main() { colour = vec4(float(number), gl_FragCoord.z, 0.0, 1.0); }
"""

POSITION = VertexLayout((VertexAttribute("position", "f4", 3, 0),), 12)


def number_program(device: GraphicsDevice) -> Handle:
    """Writes the instance's material number into red, depth into green."""
    return device.create_program(
        ProgramDescriptor(
            ShaderText(PLACED_VERTEX), ShaderText(NUMBER_FRAGMENT), "number"
        ),
        wait=True,
    )


def buffer(
    device: GraphicsDevice, usage: BufferUsage, data: NDArray[Any]
) -> Handle:
    """A buffer of an array's bytes."""
    return device.create_buffer(BufferDescriptor(usage, data.nbytes), data)


def square(
    device: GraphicsDevice, *, indexed: bool = True, scale: float = 1.0
) -> Handle:
    """The square from -1 to 1 times ``scale``, facing +Z."""
    corners = scale * np.array(
        [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32
    )
    order = np.array([0, 1, 2, 0, 2, 3], np.uint16)
    vertices = corners if indexed else corners[order]
    return device.create_mesh(
        MeshDescriptor(
            Topology.TRIANGLES,
            6,
            vertex_buffer=buffer(
                device, BufferUsage.VERTEX, np.ascontiguousarray(vertices)
            ),
            layout=POSITION,
            index_buffer=(
                buffer(device, BufferUsage.INDEX, order) if indexed else None
            ),
            index_type=IndexType.UINT16,
        )
    )


def tiles(numbers: Sequence[int], columns: int) -> NDArray[np.void]:
    """Instances that put unit squares into a grid of tiles, row by row."""
    rows = -(-len(numbers) // columns)
    instances = np.zeros(len(numbers), INSTANCE)
    for index, number in enumerate(numbers):
        x, y = index % columns, index // columns
        instances[index]["transform"] = [
            [1 / columns, 0, 0, (2 * x + 1) / columns - 1],
            [0, 1 / rows, 0, (2 * y + 1) / rows - 1],
            [0, 0, 1, 0],
        ]
        instances[index]["material"] = number
    return instances


class Canvas:
    """A float32 target with depth, and the picture drawn into it."""

    def __init__(
        self,
        device: GraphicsDevice,
        size: tuple[int, int] = (16, 16),
        samples: int = 1,
    ) -> None:
        self.device = device
        self.size = size
        colour = device.create_texture(
            TextureDescriptor(PixelFormat.RGBA32F, *size, samples=samples)
        )
        depth = device.create_texture(
            TextureDescriptor(PixelFormat.DEPTH32F, *size, samples=samples)
        )
        self.texture = colour
        self.framebuffer = device.create_framebuffer(
            FramebufferDescriptor((Attachment(colour),), Attachment(depth))
        )

    def begin(self, commands: CommandList) -> None:
        """Bind and clear: colour to -1, depth to the far end."""
        commands.bind_framebuffer(self.framebuffer)
        commands.clear((-1.0, -1.0, -1.0, 1.0), 1.0)

    def finish(self, commands: CommandList) -> NDArray[np.float32]:
        """Run the list; the picture (H, W, 4), bottom row first."""
        readback = commands.read_pixels(self.framebuffer, (0, 0, *self.size))
        self.device.submit(commands).wait()
        assert readback.data is not None
        return readback.data


def nothing_bound(device: GraphicsDevice) -> Handle:
    """A bind group of nothing."""
    return device.create_bind_group(BindGroupDescriptor())
