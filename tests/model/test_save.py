"""Saving and loading again, with everything that a model can hold."""

import json
import math
from pathlib import Path

import numpy as np
import pygltflib
import pytest

from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    Topology,
    Wrap,
)
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError, ModelError
from moka.material.material import (
    AlphaMode,
    Material,
    Texture,
    TextureTransform,
)
from moka.model import (
    CameraDescription,
    LightKind,
    Model,
    Orthographic,
    Perspective,
    Primitive,
    PunctualLight,
    load_model,
    model_of,
    quad,
    save_model,
    sphere,
)
from moka.model.validation.validate import validate
from moka.scene.picture_needs import picture_needs
from tests.support.characters import Character
from tests.support.gltf_file import GltfFile

PNG = b"\x89PNG\r\n\x1a\n not really"
JPEG = b"\xff\xd8\xff\xe0 not really"
SAMPLER = SamplerDescriptor(
    Wrap.CLAMP_TO_EDGE,
    Wrap.MIRRORED_REPEAT,
    Filter.NEAREST,
    Filter.LINEAR,
    MipmapMode.NEAREST,
)


def rich_model(folder: Path) -> Model:
    (folder / "normal.jpg").write_bytes(JPEG)
    image = EncodedImage("colour", data=PNG)
    material = Material(
        name="rich",
        base_colour_factor=(0.1, 0.2, 0.3, 0.4),
        metallic_factor=0.25,
        roughness_factor=0.75,
        normal_scale=2.0,
        occlusion_strength=0.5,
        emissive_factor=(1.0, 4.0, 0.0),
        ior=1.25,
        specular_factor=0.5,
        specular_colour_factor=(0.5, 2.0, 1.0),
        specular_texture=Texture(image, SAMPLER, uv_set=1),
        specular_colour_texture=Texture(
            image, transform=TextureTransform((0.5, 0.25), 1.5, (2.0, 3.0))
        ),
        base_colour_texture=Texture(image, SAMPLER),
        metallic_roughness_texture=Texture(image, uv_set=1),
        normal_texture=Texture(
            EncodedImage("normal", path=folder / "normal.jpg"),
            transform=TextureTransform((0.5, 0.25), 1.5, (2.0, 3.0)),
        ),
        occlusion_texture=Texture(image, SAMPLER),
        alpha_mode=AlphaMode.MASK,
        alpha_cutoff=0.125,
        double_sided=True,
    )
    points = Primitive(
        {"POSITION": np.eye(3), "COLOR_0": np.ones((3, 4))},
        topology=Topology.POINTS,
    )
    turned = np.eye(4)[[1, 2, 0, 3]]
    turned[:3, 3] = (0.1, -2, 1 / 3)
    return model_of(
        [
            (sphere(), material, turned),
            (sphere(), Material(unlit=True), np.eye(4)),
            (points, None, np.diag([-1, 2, 3, 1])),
        ],
        name="rich",
        cameras=[
            (CameraDescription(Perspective(0.7, 1.5, 0.1), "one"), np.eye(4)),
            (CameraDescription(Orthographic(2, 1, 0, 9)), turned),
        ],
        lights=[
            (PunctualLight(LightKind.DIRECTIONAL, name="sun"), turned),
            (
                PunctualLight(LightKind.SPOT, (1, 0.5, 0), 60, 9, 0.25, 0.5),
                np.eye(4),
            ),
        ],
    )


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_everything_comes_back(tmp_path: Path, suffix: str) -> None:
    model = rich_model(tmp_path)
    path = tmp_path / f"saved model{suffix}"
    save_model(model, path)
    again = load_model(path)
    assert again.unsupported_extensions == ()
    assert again.extensions == (
        "KHR_lights_punctual",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_specular",
        "KHR_materials_unlit",
        "KHR_texture_transform",
    )
    assert again.cameras == model.cameras
    assert again.lights == model.lights
    assert math.isinf(again.lights[0].range)
    assert again.nodes.names == model.nodes.names
    np.testing.assert_array_equal(again.nodes.local, model.nodes.local)
    for one, two in zip(
        again.light_instances() + again.instances(),
        model.light_instances() + model.instances(),
        strict=True,
    ):
        assert one.tolist() == two.tolist()
    for left, right in zip(again.meshes, model.meshes, strict=True):
        (one,), (two,) = left.primitives, right.primitives
        assert one.topology is two.topology
        assert (one.material is None) == (two.material is None)
        for name, array in two.attributes.items():
            np.testing.assert_array_equal(one.attributes[name], array)
    rich, unlit = again.materials
    assert unlit.unlit
    wanted = model.materials[0]
    for name in Material.__slots__:
        if not name.endswith("_texture"):
            assert getattr(rich, name) == getattr(wanted, name), name
    for name in (
        *("base_colour", "metallic_roughness", "normal", "occlusion"),
        *("specular", "specular_colour"),
    ):
        one = getattr(rich, f"{name}_texture")
        two = getattr(wanted, f"{name}_texture")
        assert bytes(one.image.read()) == two.image.read()
        assert (one.sampler, one.uv_set, one.transform) == (
            two.sampler,
            two.uv_set,
            two.transform,
        )
    assert rich.emissive_texture is None
    assert rich.base_colour_texture is not None
    assert rich.occlusion_texture is not None
    assert rich.base_colour_texture.image is rich.occlusion_texture.image


