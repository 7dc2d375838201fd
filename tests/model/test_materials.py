"""Materials, textures, samplers and their extensions."""

import base64
import json
from typing import Any

import pytest

from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    Wrap,
)
from moka.core.errors import ModelError
from moka.material.material import AlphaMode, Material, TextureTransform
from moka.model import Model, load_model
from tests.model.files import TRIANGLE_BINARY, glb, triangle
from tests.support.gltf_file import GltfFile

PIXELS = "data:image/png;base64," + base64.b64encode(b"pixels").decode()


def load(*materials: dict[str, Any], **changes: Any) -> list[Material]:
    document = triangle(
        **{
            "materials": list(materials),
            "images": [{"uri": PIXELS}, {"bufferView": 1}],
            "textures": [{"source": 0}, {"source": 1, "sampler": 0}],
            "samplers": [{"wrapS": 33071}],
            **changes,
        }
    )
    document["meshes"][0]["primitives"][0].pop("material")
    return load_model(glb(document)).materials


def test_an_empty_material_is_the_default() -> None:
    (material,) = load({})
    default = Material()
    for name in Material.__slots__:
        assert getattr(material, name) == getattr(default, name)


def test_reads_every_property() -> None:
    (material,) = load(
        {
            "name": "all",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.1, 0.2, 0.3, 0.4],
                "metallicFactor": 0.5,
                "roughnessFactor": 0.6,
                "baseColorTexture": {"index": 0, "texCoord": 1},
                "metallicRoughnessTexture": {"index": 1},
            },
            "normalTexture": {"index": 0, "scale": -0.7},
            "occlusionTexture": {"index": 1, "strength": 0.8, "texCoord": 1},
            "emissiveTexture": {"index": 0},
            "emissiveFactor": [0.25, 0.5, 1],
            "alphaMode": "MASK",
            "alphaCutoff": 0.9,
            "doubleSided": True,
            "extensions": {
                "KHR_materials_emissive_strength": {"emissiveStrength": 4},
                "KHR_materials_unlit": {},
            },
        }
    )
    assert material.name == "all"
    assert material.base_colour_factor == (0.1, 0.2, 0.3, 0.4)
    assert material.metallic_factor == 0.5
    assert material.roughness_factor == 0.6
    assert material.normal_scale == -0.7
    assert material.occlusion_strength == 0.8
    assert material.emissive_factor == (1, 2, 4)
    assert material.alpha_mode is AlphaMode.MASK
    assert material.alpha_cutoff == 0.9
    assert material.double_sided
    assert material.unlit
    assert material.base_colour_texture is not None
    assert material.base_colour_texture.uv_set == 1
    assert material.occlusion_texture is not None
    assert material.occlusion_texture.uv_set == 1
    assert material.normal_texture is not None
    assert material.normal_texture.uv_set == 0
    # One object for one image, whatever it is used as.
    image = material.base_colour_texture.image
    assert material.normal_texture.image is image
    assert image.read() == b"pixels"
    assert image.where == "<bytes>: images[0]"
    assert material.metallic_roughness_texture is not None
    view = material.metallic_roughness_texture.image.read()
    assert view == TRIANGLE_BINARY[36:]
    assert material.metallic_roughness_texture.sampler.wrap_s is (
        Wrap.CLAMP_TO_EDGE
    )


def test_factors_outside_of_their_range_are_clamped() -> None:
    (material,) = load(
        {
            "pbrMetallicRoughness": {
                "baseColorFactor": [2, -1, 0.5, 9],
                "metallicFactor": -3,
                "roughnessFactor": 1.5,
            },
            "emissiveFactor": [-1, 2, 0],
        }
    )
    assert material.base_colour_factor == (1, 0, 0.5, 1)
    assert (material.metallic_factor, material.roughness_factor) == (0, 1)
    assert material.emissive_factor == (0, 2, 0)


def sampler(**properties: int) -> SamplerDescriptor:
    (material,) = load({"normalTexture": {"index": 1}}, samplers=[properties])
    assert material.normal_texture is not None
    return material.normal_texture.sampler


def test_no_sampler_repeats_and_filters_trilinearly() -> None:
    (material,) = load({"normalTexture": {"index": 0}})
    assert material.normal_texture is not None
    expected = SamplerDescriptor(
        Wrap.REPEAT,
        Wrap.REPEAT,
        Filter.LINEAR,
        Filter.LINEAR,
        MipmapMode.LINEAR,
    )
    assert material.normal_texture.sampler == sampler() == expected


