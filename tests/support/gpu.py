"""Runs moka's GLSL by itself: functions over arrays, and full-screen passes.

What comes back are float32 arrays, to be compared with the float64 oracles.
It speaks to the driver through bare ModernGL, so that a shader can be
tested without the renderer around it. The environment variable
MOKA_TEST_BACKEND picks the kind of context: egl, osmesa or window.
"""

import os
import threading
from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any

import moderngl
import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from moka.backend.contexts import open_context
from moka.commands.descriptors import ShaderText
from moka.core.errors import ContextError
from moka.graphics.shader_source import (
    explain_log,
    load_shader,
    preprocess_shader,
)

__all__ = ["Gpu", "gpu"]

WIDTH = 1024  # of the targets that hold one result per texel

Defines = Mapping[str, str | int]
NO_DEFINES: Defines = MappingProxyType({})
NO_TEXTURES: Mapping[str, Any] = MappingProxyType({})
NO_BLOCKS: Mapping[str, bytes] = MappingProxyType({})
Image = NDArray[np.float32]


class Gpu:
    """A context of its own, and the programs that were built in it."""

    def __init__(self) -> None:
        backend = os.environ.get("MOKA_TEST_BACKEND", "auto")
        try:
            self._owner = open_context(backend, debug=True)
        except ContextError as error:
            pytest.skip(str(error))
        self.context = self._owner.gl
        self._programs: dict[tuple[str, str], moderngl.Program] = {}
        self._framebuffers: dict[
            tuple[int, int, str], moderngl.Framebuffer
        ] = {}

    def evaluate(
        self,
        expression: str,
        include: str | Sequence[str],
        defines: Defines = NO_DEFINES,
        /,
        *,
        textures: Mapping[str, Any] = NO_TEXTURES,
        **inputs: ArrayLike,
    ) -> NDArray[np.float32]:
        """The GLSL ``expression`` for every row of the ``inputs``.

        An input of shape (N,) is a float in GLSL, one of shape (N, k) a
        vector; single values are repeated. ``include`` names files of
        ``shaders/include``, ``textures`` what their samplers read. Returns
        shape (N,) for a float and (N, k) for a vector of two or three,
        whichever the expression is.
        """
        arrays = {
            name: np.atleast_1d(np.asarray(value, np.float32))
            for name, value in inputs.items()
        }
        files = [include] if isinstance(include, str) else include
        source = _shader_of(expression, files, arrays)
        text = preprocess_shader(source, defines, name="expression")
        count = max(len(array) for array in arrays.values())
        height = -(-count // WIDTH)
        with self.context:
            values = {}
            for name, array in arrays.items():
                texels = np.zeros((height * WIDTH, 4), np.float32)
                rows = array.reshape(len(array), -1)
                texels[:count, : rows.shape[1]] = rows
                values[f"input_{name}"] = self.context.texture(
                    (WIDTH, height), 4, texels.tobytes(), dtype="f4"
                )
            bound = {**textures, **values}
            pixels = self._draw(text, (WIDTH, height), bound, {}, "f4")[0]
            for texture in values.values():
                texture.release()
        rows = pixels.reshape(-1, 4)[:count]
        size = int(rows[0, 3])
        return rows[:, 0] if size == 1 else rows[:, :size]

    def draw(
        self,
        name: str,
        size: tuple[int, int],
        *,
        vertex: str = "fullscreen.vert",
        defines: Defines = NO_DEFINES,
        textures: Mapping[str, Any] = NO_TEXTURES,
        blocks: Mapping[str, bytes] = NO_BLOCKS,
        dtype: str = "f4",
    ) -> Image:
        """Draw the full-screen pass ``shaders/<name>``.

        ``vertex`` makes its triangle; ``size`` is (width, height). Returns
        float32 of shape (height, width, 4), the first row at
        gl_FragCoord.y = 0.5; ``dtype`` is that of the target.
        """
        with self.context:
            return self._draw(
                load_shader(name, defines),
                size,
                textures,
                blocks,
                dtype,
                load_shader(vertex, defines),
            )[0]

    def draw_outputs(
        self,
        name: str,
        size: tuple[int, int],
        count: int,
        *,
        defines: Defines = NO_DEFINES,
        textures: Mapping[str, Any] = NO_TEXTURES,
        blocks: Mapping[str, bytes] = NO_BLOCKS,
    ) -> Image:
        """:meth:`draw` of a pass with outputs 0 to ``count`` - 1.

        Returns float32 of shape (count, height, width, 4).
        """
        text = load_shader(name, defines)
        with self.context:
            return self._draw(text, size, textures, blocks, "f4", count=count)

    def texture(self, pixels: ArrayLike) -> moderngl.Texture:
        """A float32 texture of (H, W, 4), row 0 at t = 0, bilinear."""
        array = np.ascontiguousarray(pixels, np.float32)
        height, width, channels = array.shape
        with self.context:
            texture = self.context.texture(
                (width, height), channels, array.tobytes(), dtype="f4"
            )
            texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            texture.repeat_x, texture.repeat_y = True, False
        return texture

    def cube(self, faces: ArrayLike, mipmaps: bool) -> moderngl.TextureCube:
        """A float32 cube map of (6, N, N, 4) in OpenGL's order."""
        array = np.ascontiguousarray(faces, np.float32)
        with self.context:
            texture = self.context.texture_cube(
                array.shape[1:3], array.shape[3], array.tobytes(), dtype="f4"
            )
            if mipmaps:
                texture.build_mipmaps()
                minify = moderngl.LINEAR_MIPMAP_LINEAR
            else:
                minify = moderngl.LINEAR
            texture.filter = (minify, moderngl.LINEAR)
        return texture

    def compile(self, vertex: ShaderText, fragment: ShaderText) -> None:
        """Fail the test, naming file and line, unless the two link."""
        with self.context:
            self._program(vertex, fragment)

    def _draw(
        self,
        text: ShaderText,
        size: tuple[int, int],
        textures: Mapping[str, Any],
        blocks: Mapping[str, bytes],
        dtype: str,
        vertex: ShaderText | None = None,
        count: int = 1,
    ) -> Image:
        """What each of ``count`` outputs is afterwards."""
        program = self._program(vertex or load_shader("fullscreen.vert"), text)
        for unit, (name, texture) in enumerate(textures.items()):
            # A sampler that an expression does not need is optimised away.
            if name in program:
                program[name] = unit
            texture.use(unit)
        buffers = []
        for binding, (name, data) in enumerate(blocks.items()):
            block = program[name]
            block.binding = binding
            assert len(data) >= block.size, f"{name}: {block.size} bytes"
            buffers.append(self.context.buffer(data))
            buffers[-1].bind_to_uniform_block(binding)
        framebuffer = self._framebuffer(size, dtype, count)
        framebuffer.use()
        vertices = self.context.vertex_array(program, [])
        vertices.render(moderngl.TRIANGLES, vertices=3)
        data = b"".join(
            framebuffer.read(components=4, attachment=output, dtype=dtype)
            for output in range(count)
        )
        messages = self._owner.drain_debug_messages()
        assert not [message for message in messages if message.is_error]
        assert self.context.error == "GL_NO_ERROR"
        for resource in (vertices, *buffers):
            resource.release()
        kinds = {"f4": np.float32, "f2": np.float16, "f1": np.uint8}
        pixels = np.frombuffer(data, kinds[dtype])
        scale = np.float32(255 if dtype == "f1" else 1)
        shape = count, size[1], size[0], 4
        return pixels.reshape(shape).astype(np.float32) / scale

    def _framebuffer(
        self, size: tuple[int, int], dtype: str, count: int
    ) -> moderngl.Framebuffer:
        # Kept, because ModernGL binds the last one again, even a released
        # one, when it makes another.
        key = (*size, dtype, count)
        if key not in self._framebuffers:
            self._framebuffers[key] = self.context.framebuffer(
                [
                    self.context.texture(size, 4, dtype=dtype)
                    for _ in range(count)
                ]
            )
        return self._framebuffers[key]

    def _program(
        self, vertex: ShaderText, fragment: ShaderText
    ) -> moderngl.Program:
        key = (vertex.source, fragment.source)
        if key not in self._programs:
            self._programs[key] = self._link(vertex, fragment)
        return self._programs[key]

    def _link(
        self, vertex: ShaderText, fragment: ShaderText
    ) -> moderngl.Program:
        try:
            return self.context.program(
                vertex_shader=vertex.source, fragment_shader=fragment.source
            )
        except moderngl.Error as error:
            log = str(error)
        wrong = vertex if "vertex_shader" in log else fragment
        pytest.fail(explain_log(log, wrong), pytrace=False)


def _shader_of(
    expression: str, files: Sequence[str], inputs: Mapping[str, Any]
) -> str:
    lines = [f'#include "include/{file}.glsl"' for file in files]
    body = []
    for name, array in inputs.items():
        size = 1 if array.ndim == 1 else array.shape[1]
        kind = "float" if size == 1 else f"vec{size}"
        lines.append(f"uniform sampler2D input_{name};")
        body.append(
            f"    {kind} {name} = "
            f"texelFetch(input_{name}, place, 0).{'xyzw'[:size]};"
        )
    # Overloads find the type of the expression; alpha says which it was.
    return "\n".join(
        [
            *lines,
            "out vec4 result;",
            "vec4 whole(float x) { return vec4(x, 0.0, 0.0, 1.0); }",
            "vec4 whole(vec2 x) { return vec4(x, 0.0, 2.0); }",
            "vec4 whole(vec3 x) { return vec4(x, 3.0); }",
            "void main() {",
            "    ivec2 place = ivec2(gl_FragCoord.xy);",
            *body,
            f"    result = whole({expression});",
            "}",
        ]
    )


@cache
def _of_thread(_thread: int) -> Gpu:
    return Gpu()


def gpu() -> Gpu:
    """The context of this thread; the test is skipped without a driver."""
    return _of_thread(threading.get_ident())
