"""OpenGL on paper, as far as programs and vertex arrays need it."""

import ctypes
import re
from collections.abc import Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions

__all__ = ["PaperDriver"]

_NOTHING: Mapping[str, Any] = MappingProxyType({})


class PaperDriver:
    """Writes down what is called, and answers for every program the same.

    ``uniforms`` has each one's block, -1 for none, ``blocks`` the bytes of
    each; both in the order of their indices. A shader whose source says
    ``broken`` does not compile, two of which one says ``apart`` do not link.
    Attributes and uniforms are at the locations of their indices; those in a
    block, and the attributes of OpenGL's own, have none.
    """

    def __init__(
        self,
        attributes: Sequence[str] = (),
        uniforms: Mapping[str, int] = _NOTHING,
        blocks: Mapping[str, int] = _NOTHING,
    ) -> None:
        self.calls: list[tuple[Any, ...]] = []
        self.functions = Functions(self._load)
        self.alive: set[int] = set()
        self._attributes = list(attributes)
        self._uniforms = dict(uniforms)
        self._blocks = dict(blocks)
        self._sources: dict[int, str] = {}
        self._attached: dict[int, list[int]] = {}

    def called(self, name: str) -> list[tuple[Any, ...]]:
        """The arguments of each call of ``name``."""
        return [each[1:] for each in self.calls if each[0] == name]

    def _load(self, name: str, *_signature: Any) -> Any:
        return partial(self._call, name.removeprefix("gl"))

    def _call(self, name: str, *arguments: Any) -> Any:
        self.calls.append((name, *arguments))
        snake_case = re.sub("(?=[A-Z])", "_", name).lower()
        answer = getattr(self, snake_case, None)
        return None if answer is None else answer(*arguments)

    def _make(self, *_kind: int) -> int:
        name = len(self.calls)  # Never given out twice.
        self.alive.add(name)
        return name

    _create_program = _create_shader = _make

    def _delete_program(self, name: int) -> None:
        self.alive.remove(name)

    _delete_shader = _delete_program

    def _gen_vertex_arrays(self, _count: int, into: int) -> None:
        _write(into, self._make())

    def _shader_source(
        self, shader: int, count: int, texts: int, lengths: None
    ) -> None:
        assert (count, lengths) == (1, None)
        text = ctypes.c_char_p.from_address(texts).value
        assert text is not None
        self._sources[shader] = text.decode()

    def _attach_shader(self, program: int, shader: int) -> None:
        self._attached.setdefault(program, []).append(shader)

    def _compiles(self, shader: int) -> bool:
        return "broken" not in self._sources[shader]

    def _get_shaderiv(self, shader: int, what: int, into: int) -> None:
        known = {c.COMPILE_STATUS: int(self._compiles(shader))}
        known[c.INFO_LOG_LENGTH] = 100
        _write(into, known[what])

    def _get_programiv(self, program: int, what: int, into: int) -> None:
        shaders = self._attached[program]
        links = all(map(self._compiles, shaders)) and not any(
            "apart" in self._sources[shader] for shader in shaders
        )
        known = {
            c.LINK_STATUS: int(links),
            c.INFO_LOG_LENGTH: 100,
            c.ACTIVE_ATTRIBUTES: len(self._attributes),
            c.ACTIVE_ATTRIBUTE_MAX_LENGTH: _longest(self._attributes),
            c.ACTIVE_UNIFORMS: len(self._uniforms),
            c.ACTIVE_UNIFORM_MAX_LENGTH: _longest(self._uniforms),
            c.ACTIVE_UNIFORM_BLOCKS: len(self._blocks),
            c.ACTIVE_UNIFORM_BLOCK_MAX_NAME_LENGTH: _longest(self._blocks),
        }
        _write(into, known[what])

    def _get_shader_info_log(
        self, shader: int, size: int, _: None, into: int
    ) -> None:
        _write_text(into, size, f"log of {self._sources[shader]}")

    def _get_program_info_log(
        self, _program: int, size: int, _: None, into: int
    ) -> None:
        _write_text(into, size, "log of the linker")

    def _get_active_attrib(
        self, _program: int, index: int, size: int, *into: Any
    ) -> None:
        _write_text(into[-1], size, self._attributes[index])

    def _get_attrib_location(self, _program: int, name: bytes) -> int:
        if name.startswith(b"gl_"):
            return -1
        return self._attributes.index(name.decode())

    def _get_active_uniformsiv(
        self, _program: int, count: int, indices: int, what: int, into: int
    ) -> None:
        assert what == c.UNIFORM_BLOCK_INDEX
        values = list(self._uniforms.values())
        asked = (ctypes.c_uint * count).from_address(indices)
        (ctypes.c_int * count).from_address(into)[:] = [
            values[index] for index in asked
        ]

    def _get_active_uniform_name(
        self, _program: int, index: int, size: int, _: None, into: int
    ) -> None:
        _write_text(into, size, list(self._uniforms)[index])

    def _get_uniform_location(self, _program: int, name: bytes) -> int:
        text = name.decode()
        if self._uniforms[text] >= 0 or text.startswith("gl_"):
            return -1
        return list(self._uniforms).index(text)

    def _get_active_uniform_block_name(
        self, _program: int, index: int, size: int, _: None, into: int
    ) -> None:
        _write_text(into, size, list(self._blocks)[index])

    def _get_active_uniform_blockiv(
        self, _program: int, index: int, what: int, into: int
    ) -> None:
        known = {
            c.UNIFORM_BLOCK_DATA_SIZE: list(self._blocks.values())[index],
            c.UNIFORM_BLOCK_ACTIVE_UNIFORMS: list(
                self._uniforms.values()
            ).count(index),
        }
        _write(into, known[what])


def _longest(names: Sequence[str] | Mapping[str, int]) -> int:
    """With the zero behind it, as OpenGL counts."""
    return max((len(name) + 1 for name in names), default=0)


def _write(address: int, value: int) -> None:
    ctypes.c_int.from_address(address).value = value


def _write_text(address: int, size: int, text: str) -> None:
    cut = text.encode()[: size - 1] + b"\0"
    ctypes.memmove(address, cut, len(cut))
