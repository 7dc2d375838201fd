"""Effect parameters: typed values, laid out once as GLSL's std140 asks.

The report's effect parameter is a discriminated union that is looked up by
name at every draw. Here the types of a block are declared once; from them
come the NumPy dtype of its bytes and the GLSL that reads them, so that the
two cannot disagree (OpenGL 3.3 specification, 2.11.4, "Standard Uniform
Block Layout").
"""

from collections.abc import Mapping
from enum import Enum
from functools import cached_property
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.errors import CommandError

__all__ = ["Parameter", "ParameterType", "UniformLayout"]

# Of what float32 holds.
_LARGEST = float(np.finfo(np.float32).max)


class ParameterType(Enum):
    """A GLSL type: its name, NumPy scalar, shape as given, alignment.

    Matrices are given as NumPy has them, [row, column]; std140 stores
    columns, each padded to four components.
    """

    FLOAT = ("float", "f4", (), 4)
    VEC2 = ("vec2", "f4", (2,), 8)
    VEC3 = ("vec3", "f4", (3,), 16)
    VEC4 = ("vec4", "f4", (4,), 16)
    INT = ("int", "i4", (), 4)
    UINT = ("uint", "u4", (), 4)
    IVEC4 = ("ivec4", "i4", (4,), 16)
    BOOL = ("bool", "u4", (), 4)
    MAT3 = ("mat3", "f4", (3, 3), 16)
    MAT4 = ("mat4", "f4", (4, 4), 16)

    @property
    def glsl(self) -> str:
        """The type's name in GLSL."""
        return str(self.value[0])

    @property
    def is_matrix(self) -> bool:
        """Whether values are transposed and padded when stored."""
        return len(self.value[2]) == 2


class Parameter(Struct, frozen=True):
    """One named value of a block; ``count`` > 0 makes it an array."""

    name: str
    type: ParameterType
    count: int = 0

    def declaration(self, prefix: str = "") -> str:
        """Its GLSL, without a semicolon."""
        array = f"[{self.count}]" if self.count else ""
        return f"{self.type.glsl} {prefix}{self.name}{array}"


