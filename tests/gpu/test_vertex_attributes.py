"""Vertex attributes of every type, as a shader reads them."""

import numpy as np
import pytest

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    BufferUsage,
    CullMode,
    MeshDescriptor,
    ProgramDescriptor,
    RasterState,
    ShaderText,
    Topology,
    VertexAttribute,
    VertexLayout,
)
from moka.graphics.device import GraphicsDevice
from tests.support.drawing import Canvas, buffer, nothing_bound

pytestmark = pytest.mark.gpu

FLAT = RasterState(cull=CullMode.NONE, depth_test=None, depth_write=False)

PASS_ON = """#version 330 core
in vec4 value;
flat out vec4 passed;
void main() {
    passed = value;
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
    gl_PointSize = 64.0;
}
"""
SHOW = """#version 330 core
flat in vec4 passed;
out vec4 colour;
void main() { colour = passed; }
"""


@pytest.mark.parametrize(
    ("kind", "normalised"),
    [
        ("f4", False),
        ("f2", False),
        *((kind, False) for kind in ("i1", "u1", "i2", "u2", "u4")),
        *((kind, True) for kind in ("i1", "u1", "i2", "u2")),
    ],
)
def test_attributes_reach_the_shader(
    device: GraphicsDevice, kind: str, normalised: bool
) -> None:
    dtype = np.dtype(kind)
    values = np.array([[3, 100, 0, 127]], dtype)
    if dtype.kind != "u":
        values[0, 0] = -3
    # One stranger in front: offset and stride count.
    vertex = np.zeros(1, [("other", "f4"), ("value", dtype, 4)])
    vertex["value"] = values
    program = device.create_program(
        ProgramDescriptor(ShaderText(PASS_ON), ShaderText(SHOW), kind)
    )
    mesh = device.create_mesh(
        MeshDescriptor(
            Topology.POINTS,
            1,
            vertex_buffer=buffer(device, BufferUsage.VERTEX, vertex),
            layout=VertexLayout(
                (VertexAttribute("value", kind, 4, 4, normalised),),
                vertex.itemsize,
            ),
        )
    )
    canvas = Canvas(device)
    commands = CommandList()
    canvas.begin(commands)
    commands.draw(program, mesh, nothing_bound(device), FLAT)
    shown = canvas.finish(commands)[8, 8]
    expected = values[0].astype(np.float64)
    if normalised:
        expected /= np.iinfo(dtype).max
    np.testing.assert_allclose(shown, expected, rtol=1e-6)
