"""Containers: .gltf text, .glb chunks, and every way they can be broken."""

import json
import os
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moka.core.errors import ModelError
from moka.model import load_model
from moka.model.container import split_container
from tests.model.files import (
    TRIANGLE_BINARY,
    TRIANGLE_POSITIONS,
    glb,
    triangle,
)

WHOLE = glb(triangle())


def test_reads_a_binary_file_from_bytes() -> None:
    model = load_model(WHOLE)
    (primitive,) = model.meshes[0].primitives
    assert np.array_equal(primitive.attributes["POSITION"], TRIANGLE_POSITIONS)
    assert primitive.indices is not None
    assert primitive.indices.tolist() == [0, 1, 2]
    assert model.path is None


@pytest.mark.parametrize("kind", [bytearray, memoryview])
def test_takes_any_bytes(kind: type) -> None:
    assert load_model(kind(WHOLE)).meshes[0].name == "triangle"


def test_reads_from_a_path_and_names_the_model(tmp_path: Path) -> None:
    path = tmp_path / "little triangle.glb"
    path.write_bytes(WHOLE)
    for given_path in (path, str(path)):
        model = load_model(given_path)
        assert (model.name, model.path) == ("little triangle", path)


def test_vertex_data_is_not_copied_from_a_binary_file() -> None:
    primitive = load_model(WHOLE).meshes[0].primitives[0]
    positions = primitive.attributes["POSITION"]
    assert not positions.flags.owndata
    assert not positions.flags.writeable


def test_reads_text_with_a_byte_order_mark() -> None:
    document = triangle(meshes=[], nodes=[], scenes=[{}])
    text = b"\xef\xbb\xbf \n" + json.dumps(document).encode()
    assert load_model(text).meshes == []


def test_skips_chunks_that_it_does_not_know() -> None:
    extra = struct.pack("<I4s", 4, b"NOPE") + b"1234"
    data = WHOLE + extra
    data = data[:8] + struct.pack("<I", len(data)) + data[12:]
    assert len(load_model(data).meshes) == 1


def test_ignores_zeros_behind_the_text_and_bytes_behind_the_file() -> None:
    text = json.dumps(triangle(meshes=[], nodes=[], scenes=[{}])).encode()
    text += bytes(-len(text) % 4)
    head = struct.pack("<I4s", len(text), b"JSON")
    length = 12 + len(head) + len(text)
    data = struct.pack("<4sII", b"glTF", 2, length) + head + text
    assert load_model(data + b"rubbish").meshes == []


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "neither a .glb"),
        (b"PK\x03\x04 a zip file", "neither a .glb"),
        (b"[1, 2]", "neither a .glb"),
        (b"glTF", "cut off within the header"),
        (WHOLE[:4] + struct.pack("<I", 1) + WHOLE[8:], "has version 1"),
        (WHOLE[:-1], f"cut off after {len(WHOLE) - 1} of {len(WHOLE)} bytes"),
        (WHOLE[:8] + struct.pack("<I", 12) + WHOLE[12:], "is not JSON"),
        (
            WHOLE[:12] + struct.pack("<I", 2**32 - 1) + WHOLE[16:],
            "chunk 0 of the .glb needs 4294967295 bytes",
        ),
        (WHOLE.replace(b"JSON", b"BIN\0", 1), "is not JSON"),
        (b"{", "JSON ends before it is complete"),
        (b'{"asset": nope}', "JSON is malformed"),
        (b'{"asset": {"version": "\xff"}}', "not UTF-8"),
        (b"{}", "missing required field 'asset'"),
        (b'{"extensions": {"x": ' + b"[" * 100_000, "nested too deeply"),
        (b'{"asset": {"version": "1.0"}}', "asset.version: is '1.0'"),
        (
            b'{"asset": {"version": "2.1", "minVersion": "2.1"}}',
            "asset.minVersion: asks for '2.1'",
        ),
    ],
)
def test_says_what_is_wrong_with_a_file(data: bytes, message: str) -> None:
    with pytest.raises(ModelError) as caught:
        load_model(data)
    assert message in str(caught.value)
    assert str(caught.value).startswith("<bytes>: ")
    assert "\n" not in str(caught.value)


