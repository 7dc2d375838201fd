"""A shader of your own, in two permutations.

    python examples/own_shader.py

One text is compiled twice, with and without the define MOKA_STRIPES, and
loaded once each: a program cache keeps them by their keys. The shader reads
moka's own files through `#include`, and a mistake in it would be reported
with the file and the line.
"""

from functools import partial

import numpy as np

import moka
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BufferDescriptor,
    BufferUsage,
    FramebufferDescriptor,
    PixelFormat,
    ProgramDescriptor,
    RasterState,
    TextureDescriptor,
    UniformBinding,
)
from moka.commands.draws import INSTANCE
from moka.graphics.program_cache import ProgramCache
from moka.graphics.shader_source import preprocess_shader
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.model import sphere
from moka.renderer.geometry import GeometryPool

VIEW = UniformLayout("View", (Parameter("aspect", ParameterType.FLOAT),))

VERTEX = """
#include "include/instance.glsl"
in vec3 position;
in vec3 normal;
out vec3 n;

void main() {
    mat3x4 rows = instance_rows();
    n = place_direction(rows, normal);
    vec3 p = place_point(rows, position);
    gl_Position = vec4(p.x / aspect, p.y, 0.5 - 0.1 * p.z, 1.0);
}
"""

FRAGMENT = """
#include "include/srgb.glsl"
in vec3 n;
out vec4 colour;

void main() {
    vec3 unit = normalize(n);
    float light = 0.1 + 0.9 * max(dot(unit, normalize(vec3(1, 2, 2))), 0.0);
    vec3 paint = vec3(0.9, 0.2, 0.05);
#ifdef MOKA_STRIPES
    paint = mix(paint, vec3(0.9), step(0.5, fract(4.0 * unit.y)));
#endif
    colour = vec4(srgb_encode(light * paint), 1.0);
}
"""


def describe(*, stripes: bool) -> ProgramDescriptor:
    """The sources of one permutation."""
    defines = {"MOKA_STRIPES": 1} if stripes else {}
    return ProgramDescriptor(
        preprocess_shader(VERTEX, defines, name="own.vert", injected=VIEW.glsl),
        preprocess_shader(FRAGMENT, defines, name="own.frag"),
        "own shader",
    )


def placed(x: float) -> np.ndarray:
    """The instance of a ball at ``x``."""
    instance = np.zeros(1, INSTANCE)
    instance["transform"] = np.eye(3, 4)
    instance["transform"][0, 0, 3] = x
    return instance


def render(size: tuple[int, int] = (1280, 720)) -> moka.Image:
    """A plain ball and a striped one."""
    width, height = size
    with moka.GraphicsDevice.open() as device:
        programs = ProgramCache(device)
        ball = sphere(0.7)
        (mesh,) = GeometryPool(device).meshes([(ball, ("POSITION", "NORMAL"))])
        view = device.create_buffer(
            BufferDescriptor(BufferUsage.UNIFORM, VIEW.size),
            VIEW.pack({"aspect": width / height}),
        )
        group = device.create_bind_group(
            BindGroupDescriptor(uniforms=(UniformBinding("View", view),))
        )
        colour, depth = (
            device.create_texture(TextureDescriptor(kind, width, height))
            for kind in (PixelFormat.RGBA8, PixelFormat.DEPTH32F)
        )
        target = device.create_framebuffer(
            FramebufferDescriptor((Attachment(colour),), Attachment(depth))
        )

        commands = moka.CommandList()
        commands.bind_framebuffer(target)
        commands.clear((0.1, 0.1, 0.11, 1.0), 1.0)
        for stripes, x in ((False, -0.8), (True, 0.8)):
            program = programs.get(stripes, partial(describe, stripes=stripes))
            commands.draw(program, mesh, group, RasterState(), placed(x))
        read = commands.read_pixels(target, (0, 0, width, height), dtype="u1")
        device.submit(commands).wait()
    assert read.data is not None
    shown = np.ascontiguousarray(read.data[::-1])
    return moka.Image(None, display=shown)


if __name__ == "__main__":
    render().save("own_shader.png")
