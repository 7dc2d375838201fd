"""KHR_animation_pointer: from JSON pointers to what moka moves."""

from typing import Any

import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.model import Model, load_model
from moka.model.animation import PROPERTIES, AnimationTarget
from moka.model.animation_pointer import pointer_to
from tests.support.animated import AnimatedFile

LIGHTS = {"lights": [{"type": "spot", "spot": {}}]}
TRANSFORM: dict[str, Any] = {"extensions": {"KHR_texture_transform": {}}}
MATERIAL = {
    "pbrMetallicRoughness": {
        "baseColorTexture": {"index": 0, **TRANSFORM},
        "metallicRoughnessTexture": {"index": 0, **TRANSFORM},
    },
    "normalTexture": {"index": 0, **TRANSFORM},
    "occlusionTexture": {"index": 0},
    "emissiveFactor": [0.5, 0.25, 1],
    "extensions": {
        "KHR_materials_emissive_strength": {"emissiveStrength": 4.0}
    },
}


def rich_file() -> AnimatedFile:
    """A file with one of everything that a pointer can name."""
    file = AnimatedFile(
        2,
        materials=[MATERIAL],
        textures=[{}],
        cameras=[
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}},
            {
                "type": "orthographic",
                "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9},
            },
        ],
        extensions={"KHR_lights_punctual": LIGHTS},
    )
    file.morph_targets(2)
    return file


def model_of(pointer: str, width: int) -> Model:
    file = rich_file()
    file.channel(pointer, [0, 1], np.ones((2, width)), "STEP")
    return load_model(file.glb())


@pytest.mark.parametrize(
    ("pointer", "width", "kind", "name"),
    [
        ("/nodes/1/translation", 3, "node", "translation"),
        ("/nodes/1/rotation", 4, "node", "rotation"),
        ("/nodes/1/scale", 3, "node", "scale"),
        (
            "/nodes/1/extensions/KHR_node_visibility/visible",
            1,
            "node",
            "visible",
        ),
        ("/materials/0/alphaCutoff", 1, "material", "alpha_cutoff"),
        (
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
            4,
            "material",
            "base_colour_factor",
        ),
        (
            "/materials/0/pbrMetallicRoughness/metallicFactor",
            1,
            "material",
            "metallic_factor",
        ),
        (
            "/materials/0/pbrMetallicRoughness/roughnessFactor",
            1,
            "material",
            "roughness_factor",
        ),
        ("/materials/0/normalTexture/scale", 1, "material", "normal_scale"),
        (
            "/materials/0/occlusionTexture/strength",
            1,
            "material",
            "occlusion_strength",
        ),
        (
            "/materials/0/normalTexture/extensions/KHR_texture_transform/"
            "offset",
            2,
            "material",
            "normal_texture.offset",
        ),
        (
            "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/"
            "KHR_texture_transform/rotation",
            1,
            "material",
            "base_colour_texture.rotation",
        ),
        (
            "/materials/0/extensions/KHR_materials_ior/ior",
            1,
            "material",
            "ior",
        ),
        (
            "/materials/0/extensions/KHR_materials_specular/specularFactor",
            1,
            "material",
            "specular_factor",
        ),
        (
            "/materials/0/extensions/KHR_materials_specular/"
            "specularColorFactor",
            3,
            "material",
            "specular_colour_factor",
        ),
        ("/cameras/0/perspective/yfov", 1, "camera", "yfov"),
        ("/cameras/0/perspective/znear", 1, "camera", "near"),
        ("/cameras/1/orthographic/ymag", 1, "camera", "ymag"),
        (
            "/extensions/KHR_lights_punctual/lights/0/color",
            3,
            "light",
            "colour",
        ),
        (
            "/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle",
            1,
            "light",
            "outer_cone_angle",
        ),
    ],
)
def test_a_pointer_becomes_a_target(
    pointer: str, width: int, kind: str, name: str
) -> None:
    model = model_of(pointer, width)
    (channel,) = model.animations[0].channels
    target = channel.target
    assert (target.kind, target.property) == (kind, name)
    assert PROPERTIES[kind, name] == width == channel.values.shape[1]
    assert pointer_to(target, model) == pointer


