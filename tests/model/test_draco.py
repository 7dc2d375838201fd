"""KHR_draco_mesh_compression, made with Draco's own encoder."""

import subprocess
import sys
from typing import Any

import DracoPy
import numpy as np
import pytest

from moka.commands.descriptors import Topology
from moka.core.errors import ModelError
from moka.model import Primitive, load_model
from tests.model.files import Document, changed, glb, triangle
from tests.support.compressed import DRACO, DRACO_BITS, encode_draco

Array = np.ndarray[Any, Any]
EXTENSION = f"meshes[0].primitives[0].extensions.{DRACO}"
CODES = {"f4": 5126, "u1": 5121, "u2": 5123, "i1": 5120, "i2": 5122}


def sheet(size: int = 6) -> tuple[dict[str, Array], Array]:
    """Every attribute that moka reads, each with values of its own."""
    random = np.random.default_rng(size)
    x, y = (each.reshape(-1) for each in np.mgrid[0:size, 0:size])
    count = size * size
    normals = random.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    weights = random.integers(1, 100, (count, 4))
    weights = weights / weights.sum(axis=1, keepdims=True)
    arrays = {
        "POSITION": np.stack([x, y, np.sin(x)], -1).astype("f4"),
        "NORMAL": normals.astype("f4"),
        "TANGENT": np.column_stack([normals[:, ::-1], np.ones(count)]).astype(
            "f4"
        ),
        "TEXCOORD_0": random.random((count, 2)).astype("f4"),
        "TEXCOORD_1": random.integers(0, 65536, (count, 2)).astype("u2"),
        "COLOR_0": random.integers(0, 256, (count, 4)).astype("u1"),
        "JOINTS_0": random.integers(0, 3, (count, 4)).astype("u1"),
        "WEIGHTS_0": weights.astype("f4"),
    }
    first = (np.arange(size - 1)[:, None] * size + np.arange(size - 1)).reshape(
        -1, 1
    )
    faces = first + np.array([0, size, 1, 1, size, size + 1])
    return arrays, faces.reshape(-1, 3)


def accessor(array: Array, **changes: Any) -> dict[str, Any]:
    integers = array.dtype.kind != "f"
    return {
        "componentType": CODES[array.dtype.str[1:]],
        "count": len(array),
        "type": f"VEC{array.shape[1]}",
        "normalized": integers,
        **changes,
    }


def drawn(
    data: bytes,
    ids: dict[str, int],
    arrays: dict[str, Array],
    indices: int,
    **primitive: Any,
) -> Document:
    """A document of one primitive that only Draco has."""
    document = triangle(
        materials=[],
        accessors=[
            accessor(array, normalized=name != "JOINTS_0")
            if array.dtype.kind != "f"
            else accessor(array)
            for name, array in arrays.items()
        ],
        bufferViews=[{"buffer": 0, "byteLength": len(data)}],
        buffers=[{"byteLength": len(data)}],
        extensionsUsed=[DRACO],
        extensionsRequired=[DRACO],
    )
    document["accessors"].append(
        {"componentType": 5123, "count": indices, "type": "SCALAR"}
    )
    document["meshes"][0]["primitives"] = [
        {
            "attributes": {name: n for n, name in enumerate(arrays)},
            "indices": len(arrays),
            "extensions": {DRACO: {"bufferView": 0, "attributes": ids}},
            **primitive,
        }
    ]
    return document


def whole_sheet() -> tuple[Document, bytes]:
    arrays, faces = sheet()
    data, ids = encode_draco(arrays, faces)
    return drawn(data, ids, arrays, faces.size), data


def load(document: Document, data: bytes) -> Primitive:
    return load_model(glb(document, data)).meshes[0].primitives[0]


def test_every_attribute_comes_back_by_its_id() -> None:
    arrays, faces = sheet()
    primitive = load(*whole_sheet())
    assert primitive.indices is not None
    np.testing.assert_array_equal(primitive.indices, faces.reshape(-1))
    assert primitive.attributes.keys() == arrays.keys()
    step = np.ptp(arrays["POSITION"], axis=0).max() / (2**DRACO_BITS - 1)
    np.testing.assert_allclose(
        primitive.attributes["POSITION"], arrays["POSITION"], atol=step / 2
    )
    for name in ("NORMAL", "TANGENT", "TEXCOORD_0", "WEIGHTS_0"):
        np.testing.assert_allclose(
            primitive.attributes[name], arrays[name], atol=1e-6
        )
    for name, scale in (("TEXCOORD_1", 65535), ("COLOR_0", 255)):
        np.testing.assert_allclose(
            primitive.attributes[name] * scale, arrays[name], atol=1e-2
        )
    np.testing.assert_array_equal(
        primitive.attributes["JOINTS_0"], arrays["JOINTS_0"]
    )


