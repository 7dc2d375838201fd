"""Primitives: attributes, indices, bounds, and files that lie about them."""

import numpy as np
import pytest

from moka.commands.descriptors import Topology
from moka.core.errors import ModelError
from moka.material.material import Material
from moka.model import Model, Primitive, load_model
from tests.model.files import (
    TRIANGLE_POSITIONS,
    changed,
    glb,
    mesh_document,
    triangle,
)

POSITIONS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, -2)], "<f4")


def load(*args: object, **kwargs: object) -> Primitive:
    document, binary = mesh_document(*args, **kwargs)  # type: ignore[arg-type]
    (primitive,) = load_model(glb(document, binary)).meshes[0].primitives
    return primitive


@pytest.mark.parametrize("mode", range(7))
def test_knows_all_modes(mode: int) -> None:
    names = "points lines line_loop line_strip triangles triangle_strip"
    name = [*names.split(), "triangle_fan"][mode]
    primitive = load({"POSITION": POSITIONS}, mode=mode)
    assert primitive.topology is Topology(name)
    assert primitive.indices is None
    assert primitive.element_count == (4, 2, 4, 3, 1, 2, 2)[mode]


def test_triangles_are_the_default() -> None:
    assert load({"POSITION": POSITIONS}).topology is Topology.TRIANGLES


def test_reads_float_attributes() -> None:
    random = np.random.default_rng(1)
    arrays = {
        "POSITION": POSITIONS,
        "NORMAL": random.random((4, 3), "f4"),
        "TANGENT": random.random((4, 4), "f4"),
        "TEXCOORD_0": random.random((4, 2), "f4"),
        "TEXCOORD_1": random.random((4, 2), "f4"),
        "COLOR_0": random.random((4, 4), "f4"),
        "_CUSTOM": random.random((4, 2), "f4"),
        "TEXCOORD_2": random.random((4, 2), "f4"),
    }
    primitive = load(arrays)
    assert set(primitive.attributes) == set(arrays) - {"_CUSTOM", "TEXCOORD_2"}
    for name, array in primitive.attributes.items():
        assert array.dtype == np.float32
        np.testing.assert_array_equal(array, arrays[name])


def test_quantised_attributes_become_floats() -> None:
    primitive = load(
        {
            "POSITION": np.array([(-3, 0, 7)] * 4, "<i2"),
            "NORMAL": np.array([(0, 0, 1)] * 4, "<i1"),
            "TEXCOORD_0": np.array([(65535, 0)] * 4, "<u2"),
            "COLOR_0": np.array([(255, 0, 51)] * 4, "<u1"),
        }
    )
    assert primitive.bounds[0].tolist() == [-3, 0, 7]
    assert primitive.attributes["NORMAL"][0].tolist() == [0, 0, 1]
    assert primitive.attributes["TEXCOORD_0"][0].tolist() == [1, 0]
    # A colour without alpha is opaque.
    np.testing.assert_allclose(
        primitive.attributes["COLOR_0"][0], (1, 0, 0.2, 1)
    )


@pytest.mark.parametrize("type_", ["<u1", "<u2", "<u4"])
def test_indices_of_all_sizes_become_32_bits(type_: str) -> None:
    primitive = load(
        {"POSITION": POSITIONS}, np.array([0, 2, 1, 3, 3, 0], type_)
    )
    assert primitive.indices is not None
    assert primitive.indices.dtype == np.uint32
    assert primitive.indices.tolist() == [0, 2, 1, 3, 3, 0]
    assert primitive.element_count == 2


def test_the_greatest_index_of_a_type_is_a_vertex_if_there_is_one() -> None:
    """As 32 bits it restarts nothing, so that the picture is right."""
    positions = np.zeros((256, 3), "<f4")
    primitive = load({"POSITION": positions}, np.array([255] * 3, "<u1"))
    assert primitive.indices is not None
    assert primitive.indices.tolist() == [255] * 3


