"""What another program has set in a context, kept while moka draws there.

OpenGL's state is one for everyone who draws in a context. A guest that
leaves any of it changed breaks its host in ways that are hard to find, and
a host that left anything set that the guest never thinks of, such as a
stencil test, breaks the guest. So a guest reads what it may change, begins
with what a new context has, and puts everything back. The names are those of
the state tables of OpenGL 4.6 core, chapter 23.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from ctypes import byref, c_double, c_int, c_int64, c_ubyte
from typing import Any

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.backend.gl_textures import SCRATCH_UNIT

__all__ = ["HostState"]

# A function and what to call it with, to put something back.
_Call = tuple[Callable[..., Any], tuple[Any, ...]]

# What StateCache and the backend set themselves.
_MANAGED = (
    *(c.CULL_FACE, c.DEPTH_TEST, c.FRAMEBUFFER_SRGB, c.PROGRAM_POINT_SIZE),
    *(c.SAMPLE_ALPHA_TO_COVERAGE, c.SCISSOR_TEST),
    c.TEXTURE_CUBE_MAP_SEAMLESS,
)
# What they take for granted: capability, the version that brought it, and
# whether a new context has it on.
_GRANTED = (
    (0x809D, 330, True),  # MULTISAMPLE
    (0x0B90, 330, False),  # STENCIL_TEST
    (0x0BF2, 330, False),  # COLOR_LOGIC_OP
    (0x0B20, 330, False),  # LINE_SMOOTH
    (0x0B41, 330, False),  # POLYGON_SMOOTH
    (0x2A01, 330, False),  # POLYGON_OFFSET_POINT
    (0x2A02, 330, False),  # POLYGON_OFFSET_LINE
    (0x8037, 330, False),  # POLYGON_OFFSET_FILL
    (0x809F, 330, False),  # SAMPLE_ALPHA_TO_ONE
    (0x80A0, 330, False),  # SAMPLE_COVERAGE
    (0x8E51, 330, False),  # SAMPLE_MASK
    (0x864F, 330, False),  # DEPTH_CLAMP
    (0x8F9D, 330, False),  # PRIMITIVE_RESTART
    (0x8C89, 330, False),  # RASTERIZER_DISCARD
    *((0x3000 + plane, 330, False) for plane in range(8)),  # CLIP_DISTANCE
    (0x8C36, 400, False),  # SAMPLE_SHADING
    (0x8D69, 430, False),  # PRIMITIVE_RESTART_FIXED_INDEX
)

# Rows, pixels, images to skip, lengths and byte order.
_UNPACK = (0x0CF0, 0x0CF1, 0x0CF2, 0x0CF3, 0x0CF4, 0x806D, 0x806E)
_PACK = (0x0D00, 0x0D01, 0x0D02, 0x0D03, 0x0D04, 0x806B, 0x806C)

# Targets of buffers, and what is asked for the buffer that is bound there.
_PIXEL_BUFFERS = ((0x88EB, 0x88ED), (0x88EC, 0x88EF))  # (UN)PACK
_ARRAY_BUFFER = (c.ARRAY_BUFFER, 0x8894)
_UNIFORM_BUFFER = (c.UNIFORM_BUFFER, 0x8A28)
_TEXTURE_BUFFER = (c.TEXTURE_BUFFER, c.TEXTURE_BUFFER)
_INDIRECT_BUFFER = (c.DRAW_INDIRECT_BUFFER, 0x8F43)

_UNIFORM_START, _UNIFORM_SIZE = 0x8A29, 0x8A2A

# Targets of textures, and what is asked for the texture that is bound there.
_TEXTURES = (
    (c.TEXTURE_2D, 0x8069),
    (c.TEXTURE_CUBE_MAP, 0x8514),
    (c.TEXTURE_2D_MULTISAMPLE, 0x9104),
    (c.TEXTURE_BUFFER, 0x8C2C),
)
_SAMPLER_BINDING = 0x8919
_ACTIVE_TEXTURE = 0x84E0

# Source and destination of colour, then of alpha.
_BLEND_FACTORS = (0x80C9, 0x80C8, 0x80CB, 0x80CA)
_BLEND_EQUATIONS = (0x8009, 0x883D)

_PROGRAM, _VERTEX_ARRAY = 0x8B8D, 0x85B5
_DRAW_FRAMEBUFFER, _READ_FRAMEBUFFER = 0x8CA6, 0x8CAA
_VIEWPORT, _SCISSOR_BOX = 0x0BA2, 0x0C10
_DEPTH_RANGE, _DEPTH_FUNCTION, _DEPTH_MASK = 0x0B70, 0x0B74, 0x0B72
_CULL_MODE, _FRONT_FACE, _POLYGON_MODE = 0x0B45, 0x0B46, 0x0B40
_COLOUR_MASK, _MAX_DRAW_BUFFERS = 0x0C23, 0x8824
_CLIP_ORIGIN, _CLIP_DEPTH_MODE = 0x935C, 0x935D


class HostState:
    """Keeps the state of a host, through the functions of its context.

    ``context`` is its :class:`moderngl.Context`, current whenever this is
    used. The indexed viewports of OpenGL 4.1 are kept as that of index 0.
    """

    def __init__(self, gl: Functions, context: Any) -> None:
        self._gl = gl
        self._version = version = context.version_code
        extensions = context.extensions
        self._has_clip_control = (
            version >= 450 or "GL_ARB_clip_control" in extensions
        )
        self._capabilities = (
            *_MANAGED,
            *(each[0] for each in _GRANTED if each[1] <= version),
        )
        # Kept by their binding points alone.
        self._buffers = [_ARRAY_BUFFER, _TEXTURE_BUFFER, *_PIXEL_BUFFERS]
        if version >= 430 or "GL_ARB_multi_draw_indirect" in extensions:
            self._buffers.append(_INDIRECT_BUFFER)
        (self._colours,) = self._get(_MAX_DRAW_BUFFERS)

    @contextmanager
    def kept(self, *, blocks: int = 0, units: int = 0) -> Iterator[int]:
        """Begin as in a new context; put the host's state back at the end.

        So many binding points of uniform buffers and texture units may be
        used, from 0. Gives the name of the framebuffer that the host draws
        into.
        """
        calls = [
            *self._fixed_functions(),
            *self._blending(),
            *self._objects(blocks),
            *self._textures(units),
            *self._pixel_stores(),
        ]
        (framebuffer,) = self._get(_DRAW_FRAMEBUFFER)
        self._reset()
        try:
            yield framebuffer
        finally:
            for function, arguments in calls:
                function(*arguments)

    def _reset(self) -> None:
        gl = self._gl
        for capability, since, is_on in _GRANTED:
            if since <= self._version:
                (gl.Enable if is_on else gl.Disable)(capability)
        gl.DepthRange(0.0, 1.0)
        for parameter in (*_UNPACK, *_PACK):
            gl.PixelStorei(parameter, 0)
        for target, _ in _PIXEL_BUFFERS:
            gl.BindBuffer(target, 0)

    def _fixed_functions(self) -> Iterator[_Call]:
        gl = self._gl
        for capability in self._capabilities:
            enable = gl.Enable if gl.IsEnabled(capability) else gl.Disable
            yield enable, (capability,)
        yield gl.Viewport, self._get(_VIEWPORT, 4)
        yield gl.Scissor, self._get(_SCISSOR_BOX, 4)
        yield gl.DepthFunc, self._get(_DEPTH_FUNCTION)
        yield gl.DepthMask, self._get(_DEPTH_MASK)
        depths = (c_double * 2)()
        gl.GetDoublev(_DEPTH_RANGE, byref(depths))
        yield gl.DepthRange, tuple(depths)
        yield gl.CullFace, self._get(_CULL_MODE)
        yield gl.FrontFace, self._get(_FRONT_FACE)
        # Older drivers tell one mode for each side.
        mode = self._get(_POLYGON_MODE, 2)[0]
        yield gl.PolygonMode, (c.FRONT_AND_BACK, mode)
        if self._has_clip_control:
            modes = self._get(_CLIP_ORIGIN) + self._get(_CLIP_DEPTH_MODE)
            yield gl.ClipControl, modes

    def _blending(self) -> Iterator[_Call]:
        """Of every attachment; the functions apart from OpenGL 4.0 on."""
        gl = self._gl
        mask = (c_ubyte * 4)()
        for index in range(self._colours):
            is_on = gl.IsEnabledi(c.BLEND, index)
            yield gl.Enablei if is_on else gl.Disablei, (c.BLEND, index)
            gl.GetBooleani_v(_COLOUR_MASK, index, byref(mask))
            yield gl.ColorMaski, (index, *mask)
        if self._version < 400:
            factors = [self._get(name)[0] for name in _BLEND_FACTORS]
            yield gl.BlendFuncSeparate, tuple(factors)
            equations = [self._get(name)[0] for name in _BLEND_EQUATIONS]
            yield gl.BlendEquationSeparate, tuple(equations)
            return
        for index in range(self._colours):
            factors = [self._get_of(name, index) for name in _BLEND_FACTORS]
            yield gl.BlendFuncSeparatei, (index, *factors)
            equations = [self._get_of(name, index) for name in _BLEND_EQUATIONS]
            yield gl.BlendEquationSeparatei, (index, *equations)

    def _objects(self, blocks: int) -> Iterator[_Call]:
        gl = self._gl
        yield gl.UseProgram, self._get(_PROGRAM)
        yield gl.BindVertexArray, self._get(_VERTEX_ARRAY)
        for target, name in (
            (c.DRAW_FRAMEBUFFER, _DRAW_FRAMEBUFFER),
            (c.READ_FRAMEBUFFER, _READ_FRAMEBUFFER),
        ):
            yield gl.BindFramebuffer, (target, *self._get(name))
        for target, name in self._buffers:
            yield gl.BindBuffer, (target, *self._get(name))
        start, size = c_int64(), c_int64()
        for point in range(blocks):
            buffer = self._get_of(_UNIFORM_BUFFER[1], point)
            gl.GetInteger64i_v(_UNIFORM_START, point, byref(start))
            gl.GetInteger64i_v(_UNIFORM_SIZE, point, byref(size))
            if size.value:
                span = (start.value, size.value)
                arguments = (c.UNIFORM_BUFFER, point, buffer, *span)
                yield gl.BindBufferRange, arguments
            else:
                yield gl.BindBufferBase, (c.UNIFORM_BUFFER, point, buffer)
        # Binding to a point has bound here too.
        yield gl.BindBuffer, (c.UNIFORM_BUFFER, *self._get(_UNIFORM_BUFFER[1]))

    def _textures(self, units: int) -> Iterator[_Call]:
        gl = self._gl
        active = self._get(_ACTIVE_TEXTURE)
        for unit in (*range(units), SCRATCH_UNIT):
            gl.ActiveTexture(c.TEXTURE0 + unit)
            yield gl.ActiveTexture, (c.TEXTURE0 + unit,)
            for target, name in _TEXTURES:
                yield gl.BindTexture, (target, *self._get(name))
            yield gl.BindSampler, (unit, *self._get(_SAMPLER_BINDING))
        yield gl.ActiveTexture, active

    def _pixel_stores(self) -> Iterator[_Call]:
        for parameter in (
            *(c.UNPACK_ALIGNMENT, c.PACK_ALIGNMENT),
            *(*_UNPACK, *_PACK),
        ):
            yield self._gl.PixelStorei, (parameter, *self._get(parameter))

    def _get(self, name: int, count: int = 1) -> tuple[int, ...]:
        values = (c_int * count)()
        self._gl.GetIntegerv(name, byref(values))
        return tuple(values)

    def _get_of(self, name: int, index: int) -> int:
        value = c_int()
        self._gl.GetIntegeri_v(name, index, byref(value))
        return value.value