def test_shared_arrays_and_images_are_stored_once(tmp_path: Path) -> None:
    shape = sphere()
    items = [(shape, Material(name=str(i)), np.eye(4)) for i in range(5)]
    save_model(model_of(items), tmp_path / "five.glb")
    written = pygltflib.GLTF2.load(str(tmp_path / "five.glb"))
    assert written is not None
    assert len(written.accessors) == 4
    assert len(written.meshes) == len(written.materials) == 5
    save_model(rich_model(tmp_path), tmp_path / "rich.glb")
    written = pygltflib.GLTF2.load(str(tmp_path / "rich.glb"))
    assert written is not None
    assert [image.mimeType for image in written.images] == [
        "image/png",
        "image/jpeg",
    ]
    assert len(written.textures) == 3


@pytest.mark.parametrize("count", [65535, 65536])
def test_indices_take_16_bits_where_they_fit(
    tmp_path: Path, count: int
) -> None:
    """65535 would restart strips, so that it is the first not to fit."""
    primitive = Primitive({"POSITION": np.zeros((count, 3))}, [0, 1, count - 1])
    path = tmp_path / "large.gltf"
    save_model(model_of([(primitive, None, np.eye(4))]), path)
    written = json.loads(path.read_text())
    (index,) = (a for a in written["accessors"] if a["type"] == "SCALAR")
    assert index["componentType"] == (5123 if count == 65535 else 5125)
    (again,) = load_model(path).meshes[0].primitives
    assert again.indices is not None
    assert again.indices.tolist() == [0, 1, count - 1]


def test_a_model_without_geometry(tmp_path: Path) -> None:
    path = tmp_path / "empty.gltf"
    save_model(model_of([]), path)
    again = load_model(path)
    assert len(again.nodes) == len(again.meshes) == 0
    assert not path.with_suffix(".bin").exists()


def test_hierarchies_and_empty_scenes(tmp_path: Path) -> None:
    model = model_of([(quad(), None, np.eye(4))] * 3)
    model.nodes.parents[1:] = (0, 1)
    model.scenes, model.scene_names = [[], [0]], ["none", "all"]
    model.default_scene = 1
    save_model(model, tmp_path / "chain.glb")
    again = load_model(tmp_path / "chain.glb")
    assert again.nodes.parents.tolist() == [-1, 0, 1]
    assert again.scenes == model.scenes
    assert again.scene_names == model.scene_names
    assert len(again.instances()[0]) == 3
    assert len(again.instances(0)[0]) == 0


def test_says_why_it_cannot_save(tmp_path: Path) -> None:
    model = model_of([(quad(), None, np.eye(4))])
    with pytest.raises(ModelError, match=r"\.obj: a model is saved as \.glb"):
        save_model(model, tmp_path / "model.obj")
    with pytest.raises(ModelError, match="cannot be written: No such file"):
        save_model(model, tmp_path / "gone" / "model.glb")
    strange = Material(roughness_factor=math.nan)
    with pytest.raises(ModelError, match="a number is not finite"):
        save_model(
            model_of([(quad(), strange, np.eye(4))]), tmp_path / "nan.glb"
        )
    model.meshes[0].primitives[0].release()
    with pytest.raises(ModelError, match="was released"):
        save_model(model, tmp_path / "model.glb")
    for image, error in (
        (EncodedImage("here", data=b"GIF89a"), ModelError),
        (EncodedImage("here", path=tmp_path / "gone.png"), ImageFileError),
    ):
        material = Material(normal_texture=Texture(image))
        textured = model_of([(quad(), material, np.eye(4))])
        with pytest.raises(error, match="here: "):
            save_model(textured, tmp_path / "model.glb")
    assert not list(tmp_path.iterdir())


