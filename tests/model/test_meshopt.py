"""EXT_meshopt_compression and its like, made with meshoptimizer's encoders."""

import copy
import subprocess
import sys
from typing import Any

import meshopt
import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.model import load_model
from moka.model.accessors import AccessorReader
from moka.model.source import open_source
from tests.model.files import Document, changed, glb, triangle

EXT = "EXT_meshopt_compression"
KHR = "KHR_meshopt_compression"
Array = np.ndarray[Any, Any]


def compressed(
    parts: list[tuple[Array, str, str]], name: str = EXT, version: int = 0
) -> tuple[Document, bytes]:
    """A document of views, each (rows or indices, mode, filter).

    Their own bytes are in a buffer without data, as gltfpack writes it.
    """
    document = triangle(bufferViews=[], accessors=[], meshes=[], nodes=[])
    document["scenes"] = [{}]
    document["extensionsUsed"] = document["extensionsRequired"] = [name]
    binary, plain = b"", 0
    for array, mode, filter_ in parts:
        data = meshopt.encode_gltf_buffer(array, mode, version)
        stride = array.nbytes // len(array)
        document["bufferViews"].append(
            {
                "buffer": 1,
                "byteOffset": plain,
                "byteLength": array.nbytes,
                "extensions": {
                    name: {
                        "buffer": 0,
                        "byteOffset": len(binary),
                        "byteLength": len(data),
                        "byteStride": stride,
                        "count": len(array),
                        "mode": mode,
                        "filter": filter_,
                    }
                },
            }
        )
        binary += data
        binary += bytes(-len(binary) % 4)
        plain += array.nbytes
    document["buffers"] = [
        {"byteLength": len(binary)},
        {"byteLength": plain, "extensions": {name: {"fallback": True}}},
    ]
    return document, binary


def view(document: Document, binary: bytes, index: int = 0) -> memoryview:
    return open_source(glb(document, binary)).view(index)


def unit_vectors(count: int, width: int) -> Array:
    vectors = np.random.default_rng(5).normal(size=(count, width))
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors.astype(np.float32)


@pytest.mark.parametrize("count", [1, 3, 255, 256, 257, 3000])
def test_attributes_and_indices_come_back_as_they_were(count: int) -> None:
    random = np.random.default_rng(count)
    rows = random.integers(0, 256, (count, 12), np.uint8)
    rows[:, 4:] = 7
    triangles = random.integers(0, count, 3 * count).astype("<u4")
    indices = random.integers(0, min(count, 65535), count).astype("<u2")
    document, binary = compressed(
        [
            (rows, "ATTRIBUTES", "NONE"),
            (triangles, "TRIANGLES", "NONE"),
            (indices, "INDICES", "NONE"),
        ]
    )
    assert bytes(view(document, binary, 0)) == rows.tobytes()
    # The codec may turn a triangle, which stays the same one.
    found = np.frombuffer(view(document, binary, 1), "<u4").reshape(-1, 3)
    turned = [np.roll(triangles.reshape(-1, 3), n, axis=1) for n in range(3)]
    assert np.any([(found == each).all(axis=1) for each in turned], 0).all()
    assert bytes(view(document, binary, 2)) == indices.tobytes()


def test_one_colour_fits_a_few_bytes() -> None:
    # The least that the codec needs must not be taken for too little.
    rows = np.zeros((100_000, 4), np.uint8)
    for version in (0, 1):
        document, binary = compressed(
            [(rows, "ATTRIBUTES", "NONE")], KHR, version
        )
        assert bytes(view(document, binary)) == rows.tobytes()


def test_octahedral_vectors() -> None:
    vectors = unit_vectors(500, 4)
    vectors[:, :3] /= np.linalg.norm(vectors[:, :3], axis=1, keepdims=True)
    vectors[:, 3] = np.sign(vectors[:, 3])
    for stride, bits, dtype in ((4, 8, "<i1"), (8, 12, "<i2")):
        rows = meshopt.encode_filter_oct(vectors, stride, bits)
        document, binary = compressed([(rows, "ATTRIBUTES", "OCTAHEDRAL")])
        data = np.frombuffer(view(document, binary), dtype).reshape(-1, 4)
        found = data / np.iinfo(dtype).max
        np.testing.assert_allclose(found, vectors, atol=3 / 2**bits + 0.005)


