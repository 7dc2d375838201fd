"""Record a frame by hand, without a scene and without a renderer.

    python examples/own_command_list.py

Three translucent panes stand behind each other. They are recorded from
front to back, which is the wrong order for blending, but each has a sort key
that holds its distance, so that they are drawn from back to front.
"""

import numpy as np

import moka
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BlendState,
    BufferDescriptor,
    BufferUsage,
    FramebufferDescriptor,
    MeshDescriptor,
    PixelFormat,
    ProgramDescriptor,
    RasterState,
    ShaderText,
    TextureDescriptor,
    Topology,
    UniformBinding,
    VertexAttribute,
    VertexLayout,
)
from moka.commands.draws import INSTANCE
from moka.commands.sort_key import SortKey, Stage

VERTEX = """#version 330 core
layout(std140) uniform Colours { vec4 colours[3]; };
in vec2 corner;
in vec4 instance_row_0, instance_row_1, instance_row_2;
in uvec4 instance_data;     // x is the material
flat out vec4 colour;

void main() {
    vec4 position = vec4(corner, 0.0, 1.0);
    gl_Position = vec4(
        dot(instance_row_0, position),
        dot(instance_row_1, position),
        dot(instance_row_2, position),
        1.0
    );
    colour = colours[instance_data.x];
}
"""

FRAGMENT = """#version 330 core
flat in vec4 colour;
out vec4 radiance;

void main() {
    radiance = colour;
}
"""

BACKGROUND = (0.02, 0.02, 0.03, 1.0)
COLOURS = np.array(
    [[0.9, 0.1, 0.05, 0.5], [0.1, 0.7, 0.1, 0.5], [0.05, 0.2, 0.9, 0.5]],
    np.float32,
)
CORNERS = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]], np.float32)
GLASS = RasterState(depth_test=None, blend=BlendState.ALPHA)


def pane(index: int) -> np.ndarray:
    """The instance of a pane: where it stands and which colour it has."""
    instance = np.zeros(1, INSTANCE)
    instance["transform"][0, :3, :3] = 0.5 * np.eye(3)
    instance["transform"][0, :2, 3] = 0.25 * (index - 1)
    instance["material"] = index
    return instance


def render(size: tuple[int, int] = (640, 360)) -> moka.Image:
    """The picture of the panes, red in front."""
    width, height = size
    with moka.GraphicsDevice.open() as device:
        program = device.create_program(
            ProgramDescriptor(ShaderText(VERTEX), ShaderText(FRAGMENT))
        )
        corners = device.create_buffer(
            BufferDescriptor(BufferUsage.VERTEX, CORNERS.nbytes), CORNERS
        )
        position = VertexAttribute("corner", "f4", components=2, offset=0)
        mesh = device.create_mesh(
            MeshDescriptor(
                Topology.TRIANGLE_STRIP,
                count=4,
                vertex_buffer=corners,
                layout=VertexLayout((position,), stride=8),
            )
        )
        colours = device.create_buffer(
            BufferDescriptor(BufferUsage.UNIFORM, COLOURS.nbytes), COLOURS
        )
        bind_group = device.create_bind_group(
            BindGroupDescriptor(uniforms=(UniformBinding("Colours", colours),))
        )
        texture = device.create_texture(
            TextureDescriptor(PixelFormat.RGBA32F, width, height)
        )
        target = device.create_framebuffer(
            FramebufferDescriptor((Attachment(texture),))
        )

        commands = moka.CommandList()
        setup = commands.command_buffer(SortKey(stage=Stage.SETUP))
        setup.bind_framebuffer(target)
        setup.clear(BACKGROUND)
        for index in range(3):
            distance = 1.0 + index
            key = SortKey(stage=Stage.BLENDED, depth=distance)
            commands.draw(
                program, mesh, bind_group, GLASS, pane(index), key=key
            )
        readback = commands.read_pixels(
            target, (0, 0, width, height), key=SortKey(stage=Stage.RESOLVE)
        )
        device.submit(commands).wait()
    assert readback.data is not None
    rows = readback.data[::-1]  # the bottom row comes first
    return moka.Image(rows, tone_map="none")


if __name__ == "__main__":
    render().save("own_command_list.png")