@pytest.mark.parametrize("level", [0, 5, 10])
def test_the_order_may_change_and_the_shape_does_not(level: int) -> None:
    arrays, faces = sheet()
    data = DracoPy.encode(
        arrays["POSITION"],
        faces.astype("u4"),
        quantization_bits=DRACO_BITS,
        compression_level=level,
        normals=arrays["NORMAL"].astype("f8"),
        tex_coord=arrays["TEXCOORD_0"].astype("f8"),
    )
    kept = {name: arrays[name] for name in ("POSITION", "NORMAL", "TEXCOORD_0")}
    types = {0: "POSITION", 1: "NORMAL", 3: "TEXCOORD_0"}
    ids = {
        types[each["attribute_type"]]: each["unique_id"]
        for each in DracoPy.decode(data).attributes
    }
    primitive = load(drawn(data, ids, kept, faces.size), data)
    assert primitive.indices is not None
    found = np.hstack([primitive.attributes[name] for name in kept])
    wanted = np.hstack(list(kept.values()))

    def corners(rows: Array, indices: Array) -> set[tuple[float, ...]]:
        return {tuple(row) for row in np.round(rows[indices], 2).tolist()}

    # Rounded at 0.005 above every step, so that none falls between.
    assert corners(found + 0.002, primitive.indices) == corners(
        wanted + 0.002, faces.reshape(-1)
    )


def test_signed_integers_are_cast_to_the_accessors_type() -> None:
    # Draco data hold them as floats here, as the package does for types
    # that it does not know: in their own range, or divided by it.
    arrays, faces = sheet()
    normals = np.rint(arrays["NORMAL"] * 127)
    for scale in (1.0, 127.0):
        kept = {
            "POSITION": arrays["POSITION"],
            "NORMAL": (normals / scale).astype("f4"),
        }
        data, ids = encode_draco(kept, faces)
        document = drawn(data, ids, kept, faces.size)
        document["accessors"][1] |= {"componentType": 5120, "normalized": True}
        found = load(document, data).attributes["NORMAL"]
        np.testing.assert_allclose(found * 127, normals, atol=1e-4)


def test_a_strip_is_decoded_to_a_list() -> None:
    document, data = whole_sheet()
    primitive = load(changed("meshes[0].primitives[0].mode", 5, document), data)
    assert primitive.topology is Topology.TRIANGLES
    assert primitive.element_count == 50


def test_indices_need_no_accessor() -> None:
    document, data = whole_sheet()
    del document["meshes"][0]["primitives"][0]["indices"]
    assert load(document, data).element_count == 50


def test_other_attributes_are_read_from_buffers() -> None:
    document, data = whole_sheet()
    uvs = np.full((36, 2), 0.25, "<f4")
    extension = document["meshes"][0]["primitives"][0]["extensions"][DRACO]
    del extension["attributes"]["TEXCOORD_0"]
    start = len(data) + -len(data) % 4
    document["bufferViews"].append(
        {"buffer": 0, "byteOffset": start, "byteLength": uvs.nbytes}
    )
    document["accessors"][3]["bufferView"] = 1
    data += bytes(start - len(data)) + uvs.tobytes()
    document["buffers"] = [{"byteLength": len(data)}]
    found = load(document, data).attributes
    assert (found["TEXCOORD_0"] == 0.25).all()
    assert found["NORMAL"].any()


def with_plain_elements() -> tuple[Document, bytes]:
    """A triangle, and the sheet in its place for who reads Draco."""
    arrays, faces = sheet(3)
    kept = {"POSITION": arrays["POSITION"]}
    data, ids = encode_draco(kept, faces)
    document = triangle(materials=[], extensionsUsed=[DRACO])
    plain = np.array([(0, 0, 0), (1, 0, 0), (0, 2, 0)], "<f4").tobytes()
    plain += np.array([0, 1, 2, 0], "<u2").tobytes()
    document["bufferViews"].append(
        {"buffer": 0, "byteOffset": len(plain), "byteLength": len(data)}
    )
    document["buffers"] = [{"byteLength": len(plain) + len(data)}]
    (primitive,) = document["meshes"][0]["primitives"]
    del primitive["material"]
    primitive["extensions"] = {DRACO: {"bufferView": 2, "attributes": ids}}
    return document, plain + data