def test_the_weights_of_a_mesh_are_those_of_its_nodes() -> None:
    file = rich_file()
    file.document["nodes"][1]["weights"] = [0.5, 0.5]
    file.channel("/meshes/0/weights", [0, 1], np.ones(4))
    file.channel("/nodes/1/weights/1", [0, 1], np.ones(2))
    both, one = load_model(file.glb()).animations[0].channels
    assert both.target == AnimationTarget("node", 0, "weights")
    assert both.values.shape == (2, 2)
    assert one.target == AnimationTarget("node", 1, "weights", 1)
    assert one.values.shape == (2, 1)


def test_the_factor_of_emission_holds_its_strength() -> None:
    file = rich_file()
    file.channel("/materials/0/emissiveFactor", [0], [(1.0, 0.5, 0.0)])
    strength = (
        "/materials/0/extensions/KHR_materials_emissive_strength/"
        "emissiveStrength"
    )
    file.channel(strength, [0], [2.0], animation="stronger")
    file.channel(
        "/materials/0/emissiveFactor", [0], [(1.0, 1.0, 1.0)], animation="both"
    )
    file.channel(strength, [0], [2.0], animation="both")
    model = load_model(file.glb())
    factor, stronger, both = (each.channels for each in model.animations)
    np.testing.assert_array_equal(factor[0].values, [(4, 2, 0)])
    assert stronger[0].target.property == "emissive_factor"
    np.testing.assert_array_equal(stronger[0].values, [(1, 0.5, 2)])
    assert [each.target.property for each in both] == [
        "emissive_factor",
        "emissive_strength",
    ]
    assert both[1].values == 2


def test_materials_are_marked_with_what_changes() -> None:
    file = rich_file()
    file.channel("/materials/0/alphaCutoff", [0], [0.5])
    (material,) = load_model(file.glb()).materials
    assert material.animated == {"alpha_cutoff"}


def test_what_moka_does_not_draw_is_left_out_and_counted() -> None:
    file = rich_file()
    file.channel(
        "/materials/0/extensions/ACME_materials_glow/glowFactor", [0], [0.5]
    )
    file.channel("/scenes/0/brightness", [0], [0.5])
    model = load_model(file.glb())
    assert not model.animations[0].channels
    assert model.omitted["animation channels"] == 2


@pytest.mark.parametrize(
    ("pointer", "message"),
    [
        ("nodes/0/scale", "does not begin with '/'"),
        ("/nodes/9/scale", "there is no nodes[9]"),
        ("/materials/3/alphaCutoff", "there is no materials[3]"),
        (
            "/extensions/KHR_lights_punctual/lights/1/intensity",
            "there is no lights[1], the file has 1",
        ),
        ("/cameras/0/orthographic/ymag", "names nothing in the file"),
        (
            "/materials/0/occlusionTexture/extensions/KHR_texture_transform/"
            "offset",
            "names nothing in the file",
        ),
        (
            "/materials/0/emissiveTexture/extensions/KHR_texture_transform/"
            "scale",
            "names nothing in the file",
        ),
        ("/nodes/0/weights/2", "nodes[0] has 2 morph targets"),
    ],
)
def test_a_pointer_to_nothing_is_refused(pointer: str, message: str) -> None:
    with pytest.raises(ModelError) as caught:
        model_of(pointer, 3)
    assert message in str(caught.value)
    assert (
        "animations[0].channels[0].target.extensions.KHR_animation_pointer"
        ".pointer: " in str(caught.value)
    )


def test_visibility_needs_steps() -> None:
    file = rich_file()
    file.channel(
        "/nodes/0/extensions/KHR_node_visibility/visible",
        [0, 1],
        np.ones(2, "u1"),
    )
    with pytest.raises(ModelError, match=r"true and false need STEP"):
        load_model(file.glb())
