"""Programs compile side by side, and say where they do not compile."""

from collections.abc import Callable, Iterator
from ctypes import c_ubyte, c_uint
from typing import Any

import numpy as np
import pytest

from moka.backend.contexts import GraphicsContext, open_context
from moka.backend.moderngl_backend import ModernGLBackend
from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    BindGroupDescriptor,
    CullMode,
    Filter,
    MeshDescriptor,
    MipmapMode,
    PixelFormat,
    ProgramDescriptor,
    RasterState,
    SamplerDescriptor,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
    Topology,
)
from moka.commands.handles import Handle
from moka.core.errors import ContextError, DeviceError, ShaderError
from moka.graphics.device import GraphicsDevice
from moka.graphics.shader_source import explain_log, preprocess_shader
from moka.lighting.environment import load_environment
from moka.model import demo_model
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.drawing import (
    Canvas,
    nothing_bound,
    number_program,
    square,
    tiles,
)

pytestmark = pytest.mark.gpu

FLAT = RasterState(cull=CullMode.NONE, depth_test=None, depth_write=False)
# Whole numbers cannot be filtered.
TEXELS = SamplerDescriptor(
    magnify=Filter.NEAREST, minify=Filter.NEAREST, mipmap=MipmapMode.NONE
)

VERTEX = """
out vec2 place;
void main() {
    place = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
    gl_Position = vec4(4.0 * place - 1.0, 0.0, 1.0);
}
"""
FRAGMENT = """
in vec2 place;
out vec4 colour;
void main() {
    colour = vec4(place, 0.0, 1.0);
}
"""

DEEP = """
in vec3 place;
out vec4 colour;
void main() { colour = vec4(place, 1.0); }
"""

# Shaders, and how what is said of them begins.
FAULTS = [
    (VERTEX.replace("place = vec2", "plaice = vec2"), FRAGMENT, "a.vert:4: "),
    (VERTEX, FRAGMENT.replace("(place", "(plaice"), "a.frag:5: "),
    # The one writes two numbers, the other reads three.
    (VERTEX, DEEP, "a.vert and a.frag: "),
]


def describe(
    vertex: str = VERTEX, fragment: str = FRAGMENT
) -> ProgramDescriptor:
    return ProgramDescriptor(
        preprocess_shader(vertex, name="a.vert"),
        preprocess_shader(fragment, name="a.frag"),
        "program a",
    )


