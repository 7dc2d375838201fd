"""moka in another program's context leaves it as it was, and draws the same."""

import ctypes
import gc
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from moka.backend.contexts import open_context
from moka.backend.gl_functions import Functions
from moka.backend.host_state import HostState
from moka.commands.command_list import CommandList
from moka.core.errors import ContextError, DeviceError, ShaderError
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import load_environment
from moka.model import demo_model
from moka.renderer.renderer import Renderer
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.display import running_display

pytestmark = pytest.mark.gpu

SIZE = (64, 36)

VERTEX = """#version 330 core
in vec2 corner;
out vec2 position;
void main() { position = corner; gl_Position = vec4(corner, 0.2, 1.0); }
"""
FRAGMENT = """#version 330 core
uniform sampler2D image;
layout(std140) uniform Tint { vec4 tint; };
in vec2 position;
out vec4 colour;
void main() { colour = tint * texture(image, position + 0.5); }
"""

# One integer each: what glGetIntegerv tells of states that moka may touch.
STATES = {
    "ACTIVE_TEXTURE": 0x84E0,
    "ARRAY_BUFFER_BINDING": 0x8894,
    "CLIP_DEPTH_MODE": 0x935D,
    "CLIP_ORIGIN": 0x935C,
    "CULL_FACE_MODE": 0x0B45,
    "CURRENT_PROGRAM": 0x8B8D,
    "DEPTH_FUNC": 0x0B74,
    "DEPTH_WRITEMASK": 0x0B72,
    "DRAW_FRAMEBUFFER_BINDING": 0x8CA6,
    "DRAW_INDIRECT_BUFFER_BINDING": 0x8F43,
    "FRONT_FACE": 0x0B46,
    "PIXEL_PACK_BUFFER_BINDING": 0x88ED,
    "PIXEL_UNPACK_BUFFER_BINDING": 0x88EF,
    "PACK_ALIGNMENT": 0x0D05,
    "READ_FRAMEBUFFER_BINDING": 0x8CAA,
    "TEXTURE_BUFFER_BINDING": 0x8C2A,
    "UNIFORM_BUFFER_BINDING": 0x8A28,
    "UNPACK_ALIGNMENT": 0x0CF5,
    "UNPACK_ROW_LENGTH": 0x0CF2,
    "VERTEX_ARRAY_BINDING": 0x85B5,
}
CAPABILITIES = {
    "BLEND": 0x0BE2,
    "CULL_FACE": 0x0B44,
    "DEPTH_TEST": 0x0B71,
    "FRAMEBUFFER_SRGB": 0x8DB9,
    "PROGRAM_POINT_SIZE": 0x8642,
    "RASTERIZER_DISCARD": 0x8C89,
    "SAMPLE_ALPHA_TO_COVERAGE": 0x809E,
    "SCISSOR_TEST": 0x0C11,
    "STENCIL_TEST": 0x0B90,
    "TEXTURE_CUBE_MAP_SEAMLESS": 0x884F,
}


