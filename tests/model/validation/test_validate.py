"""Every fault is found and told by its code; nothing else is."""

import copy
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moka.core.errors import ModelError
from moka.model.validation.issues import Report, Severity, path_text
from moka.model.validation.validate import validate
from tests.model.validation.codes import CODE_OF
from tests.model.validation.faults import FAULTS, glb, whole
from tests.support.gltf_file import GltfFile


def document_of(data: bytes) -> dict[str, Any]:
    """The JSON of a .glb."""
    (length,) = struct.unpack_from("<I", data, 12)
    made: dict[str, Any] = json.loads(data[20 : 20 + length])
    return made


def test_a_file_without_fault_has_no_issue() -> None:
    report = validate(whole())
    assert report.issues == []
    assert report.is_valid


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_told_by_its_code(name: str) -> None:
    report = validate(whole(FAULTS[name]))
    codes = {issue.code for issue in report.issues}
    assert CODE_OF[name] in codes, report.issues
    for issue in report.issues:
        assert "\n" not in issue.message


def test_each_fault_is_in_the_table() -> None:
    assert CODE_OF.keys() == FAULTS.keys()


def test_an_issue_says_where_it_is() -> None:
    report = validate(whole(FAULTS["least is wrong"]))
    assert [(each.code, each.path) for each in report.issues] == [
        ("ACCESSOR_MIN_MISMATCH", "accessors[0].min[0]"),
        ("ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND", "accessors[0].min[0]"),
    ]
    assert report.issues[0].message == "is 0.5, in the data it is 0.0"
    assert not report.is_valid


def test_errors_come_first_and_each_issue_once() -> None:
    report = Report()
    report.add("UNEXPECTED_PROPERTY", ("a", 0), "a warning")
    report.add("NODE_LOOP", ("nodes", 3, "b"), "an error")
    report.add("NODE_LOOP", ("nodes", 3, "b"), "the same")
    assert [each.path for each in report.issues] == ["nodes[3].b", "a[0]"]
    assert [report.count(each) for each in Severity] == [1, 1, 0]
    assert path_text(()) == ""


def test_a_required_extension_that_is_not_drawn_is_an_error() -> None:
    document = document_of(whole())
    document["extensionsUsed"] = ["VENDOR_clouds"]
    text = json.dumps(document).encode()
    data = whole()
    binary = data[28 + struct.unpack_from("<I", data, 12)[0] :]
    (issue,) = validate(glb(text, binary)).issues
    assert issue.severity is Severity.INFORMATION
    document["extensionsRequired"] = ["VENDOR_clouds"]
    text = json.dumps(document).encode()
    (issue,) = validate(glb(text, binary)).issues
    assert (issue.code, issue.severity) == (
        "UNSUPPORTED_EXTENSION",
        Severity.ERROR,
    )


def test_a_text_file_and_its_buffers(tmp_path: Path) -> None:
    data = whole()
    document = document_of(data)
    binary = data[28 + struct.unpack_from("<I", data, 12)[0] :]
    document["buffers"][0]["uri"] = "a%20b.bin"
    path = tmp_path / "scene.gltf"
    path.write_text(json.dumps(document))
    (issue,) = validate(path).issues
    assert (issue.code, issue.path) == ("IO_ERROR", "buffers[0].uri")
    (tmp_path / "a b.bin").write_bytes(binary)
    assert validate(path).issues == []
    (tmp_path / "a b.bin").write_bytes(binary[:40])
    codes = [issue.code for issue in validate(path).issues]
    assert codes == ["BUFFER_BYTE_LENGTH_MISMATCH"]


def test_what_cannot_be_read_raises(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="no such file"):
        validate(tmp_path / "missing.glb")


def test_every_vertex_is_looked_at() -> None:
    """One bad element among two hundred thousand."""
    file = GltfFile()
    count = 200_000
    normals = np.tile(np.float32([0, 0, 1]), (count, 1))
    normals[123_456] = (0, 0, 2)
    positions = np.zeros((count, 3), np.float32)
    file.node(mesh=file.mesh({"POSITION": positions, "NORMAL": normals}))
    file.document["meshes"][0]["primitives"][0]["mode"] = 0
    (issue,) = validate(file.glb()).issues
    assert issue.code == "ACCESSOR_VECTOR3_NON_UNIT"
    assert issue.message == "element 123456 has the length 2"


def test_elements_that_no_byte_backs_take_no_memory() -> None:
    document = copy.deepcopy(WHOLE)
    accessor = document["accessors"][1]
    del accessor["bufferView"]
    accessor["count"] = 2**50
    accessor["sparse"] = {
        "count": 1,
        "indices": {"bufferView": 5, "componentType": 5123},
        "values": {"bufferView": 0},
    }
    report = validate(glb(json.dumps(document).encode(), BINARY))
    codes = {issue.code for issue in report.issues}
    assert "MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT" in codes


anything = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**40), 2**40)
    | st.sampled_from([10**400, -(10**400), 1e300])
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=4,
)


def places(value: Any, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The path to everything below ``value``."""
    found = [place] if place else []
    steps = (
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else ()
    )
    for step, each in steps:
        found += places(each, (*place, step))
    return found


WHOLE = document_of(whole())
BINARY = whole()[28 + struct.unpack_from("<I", whole(), 12)[0] :]
PLACES = places(WHOLE)


@settings(deadline=None, max_examples=300)
@given(st.lists(st.tuples(st.sampled_from(PLACES), anything), max_size=3))
def test_any_json_gets_a_report(
    changes: list[tuple[tuple[Any, ...], Any]],
) -> None:
    """Values of any type anywhere: no exception, whatever is found."""
    document = copy.deepcopy(WHOLE)
    for place, value in changes:
        owner: Any = document
        try:
            for step in place[:-1]:
                owner = owner[step]
            owner[place[-1]] = value
        except (TypeError, KeyError, IndexError):
            continue  # A change before took its place away.
    validate(glb(json.dumps(document).encode(), BINARY))


@settings(deadline=None, max_examples=200)
@given(
    st.integers(0, len(whole())),
    st.lists(
        st.tuples(st.integers(0, len(whole()) - 1), st.integers(0, 255)),
        max_size=4,
    ),
)
def test_any_bytes_get_a_report(
    length: int, changes: list[tuple[int, int]]
) -> None:
    """Cut off anywhere, and any byte another one."""
    data = bytearray(whole())
    for offset, value in changes:
        data[offset] = value
    validate(bytes(data[:length]))
