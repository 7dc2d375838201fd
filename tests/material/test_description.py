"""Descriptions hold what changes a shader, and nothing else."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.commands.descriptors import SamplerDescriptor, Topology, Wrap
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ModelError
from moka.core.png import encode_png
from moka.material.description import (
    Feature,
    MaterialDescription,
    defines_of,
    describe_material,
)
from moka.material.material import (
    AlphaMode,
    Material,
    Texture,
    TextureTransform,
)

IMAGE = EncodedImage("model.gltf: images[0]", data=b"one")
OTHER = EncodedImage("model.gltf: images[1]", data=b"two")
FLAT = EncodedImage("flat", data=encode_png(np.zeros((4, 4, 3), np.uint8)))
ALL = ("POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0")


def describe(**fields: object) -> MaterialDescription:
    """The description of a material on vertices with everything."""
    return describe_material(Material(**fields), ALL)


def test_equal_materials_share_a_description() -> None:
    first = describe(base_colour_factor=(1, 0, 0, 1), roughness_factor=0.1)
    second = describe(base_colour_factor=(0, 1, 0, 1), roughness_factor=0.9)
    assert first == second
    assert hash(first) == hash(second)


def test_a_plain_material_reads_position_and_normal_only() -> None:
    description = describe_material(Material(), ALL[:5])
    assert description.attributes == ("POSITION", "NORMAL")
    assert description.textures == ()


def test_tangents_are_read_for_a_normal_map_only() -> None:
    with_map = describe(normal_texture=Texture(IMAGE))
    assert Feature.VERTEX_TANGENT in with_map.features
    assert "TANGENT" in with_map.attributes
    flat = describe(normal_texture=Texture(IMAGE), normal_scale=0.0)
    assert Feature.VERTEX_TANGENT not in flat.features
    assert flat.textures == ()


def test_a_normal_map_gets_tangents_where_there_are_none() -> None:
    bare = [name for name in ALL if name != "TANGENT"]
    for uv_set in (0, 1):
        texture = Texture(IMAGE, uv_set=uv_set)
        description = describe_material(Material(normal_texture=texture), bare)
        assert Feature.VERTEX_TANGENT in description.features
        assert f"TANGENT_OF_UV_{uv_set}" in description.attributes
        assert "TANGENT" not in description.attributes


@pytest.mark.parametrize(
    ("changes", "missing", "morphed"),
    [
        ({}, {"NORMAL"}, ()),
        ({}, {"TEXCOORD_0"}, ()),
        ({}, set(), ("POSITION",)),
        ({"transform": TextureTransform()}, set(), ()),
    ],
)
def test_no_tangents_are_made_where_they_would_not_hold(
    changes: dict[str, Any], missing: set[str], morphed: tuple[str, ...]
) -> None:
    material = Material(normal_texture=Texture(IMAGE, **changes))
    description = describe_material(
        material, set(ALL) - {"TANGENT"} - missing, morphed=morphed
    )
    assert not any("TANGENT" in name for name in description.attributes)
    without = describe_material(Material(), set(ALL) - {"TANGENT"})
    assert not any("TANGENT" in name for name in without.attributes)


def test_an_emissive_texture_under_a_black_factor_is_left_out() -> None:
    dark = describe(emissive_texture=Texture(IMAGE))
    assert dark.textures == ()
    assert Feature.EMISSIVE not in dark.features
    bright = describe(
        emissive_texture=Texture(IMAGE), emissive_factor=(1, 1, 1)
    )
    assert [use.slot for use in bright.textures] == ["emissive"]


def test_unlit_reads_its_base_colour_only() -> None:
    description = describe(
        unlit=True,
        base_colour_texture=Texture(IMAGE),
        normal_texture=Texture(OTHER),
        emissive_texture=Texture(OTHER),
        emissive_factor=(1, 1, 1),
    )
    assert [use.slot for use in description.textures] == ["base_colour"]
    assert "NORMAL" not in description.attributes


def test_textures_without_their_coordinates_are_left_out() -> None:
    material = Material(base_colour_texture=Texture(IMAGE, uv_set=1))
    description = describe_material(material, ("POSITION", "TEXCOORD_0"))
    assert description.textures == ()


def test_occlusion_in_the_roughness_texture_costs_no_sample() -> None:
    shared = describe(
        metallic_roughness_texture=Texture(IMAGE),
        occlusion_texture=Texture(IMAGE),
    )
    assert [use.slot for use in shared.textures] == ["metallic_roughness"]
    assert Feature.PACKED_OCCLUSION in shared.features
    for different in (
        Texture(OTHER),
        Texture(IMAGE, uv_set=1),
        Texture(IMAGE, SamplerDescriptor(Wrap.CLAMP_TO_EDGE)),
        Texture(IMAGE, transform=TextureTransform(offset=(0.5, 0))),
    ):
        apart = describe(
            metallic_roughness_texture=Texture(IMAGE),
            occlusion_texture=different,
        )
        assert len(apart.textures) == 2


def test_values_are_carried_where_all_of_them_fit() -> None:
    """Alphas of opaque colours, normals and emission, of one size."""

    def carriers(side: int = 4, deep: bool = False, **fields: Any) -> Any:
        data = encode_png(np.zeros((side, side, 3), np.uint8))
        if deep:
            data = data[:24] + b"\x10" + data[25:]
        surface = EncodedImage("surface", data=data)
        return dict(
            describe(
                base_colour_texture=Texture(FLAT),
                normal_texture=Texture(FLAT),
                metallic_roughness_texture=Texture(surface),
                **fields,
            ).carriers
        )

    both = {"roughness": "normal", "metalness": "base_colour"}
    assert carriers() == both
    # Sizes that differ, values of 16 bits, an alpha that is read, and one
    # value too many.
    assert carriers(side=8) == {}
    assert carriers(deep=True) == {}
    assert carriers(alpha_mode=AlphaMode.MASK) == {}
    occlusion = {"occlusion_texture": Texture(FLAT)}
    assert carriers(**occlusion) == {}
    glow = {"emissive_texture": Texture(FLAT), "emissive_factor": (1, 1, 1)}
    assert carriers(**occlusion, **glow) == both | {"occlusion": "emissive"}


def test_a_pure_metal_needs_no_diffuse_light() -> None:
    assert Feature.DIFFUSE not in describe(metallic_factor=1.0).features
    assert Feature.DIFFUSE in describe(metallic_factor=0.9).features
    textured = describe(metallic_roughness_texture=Texture(IMAGE))
    assert Feature.DIFFUSE in textured.features


def test_a_third_set_of_coordinates_is_an_error_that_names_it() -> None:
    with pytest.raises(ModelError, match="TEXCOORD_2"):
        describe(base_colour_texture=Texture(IMAGE, uv_set=2))


@given(
    st.sampled_from(AlphaMode),
    st.booleans(),
    st.booleans(),
    st.sampled_from([Topology.POINTS, Topology.TRIANGLES]),
    st.sets(st.sampled_from(ALL[1:])),
    st.integers(0, 1),
    st.booleans(),
)
def test_defines_are_named_and_follow_the_description(
    alpha_mode: AlphaMode,
    double_sided: bool,
    unlit: bool,
    topology: Topology,
    attributes: set[str],
    uv_set: int,
    moved: bool,
) -> None:
    transform = TextureTransform(rotation=1) if moved else None
    material = Material(
        alpha_mode=alpha_mode,
        double_sided=double_sided,
        unlit=unlit,
        base_colour_texture=Texture(IMAGE, uv_set=uv_set, transform=transform),
    )
    description = describe_material(
        material, {"POSITION", *attributes}, topology
    )
    defines = defines_of(description)
    assert all(name.startswith("MOKA_") for name in defines)
    assert set(description.attributes) <= {"POSITION", *attributes}
    assert ("MOKA_ALPHA_MASK" in defines) == (alpha_mode is AlphaMode.MASK)
    assert ("MOKA_DOUBLE_SIDED" in defines) == double_sided
    has_uv = f"TEXCOORD_{uv_set}" in attributes
    assert ("MOKA_BASE_COLOUR_TEXTURE" in defines) == has_uv
    assert ("MOKA_BASE_COLOUR_TRANSFORM" in defines) == (has_uv and moved)
    assert defines.get("MOKA_BASE_COLOUR_UV", uv_set) == uv_set


@pytest.mark.parametrize(
    "fields",
    [
        {"ior": 1.45},
        {"specular_factor": 0.0},
        {"specular_colour_factor": (1.0, 1.0, 0.5)},
        {"specular_texture": Texture(IMAGE)},
        {"specular_colour_texture": Texture(IMAGE)},
        {"animated": frozenset({"ior"})},
    ],
)
def test_only_a_dielectric_that_is_not_the_default_has_its_own_shader(
    fields: dict[str, Any],
) -> None:
    default = describe(metallic_factor=0.5)
    assert Feature.SPECULAR not in default.features
    changed = describe(metallic_factor=0.5, **fields)
    assert Feature.SPECULAR in changed.features
    assert defines_of(changed)["MOKA_SPECULAR"] == 1
    # What has no dielectric interface does not ask for it.
    assert describe(**fields) == describe()
    assert describe(unlit=True, **fields) == describe(unlit=True)


@pytest.mark.parametrize(
    "fields",
    [
        {"specular_factor": 0.0},
        {"specular_colour_factor": (0, 0, 0)},
        {"ior": 1.0},
    ],
)
def test_a_specular_colour_of_nothing_is_not_sampled(
    fields: dict[str, Any],
) -> None:
    description = describe(
        metallic_factor=0.0, specular_colour_texture=Texture(IMAGE), **fields
    )
    assert description.textures == ()
    moving = describe(
        metallic_factor=0.0,
        specular_colour_texture=Texture(IMAGE),
        animated=frozenset(fields),
        **fields,
    )
    assert [use.slot for use in moving.textures] == ["specular_colour"]