def test_draco_goes_before_what_is_plain() -> None:
    assert load(*with_plain_elements()).element_count == 8


def test_without_the_package_plain_elements_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    assert load(*with_plain_elements()).element_count == 1
    with pytest.raises(ModelError) as caught:
        load(*whole_sheet())
    assert str(caught.value) == (
        f"<bytes>: {EXTENSION}: needs the package DracoPy; "
        "pip install 'moka-pbr[compressed]'"
    )


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (
            "meshes[0].primitives[0].mode",
            1,
            f"meshes[0].primitives[0].mode: is 1; {DRACO} compresses",
        ),
        (f"{EXTENSION}.bufferView", 4, "there is no bufferViews[4]"),
        (f"{EXTENSION}.bufferView", -1, "bufferView: expected 'int' >= 0"),
        (
            f"{EXTENSION}.attributes.NORMAL",
            77,
            f"{EXTENSION}.attributes.NORMAL: the Draco data have no id 77",
        ),
        (
            f"{EXTENSION}.attributes.COLOR_1",
            0,
            f"{EXTENSION}.attributes.COLOR_1: is none of the primitive's own",
        ),
        (
            "meshes[0].primitives[0].attributes.NORMAL",
            99,
            "attributes.NORMAL: there is no accessors[99]",
        ),
        (
            "accessors[1].type",
            "VEC2",
            f"{EXTENSION}.attributes.NORMAL: has 3 components, the accessor "
            "is VEC2",
        ),
        (
            "accessors[4].componentType",
            5121,
            "attributes.TEXCOORD_1: has values beyond the accessor's uint8",
        ),
        (
            "bufferViews[0].byteLength",
            9,
            f"{EXTENSION}: the buffer view holds no Draco data",
        ),
        (
            "bufferViews[0].byteLength",
            300,
            f"{EXTENSION}: the Draco data cannot be decoded",
        ),
    ],
)
def test_names_what_is_wrong(path: str, value: Any, message: str) -> None:
    document, data = whole_sheet()
    with pytest.raises(ModelError) as caught:
        load(changed(path, value, document), data)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_point_cloud_is_none() -> None:
    arrays, faces = sheet()
    data = DracoPy.encode(arrays["POSITION"])
    document = drawn(data, {"POSITION": 0}, arrays, faces.size)
    with pytest.raises(ModelError, match="are a point cloud, not triangles"):
        load(document, data)


def test_a_huge_count_is_found_in_the_header() -> None:
    document, data = whole_sheet()
    assert data[8] == 0  # sequential: triangles come first
    huge = b"\xff\xff\xff\xff\x07"
    with pytest.raises(ModelError, match="ask for 2147483647 vertices or"):
        load(document, data[:11] + huge + data[11 + len(huge) :])


def test_broken_data_are_errors_and_nothing_worse() -> None:
    document, data = whole_sheet()
    random = np.random.default_rng(4)
    messages = []
    for number in range(300):
        broken = bytearray(data)
        for place in random.integers(0, 40 if number % 2 else len(data), 2):
            broken[place] = random.integers(256)
        try:
            load(document, bytes(broken))
        except ModelError as error:
            messages.append(str(error))
    assert messages
    assert not any("\n" in message for message in messages)


@pytest.mark.parametrize("extensions", [{}, {"KHR_materials_variants": {}}])
def test_a_file_without_it_imports_none_of_it(extensions: object) -> None:
    code = (
        "import sys, moka.model; moka.model.load_model(sys.stdin.buffer.read())"
        "\nprint([name for name in sys.modules if name in "
        "('DracoPy', 'moka.model.draco', 'moka.model.workers')])"
    )
    path = "meshes[0].primitives[0].extensions"
    output = subprocess.run(
        [sys.executable, "-c", code],
        input=glb(changed(path, extensions)),
        check=True,
        capture_output=True,
    ).stdout
    assert output.decode().strip() == "[]"
