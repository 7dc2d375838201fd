"""Programs: compiled and linked side by side, then asked what they read.

A driver with threads of its own compiles on them until somebody asks how a
shader or a program has come out; whoever asks waits. So all that are needed
are begun first (:class:`GlProgram`), and asked only when one is to be drawn
with (:meth:`GlProgram.finish`). Drivers say that they work like this by
KHR_parallel_shader_compile or ARB_parallel_shader_compile; nothing of either
is called, as a context begins with as many threads as the driver has to give.
On others the order does no harm.
"""

from collections.abc import Callable, Iterator
from ctypes import addressof, c_char_p, c_int, c_uint, create_string_buffer
from typing import Any, Protocol

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.commands.descriptors import ProgramDescriptor, ShaderText
from moka.core.errors import ShaderError

__all__ = ["BindingPoints", "Explain", "GlProgram"]

# Samplers of a program are hardly ever more.
_UNIFORMS_AT_ONCE = 16


class Explain(Protocol):
    """Turns a driver's log into one line that names file and line.

    ``texts`` are what it is about: the shader that does not compile, or the
    vertex and the fragment shader that do not link.
    """

    def __call__(self, log: str, *texts: ShaderText) -> str: ...


class BindingPoints:
    """Gives every uniform block name one binding point for all programs.

    So that a block which many programs share (the frame's) stays bound when
    the program changes. Texture units each program counts for itself;
    ``units`` are those of the one that reads most.
    """

    def __init__(self) -> None:
        self._points: dict[str, int] = {}
        self.units = 0

    def __len__(self) -> int:
        """How many points have been given out, from 0."""
        return len(self._points)

    def point(self, name: str) -> int:
        """The binding point of the blocks called ``name``."""
        return self._points.setdefault(name, len(self._points))