class Host:
    """A program with a context of its own, and state of every kind set."""

    def __init__(self) -> None:
        self.owner = open_context("egl")
        self.gl = self.owner.gl
        self.gl.gc_mode = None
        self.target = self.gl.simple_framebuffer(SIZE)
        self.other = self.gl.simple_framebuffer((8, 8))
        corners = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]], "f4")
        program = self.gl.program(
            vertex_shader=VERTEX, fragment_shader=FRAGMENT
        )
        self.array = self.gl.vertex_array(
            program,
            [(self.gl.buffer(corners), "2f", "corner")],
            mode=moderngl.TRIANGLE_STRIP,
        )
        self.image = self.gl.texture(
            (4, 4), 4, np.arange(64, dtype=np.uint8).tobytes()
        )
        self.sampler = self.gl.sampler(
            filter=(moderngl.NEAREST, moderngl.NEAREST)
        )
        self.tint = self.gl.buffer(
            np.array([0, 0, 0, 0] * 16 + [4, 3, 2, 0.5], "f4")
        )

    def call(self, name: str, *arguments: float) -> None:
        """An OpenGL function of integers, or of doubles where one is given."""
        kinds = [
            ctypes.c_double if isinstance(value, float) else ctypes.c_uint
            for value in arguments
        ]
        self.owner.function(name, None, *kinds)(*arguments)

    def set_odd_state(self) -> None:
        """Clear; then everything is other than in a new context."""
        self.call("glDisable", CAPABILITIES["SCISSOR_TEST"])
        self.target.clear(0.5, 0.5, 0.5, 0.5)
        self.gl.enable(moderngl.BLEND | moderngl.CULL_FACE)
        self.gl.blend_func = moderngl.ONE, moderngl.SRC_ALPHA
        self.gl.cull_face = "front"
        self.gl.front_face = "cw"
        self.gl.depth_func = "!="
        self.gl.disable(moderngl.PROGRAM_POINT_SIZE)
        self.call("glEnable", CAPABILITIES["STENCIL_TEST"])
        self.call("glStencilFunc", 0x0200, 1, 1)  # NEVER passes
        self.call("glEnable", CAPABILITIES["FRAMEBUFFER_SRGB"])
        self.call("glDisable", CAPABILITIES["TEXTURE_CUBE_MAP_SEAMLESS"])
        self.call("glEnable", CAPABILITIES["SCISSOR_TEST"])
        self.call("glScissor", 3, 5, 30, 20)
        self.call("glClipControl", 0x8CA2, 0x935E)  # UPPER_LEFT, -1 to 1
        self.call("glDepthRange", 0.25, 0.5)
        self.call("glDepthMask", 0)
        self.call("glColorMaski", 0, 1, 0, 1, 1)
        self.call("glPixelStorei", STATES["UNPACK_ALIGNMENT"], 8)
        self.call("glPixelStorei", STATES["UNPACK_ROW_LENGTH"], 5)
        self.call("glBindBuffer", 0x88EC, self.tint.glo)  # PIXEL_UNPACK
        self.call("glBindBuffer", 0x88EB, self.tint.glo)  # PIXEL_PACK
        for unit in range(8):
            self.image.use(unit)
            self.sampler.use(unit)
            self.tint.bind_to_uniform_block(unit, offset=256, size=16)
        self.call("glActiveTexture", 0x84C0 + 3)

    def draw(self) -> NDArray[np.uint8]:
        """What its program draws with all that is set now."""
        self.target.clear(0.2, 0.4, 0.6, 0.8)
        self.array.render()
        self.call("glBindBuffer", 0x88EB, 0)  # or it would be read into
        pixels = np.frombuffer(self.target.read(components=4), np.uint8)
        self.call("glBindBuffer", 0x88EB, self.tint.glo)
        return pixels.reshape(SIZE[1], SIZE[0], 4)

    def state(self) -> dict[str, Any]:
        """All that OpenGL tells of it."""
        get = self.owner.function(
            "glGetIntegerv", None, ctypes.c_uint, ctypes.c_void_p
        )
        get_of = self.owner.function(
            "glGetIntegeri_v",
            None,
            *(ctypes.c_uint, ctypes.c_uint, ctypes.c_void_p),
        )
        is_enabled = self.owner.function(
            "glIsEnabled", ctypes.c_ubyte, ctypes.c_uint
        )

        def values(code: int, count: int = 1) -> list[int]:
            found = (ctypes.c_int * count)()
            get(code, found)
            return list(found)

        def indexed(code: int, index: int, count: int = 1) -> list[int]:
            found = (ctypes.c_int * count)()
            get_of(code, index, found)
            return list(found)

        found: dict[str, Any] = {
            name: values(code) for name, code in STATES.items()
        }
        for name, code in CAPABILITIES.items():
            found[name] = is_enabled(code)
        found["viewport"] = values(0x0BA2, 4)
        found["scissor"] = values(0x0C10, 4)
        found["depth range"] = values(0x0B70, 2)
        for index in range(8):
            found[f"mask {index}"] = indexed(0x0C23, index, 4)
            found[f"blend {index}"] = [
                indexed(code, index) for code in range(0x80C8, 0x80CC)
            ]
            found[f"block {index}"] = [
                indexed(code, index) for code in (0x8A28, 0x8A29, 0x8A2A)
            ]
        active = found["ACTIVE_TEXTURE"][0]
        for unit in (*range(32), 47):
            self.call("glActiveTexture", 0x84C0 + unit)
            found[f"unit {unit}"] = [
                values(code)
                for code in (0x8069, 0x8514, 0x9104, 0x8C2C, 0x8919)
            ]
        self.call("glActiveTexture", active)
        return found