class UniformLayout(Struct, frozen=True, dict=True):
    """The parameters of a uniform block, or of one row of an array of them.

    As an array (``rows`` > 0) the block is ``Name { NameRow rows[N]; }``.
    """

    name: str
    parameters: tuple[Parameter, ...]
    rows: int = 0

    @cached_property
    def dtype(self) -> "np.dtype[np.void]":
        """The NumPy type of one row, padding included."""
        offset = 0
        names, formats, offsets = [], [], []
        for parameter in self.parameters:
            scalar, shape, size, alignment = _storage(parameter)
            offset = _align(offset, alignment)
            names.append(parameter.name)
            formats.append((scalar, shape))
            offsets.append(offset)
            offset += size
        return np.dtype(
            {
                "names": names,
                "formats": formats,
                "offsets": offsets,
                "itemsize": _align(offset, 16),
            }
        )

    @cached_property
    def _members(self) -> "dict[str, _Member]":
        return {
            parameter.name: _Member.of(parameter)
            for parameter in self.parameters
        }

    @property
    def size(self) -> int:
        """Bytes of the whole block."""
        return self.dtype.itemsize * max(1, self.rows)

    @cached_property
    def glsl(self) -> str:
        """The declaration of the block, to be injected into a shader."""
        members = "\n".join(
            f"    {parameter.declaration()};" for parameter in self.parameters
        )
        if not self.rows:
            return f"layout(std140) uniform {self.name} {{\n{members}\n}};\n"
        variable = self.name.lower()
        return (
            f"struct {self.name}Row {{\n{members}\n}};\n"
            f"layout(std140) uniform {self.name} {{\n"
            f"    {self.name}Row {variable}[{self.rows}];\n}};\n"
        )

    @cached_property
    def flat_outputs(self) -> str:
        """What lets a vertex shader copy a block to flat outputs.

        Injected after :attr:`glsl`; ``copy_name()`` does it.
        """
        outputs = "".join(
            f"flat out {parameter.declaration('flat_')};\n"
            for parameter in self.parameters
        )
        copies = "".join(
            f"    flat_{parameter.name} = {parameter.name};\n"
            for parameter in self.parameters
        )
        return f"{outputs}void copy_{self.name.lower()}() {{\n{copies}}}\n"

    @cached_property
    def flat_inputs(self) -> str:
        """What lets a fragment shader read these copies by their own names.

        Injected in the place of :attr:`glsl`.
        """
        return "".join(
            f"flat in {parameter.declaration('flat_')};\n"
            f"#define {parameter.name} flat_{parameter.name}\n"
            for parameter in self.parameters
        )

    def pack(self, values: Mapping[str, Any]) -> NDArray[np.void]:
        """One row as an array of length 1; absent parameters are zero.

        Raises CommandError for a name the block does not have, or a value
        of the wrong shape.
        """
        row = np.zeros(1, self.dtype)
        self.fill(row, values)
        return row

    def fill(self, row: NDArray[np.void], values: Mapping[str, Any]) -> None:
        """Write ``values`` into the first element of ``row``."""
        members = self._members
        with np.errstate(over="ignore"):
            for name, value in values.items():
                member = members.get(name)
                if member is None:
                    raise CommandError(
                        f"block {self.name}: has no parameter {name!r}; it "
                        f"has {', '.join(members)}"
                    )
                row[name][0] = self._convert(member, value)

    def _convert(self, member: "_Member", value: Any) -> Any:
        """What is stored of ``value``; overflow may be a warning."""
        if member.is_float and type(value) is float:
            # Several in every frame, in a tenth of the time of an array.
            return min(max(value, -_LARGEST), _LARGEST)
        try:
            array = np.asarray(value, member.scalar)
        except (TypeError, ValueError):
            array = np.empty((0, 0, 0, 0))
        if array.shape != member.shape:
            raise CommandError(
                f"block {self.name}: parameter {member.name!r} is a "
                f"{member.glsl} of shape {member.shape}, got {value!r}"
            )
        if member.scalar == "f4":
            # One infinity would make NaN of all that it meets.
            array = np.minimum(np.maximum(array, -_LARGEST), _LARGEST)
        if member.is_matrix:
            array = np.swapaxes(array, -1, -2)
        return _pad_last(array, member) if member.is_padded else array


class _Member(Struct, frozen=True):
    """What storing a parameter asks about it."""

    name: str
    glsl: str
    scalar: str
    shape: tuple[int, ...]
    is_float: bool
    is_matrix: bool
    # Whether its innermost axis is stored as four.
    is_padded: bool
    is_array_of_scalars: bool

    @classmethod
    def of(cls, parameter: Parameter) -> "_Member":
        kind = parameter.type
        glsl, scalar, shape, _ = kind.value
        count = (parameter.count,) if parameter.count else ()
        return cls(
            parameter.name,
            glsl,
            scalar,
            count + shape,
            is_float=kind is ParameterType.FLOAT and not count,
            is_matrix=kind.is_matrix,
            is_padded=kind.is_matrix or bool(count),
            is_array_of_scalars=bool(count) and not shape,
        )


def _storage(
    parameter: Parameter,
) -> tuple[str, tuple[int, ...], int, int]:
    """NumPy scalar, stored shape, bytes and alignment of a member."""
    _, scalar, shape, alignment = parameter.type.value
    if parameter.type.is_matrix:
        # Columns are padded to vec4: mat3 is three of them.
        stored: tuple[int, ...] = (shape[1], 4)
    elif parameter.count:
        # Array elements are padded to 16 bytes.
        stored = (4,)
    else:
        stored = shape
    if parameter.count:
        stored = (parameter.count, *stored)
        alignment = 16
    return scalar, stored, 4 * int(np.prod(stored)), alignment


def _pad_last(array: NDArray[Any], member: _Member) -> NDArray[Any]:
    """Pad the innermost axis (a column, or an array's element) to 4."""
    if member.is_array_of_scalars:
        array = array[..., np.newaxis]
    padded = np.zeros((*array.shape[:-1], 4), member.scalar)
    padded[..., : array.shape[-1]] = array
    return padded


def _align(offset: int, alignment: int) -> int:
    return -(-offset // alignment) * alignment