def test_quaternions() -> None:
    quaternions = unit_vectors(500, 4)
    rows = meshopt.encode_filter_quat(quaternions, 8, 12)
    document, binary = compressed([(rows, "ATTRIBUTES", "QUATERNION")])
    found = np.frombuffer(view(document, binary), "<i2").reshape(-1, 4) / 32767
    # A quaternion and its negative are one rotation.
    along = np.abs((found * quaternions).sum(axis=1))
    np.testing.assert_allclose(along, 1, atol=1e-3)


def test_exponential_floats() -> None:
    values = np.random.default_rng(2).normal(scale=1e3, size=(300, 3))
    rows = meshopt.encode_filter_exp(values, 15)
    document, binary = compressed([(rows, "ATTRIBUTES", "EXPONENTIAL")])
    found = np.frombuffer(view(document, binary), "<f4").reshape(-1, 3)
    step = np.abs(values).max(axis=1, keepdims=True) * 2.0**-14
    assert (np.abs(found - values) <= step).all()


@pytest.mark.parametrize(("stride", "dtype"), [(4, "<u1"), (8, "<u2")])
def test_colours(stride: int, dtype: str) -> None:
    colours = np.random.default_rng(3).random((200, 4), np.float32)
    rows = meshopt.encode_filter_color(colours, stride, 8)
    document, binary = compressed([(rows, "ATTRIBUTES", "COLOR")], KHR, 1)
    found = np.frombuffer(view(document, binary), dtype).reshape(-1, 4)
    np.testing.assert_allclose(
        found / np.iinfo(dtype).max, colours, atol=2 / 128
    )


def square(**primitive: Any) -> tuple[Document, bytes]:
    """A square whose vertices and indices are compressed."""
    positions = np.array(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32
    )
    indices = np.array([0, 1, 2, 0, 2, 3], "<u2")
    document, binary = compressed(
        [(positions, "ATTRIBUTES", "NONE"), (indices, "TRIANGLES", "NONE")]
    )
    document["accessors"] = [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ]
    document["meshes"] = [
        {
            "primitives": [
                {"attributes": {"POSITION": 0}, "indices": 1, **primitive}
            ]
        }
    ]
    document["nodes"] = [{"mesh": 0}]
    document["scenes"] = [{"nodes": [0]}]
    return document, binary


def test_a_model_is_drawn_from_compressed_views() -> None:
    model = load_model(glb(*square()))
    (primitive,) = model.meshes[0].primitives
    assert primitive.element_count == 2
    assert primitive.bounds[1].tolist() == [1, 1, 0]
    assert model.unsupported_extensions == ()


def with_plain_bytes(document: Document, binary: bytes) -> tuple[Any, bytes]:
    """The same with the bytes uncompressed too, and moved by one."""
    plain = b"".join(bytes(view(document, binary, index)) for index in range(2))
    moved = np.frombuffer(plain[:48], "<f4") + np.float32(1)
    document = copy.deepcopy(document)
    document["extensionsRequired"] = []
    start = len(binary)
    binary += moved.tobytes() + plain[48:]
    document["buffers"] = [{"byteLength": len(binary)}]
    for each in document["bufferViews"]:
        each["buffer"] = 0
        each["byteOffset"] += start
    return document, binary


def test_the_compressed_bytes_go_before_the_others() -> None:
    model = load_model(glb(*with_plain_bytes(*square())))
    assert model.meshes[0].primitives[0].bounds[0].tolist() == [0, 0, 0]