def test_bounds_are_those_of_the_data() -> None:
    document, binary = mesh_document({"POSITION": POSITIONS})
    document["accessors"][0].update(min=[-9, -9, -9], max=[9, 9, 9])
    primitive = load_model(glb(document, binary)).meshes[0].primitives[0]
    least, greatest = primitive.bounds
    assert least.dtype == greatest.dtype == np.float32
    assert (least.tolist(), greatest.tolist()) == ([0, 0, -2], [1, 1, 0])


def test_tangents_without_normals_are_ignored() -> None:
    tangents = np.ones((4, 4), "<f4")
    primitive = load({"POSITION": POSITIONS, "TANGENT": tangents})
    assert set(primitive.attributes) == {"POSITION"}


def test_primitives_share_the_arrays_of_an_accessor() -> None:
    document, binary = mesh_document({"POSITION": POSITIONS})
    document["meshes"] *= 2
    first, second = load_model(glb(document, binary)).meshes
    assert (
        first.primitives[0].attributes["POSITION"]
        is second.primitives[0].attributes["POSITION"]
    )


def test_a_primitive_without_positions_is_left_out_and_counted() -> None:
    document = changed("meshes[0].primitives[1]", {"attributes": {}})
    model = load_model(glb(document))
    assert len(model.meshes[0].primitives) == 1
    assert model.omitted == {"primitives without positions": 1}


def test_keeps_names_weights_and_materials() -> None:
    targets = changed("meshes[0].primitives[0].targets", [{"POSITION": 0}] * 2)
    model = load_model(glb(changed("meshes[0].weights", [0.5, 1], targets)))
    (mesh,) = model.meshes
    assert (mesh.name, mesh.weights) == ("triangle", [0.5, 1.0])
    assert mesh.primitives[0].material is model.materials[0]
    assert load({"POSITION": POSITIONS}).material is None


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (
            "meshes[0].primitives[0].attributes.POSITION",
            9,
            "attributes.POSITION: there is no accessors[9], the file has 2",
        ),
        (
            "meshes[0].primitives[0].attributes.POSITION",
            -1,
            "meshes[0].primitives[0].attributes[...]: expected 'int' >= 0",
        ),
        (
            "meshes[0].primitives[0].attributes.NORMAL",
            1,
            "attributes.NORMAL: accessors[1] is SCALAR, not VEC3",
        ),
        (
            "meshes[0].primitives[0].attributes.COLOR_0",
            1,
            "attributes.COLOR_0: accessors[1] is SCALAR, not VEC3 or VEC4",
        ),
        (
            "meshes[0].primitives[0].indices",
            2,
            "indices: there is no accessors[2], the file has 2",
        ),
        (
            "meshes[0].primitives[0].material",
            1,
            "material: there is no materials[1], the file has 1",
        ),
        (
            "meshes[0].primitives[0].mode",
            7,
            "meshes[0].primitives[0].mode: invalid enum value 7",
        ),
        (
            "meshes[0].primitives[0].mode",
            "TRIANGLES",
            "meshes[0].primitives[0].mode: expected 'int', got 'str'",
        ),
        (
            "accessors[0].componentType",
            5125,
            "accessors[0] has 32-bit integers, which none may have",
        ),
        (
            "accessors[0].count",
            2,
            "index 2 at 2 is beyond the 2 vertices",
        ),
    ],
)
def test_names_what_is_wrong(path: str, value: object, message: str) -> None:
    with pytest.raises(ModelError) as caught:
        load_model(glb(changed(path, value)))
    assert str(caught.value).startswith("<bytes>: meshes[0].primitives[0]")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("meshes[0].primitives[0].indices", 0),
        ("accessors[1].normalized", True),
        ("accessors[1].componentType", 5122),
    ],
)
def test_indices_must_be_plain_unsigned_scalars(
    path: str, value: object
) -> None:
    with pytest.raises(ModelError) as caught:
        load_model(glb(changed(path, value)))
    assert str(caught.value).endswith(
        "holds indices, which must be plain unsigned scalars"
    )


