"""The ModernGL backend draws what a recording says, and nothing leaks."""

from collections.abc import Callable

import numpy as np
import pytest

from moka.backend.contexts import open_context
from moka.backend.moderngl_backend import ModernGLBackend
from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BlendState,
    BufferDescriptor,
    BufferUsage,
    CompareFunction,
    CullMode,
    FramebufferDescriptor,
    MeshDescriptor,
    PixelFormat,
    ProgramDescriptor,
    RasterState,
    SamplerDescriptor,
    ShaderText,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
    Topology,
    UniformBinding,
    Wrap,
)
from moka.commands.draws import DRAW
from moka.commands.sort_key import SortKey, Stage
from moka.core.errors import DeviceError, ShaderError
from moka.graphics.device import GraphicsDevice
from moka.graphics.shader_source import explain_log
from tests.support.drawing import (
    Canvas,
    nothing_bound,
    number_program,
    square,
    tiles,
)

pytestmark = pytest.mark.gpu

FLAT = RasterState(cull=CullMode.NONE, depth_test=None, depth_write=False)

SAMPLE = """#version 330 core
uniform sampler2D image;
layout(std140) uniform Place { vec4 place; };
out vec4 colour;
void main() { colour = texture(image, place.xy); }
"""
COVER = """#version 330 core
void main() {
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
    gl_Position = vec4(4.0 * corner - 1.0, 0.0, 1.0);
}
"""


def test_instances_land_in_their_tiles(device: GraphicsDevice) -> None:
    canvas = Canvas(device)
    commands = CommandList()
    canvas.begin(commands)
    commands.draw(
        number_program(device),
        square(device),
        nothing_bound(device),
        FLAT,
        tiles(range(16), 4),
    )
    picture = canvas.finish(commands)
    expected = np.arange(16).reshape(4, 4).repeat(4, 0).repeat(4, 1)
    assert np.array_equal(picture[:, :, 0], expected)


