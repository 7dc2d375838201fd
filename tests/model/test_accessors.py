"""Accessors against an oracle that unpacks one component at a time."""

import struct
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moka.core.errors import ModelError
from moka.model import AccessorReader
from moka.model.source import open_source
from tests.model.files import Document, changed, glb, triangle

FORMATS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
LIMITS = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}
# Columns, rows and bytes between columns for components of 1, 2, 4 bytes, as
# the table of section 3.6.2.4 of the specification has them.
ELEMENTS = {
    "SCALAR": (1, 1, {1: 1, 2: 2, 4: 4}),
    "VEC2": (1, 2, {1: 2, 2: 4, 4: 8}),
    "VEC3": (1, 3, {1: 3, 2: 6, 4: 12}),
    "VEC4": (1, 4, {1: 4, 2: 8, 4: 16}),
    "MAT2": (2, 2, {1: 4, 2: 4, 4: 8}),
    "MAT3": (3, 3, {1: 4, 2: 8, 4: 12}),
    "MAT4": (4, 4, {1: 4, 2: 8, 4: 16}),
}


def reader(document: Document, binary: bytes) -> AccessorReader:
    return AccessorReader(open_source(glb(document, binary)))


def unpack(
    data: bytes, offset: int, stride: int, count: int, component: int, kind: str
) -> np.ndarray[Any, Any]:
    """Element by element, as the specification words it."""
    columns, rows, column_strides = ELEMENTS[kind]
    code = FORMATS[component]
    size = struct.calcsize(code)
    elements = []
    for index in range(count):
        matrix = np.zeros((rows, columns))
        for column in range(columns):
            for row in range(rows):
                place = offset + index * stride
                place += column * column_strides[size] + row * size
                (matrix[row, column],) = struct.unpack_from(
                    f"<{code}", data, place
                )
        elements.append(matrix)
    array = np.array(elements)
    if kind == "SCALAR":
        return array[:, 0, 0]
    return array if kind.startswith("MAT") else array[:, :, 0]


@st.composite
def layouts(draw: st.DrawFn) -> tuple[Document, bytes]:
    """Any type in any layout: interleaved, unaligned, sparse, normalised."""
    component = draw(st.sampled_from(sorted(FORMATS)))
    kind = draw(st.sampled_from(sorted(ELEMENTS)))
    count = draw(st.integers(1, 5))
    columns, rows, column_strides = ELEMENTS[kind]
    size = struct.calcsize(FORMATS[component])
    last = (columns - 1) * column_strides[size] + rows * size
    tight = columns * column_strides[size]
    stride = draw(st.none() | st.integers(last, last + 9))
    offset = draw(st.integers(0, 5))
    view_offset = draw(st.integers(0, 5))
    length = offset + (count - 1) * (stride or tight) + last
    binary = draw(
        st.binary(min_size=view_offset + length, max_size=view_offset + length)
    )
    view = {"buffer": 0, "byteOffset": view_offset, "byteLength": length}
    if stride is not None:
        view["byteStride"] = stride
    accessor = {
        "bufferView": 0,
        "byteOffset": offset,
        "componentType": component,
        "count": count,
        "type": kind,
        "normalized": component in LIMITS and draw(st.booleans()),
    }
    document = triangle(
        bufferViews=[view],
        accessors=[accessor],
        buffers=[{"byteLength": len(binary)}],
        meshes=[],
        nodes=[],
        scenes=[],
    )
    del document["scene"]
    return document, binary


@settings(deadline=None)
@given(layouts())
def test_reads_what_the_oracle_unpacks(file: tuple[Document, bytes]) -> None:
    document, binary = file
    accessor, view = document["accessors"][0], document["bufferViews"][0]
    component, kind = accessor["componentType"], accessor["type"]
    columns, _, column_strides = ELEMENTS[kind]
    size = struct.calcsize(FORMATS[component])
    expected = unpack(
        binary,
        view["byteOffset"] + accessor["byteOffset"],
        view.get("byteStride", columns * column_strides[size]),
        accessor["count"],
        component,
        kind,
    )
    opened = reader(document, binary)
    array = opened.array(0)
    assert array.dtype == np.dtype(f"<{FORMATS[component]}")
    np.testing.assert_array_equal(array, expected)
    if accessor["normalized"]:
        expected = np.maximum(expected / LIMITS[component], -1)
    floats = opened.floats(0)
    assert floats.dtype == np.float32
    np.testing.assert_allclose(floats, expected.astype("f4"), rtol=1e-6)