def test_without_the_package_the_others_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plain = glb(*with_plain_bytes(*square()))
    required = glb(*square())
    monkeypatch.setitem(sys.modules, "meshopt", None)
    model = load_model(plain)
    assert model.meshes[0].primitives[0].bounds[0].tolist() == [1, 1, 1]
    with pytest.raises(ModelError) as caught:
        load_model(required)
    assert str(caught.value) == (
        f"<bytes>: bufferViews[0].extensions.{EXT}: needs the package "
        "meshopt; pip install 'moka-pbr[compressed]'"
    )


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("byteStride", 10, "byteStride: 10 is no multiple of 4"),
        ("byteStride", 300, "byteStride: expected 'int' <= 256"),
        ("byteStride", 8, "count: 4 elements of 8 bytes do not fill the 48"),
        ("count", 5, "count: 5 elements of 12 bytes do not fill the 48"),
        ("count", 0, "count: expected 'int' >= 1"),
        ("mode", "POINTS", "mode: invalid enum value 'POINTS'"),
        ("filter", "CUBIC", "filter: invalid enum value 'CUBIC'"),
        ("filter", "QUATERNION", "byteStride: 12 does not fit the filter"),
        ("byteOffset", 10**6, "ends at byte"),
        ("byteLength", 3, "byteLength: 3 bytes cannot hold 4 elements"),
        ("byteLength", 20, "cannot be decoded"),
        ("buffer", 7, "there is no buffers[7]"),
    ],
)
def test_names_what_is_wrong(name: str, value: Any, message: str) -> None:
    document, binary = square()
    path = f"bufferViews[0].extensions.{EXT}.{name}"
    with pytest.raises(ModelError) as caught:
        load_model(glb(changed(path, value, document), binary))
    text = str(caught.value)
    assert text.startswith(f"<bytes>: bufferViews[0].extensions.{EXT}")
    assert message in text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("filter", "OCTAHEDRAL", "filter: is OCTAHEDRAL, indices have none"),
        ("byteStride", 12, "byteStride: indices have 2 or 4 bytes, not 12"),
        ("count", 4, "count: 4 is no multiple of 3"),
    ],
)
def test_names_what_is_wrong_with_indices(
    name: str, value: Any, message: str
) -> None:
    document, binary = square()
    path = f"bufferViews[1].extensions.{EXT}.{name}"
    with pytest.raises(ModelError) as caught:
        load_model(glb(changed(path, value, document), binary))
    assert message in str(caught.value)


def test_a_huge_count_allocates_nothing() -> None:
    document, binary = square()
    path = "bufferViews[0].extensions"
    extension = document["bufferViews"][0]["extensions"][EXT]
    extension = {EXT: {**extension, "count": 2**31}}
    document = changed(path, extension, document)
    document["bufferViews"][0]["byteLength"] = 12 * 2**31
    document["buffers"][1]["byteLength"] = 12 * 2**31 + 12
    with pytest.raises(ModelError, match="cannot hold 2147483648 elements"):
        view(document, binary)


def test_broken_data_are_errors_and_nothing_worse() -> None:
    document, binary = square()
    random = np.random.default_rng(1)
    messages = []
    for _ in range(300):
        broken = bytearray(binary)
        for place in random.integers(0, len(binary), 2):
            broken[place] = random.integers(256)
        try:
            load_model(glb(document, bytes(broken)))
        except ModelError as error:
            messages.append(str(error))
    assert messages
    assert not any("\n" in message for message in messages)


def test_a_fallback_buffer_has_no_bytes_of_its_own() -> None:
    document, binary = square()
    del document["bufferViews"][0]["extensions"]
    with pytest.raises(ModelError, match=r"buffers\[1\]: has no uri"):
        load_model(glb(document, binary))


def test_quantised_attributes_of_any_width() -> None:
    positions = np.array([(0, 0, 0), (500, 0, 0), (0, 65535, 3)], "<u2")
    rows = np.zeros((3, 4), "<u2")
    rows[:, :3] = positions
    document, binary = compressed([(rows, "ATTRIBUTES", "NONE")])
    document["bufferViews"][0]["byteStride"] = 8
    document["accessors"] = [
        {"bufferView": 0, "componentType": 5123, "count": 3, "type": "VEC3"}
    ]
    reader = AccessorReader(open_source(glb(document, binary)))
    assert reader.floats(0).tolist() == positions.tolist()


def test_a_file_without_it_imports_none_of_it() -> None:
    code = (
        "import sys, moka.model; moka.model.load_model(sys.stdin.buffer.read())"
        "\nprint([name for name in sys.modules if name in "
        "('meshopt', 'moka.model.meshopt', 'moka.model.workers')])"
    )
    output = subprocess.run(
        [sys.executable, "-c", code],
        input=glb(triangle()),
        check=True,
        capture_output=True,
    ).stdout
    assert output.decode().strip() == "[]"