@pytest.fixture
def host() -> Iterator[Host]:
    """A host that is current; skips the test where there is no EGL."""
    try:
        host = Host()
    except ContextError as error:
        pytest.skip(str(error))
    yield host
    host.owner.close()


def scene_and_camera() -> tuple[Scene, Camera]:
    scene, camera = Scene(), Camera()
    scene.add(demo_model())
    scene.environment = load_environment("studio")
    camera.frame(scene.bounds(), SIZE[0] / SIZE[1])
    return scene, camera


def draw_scene(device: GraphicsDevice) -> None:
    """Draw the scene into what stands for the window."""
    scene, camera = scene_and_camera()
    renderer = Renderer(device, SIZE, to_window=True)
    commands = CommandList()
    renderer.draw(scene, camera, commands)
    device.submit(commands)
    renderer.close()


def picture(target: moderngl.Framebuffer) -> NDArray[np.uint8]:
    pixels = np.frombuffer(target.read(components=4), np.uint8)
    return pixels.reshape(SIZE[1], SIZE[0], 4)


def own_picture() -> NDArray[np.uint8]:
    """The scene as a device with a render thread of its own draws it."""
    with GraphicsDevice.open("egl") as device:
        renderer = Renderer(device, SIZE)
        scene, camera = scene_and_camera()
        commands = CommandList()
        renderer.draw(scene, camera, commands)
        readback = renderer.read_display(commands)
        device.submit(commands).wait()
        renderer.close()
    assert readback.data is not None
    return np.asarray(readback.data)


def test_the_picture_is_that_of_a_device_of_its_own(host: Host) -> None:
    host.target.use()
    with GraphicsDevice.embed(host.gl) as device:
        assert device.info.kind == "embedded"
        draw_scene(device)
    np.testing.assert_array_equal(picture(host.target), own_picture())


def test_all_state_is_left_as_it_was_and_none_shows(host: Host) -> None:
    host.gl.gc_mode = "context_gc"
    host.target.use()
    host.set_odd_state()
    drawn = host.draw()
    assert np.ptp(drawn) > 0
    # Clearing and reading through ModernGL has changed some of it.
    host.set_odd_state()
    before = host.state()
    with GraphicsDevice.embed(host.gl) as device:
        assert host.state() == before
        draw_scene(device)
        assert host.state() == before
        assert host.gl.gc_mode == "context_gc"
        host.call("glBindBuffer", 0x88EB, 0)
        np.testing.assert_array_equal(picture(host.target), own_picture())
        host.set_odd_state()
        np.testing.assert_array_equal(host.draw(), drawn)
        host.set_odd_state()
    assert host.state() == before
    np.testing.assert_array_equal(host.draw(), drawn)
    assert host.gl.error == "GL_NO_ERROR"


def test_state_is_kept_without_what_later_versions_have(host: Host) -> None:
    """By the functions of OpenGL 3.3, which set all attachments as one."""
    old = SimpleNamespace(version_code=330, extensions=frozenset[str]())
    state = HostState(Functions(host.owner.function), old)
    host.target.use()
    host.set_odd_state()
    # No function of 3.3 could have set this.
    host.call("glClipControl", 0x8CA1, 0x935E)
    before = host.state()
    with state.kept(blocks=8, units=8) as framebuffer:
        assert framebuffer == host.target.glo
        host.gl.disable(moderngl.BLEND | moderngl.CULL_FACE)
        host.gl.blend_func = moderngl.DST_COLOR, moderngl.ONE
        host.call("glUseProgram", 0)
        host.call("glBindVertexArray", 0)
        for unit in range(8):
            host.call("glActiveTexture", 0x84C0 + unit)
            host.call("glBindTexture", 0x0DE1, 0)
            host.call("glBindSampler", unit, 0)
            host.tint.bind_to_uniform_block(unit, offset=0)
        host.other.use()
        host.other.clear()
        assert host.state() != before
    assert host.state() == before