class TestPygltflib:
    """Documents that were made or changed with pygltflib."""

    def test_reads_one_that_was_never_in_a_file(self) -> None:
        positions = np.eye(3, dtype="<f4").tobytes()
        gltf = pygltflib.GLTF2(
            scenes=[pygltflib.Scene(nodes=[0])],
            nodes=[pygltflib.Node(mesh=0)],
            meshes=[
                pygltflib.Mesh(
                    primitives=[
                        pygltflib.Primitive(
                            attributes=pygltflib.Attributes(POSITION=0)
                        )
                    ]
                )
            ],
            accessors=[
                pygltflib.Accessor(
                    bufferView=0, componentType=5126, count=3, type="VEC3"
                )
            ],
            bufferViews=[pygltflib.BufferView(buffer=0, byteLength=36)],
            buffers=[pygltflib.Buffer(byteLength=36)],
        )
        gltf.set_binary_blob(positions)
        model = load_model(gltf)
        (primitive,) = model.meshes[0].primitives
        assert np.array_equal(primitive.attributes["POSITION"], np.eye(3))
        assert model.path is None

    def test_finds_the_files_beside_its_own(self, tmp_path: Path) -> None:
        save_model(model_of([(quad(), None, np.eye(4))]), tmp_path / "a.gltf")
        gltf = pygltflib.GLTF2.load(str(tmp_path / "a.gltf"))
        assert gltf is not None
        model = load_model(gltf)
        assert model.path == tmp_path / "a.gltf"
        assert model.meshes[0].primitives[0].vertex_count == 4

    @pytest.mark.parametrize("value", [object(), "three", math.nan])
    def test_refuses_values_that_are_no_gltf(self, value: object) -> None:
        gltf = pygltflib.GLTF2(
            accessors=[
                pygltflib.Accessor(componentType=5126, count=value, type="VEC3")
            ]
        )
        with pytest.raises(ModelError, match="pygltflib"):
            load_model(gltf)


def test_skins_morph_targets_and_weights_come_back(tmp_path: Path) -> None:
    character = Character(joints=5, sets=2, targets=3, morphs_colour=True)
    model = load_model(character.glb())
    save_model(model, tmp_path / "saved.glb")
    again = load_model(tmp_path / "saved.glb")
    assert again.nodes.skins == model.nodes.skins
    assert again.nodes.weights == model.nodes.weights
    for one, two in zip(model.skins, again.skins, strict=True):
        assert one.name == two.name
        np.testing.assert_array_equal(one.joints, two.joints)
        np.testing.assert_array_equal(one.inverse_bind, two.inverse_bind)
    first, second = model.meshes[0].primitives[0], again.meshes[0].primitives[0]
    assert first.attributes.keys() == second.attributes.keys()
    for name, array in first.attributes.items():
        np.testing.assert_array_equal(array, second.attributes[name])
    assert first.targets is not None
    assert second.targets is not None
    for one, two in zip(
        first.targets.deltas, second.targets.deltas, strict=True
    ):
        assert one.keys() == two.keys()
        for name, array in one.items():
            np.testing.assert_array_equal(array, two[name])


def test_what_chooses_comes_back(tmp_path: Path) -> None:
    """Hidden nodes, levels of nodes and materials, variants, instances."""
    file = GltfFile()
    shades = [file.unlit(number / 4, 0, 0, 1) for number in range(4)]
    finest = file.document["materials"][shades[0]]
    finest["extensions"]["MSFT_lod"] = {"ids": [shades[1]]}
    finest["extras"] = {"MSFT_screencoverage": [0.5, 0.125]}
    mappings = [
        {"material": shades[2], "variants": [1]},
        {"material": shades[3], "variants": [0, 2]},
    ]
    mesh = file.quad(
        material=shades[0],
        extensions={"KHR_materials_variants": {"mappings": mappings}},
    )
    file.document["extensions"] = {
        "KHR_materials_variants": {
            "variants": [{"name": "a"}, {"name": "b"}, {"name": "c"}]
        }
    }
    places = file.accessor([(0, 0, 0), (1, 2, 3)])
    file.node(
        mesh=mesh,
        extensions={"MSFT_lod": {"ids": [1, 2]}},
        extras={"MSFT_screencoverage": [0.25, 0.0625, 0.0]},
    )
    instancing = {"attributes": {"TRANSLATION": places}}
    file.node(mesh=mesh, extensions={"EXT_mesh_gpu_instancing": instancing})
    file.node(mesh=mesh, extensions={"KHR_node_visibility": {"visible": False}})
    file.node(children=[0], translation=[0, 0, 5])
    file.document["scenes"] = [{"nodes": [3]}]
    model = load_model(file.glb())
    path = tmp_path / "again.glb"
    save_model(model, path)
    # Any reader sees the finest level alone.
    assert not [
        issue for issue in validate(path).issues if issue.code != "NODE_EMPTY"
    ]
    again = load_model(path)
    for variant in (None, *model.variants):
        needs = picture_needs(model, variant=variant)
        assert needs["draws"]["other_levels"] > 0
        assert picture_needs(again, variant=variant) == needs
    assert again.variants == model.variants
    levels, before = again.nodes.levels, model.nodes.levels
    assert levels is not None
    assert before is not None
    assert levels.limit.tolist() == before.limit.tolist()
    assert again.materials[0].limits == (0.5, 0.125)
    assert again.materials[0].coarser == (again.materials[1],)
    assert len(again.nodes.hidden) == 1
    first = again.meshes[0].primitives[0]
    assert {
        number: again.materials.index(material)
        for number, material in first.variants.items()
    } == {0: 3, 1: 2, 2: 3}
    nodes, _ = again.instances()
    expected, _ = model.instances()
    world = again.nodes.world_matrices()[nodes]
    assert sorted(world.reshape(-1, 16).tolist()) == sorted(
        model.nodes.world_matrices()[expected].reshape(-1, 16).tolist()
    )