@pytest.mark.parametrize(
    ("code", "minify", "mipmap"),
    [
        (9728, "nearest", "none"),
        (9729, "linear", "none"),
        (9984, "nearest", "nearest"),
        (9985, "linear", "nearest"),
        (9986, "nearest", "linear"),
        (9987, "linear", "linear"),
    ],
)
def test_minifying_filters(code: int, minify: str, mipmap: str) -> None:
    made = sampler(minFilter=code)
    assert (made.minify, made.mipmap) == (Filter(minify), MipmapMode(mipmap))


def test_magnifying_filters_and_wraps() -> None:
    made = sampler(magFilter=9728, wrapS=33648, wrapT=33071)
    assert made.magnify is Filter.NEAREST
    assert made.wrap_s is Wrap.MIRRORED_REPEAT
    assert made.wrap_t is Wrap.CLAMP_TO_EDGE
    assert sampler(magFilter=9729).magnify is Filter.LINEAR
    assert sampler(wrapT=10497).wrap_t is Wrap.REPEAT


def test_texture_transform_may_choose_other_coordinates() -> None:
    def info(**extension: Any) -> dict[str, Any]:
        return {
            "normalTexture": {
                "index": 0,
                "texCoord": 1,
                "extensions": {"KHR_texture_transform": extension},
            }
        }

    first, second = load(
        info(offset=[1, 2], rotation=0.5, scale=[3, 4], texCoord=0), info()
    )
    assert first.normal_texture is not None
    assert first.normal_texture.uv_set == 0
    assert first.normal_texture.transform == TextureTransform(
        (1.0, 2.0), 0.5, (3.0, 4.0)
    )
    assert second.normal_texture is not None
    assert second.normal_texture.uv_set == 1
    assert second.normal_texture.transform == TextureTransform()


def test_a_texture_that_only_an_extension_has_is_left_out() -> None:
    (material,) = load(
        {"normalTexture": {"index": 0}},
        textures=[{"extensions": {"EXT_texture_unknown": {"source": 0}}}],
        extensionsUsed=["EXT_texture_unknown"],
    )
    assert material.normal_texture is None


NORMAL = {"normalTexture": {"index": 0}}


@pytest.mark.parametrize(
    ("material", "changes", "message"),
    [
        (
            {"normalTexture": {"index": 2}},
            {},
            "materials[0].normalTexture.index: there is no textures[2], the "
            "file has 2",
        ),
        (
            {"normalTexture": {}},
            {},
            "materials[0].normalTexture: object missing required field 'index'",
        ),
        (
            {"normalTexture": {"index": 0, "texCoord": 2}},
            {},
            "materials[0].normalTexture: uses TEXCOORD_2; moka reads "
            "TEXCOORD_0 and TEXCOORD_1",
        ),
        (
            {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1]}},
            {},
            "materials[0].pbrMetallicRoughness.baseColorFactor: expected "
            "'array' of length 4",
        ),
        (
            {"alphaMode": "GLASS"},
            {},
            "materials[0].alphaMode: invalid enum value 'GLASS'",
        ),
        (
            NORMAL,
            {"textures": [{"source": 4}]},
            "textures[0].source: there is no images[4], the file has 2",
        ),
        (
            NORMAL,
            {"textures": [{"source": 0, "sampler": 1}]},
            "textures[0].sampler: there is no samplers[1], the file has 1",
        ),
        (
            NORMAL,
            {"samplers": [{"wrapS": 1}]},
            "samplers[0].wrapS: invalid enum value 1",
        ),
        (
            NORMAL,
            {"images": [{}, {}]},
            "images[0]: needs either a uri or a bufferView",
        ),
        (
            NORMAL,
            {"images": [{"uri": PIXELS, "bufferView": 0}, {}]},
            "images[0]: needs either a uri or a bufferView",
        ),
        (
            NORMAL,
            {"images": [{"bufferView": 5}, {}]},
            "images[0].bufferView: there is no bufferViews[5]",
        ),
        (
            NORMAL,
            {"images": [{"uri": "data:image/png;base64,?"}, {}]},
            "images[0].uri: the data URI",
        ),
        (
            {
                "normalTexture": {
                    "index": 0,
                    "extensions": {"KHR_texture_transform": {"scale": [1]}},
                }
            },
            {},
            "materials[0].normalTexture.extensions.KHR_texture_transform."
            "scale: expected 'array' of length 2",
        ),
        (
            {
                "extensions": {
                    "KHR_materials_emissive_strength": {"emissiveStrength": -1}
                }
            },
            {},
            "materials[0].extensions.KHR_materials_emissive_strength."
            "emissiveStrength: expected 'float' >= 0",
        ),
        (
            {"extensions": {"KHR_materials_unlit": True}},
            {},
            "materials[0].extensions.KHR_materials_unlit: expected 'object'",
        ),
    ],
)
def test_names_what_is_wrong(
    material: dict[str, Any], changes: dict[str, Any], message: str
) -> None:
    with pytest.raises(ModelError) as caught:
        load(material, **changes)
    assert str(caught.value).startswith(f"<bytes>: {message}")


