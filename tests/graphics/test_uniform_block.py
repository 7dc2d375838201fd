"""Parameters land where GLSL's std140 looks for them."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from moka.core.errors import CommandError
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)

FLOAT, VEC2, VEC3 = ParameterType.FLOAT, ParameterType.VEC2, ParameterType.VEC3
INT, MAT3, MAT4 = ParameterType.INT, ParameterType.MAT3, ParameterType.MAT4

# The worked example of the OpenGL 3.3 specification, section 2.11.4, as far
# as these types go.
EXAMPLE = UniformLayout(
    "Example",
    (
        Parameter("a", FLOAT),
        Parameter("b", VEC2),
        Parameter("c", VEC3),
        Parameter("d", INT),
        Parameter("e", FLOAT, 2),
        Parameter("f", MAT3),
        Parameter("g", FLOAT),
        Parameter("h", MAT4),
    ),
)


def test_offsets_are_those_of_the_specification() -> None:
    offsets = {
        name: EXAMPLE.dtype.fields[name][1] for name in EXAMPLE.dtype.names
    }
    assert offsets == {
        "a": 0,
        "b": 8,
        "c": 16,
        "d": 28,
        "e": 32,
        "f": 64,
        "g": 112,
        "h": 128,
    }
    assert EXAMPLE.size == 192


def test_matrices_are_stored_by_padded_columns() -> None:
    matrix = np.arange(9.0).reshape(3, 3)
    row = EXAMPLE.pack({"f": matrix})
    floats = row.view(np.float32)[16:28].reshape(3, 4)
    assert np.array_equal(floats[:, :3], matrix.T)
    assert not floats[:, 3].any()


def test_arrays_are_padded_to_sixteen_bytes_an_element() -> None:
    row = EXAMPLE.pack({"e": [5, 7]})
    floats = row.view(np.float32)
    assert floats[8] == 5
    assert floats[12] == 7


def test_the_declaration_names_everything() -> None:
    assert EXAMPLE.glsl.startswith("layout(std140) uniform Example {")
    assert "    float e[2];" in EXAMPLE.glsl
    rows = UniformLayout("Lights", (Parameter("a", VEC3),), rows=8)
    assert "struct LightsRow {" in rows.glsl
    assert "LightsRow lights[8];" in rows.glsl
    assert rows.size == 128


def test_copies_are_read_by_their_own_names() -> None:
    assert EXAMPLE.flat_outputs.count("flat out ") == len(EXAMPLE.parameters)
    assert "flat out float flat_e[2];" in EXAMPLE.flat_outputs
    assert "void copy_example() {" in EXAMPLE.flat_outputs
    assert "    flat_h = h;" in EXAMPLE.flat_outputs
    assert "flat in mat4 flat_h;\n#define h flat_h\n" in EXAMPLE.flat_inputs


def test_what_float32_cannot_hold_becomes_the_largest_it_can() -> None:
    row = EXAMPLE.pack({"c": (1e300, -np.inf, 1.0)})
    largest = np.finfo(np.float32).max
    assert row.view(np.float32)[4:7].tolist() == [largest, -largest, 1.0]


@pytest.mark.parametrize("kind", [float, np.float64, np.float32, np.asarray])
@pytest.mark.parametrize("value", [0.1, 1e300, -math.inf, math.nan, 1e-60])
def test_one_number_is_stored_as_many_are(
    kind: Callable[[float], Any], value: float
) -> None:
    with np.errstate(over="ignore"):
        given = kind(value)
    row = EXAMPLE.pack({"a": given, "b": (value, value)})
    assert row["a"].tobytes() == row["b"][0, :1].tobytes()


@pytest.mark.parametrize(
    "values",
    [{"a": (1, 2)}, {"b": 1}, {"f": np.zeros((4, 4))}, {"a": "red"}],
)
def test_a_value_of_the_wrong_shape_is_named(values: dict) -> None:
    (name,) = values
    with pytest.raises(CommandError, match=f"parameter '{name}'"):
        EXAMPLE.pack(values)


def test_an_unknown_parameter_is_named_with_what_there_is() -> None:
    with pytest.raises(CommandError, match="has no parameter 'z'; it has a"):
        EXAMPLE.pack({"z": 1})