class Listener:
    """The names of the functions of OpenGL that a backend calls."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self.context: GraphicsContext | None = None

    def open_backend(self) -> ModernGLBackend:
        self.context = context = open_context("egl", debug=True)
        load = context.function

        def listened(name: str, *signature: Any) -> Callable[..., Any]:
            function = load(name, *signature)

            def call(*arguments: Any) -> Any:
                self.names.append(name)
                return function(*arguments)

            return call

        context.function = listened
        return ModernGLBackend(context, explain_log)


@pytest.fixture
def listener() -> Listener:
    return Listener()


@pytest.fixture
def heard(listener: Listener) -> Iterator[GraphicsDevice]:
    """A device to whose functions the listener listens."""
    with GraphicsDevice(listener.open_backend) as device:
        try:
            device.finish()
        except ContextError as error:
            pytest.skip(f"no EGL context: {error}")
        listener.names.clear()
        yield device


def covered(device: GraphicsDevice, program: Handle) -> np.ndarray:
    """What a program draws that makes its own triangle and reads nothing."""
    canvas = Canvas(device)
    commands = CommandList()
    canvas.begin(commands)
    mesh = device.create_mesh(MeshDescriptor(Topology.TRIANGLES, 3))
    commands.draw(program, mesh, nothing_bound(device), FLAT)
    return canvas.finish(commands)


def test_all_programs_link_before_one_is_asked_for(
    heard: GraphicsDevice, listener: Listener
) -> None:
    programs = [
        heard.create_program(describe(fragment=FRAGMENT.replace("0.0", value)))
        for value in ("0.25", "0.5", "0.75")
    ]
    blues = [covered(heard, program)[8, 8, 2] for program in programs]
    assert blues == [0.25, 0.5, 0.75]
    names = listener.names
    assert names.count("glLinkProgram") == 3
    last = max(i for i, name in enumerate(names) if name == "glLinkProgram")
    for question in ("glGetShaderiv", "glGetProgramiv", "glUseProgram"):
        assert question not in names[:last]
    assert "glGetProgramiv" in names


def test_several_that_are_waited_for_link_side_by_side(
    heard: GraphicsDevice, listener: Listener
) -> None:
    fragments = [FRAGMENT.replace("0.0", value) for value in ("0.25", "0.5")]
    programs = heard.create_programs(
        [describe(fragment=fragment) for fragment in fragments]
    )
    names = listener.names
    assert names.index("glGetProgramiv") > names.index("glLinkProgram")
    assert "glLinkProgram" not in names[names.index("glGetProgramiv") :]
    assert [covered(heard, each)[8, 8, 2] for each in programs] == [0.25, 0.5]


@pytest.mark.parametrize("shading", ["forward", "visibility"])
@pytest.mark.parametrize("background", ["environment", (1.0, 0.5, 0.0)])
def test_a_picture_begins_all_its_programs_before_one_is_asked_for(
    heard: GraphicsDevice, listener: Listener, shading: str, background: Any
) -> None:
    """Those of its light too, which has to be integrated first."""
    size = (32, 32)
    scene, camera = Scene(), Camera()
    scene.add(demo_model())
    scene.environment = load_environment("studio")
    scene.background = background
    camera.frame(scene.bounds(), 1.0)
    renderer = Renderer(heard, size, RenderSettings(shading=shading))
    commands = CommandList()
    renderer.draw(scene, camera, commands)
    readback = renderer.read_display(commands)
    heard.submit(commands).wait()
    renderer.close()
    assert readback.data is not None
    assert np.ptp(readback.data) > 0
    names = listener.names
    # Four integrate the light; the surfaces and the display have others.
    assert names.count("glLinkProgram") >= 6
    assert "glLinkProgram" not in names[names.index("glGetProgramiv") :]


@pytest.mark.parametrize(("vertex", "fragment", "message"), FAULTS)
def test_a_fault_names_file_and_line_where_it_is_waited_for(
    egl_device: GraphicsDevice, vertex: str, fragment: str, message: str
) -> None:
    good = describe()
    with pytest.raises(ShaderError) as caught:
        egl_device.create_programs([good, describe(vertex, fragment), good])
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)
    # The device goes on, and no debug message is left over.
    program = egl_device.create_program(good, wait=True)
    assert covered(egl_device, program)[8, 8, 3] == 1.0


@pytest.mark.parametrize(("vertex", "fragment", "message"), FAULTS)
@pytest.mark.parametrize("next_call", ["finish", "submit", "texture"])
def test_a_fault_that_nobody_waits_for_is_raised_by_the_next_call(
    heard: GraphicsDevice,
    next_call: str,
    vertex: str,
    fragment: str,
    message: str,
) -> None:
    heard.create_program(describe())
    heard.create_program(describe(vertex, fragment))

    def call() -> None:
        if next_call == "submit":
            heard.submit(CommandList()).wait()
        if next_call == "texture":
            # Reports of the driver are read here: not as the texture's.
            heard.create_texture(TextureDescriptor(PixelFormat.R8, 4, 4))
        heard.finish()

    with pytest.raises(ShaderError) as caught:
        call()
    assert str(caught.value).startswith(message)
    # And by all that follow: there is no such program.
    with pytest.raises((ShaderError, DeviceError)):
        heard.create_program(describe(), wait=True)


def test_samplers_of_every_type_are_found(egl_device: GraphicsDevice) -> None:
    """Each reads its own texture, whatever is read before and after it."""
    fragment = """
    uniform samplerCube cube;
    uniform usampler2D numbers;
    uniform sampler2D image;
    uniform samplerBuffer texels;
    in vec2 place;
    out vec4 colour;
    void main() {
        colour = vec4(
            textureLod(cube, vec3(place, 1.0), 0.0).r,
            float(texelFetch(numbers, ivec2(0), 0).r),
            texelFetch(image, ivec2(0), 0).r,
            texelFetch(texels, 1).r);
    }
    """
    program = egl_device.create_program(describe(fragment=fragment))

    def texture(
        name: str, pixels: PixelFormat, kind: TextureKind, texels: np.ndarray
    ) -> TextureBinding:
        height, width = texels.shape[-3:-1]
        descriptor = TextureDescriptor(pixels, width, height, kind)
        handle = egl_device.create_texture(descriptor, [texels])
        return TextureBinding(name, handle, TEXELS)

    flat, floats = TextureKind.TEXTURE_2D, PixelFormat.R32F
    rows = np.array([[[0], [4]]], np.float32)
    group = egl_device.create_bind_group(
        BindGroupDescriptor(
            (
                texture("image", floats, flat, rows[:, 1:] - 1),
                texture("texels", PixelFormat.R32F, TextureKind.BUFFER, rows),
                texture(
                    "numbers",
                    PixelFormat.R32UI,
                    flat,
                    np.array([[[2]]], np.uint32),
                ),
                texture(
                    "cube",
                    floats,
                    TextureKind.CUBE,
                    np.ones((6, 1, 1, 1), np.float32),
                ),
            )
        )
    )
    canvas = Canvas(egl_device)
    commands = CommandList()
    canvas.begin(commands)
    mesh = egl_device.create_mesh(MeshDescriptor(Topology.TRIANGLES, 3))
    commands.draw(program, mesh, group, FLAT)
    shown = canvas.finish(commands)[8, 8]
    np.testing.assert_allclose(shown, [1, 2, 3, 4], rtol=1e-6)


def test_a_destroyed_program_takes_its_vertex_arrays_along(
    heard: GraphicsDevice, listener: Listener
) -> None:
    canvas, mesh = Canvas(heard), square(heard)
    group = nothing_bound(heard)

    def alive(kind: str) -> int:
        assert listener.context is not None
        signature = (f"glIs{kind}", c_ubyte, c_uint)
        exists = listener.context.function(*signature)
        return heard._thread.call(
            lambda _: sum(exists(name) for name in range(1, 100))
        )

    kinds = ("Program", "Shader", "VertexArray")
    before = [alive(kind) for kind in kinds]
    program = number_program(heard)
    commands = CommandList()
    canvas.begin(commands)
    commands.draw(program, mesh, group, FLAT, tiles(range(4), 2))
    drawn = canvas.finish(commands)
    assert [alive(kind) for kind in kinds] == [
        *(before[0] + 1, before[1], before[2] + 1)
    ]
    heard.destroy(program)
    heard.create_program(describe())  # begun, and not asked for
    assert [alive(kind) for kind in kinds][2] == before[2]

    # Another one in its slot has arrays of its own.
    commands = CommandList()
    canvas.begin(commands)
    commands.draw(number_program(heard), mesh, group, FLAT, tiles(range(4), 2))
    assert np.array_equal(canvas.finish(commands), drawn)