@pytest.mark.window
def test_a_window_of_the_host_is_drawn_into() -> None:
    glfw = pytest.importorskip("glfw", reason="glfw is not installed")
    with running_display():
        if not glfw.init():
            pytest.skip("GLFW finds no display")
        glfw.default_window_hints()
        glfw.window_hint(glfw.VISIBLE, False)
        glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, 3)
        glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, 3)
        glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
        window = glfw.create_window(*SIZE, "host", None, None)
        glfw.make_context_current(window)
        # As a program has it that did not make its context by ModernGL.
        moderngl.init_context()
        gl = moderngl.get_context()
        gl.screen.use()
        with GraphicsDevice.embed(gl) as device:
            draw_scene(device)
        assert gl.error == "GL_NO_ERROR"
        pixels = np.frombuffer(gl.screen.read(components=3), np.uint8)
        gl.release()
        glfw.make_context_current(None)
        glfw.destroy_window(window)
        glfw.terminate()
    shown = pixels.reshape(SIZE[1], SIZE[0], 3).astype(int)
    assert np.abs(shown - own_picture()[..., :3]).max() <= 1


def test_frames_go_where_the_host_draws_at_that_moment(host: Host) -> None:
    with GraphicsDevice.embed(host.gl) as device:
        commands = CommandList()
        commands.bind_framebuffer(None)
        commands.clear((1.0, 0.0, 0.0, 1.0))
        for target in (host.other, host.target):
            target.use()
            target.clear()
            device.submit(commands)
            pixels = np.frombuffer(target.read(components=4), np.uint8)
            assert (pixels.reshape(-1, 4) == (255, 0, 0, 255)).all()


def test_closing_leaves_only_what_the_host_has_made(host: Host) -> None:
    kinds = ("Buffer", "Program", "Texture", "Framebuffer", "VertexArray")

    def alive() -> dict[str, list[int]]:
        return {
            kind: [
                name
                for name in range(1, 400)
                if host.owner.function(
                    f"glIs{kind}", ctypes.c_ubyte, ctypes.c_uint
                )(name)
            ]
            for kind in (*kinds, "Sampler", "Shader")
        }

    host.target.use()
    host.draw()
    before = alive()
    device = GraphicsDevice.embed(host.gl)
    draw_scene(device)
    assert alive() != before
    device.close()
    device.close()
    assert alive() == before
    with pytest.raises(DeviceError, match="closed"):
        device.finish()


def test_a_dropped_device_speaks_to_the_context_no_more(host: Host) -> None:
    device = GraphicsDevice.embed(host.gl)
    draw_scene(device)
    before = host.state()
    del device
    gc.collect()
    assert host.state() == before


def test_other_threads_are_told_where_it_belongs(host: Host) -> None:
    caught: list[Exception] = []

    def misuse(device: GraphicsDevice) -> None:
        try:
            device.finish()
        except DeviceError as error:
            caught.append(error)

    with GraphicsDevice.embed(host.gl) as device:
        thread = threading.Thread(target=misuse, args=(device,), name="worker")
        thread.start()
        thread.join()
        device.finish()
    assert str(caught[0]) == (
        "embedded device: belongs to thread MainThread, and was called from "
        "worker; call it where it was embedded"
    )


def test_an_error_leaves_state_and_device_in_order(host: Host) -> None:
    from moka.commands.descriptors import ProgramDescriptor, ShaderText

    host.target.use()
    before = host.state()
    broken = ShaderText("#version 330 core\nvoid main() { nonsense }")
    with GraphicsDevice.embed(host.gl) as device:
        for wait in (False, True):
            with pytest.raises(ShaderError, match="syntax error"):
                device.create_program(
                    ProgramDescriptor(broken, broken), wait=wait
                )
            assert host.state() == before
        draw_scene(device)
    np.testing.assert_array_equal(picture(host.target), own_picture())


def test_only_a_living_moderngl_context_will_do(host: Host) -> None:
    with pytest.raises(ContextError, match=r"str is no moderngl\.Context"):
        GraphicsDevice.embed("context")
    released = moderngl.create_standalone_context(backend="egl")
    released.release()
    with pytest.raises(ContextError, match="has been released"):
        GraphicsDevice.embed(released)
    host.owner._native.make_current()


def test_two_devices_share_a_context(host: Host) -> None:
    host.target.use()
    expected = own_picture()
    with (
        GraphicsDevice.embed(host.gl) as first,
        GraphicsDevice.embed(host.gl) as second,
    ):
        for device in (first, second):
            host.target.clear()
            draw_scene(device)
            np.testing.assert_array_equal(picture(host.target), expected)
        first.close()
        host.target.clear()
        draw_scene(second)
        np.testing.assert_array_equal(picture(host.target), expected)