def test_attributes_must_have_one_length() -> None:
    document, binary = mesh_document(
        {"POSITION": POSITIONS, "NORMAL": np.zeros((3, 3), "<f4")}
    )
    with pytest.raises(ModelError) as caught:
        load_model(glb(document, binary))
    assert str(caught.value) == (
        "<bytes>: meshes[0].primitives[0].attributes.NORMAL: has 3 elements, "
        "POSITION has 4"
    )


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_positions_must_be_finite(value: float) -> None:
    positions = TRIANGLE_POSITIONS.copy()
    positions[1, 2] = value
    document, binary = mesh_document({"POSITION": positions})
    with pytest.raises(ModelError) as caught:
        load_model(glb(document, binary))
    assert str(caught.value) == (
        "<bytes>: meshes[0].primitives[0]: POSITION of vertex 1 is not finite"
    )


def test_a_huge_count_is_refused_before_memory_is_taken() -> None:
    """10 GB of zeros that a file of 1 kB asks for."""
    accessor = {"componentType": 5126, "count": 10**9, "type": "VEC3"}
    document = triangle(accessors=[accessor])
    del document["meshes"][0]["primitives"][0]["indices"]
    assert len(glb(document)) < 1500
    with pytest.raises(ModelError, match=r"accessors\[0\].count: asks for"):
        load_model(glb(document))


class TestInMemory:
    def test_takes_lists(self) -> None:
        primitive = Primitive({"POSITION": [(0, 1, 2)]}, [0])
        assert primitive.vertex_count == primitive.index_count == 1
        assert primitive.size == 16
        assert repr(primitive) == "Primitive(TRIANGLES, 1 vertices, 1 indices)"

    @pytest.mark.parametrize(
        ("attributes", "indices", "message"),
        [
            ({}, None, "needs the attribute POSITION"),
            ({"POSITION": np.zeros((0, 3))}, None, "POSITION is empty"),
            ({"POSITION": [1, 2, 3]}, None, r"shape \(3,\), not \(3, 3\)"),
            (
                {"POSITION": [(0, 0, 0)], "COLOR_0": [(1, 1, 1)]},
                None,
                r"COLOR_0 has the shape \(1, 3\), not \(1, 4\)",
            ),
            ({"POSITION": [(0, 0, 0)]}, [], "must be integers"),
            ({"POSITION": [(0, 0, 0)]}, np.zeros(0, "u4"), "are empty"),
            ({"POSITION": [(0, 0, 0)]}, [0.5], "must be integers"),
            ({"POSITION": [(0, 0, 0)]}, [[0]], "in one dimension"),
            ({"POSITION": [(0, 0, 0)]}, [0, -1], "index -1 at 1 is beyond"),
        ],
    )
    def test_refuses_wrong_arrays(
        self, attributes: dict[str, object], indices: object, message: str
    ) -> None:
        with pytest.raises(ModelError, match=message):
            Primitive(attributes, indices)  # type: ignore[arg-type]

    def test_release_drops_arrays_and_keeps_what_drawing_needs(self) -> None:
        primitive = Primitive({"POSITION": POSITIONS}, [0, 1, 2])
        primitive.release()
        assert primitive.attributes == {}
        assert primitive.indices is None
        assert primitive.size == 0
        assert (primitive.vertex_count, primitive.index_count) == (4, 3)
        assert primitive.bounds[1].tolist() == [1, 1, 0]
        assert primitive.element_count == 1

    def test_another_material_shares_the_arrays(self) -> None:
        first = Primitive({"POSITION": POSITIONS})
        second = first.with_material(material := Material())
        assert (first.material, second.material) == (None, material)
        assert second.attributes["POSITION"] is first.attributes["POSITION"]
        first.release()
        assert second.attributes


def test_a_mesh_is_shared_by_its_instances() -> None:
    document = triangle(
        nodes=[{"mesh": 0}, {"mesh": 0}], scenes=[{"nodes": [0, 1]}]
    )
    model: Model = load_model(glb(document))
    nodes, meshes = model.instances()
    assert (nodes.tolist(), meshes.tolist()) == ([0, 1], [0, 0])