@settings(deadline=None)
@given(
    base=st.lists(st.integers(0, 255), min_size=6, max_size=6),
    places=st.sets(st.integers(0, 5), min_size=1),
    has_view=st.booleans(),
    index_type=st.sampled_from([5121, 5123, 5125]),
    data=st.data(),
)
def test_sparse_elements_replace_those_below(
    base: list[int],
    places: set[int],
    has_view: bool,
    index_type: int,
    data: st.DataObject,
) -> None:
    order = sorted(places)
    values = data.draw(
        st.lists(st.integers(0, 255), min_size=len(order), max_size=len(order))
    )
    indices = struct.pack(f"<{len(order)}{FORMATS[index_type]}", *order)
    binary = bytes(base) + indices + bytes(values)
    ends = np.cumsum([0, 6, len(indices), len(values)]).tolist()
    accessor = {
        "componentType": 5121,
        "count": 6,
        "type": "SCALAR",
        "sparse": {
            "count": len(order),
            "indices": {"bufferView": 1, "componentType": index_type},
            "values": {"bufferView": 2},
        },
    }
    if has_view:
        accessor["bufferView"] = 0
    document = triangle(
        accessors=[accessor],
        bufferViews=[
            {"buffer": 0, "byteOffset": start, "byteLength": end - start}
            for start, end in pairwise(ends)
        ],
        buffers=[{"byteLength": len(binary)}],
    )
    expected = list(base) if has_view else [0] * 6
    for place, value in zip(order, values, strict=True):
        expected[place] = value
    assert reader(document, binary).array(0).tolist() == expected


def test_floats_are_views_into_the_file() -> None:
    document = triangle()
    binary = bytearray(42)
    opened = AccessorReader(open_source(glb(document, bytes(binary))))
    floats = opened.floats(0)
    assert not floats.flags.owndata
    assert opened.floats(0) is floats


SPARSE = {
    "count": 1,
    "indices": {"bufferView": 1, "componentType": 5123},
    "values": {"bufferView": 0},
}


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("accessors[0].count", 0, "accessors[0].count: must be at least 1"),
        ("accessors[0].count", -3, "accessors[0].count: expected 'int' >= 0"),
        (
            "accessors[0].count",
            10_000_000_000,
            "accessors[0]: needs 120000000000 bytes of bufferViews[0], "
            "which has 36",
        ),
        (
            "accessors[0].byteOffset",
            1,
            "accessors[0]: needs 37 bytes of bufferViews[0], which has 36",
        ),
        (
            "accessors[0].bufferView",
            7,
            "accessors[0].bufferView: there is no bufferViews[7], the file "
            "has 2",
        ),
        (
            "accessors[0].componentType",
            5124,
            "accessors[0].componentType: invalid enum value 5124",
        ),
        ("accessors[0].type", "VEC5", "accessors[0].type: invalid enum"),
        (
            "bufferViews[0].byteStride",
            8,
            "bufferViews[0].byteStride: is 8, the elements of accessors[0] "
            "have 12 bytes",
        ),
        (
            "bufferViews[0].byteOffset",
            7,
            "bufferViews[0]: ends at byte 43, buffers[0] has 42",
        ),
        (
            "bufferViews[0].buffer",
            1,
            "bufferViews[0].buffer: there is no buffers[1]",
        ),
        (
            "buffers[0].byteLength",
            45,
            "buffers[0].byteLength: is 45, the data has 44",
        ),
        (
            "accessors[0].sparse",
            {**SPARSE, "count": 4},
            "accessors[0].sparse.count: must be 1 to 3",
        ),
        (
            "accessors[0].sparse",
            {**SPARSE, "values": {"bufferView": 1}},
            "accessors[0].sparse.values: needs 12 bytes of bufferViews[1]",
        ),
    ],
)
def test_names_what_is_wrong(path: str, value: object, message: str) -> None:
    with pytest.raises(ModelError) as caught:
        reader(changed(path, value), bytes(42)).array(0)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("indices", "message"),
    [
        ((0, 3), "accessors[0].sparse.indices: index 3 is beyond 3 elements"),
        ((1, 1), "accessors[0].sparse.indices: must increase strictly"),
    ],
)
def test_refuses_wrong_sparse_indices(
    indices: tuple[int, int], message: str
) -> None:
    document = changed("accessors[0].sparse", {**SPARSE, "count": 2})
    binary = bytes(36) + struct.pack("<2H", *indices) + bytes(2)
    with pytest.raises(ModelError) as caught:
        reader(document, binary).array(0)
    assert message in str(caught.value)


def test_refuses_normalised_integers_of_32_bits() -> None:
    document = changed("accessors[0].componentType", 5125)
    document["accessors"][0]["normalized"] = True
    with pytest.raises(ModelError, match=r"accessors\[0\].normalized: is only"):
        reader(document, bytes(42)).floats(0)


def test_elements_that_no_byte_backs_are_zero_and_few() -> None:
    accessor = {"componentType": 5126, "count": 4, "type": "VEC3"}
    assert not reader(triangle(accessors=[accessor]), b"").array(0).any()
    # A small file of many accessors may not ask for much either.
    many = [{**accessor, "count": 3 << 20} for _ in range(2)]
    opened = reader(triangle(accessors=many), b"")
    opened.array(0)
    with pytest.raises(ModelError, match=r"accessors\[1\].count: asks for"):
        opened.array(1)


def test_the_lowest_integer_is_minus_one() -> None:
    document = triangle(
        accessors=[
            {
                "bufferView": 0,
                "componentType": 5120,
                "count": 3,
                "type": "SCALAR",
                "normalized": True,
            }
        ]
    )
    floats = reader(document, struct.pack("<3b", -128, -127, 127) + bytes(39))
    assert floats.floats(0).tolist() == [-1, -1, 1]