@pytest.mark.parametrize("multi_draw", [True, False])
@pytest.mark.parametrize("indexed", [True, False])
def test_merged_draws_make_the_picture_of_single_ones(
    multi_draw: bool, indexed: bool
) -> None:
    """GL 3.3's path and multi-draw-indirect agree with drawing by hand."""

    def open_backend() -> ModernGLBackend:
        return ModernGLBackend(
            open_context("egl", debug=True),
            explain_log,
            multi_draw=multi_draw,
        )

    with GraphicsDevice(open_backend) as device:
        program = number_program(device)
        meshes = [square(device, indexed=indexed, scale=s) for s in (1, 0.5)]
        group = nothing_bound(device)
        numbers = list(range(16))
        instances = tiles(numbers, 4)

        canvas = Canvas(device)
        commands = CommandList()
        canvas.begin(commands)
        for index in numbers:
            commands.draw(
                program,
                meshes[index // 3 % 2],
                group,
                FLAT,
                instances[index : index + 1],
            )
        by_hand = canvas.finish(commands)

        rows = np.zeros(len(numbers), DRAW)
        rows["key"] = int(SortKey(1, stage=Stage.OPAQUE))
        rows["program"] = program.index
        rows["bind_group"] = group.index
        rows["mesh"] = [meshes[index // 3 % 2].index for index in numbers]
        rows["first_instance"] = numbers
        rows["instance_count"] = 1
        commands = CommandList()
        canvas.begin(commands)
        rows["state"] = commands.state_index(FLAT)
        commands.use(frozenset((program, group, *meshes)))
        commands.draws(rows, instances)
        buffer = commands.command_buffer(SortKey(2))
        readback = buffer.read_pixels(canvas.framebuffer, (0, 0, *canvas.size))
        counters = device.submit(commands).wait()
        assert np.array_equal(readback.data, by_hand)
        # Six runs of one mesh each; meshes have buffers of their own.
        assert counters.gl_draws == 6
        assert counters.draw_packets == 16


def test_redundant_state_is_skipped_and_counted(
    egl_device: GraphicsDevice,
) -> None:
    program = number_program(egl_device)
    mesh, group = square(egl_device), nothing_bound(egl_device)
    canvas = Canvas(egl_device)

    def frame(draws: int) -> tuple[int, int]:
        commands = CommandList()
        canvas.begin(commands)
        for _ in range(draws):
            commands.draw(program, mesh, group, FLAT, tiles([1], 1))
        counters = egl_device.submit(commands).wait()
        return counters.state_changes, counters.state_changes_skipped

    frame(1)
    one, ten = frame(1), frame(10)
    assert ten[0] == one[0]
    assert ten[1] > one[1]


def test_what_is_uploaded_counts_with_the_next_frame(
    egl_device: GraphicsDevice,
) -> None:
    """Also where light is integrated between the two."""
    texels = np.zeros((4, 8, 4), np.uint8)
    egl_device.create_texture(
        TextureDescriptor(PixelFormat.RGBA8, 8, 4), [texels]
    )
    egl_device.submit(CommandList(), stage="environment")
    counts = [
        egl_device.submit(CommandList()).wait().bytes_uploaded for _ in range(2)
    ]
    assert counts == [texels.nbytes, 0]


def test_nothing_leaks_from_one_draw_into_the_next(
    egl_device: GraphicsDevice,
) -> None:
    """A plain draw looks the same whatever was drawn before it."""
    program = number_program(egl_device)
    mesh, group = square(egl_device), nothing_bound(egl_device)
    canvas = Canvas(egl_device)
    odd_states = [
        RasterState(cull=CullMode.FRONT, front_clockwise=True),
        RasterState(depth_test=CompareFunction.GREATER, depth_write=False),
        RasterState(blend=BlendState.ADDITIVE, colour_write=False),
        RasterState(wireframe=True, blend=BlendState.ALPHA),
        RasterState(alpha_to_coverage=True, depth_test=None),
    ]

    def picture(before: list[RasterState]) -> np.ndarray:
        commands = CommandList()
        canvas.begin(commands)
        for state in before:
            commands.draw(program, mesh, group, state, tiles([9], 1))
        # Another framebuffer, viewport and scissor, then back.
        commands.scissor((1, 1, 2, 2))
        commands.viewport(3, 3, 5, 5)
        canvas.begin(commands)
        commands.draw(
            program, mesh, group, RasterState(), tiles([1, 2, 3, 4], 2)
        )
        return canvas.finish(commands)

    plain = picture([])
    assert (plain[:, :, 0] > 0).all()
    for state in odd_states:
        assert np.array_equal(picture([state]), plain), state


def test_viewport_and_scissor_cut(egl_device: GraphicsDevice) -> None:
    program = number_program(egl_device)
    mesh, group = square(egl_device), nothing_bound(egl_device)
    canvas = Canvas(egl_device)
    commands = CommandList()
    canvas.begin(commands)
    commands.viewport(4, 0, 8, 16)
    commands.scissor((0, 2, 16, 5))
    commands.draw(program, mesh, group, FLAT, tiles([7], 1))
    picture = canvas.finish(commands)[:, :, 0]
    expected = np.full((16, 16), -1.0)
    expected[2:7, 4:12] = 7
    assert np.array_equal(picture, expected)


def test_samples_are_averaged_by_a_resolve(
    egl_device: GraphicsDevice,
) -> None:
    canvas = Canvas(egl_device)
    sampled = Canvas(egl_device, samples=4)
    commands = CommandList()
    commands.bind_framebuffer(sampled.framebuffer)
    commands.clear((0, 0, 0, 1), 1.0)
    instances = tiles([1], 1)
    # The right edge cuts the middle of a column of pixels.
    instances["transform"][0, 0] = [0.5, 0, 0, -0.5 + 1 / 16]
    commands.draw(
        number_program(egl_device),
        square(egl_device),
        nothing_bound(egl_device),
        FLAT,
        instances,
    )
    commands.resolve(sampled.framebuffer, canvas.framebuffer)
    picture = canvas.finish(commands)[:, :, 0]
    assert np.array_equal(picture[:, 7], np.ones(16))
    assert np.allclose(picture[:, 8], 0.5)
    assert not picture[:, 9:].any()


def cover(device: GraphicsDevice) -> tuple:
    """A program that reads one point of a texture, over every pixel."""
    program = device.create_program(
        ProgramDescriptor(ShaderText(COVER), ShaderText(SAMPLE), "sample"),
        wait=True,
    )
    return program, device.create_mesh(MeshDescriptor(Topology.TRIANGLES, 3))


@pytest.mark.parametrize(
    "pixels",
    [
        PixelFormat.R8,
        PixelFormat.RG8,
        PixelFormat.RGB8,
        PixelFormat.RGBA8,
        PixelFormat.R16,
        PixelFormat.RGB16,
        PixelFormat.RG16F,
        PixelFormat.RGB16F,
        PixelFormat.RGBA16F,
        PixelFormat.R32F,
        PixelFormat.RGB32F,
        PixelFormat.RGBA32F,
    ],
)
def test_texels_of_every_format_come_back(
    egl_device: GraphicsDevice, pixels: PixelFormat
) -> None:
    """Odd widths too: rows of three channels are not aligned to four."""
    generator = np.random.default_rng(5)
    shape = (3, 5, pixels.channels)
    if pixels.dtype[0] == "u":
        top = np.iinfo(pixels.dtype).max
        texels = generator.integers(0, top, shape).astype(pixels.dtype)
    else:
        texels = generator.normal(0, 100, shape).astype(pixels.dtype)
    texture = egl_device.create_texture(
        TextureDescriptor(pixels, 5, 3), [texels]
    )
    assert np.array_equal(egl_device.read_texture(texture), texels)


def test_mip_levels_are_those_that_were_given(
    egl_device: GraphicsDevice,
) -> None:
    levels = [
        np.full((size, size, 4), index, np.uint8)
        for index, size in enumerate((8, 4, 2, 1))
    ]
    texture = egl_device.create_texture(
        TextureDescriptor(PixelFormat.RGBA8, 8, 8, levels=4), levels
    )
    for level in range(4):
        texels = egl_device.read_texture(texture, level=level)
        assert np.array_equal(texels, levels[level])


def test_cube_faces_and_levels_can_be_drawn_into(
    device: GraphicsDevice,
) -> None:
    cube = device.create_texture(
        TextureDescriptor(PixelFormat.RGBA32F, 4, 4, TextureKind.CUBE, levels=2)
    )
    commands = CommandList()
    for level in range(2):
        for face in range(6):
            target = device.create_framebuffer(
                FramebufferDescriptor((Attachment(cube, level, face),))
            )
            commands.bind_framebuffer(target)
            commands.clear((face, level, 0, 1))
    device.submit(commands).wait()
    for level in range(2):
        for face in range(6):
            texels = device.read_texture(cube, level=level, face=face)
            assert texels.shape == (4 >> level, 4 >> level, 4)
            assert (texels == [face, level, 0, 1]).all()


@pytest.mark.parametrize(
    ("wrap", "u", "expected"),
    [
        (Wrap.REPEAT, 1.25, 0),
        (Wrap.MIRRORED_REPEAT, 1.25, 1),
        (Wrap.CLAMP_TO_EDGE, 5.0, 1),
    ],
)
def test_wraps(
    egl_device: GraphicsDevice, wrap: Wrap, u: float, expected: float
) -> None:
    texture = egl_device.create_texture(
        TextureDescriptor(PixelFormat.R32F, 2, 1),
        [np.array([[[0], [1]]], np.float32)],
    )
    place = egl_device.create_buffer(
        BufferDescriptor(BufferUsage.UNIFORM, 16),
        np.array([u, 0.5, 0, 0], np.float32),
    )
    group = egl_device.create_bind_group(
        BindGroupDescriptor(
            (TextureBinding("image", texture, SamplerDescriptor(wrap)),),
            (UniformBinding("Place", place),),
        )
    )
    canvas = Canvas(egl_device, (1, 1))
    commands = CommandList()
    canvas.begin(commands)
    commands.draw(*cover(egl_device), group, FLAT)
    assert canvas.finish(commands)[0, 0, 0] == pytest.approx(expected)


def test_a_filled_buffer_is_read_by_the_draws_behind_it(
    egl_device: GraphicsDevice,
) -> None:
    program = egl_device.create_program(
        ProgramDescriptor(
            ShaderText(COVER),
            ShaderText(
                "#version 330 core\n"
                "layout(std140) uniform Place { vec4 place; };\n"
                "out vec4 colour; void main() { colour = place; }"
            ),
        ),
        wait=True,
    )
    mesh = egl_device.create_mesh(MeshDescriptor(Topology.TRIANGLES, 3))
    place = egl_device.create_buffer(
        BufferDescriptor(BufferUsage.UNIFORM, 16, dynamic=True)
    )
    group = egl_device.create_bind_group(
        BindGroupDescriptor((), (UniformBinding("Place", place),))
    )
    canvas = Canvas(egl_device)
    commands = CommandList()
    canvas.begin(commands)
    for number, x in enumerate((0, 8)):
        commands.fill_buffer(place, np.full(4, number, np.float32))
        commands.viewport(x, 0, 8, 16)
        commands.draw(program, mesh, group, FLAT)
    picture = canvas.finish(commands)[:, :, 0]
    assert not picture[:, :8].any()
    assert (picture[:, 8:] == 1).all()


def fails(device: GraphicsDevice, draw: Callable[[], None]) -> str:
    """The message of the error that ``draw`` causes."""

    def draw_and_finish() -> None:
        draw()
        device.finish()

    with pytest.raises((DeviceError, ShaderError)) as caught:
        draw_and_finish()
    return str(caught.value)


def test_a_missing_texture_is_named() -> None:
    with GraphicsDevice.open("egl", debug=True) as device:
        canvas = Canvas(device)
        program, mesh = cover(device)
        commands = CommandList()
        canvas.begin(commands)
        commands.draw(program, mesh, nothing_bound(device), FLAT)
        message = fails(device, lambda: device.submit(commands).wait())
    assert "reads texture 'image'" in message


def test_a_missing_attribute_is_named() -> None:
    with GraphicsDevice.open("egl", debug=True) as device:
        canvas = Canvas(device)
        mesh = device.create_mesh(MeshDescriptor(Topology.TRIANGLES, 3))
        commands = CommandList()
        canvas.begin(commands)
        commands.draw(number_program(device), mesh, nothing_bound(device), FLAT)
        message = fails(device, lambda: device.submit(commands).wait())
    assert "reads attribute 'position'" in message


def test_a_broken_shader_is_an_error_and_the_device_goes_on(
    device: GraphicsDevice,
) -> None:
    with pytest.raises(ShaderError, match="undeclared"):
        device.create_program(
            ProgramDescriptor(
                ShaderText(COVER),
                ShaderText(
                    "#version 330 core\nout vec4 c; void main() { c = x; }"
                ),
            ),
            wait=True,
        )
    canvas = Canvas(device)
    commands = CommandList()
    canvas.begin(commands)
    assert (canvas.finish(commands)[:, :, :3] == -1).all()


def test_an_incomplete_framebuffer_is_an_error() -> None:
    with GraphicsDevice.open("egl", debug=True) as device:
        small, large = (
            device.create_texture(
                TextureDescriptor(PixelFormat.RGBA8, size, size)
            )
            for size in (4, 8)
        )
        message = fails(
            device,
            lambda: device.create_framebuffer(
                FramebufferDescriptor((Attachment(small), Attachment(large)))
            ),
        )
    assert "one size" in message


def test_gl_errors_are_fatal_in_debug() -> None:
    with GraphicsDevice.open("egl", debug=True) as device:
        commands = CommandList()
        canvas = Canvas(device)
        # GL refuses a viewport of negative size.
        commands.bind_framebuffer(canvas.framebuffer)
        commands.viewport(0, 0, -1, -1)
        message = fails(device, lambda: device.submit(commands).wait())
    assert "OpenGL reports" in message


def test_two_devices_draw_side_by_side() -> None:
    with (
        GraphicsDevice.open("egl", debug=True) as first,
        GraphicsDevice.open("egl", debug=True) as second,
    ):
        devices = (first, second)
        parts = [
            (number_program(d), square(d), nothing_bound(d), Canvas(d))
            for d in devices
        ]
        for round_ in range(5):
            lists = []
            for number, (program, mesh, group, canvas) in enumerate(parts):
                commands = CommandList()
                canvas.begin(commands)
                commands.draw(
                    program, mesh, group, FLAT, tiles([10 * round_ + number], 1)
                )
                lists.append(commands)
            for number, (commands, part) in enumerate(
                zip(lists, parts, strict=True)
            ):
                picture = part[3].finish(commands)
                assert (picture[:, :, 0] == 10 * round_ + number).all()


def test_destroyed_slots_are_used_again_without_ghosts(
    egl_device: GraphicsDevice,
) -> None:
    program, group = number_program(egl_device), nothing_bound(egl_device)
    canvas = Canvas(egl_device)
    for scale in (1.0, 0.5, 0.25, 1.0):
        mesh = square(egl_device, scale=scale)
        commands = CommandList()
        canvas.begin(commands)
        commands.draw(program, mesh, group, FLAT, tiles([1], 1))
        picture = canvas.finish(commands)[:, :, 0]
        assert (picture == 1).sum() == round(16 * scale) ** 2
        egl_device.destroy(mesh)