def test_names_a_path_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"gone\.glb: no such file"):
        load_model(tmp_path / "gone.glb")
    with pytest.raises(ModelError, match=r"Is a directory"):
        load_model(tmp_path)
    with pytest.raises(ModelError, match=r"cannot be read"):
        load_model("null\0byte.glb")


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="needs a device")
def test_refuses_a_file_without_end() -> None:
    with pytest.raises(ModelError, match="/dev/zero: not a regular file"):
        load_model("/dev/zero")


def test_refuses_what_is_no_model() -> None:
    with pytest.raises(ModelError, match="int: not a model"):
        load_model(3)  # type: ignore[arg-type]


def test_splitting_copies_nothing() -> None:
    data = memoryview(WHOLE)
    text, binary = split_container(data, "here")
    assert text.obj is WHOLE
    assert binary is not None
    assert binary.obj is WHOLE
    assert bytes(binary[: len(TRIANGLE_BINARY)]) == TRIANGLE_BINARY


def rich_file() -> bytes:
    """A file with every part of a document that the reader looks into."""
    document = triangle(
        extensionsUsed=["KHR_lights_punctual", "KHR_texture_transform"],
        extensions={
            "KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}
        },
        cameras=[
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}
        ],
        images=[{"bufferView": 0}, {"uri": "data:image/png;base64,AAAA"}],
        samplers=[{"minFilter": 9984}],
        textures=[{"source": 0, "sampler": 0}, {"source": 1}],
        materials=[
            {
                "normalTexture": {
                    "index": 0,
                    "extensions": {"KHR_texture_transform": {"scale": [2, 2]}},
                },
                "emissiveTexture": {"index": 1},
            }
        ],
    )
    document["nodes"] = [
        {"mesh": 0, "children": [1, 2]},
        {"camera": 0, "rotation": [0, 0, 0.6, 0.8]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}},
    ]
    document["accessors"][0]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 0},
    }
    return glb(document)


RICH = rich_file()


def load_or_refuse(data: bytes) -> None:
    """Only a ModelError may come out, and what loads must be usable."""
    try:
        model = load_model(data)
    except ModelError as error:
        assert "\n" not in str(error)  # noqa: PT017
        return
    model.bounds()
    model.nodes.world_matrices()


def test_the_rich_file_is_whole() -> None:
    model = load_model(RICH)
    assert len(model.cameras) == len(model.lights) == 1


@settings(deadline=None)
@given(st.integers(0, len(RICH)))
def test_cut_files_load_or_raise_model_errors(length: int) -> None:
    load_or_refuse(RICH[:length])


@settings(deadline=None, max_examples=400)
@given(
    st.lists(
        st.tuples(st.integers(0, len(RICH) - 1), st.integers(0, 255)),
        min_size=1,
        max_size=4,
    )
)
def test_damaged_files_load_or_raise_model_errors(
    damage: list[tuple[int, int]],
) -> None:
    data = bytearray(RICH)
    for place, value in damage:
        data[place] = value
    load_or_refuse(bytes(data))


@settings(deadline=None, max_examples=400)
@given(
    st.integers(0, 200),
    st.sampled_from(
        [-1, 0, 1, 7, 255, 2**31 - 1, 2**31, 2**53, 2**63, 1e300, -1e300]
    ),
)
def test_hostile_numbers_load_or_raise_model_errors(
    which: int, value: float
) -> None:
    """Replaces one number of the JSON, wherever it stands."""
    length = struct.unpack_from("<I", RICH, 12)[0]
    document = json.loads(RICH[20 : 20 + length])
    places = []

    def walk(owner: object) -> None:
        pairs = (
            owner.items()
            if isinstance(owner, dict)
            else enumerate(owner)
            if isinstance(owner, list)
            else ()
        )
        for key, item in list(pairs):
            if isinstance(item, int | float) and not isinstance(item, bool):
                places.append((owner, key))
            walk(item)

    walk(document)
    owner, key = places[which % len(places)]
    owner[key] = value  # type: ignore[index]
    load_or_refuse(glb(document))