class TestExtensions:
    def load(self, **changes: Any) -> Model:
        return load_model(
            json.dumps({"asset": {"version": "2.0"}} | changes).encode()
        )

    def test_an_unknown_required_one_is_an_error_that_names_it(self) -> None:
        with pytest.raises(ModelError) as caught:
            self.load(
                extensionsUsed=["X_unknown"],
                extensionsRequired=[
                    "KHR_texture_transform",
                    "X_unknown",
                ],
            )
        assert str(caught.value).startswith(
            "<bytes>: extensionsRequired[1]: the extension "
            "'X_unknown' is required and not supported"
        )

    def test_unknown_optional_ones_are_listed(self) -> None:
        used = ["KHR_materials_unlit", "X_b", "X_a", "X_a"]
        model = self.load(extensionsUsed=used)
        assert model.unsupported_extensions == ("X_a", "X_b")
        assert model.extensions == ("KHR_materials_unlit", "X_a", "X_b")

    def test_supported_ones_may_be_required(self) -> None:
        model = self.load(
            extensionsUsed=["KHR_mesh_quantization"],
            extensionsRequired=["KHR_mesh_quantization"],
        )
        assert model.unsupported_extensions == ()


def test_coarser_levels_are_those_that_animations_move() -> None:
    file = GltfFile()
    coarse = file.unlit(0, 1, 0, 1)
    fine = file.unlit(1, 0, 0, 1)
    finest = file.document["materials"][fine]
    finest["extensions"]["MSFT_lod"] = {"ids": [coarse]}
    file.node(mesh=file.quad(material=fine))
    pointer = f"/materials/{coarse}/pbrMetallicRoughness/baseColorFactor"
    sampler = {
        "input": file.accessor([0, 1], limits=True),
        "output": file.accessor([[0, 1, 0, 1], [0, 0, 1, 1]]),
    }
    target = {
        "path": "pointer",
        "extensions": {"KHR_animation_pointer": {"pointer": pointer}},
    }
    file.document["animations"] = [
        {
            "samplers": [sampler],
            "channels": [{"sampler": 0, "target": target}],
        }
    ]
    model = load_model(file.glb())
    assert model.materials[coarse].animated == {"base_colour_factor"}
    assert model.materials[fine].coarser == (model.materials[coarse],)
    (primitive,) = model.meshes[0].primitives
    assert primitive.material is model.materials[fine]


def test_reads_what_a_dielectric_reflects() -> None:
    (material,) = load(
        {
            "extensions": {
                "KHR_materials_ior": {"ior": 0},
                "KHR_materials_specular": {
                    "specularFactor": 0.25,
                    "specularColorFactor": [0.5, 1, 3],
                    "specularTexture": {"index": 0, "texCoord": 1},
                    "specularColorTexture": {
                        "index": 1,
                        "extensions": {
                            "KHR_texture_transform": {"offset": [0.5, 0]}
                        },
                    },
                },
            }
        }
    )
    assert material.ior == 0
    assert material.specular_factor == 0.25
    assert material.specular_colour_factor == (0.5, 1, 3)
    assert material.specular_texture is not None
    assert material.specular_texture.uv_set == 1
    colour = material.specular_colour_texture
    assert colour is not None
    assert colour.transform == TextureTransform((0.5, 0))
    assert material.textures == (material.specular_texture, colour)


@pytest.mark.parametrize(
    ("extension", "content", "path"),
    [
        ("ior", {"ior": 0.9}, "ior: is 0.9; it is 0, or 1 and more"),
        ("ior", {"ior": -1}, "ior: is -1; it is 0, or 1 and more"),
        ("ior", {"ior": "glass"}, "ior: "),
        ("specular", {"specularFactor": -0.5}, "specularFactor: "),
        (
            "specular",
            {"specularColorFactor": [1, -1, 1]},
            "specularColorFactor[1]: ",
        ),
        ("specular", {"specularTexture": {"index": 9}}, "specularTexture"),
    ],
)
def test_an_impossible_dielectric_is_an_error(
    extension: str, content: dict[str, Any], path: str
) -> None:
    name = f"KHR_materials_{extension}"
    with pytest.raises(ModelError) as raised:
        load({"extensions": {name: content}})
    place = f"<bytes>: materials[0].extensions.{name}.{path}"
    assert str(raised.value).startswith(place)