class GlProgram:
    """A vertex and a fragment shader, and what they read, by name.

    When it is made the driver has been told all and asked nothing.
    ``samplers`` (texture units), ``blocks`` (binding points and bytes) and
    ``attributes`` (locations) are there after :meth:`finish`.
    """

    def __init__(self, gl: Functions, descriptor: ProgramDescriptor) -> None:
        self.label = descriptor.label
        self.samplers: dict[str, int] = {}
        self.blocks: dict[str, tuple[int, int]] = {}
        self.attributes: dict[str, int] = {}
        self._gl = gl
        self.name: int = gl.CreateProgram()
        self._shaders = [
            (self._begin_shader(kind, text), text)
            for kind, text in (
                (c.VERTEX_SHADER, descriptor.vertex),
                (c.FRAGMENT_SHADER, descriptor.fragment),
            )
        ]
        gl.LinkProgram(self.name)

    def finish(self, points: BindingPoints, explain: Explain) -> None:
        """Wait until it is linked; find what it reads, and bind that.

        It may be the current program then. Raises ShaderError.
        """
        # What does not compile does not link: one question is enough.
        if not self._gl.parameter("Program", self.name, c.LINK_STATUS):
            raise ShaderError(self._fault(explain))
        self._release_shaders()
        self._find_attributes()
        self._find_samplers(self._find_blocks(points))
        points.units = max(points.units, len(self.samplers))

    def release(self) -> None:
        """Delete the GL objects."""
        self._release_shaders()
        self._gl.DeleteProgram(self.name)

    def _begin_shader(self, kind: int, text: ShaderText) -> int:
        gl = self._gl
        shader: int = gl.CreateShader(kind)
        source = c_char_p(text.source.encode())
        gl.ShaderSource(shader, 1, addressof(source), None)
        gl.CompileShader(shader)
        gl.AttachShader(self.name, shader)
        return shader

    def _release_shaders(self) -> None:
        for shader, _ in self._shaders:
            self._gl.DetachShader(self.name, shader)
            self._gl.DeleteShader(shader)
        self._shaders.clear()

    def _fault(self, explain: Explain) -> str:
        """Why it is not linked."""
        gl = self._gl
        for shader, text in self._shaders:
            if not gl.parameter("Shader", shader, c.COMPILE_STATUS):
                return explain(gl.log("Shader", shader), text)
        texts = (text for _, text in self._shaders)
        return explain(gl.log("Program", self.name), *texts)

    def _find_attributes(self) -> None:
        gl, program = self._gl, self.name
        size, kind = c_int(), c_uint()
        names = self._names(
            c.ACTIVE_ATTRIBUTES,
            c.ACTIVE_ATTRIBUTE_MAX_LENGTH,
            lambda index, length, into: gl.GetActiveAttrib(
                program,
                index,
                length,
                None,
                addressof(size),
                addressof(kind),
                into,
            ),
        )
        for _, name in names:
            # What no buffer feeds, such as gl_VertexID, is none of these.
            if not name.startswith(b"gl_"):
                location = gl.GetAttribLocation(program, name)
                self.attributes[name.decode()] = location

    def _find_blocks(self, points: BindingPoints) -> int:
        """Bind all uniform blocks; how many uniforms are members of one."""
        gl, program = self._gl, self.name
        value, members = c_int(), 0
        for index, name in self._names(
            c.ACTIVE_UNIFORM_BLOCKS,
            c.ACTIVE_UNIFORM_BLOCK_MAX_NAME_LENGTH,
            lambda index, length, into: gl.GetActiveUniformBlockName(
                program, index, length, None, into
            ),
        ):
            gl.GetActiveUniformBlockiv(
                program,
                index,
                c.UNIFORM_BLOCK_ACTIVE_UNIFORMS,
                addressof(value),
            )
            members += value.value
            gl.GetActiveUniformBlockiv(
                program, index, c.UNIFORM_BLOCK_DATA_SIZE, addressof(value)
            )
            point = points.point(name.decode())
            gl.UniformBlockBinding(program, index, point)
            self.blocks[name.decode()] = (point, value.value)
        return members

    def _find_samplers(self, members: int) -> None:
        """Uniforms outside of blocks are samplers; values live in blocks.

        Of whatever type: a sampler of floats or of whole numbers, of a cube
        or of a buffer. So many uniforms are ``members`` of blocks.
        """
        gl, program = self._gl, self.name
        indices = self._outside_of_blocks(members)
        if not indices:
            return
        gl.UseProgram(program)
        length = gl.parameter("Program", program, c.ACTIVE_UNIFORM_MAX_LENGTH)
        name = create_string_buffer(length)
        for index in indices:
            gl.GetActiveUniformName(
                program, index, length, None, addressof(name)
            )
            location = gl.GetUniformLocation(program, name.value)
            if location >= 0:
                unit = len(self.samplers)
                gl.Uniform1i(location, unit)
                self.samplers[name.value.decode().removesuffix("[0]")] = unit

    def _outside_of_blocks(self, members: int) -> list[int]:
        """Indices of the uniforms that are in no block, in their order.

        A page of the material table alone has thousands of members. Mesa,
        which has the others behind them, takes the time of an index to find
        what is there: looking from the end on for as many as there must be
        is a twentieth of asking for all.
        """
        gl, program = self._gl, self.name
        end = gl.parameter("Program", program, c.ACTIVE_UNIFORMS)
        wanted, found = end - members, list[int]()
        while end and len(found) < wanted:
            count = min(end, _UNIFORMS_AT_ONCE)
            end -= count
            indices = (c_uint * count)(*range(end, end + count))
            blocks = (c_int * count)()
            gl.GetActiveUniformsiv(
                program,
                count,
                addressof(indices),
                c.UNIFORM_BLOCK_INDEX,
                addressof(blocks),
            )
            found += [
                index
                for index, block in zip(indices, blocks, strict=True)
                if block < 0
            ]
        return sorted(found)

    def _names(
        self,
        count: int,
        longest: int,
        get: Callable[[int, int, int], Any],
    ) -> Iterator[tuple[int, bytes]]:
        """Indices and names of what there are ``count`` of.

        ``count`` and ``longest`` are what tells the number and the length of
        the longest name, its zero included; ``get`` writes that of an index,
        with so many bytes at most, to an address.
        """
        gl = self._gl
        length = gl.parameter("Program", self.name, longest)
        name = create_string_buffer(max(length, 1))
        for index in range(gl.parameter("Program", self.name, count)):
            get(index, length, addressof(name))
            yield index, name.value
