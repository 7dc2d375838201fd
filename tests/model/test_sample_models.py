"""Real models, read by moka and by pygltflib, value by value."""

from pathlib import Path

import numpy as np
import pygltflib
import pytest

from moka.commands.descriptors import Topology
from moka.model import (
    Model,
    Primitive,
    describe,
    format_description,
    load_model,
    save_model,
    triangle_corners,
    with_tangents,
)
from moka.model.morphs import MorphTargets
from tests.support.oracles.gltf_file import elements

pytestmark = pytest.mark.assets

NAMES = [
    "AlphaBlendModeTest.glb",
    "Avocado/Avocado.gltf",
    "BoomBox/BoomBox.gltf",
    "BoxInterleaved.glb",
    "CesiumMilkTruck.glb",
    "ClearCoatTest/ClearCoatTest.gltf",
    "ClearcoatWicker.glb",
    "DamagedHelmet/DamagedHelmet.gltf",
    "Duck.glb",
    "Michelle.glb",
    "MorphStressTest.gltf",
    "Soldier.glb",
    "Suzanne/Suzanne.gltf",
    "TextureTransformTest/TextureTransformTest.gltf",
    "cube.glb",
    "cubevc.glb",
    "nested.glb",
]


@pytest.fixture(scope="module", params=NAMES)
def path(request: pytest.FixtureRequest, assets: Path) -> Path:
    return assets / "models" / request.param


@pytest.fixture(scope="module")
def model(path: Path) -> Model:
    return load_model(path)


@pytest.fixture(scope="module")
def other(path: Path) -> pygltflib.GLTF2:
    loaded = pygltflib.GLTF2.load(str(path))
    assert loaded is not None
    return loaded


def check_primitive(
    found: Primitive, gltf: pygltflib.GLTF2, wanted: pygltflib.Primitive
) -> None:
    assert found.topology is list(Topology)[wanted.mode]
    weights = found.attributes.get("WEIGHTS_0")
    for name, array in found.attributes.items():
        expected = elements(gltf, getattr(wanted.attributes, name))
        if name == "JOINTS_0":  # of those that move a vertex
            expected = np.where(weights > 0, expected, 0)
        elif name == "WEIGHTS_0":
            expected = expected / expected.sum(axis=1, keepdims=True)
        np.testing.assert_allclose(
            array[:, : expected.shape[1]], expected, rtol=1e-6
        )
    positions = gltf.accessors[wanted.attributes.POSITION]
    np.testing.assert_allclose(found.bounds[0], positions.min, rtol=1e-5)
    np.testing.assert_allclose(found.bounds[1], positions.max, rtol=1e-5)
    if wanted.indices is None:
        assert found.indices is None
    else:
        expected = elements(gltf, wanted.indices)[:, 0]
        np.testing.assert_array_equal(found.indices, expected)


def test_geometry_agrees(model: Model, other: pygltflib.GLTF2) -> None:
    assert len(model.meshes) == len(other.meshes)
    for mesh, wanted in zip(model.meshes, other.meshes, strict=True):
        assert mesh.name == (wanted.name or "")
        for found, primitive in zip(
            mesh.primitives, wanted.primitives, strict=True
        ):
            check_primitive(found, other, primitive)
            if primitive.material is None:
                assert found.material is None
            else:
                material = model.materials[primitive.material]
                assert found.material is material


def test_materials_agree(model: Model, other: pygltflib.GLTF2) -> None:
    assert len(model.materials) == len(other.materials)
    for found, wanted in zip(model.materials, other.materials, strict=True):
        pbr = wanted.pbrMetallicRoughness or pygltflib.PbrMetallicRoughness()
        assert found.name == (wanted.name or "")
        assert list(found.base_colour_factor) == pbr.baseColorFactor
        assert found.metallic_factor == pbr.metallicFactor
        assert found.roughness_factor == pbr.roughnessFactor
        assert list(found.emissive_factor) == wanted.emissiveFactor
        assert found.alpha_mode.value == wanted.alphaMode
        assert found.double_sided == wanted.doubleSided
        for texture, info in (
            (found.base_colour_texture, pbr.baseColorTexture),
            (found.metallic_roughness_texture, pbr.metallicRoughnessTexture),
            (found.normal_texture, wanted.normalTexture),
            (found.occlusion_texture, wanted.occlusionTexture),
            (found.emissive_texture, wanted.emissiveTexture),
        ):
            assert (texture is None) == (info is None)
            if texture is not None:
                source = other.textures[info.index].source
                assert texture.image.where.endswith(f": images[{source}]")


def test_nodes_agree(model: Model, other: pygltflib.GLTF2) -> None:
    tree = model.nodes
    assert len(tree) == len(other.nodes)
    for row, index in enumerate(tree.source.tolist()):
        node = other.nodes[index]
        assert tree.names[row] == (node.name or "")
        assert tree.mesh[row] == (-1 if node.mesh is None else node.mesh)
        assert tree.camera[row] == (-1 if node.camera is None else node.camera)
        children = tree.source[tree.parents == row].tolist()
        assert sorted(children) == sorted(node.children)
        local = tree.local[row]
        if node.matrix is not None:
            assert local.T.reshape(-1).tolist() == node.matrix
        elif node.translation is not None:
            assert local[:3, 3].tolist() == node.translation
    scene = other.scenes[other.scene or 0]
    roots = tree.source[model.scenes[model.default_scene]]
    assert roots.tolist() == scene.nodes


def same_model(first: Model, second: Model) -> None:
    assert first.nodes.names == second.nodes.names
    np.testing.assert_array_equal(first.nodes.parents, second.nodes.parents)
    np.testing.assert_allclose(first.nodes.local, second.nodes.local)
    assert first.cameras == second.cameras
    assert first.scenes == second.scenes
    for one, two in zip(first.meshes, second.meshes, strict=True):
        for left, right in zip(one.primitives, two.primitives, strict=True):
            assert left.attributes.keys() == right.attributes.keys()
            for name, array in left.attributes.items():
                np.testing.assert_array_equal(array, right.attributes[name])
            assert (left.indices is None) == (right.indices is None)
            if left.indices is not None:
                np.testing.assert_array_equal(left.indices, right.indices)
            assert (left.targets is None) == (right.targets is None)
            if left.targets is not None and right.targets is not None:
                same_targets(left.targets, right.targets)
    assert first.nodes.skins == second.nodes.skins
    for skin, other in zip(first.skins, second.skins, strict=True):
        assert skin.name == other.name
        np.testing.assert_array_equal(skin.joints, other.joints)
        np.testing.assert_array_equal(skin.inverse_bind, other.inverse_bind)


def same_targets(first: MorphTargets, second: MorphTargets) -> None:
    for one, two in zip(first.deltas, second.deltas, strict=True):
        assert one.keys() == two.keys()
        for name, array in one.items():
            np.testing.assert_array_equal(array, two[name])


def test_the_three_kinds_of_source_agree(
    model: Model, other: pygltflib.GLTF2, path: Path
) -> None:
    same_model(model, load_model(other))
    if path.suffix == ".glb":
        same_model(model, load_model(path.read_bytes()))


def test_a_saved_model_reads_the_same(model: Model, tmp_path: Path) -> None:
    save_model(model, tmp_path / "saved.glb")
    again = load_model(tmp_path / "saved.glb")
    same_model(model, again)
    for one, two in zip(model.materials, again.materials, strict=True):
        assert one.base_colour_factor == two.base_colour_factor
        if one.base_colour_texture is not None:
            assert two.base_colour_texture is not None
            assert bytes(one.base_colour_texture.image.read()) == bytes(
                two.base_colour_texture.image.read()
            )


def test_it_can_be_described(model: Model) -> None:
    description = describe(model)
    assert all(each["width"] for each in description["textures"])
    assert str(model.path) in format_description(description)


@pytest.mark.parametrize(
    "name", ["Avocado/Avocado.gltf", "BoomBox/BoomBox.gltf", "cubevc.glb"]
)
def test_tangents_are_those_of_the_authors(assets: Path, name: str) -> None:
    """Their tools used MikkTSpace too."""
    (mesh,) = load_model(assets / "models" / name).meshes
    primitive = mesh.primitives[0]
    made = with_tangents(primitive)
    theirs = primitive.attributes["TANGENT"][triangle_corners(primitive)]
    ours = made.attributes["TANGENT"][triangle_corners(made)]
    assert (theirs[..., 3] == ours[..., 3]).mean() > 0.998
    cosine = (theirs[..., :3] * ours[..., :3]).sum(axis=-1)
    assert np.median(cosine) > 0.9999
    assert np.percentile(cosine, 2) > 0.99
