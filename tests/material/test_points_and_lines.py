"""What a shader must know of points and lines (glTF 2.0, section 3.9.7)."""

import numpy as np
import pytest

from moka.commands.descriptors import Topology
from moka.core.encoded_image import EncodedImage
from moka.core.png import encode_png
from moka.material.description import (
    Feature,
    defines_of,
    describe_material,
)
from moka.material.material import Material, Texture

LINES = (Topology.LINES, Topology.LINE_LOOP, Topology.LINE_STRIP)
TRIANGLES = (
    Topology.TRIANGLES,
    Topology.TRIANGLE_STRIP,
    Topology.TRIANGLE_FAN,
)
FULL = ("POSITION", "NORMAL", "TANGENT", "TEXCOORD_0")


def bumpy() -> Material:
    image = EncodedImage(
        "bumps", data=encode_png(np.full((2, 2, 3), 128, np.uint8))
    )
    return Material(
        normal_texture=Texture(image),
        emissive_factor=(1, 1, 1),
        emissive_texture=Texture(image),
    )


@pytest.mark.parametrize("topology", TRIANGLES)
def test_triangles_know_nothing_of_them(topology: Topology) -> None:
    description = describe_material(bumpy(), FULL, topology)
    assert not description.features & (Feature.LINES | Feature.POINTS)
    assert "LINE_OTHER" not in description.attributes
    defines = defines_of(description)
    assert not {"MOKA_LINES", "MOKA_POINTS"} & defines.keys()


@pytest.mark.parametrize("topology", [Topology.POINTS, *LINES])
def test_without_normals_they_are_not_lit(topology: Topology) -> None:
    attributes = ("POSITION", "TEXCOORD_0", "COLOR_0")
    features = describe_material(bumpy(), attributes, topology).features
    assert Feature.UNLIT | Feature.EMISSIVE in features
    assert Feature.VERTEX_COLOUR in features
    assert (Feature.LINES in features) == (topology in LINES)
    slots = {
        use.slot
        for use in describe_material(bumpy(), attributes, topology).textures
    }
    assert slots == {"emissive"}
    # A material that is unlit by its own word has no emission either.
    unlit = describe_material(
        Material(unlit=True, emissive_factor=(1, 1, 1)), attributes, topology
    )
    assert Feature.EMISSIVE not in unlit.features


@pytest.mark.parametrize("topology", [Topology.POINTS, *LINES])
@pytest.mark.parametrize("has_tangents", [False, True])
def test_normal_maps_need_tangents(
    topology: Topology, has_tangents: bool
) -> None:
    attributes = [each for each in FULL if has_tangents or each != "TANGENT"]
    description = describe_material(bumpy(), attributes, topology)
    assert Feature.UNLIT not in description.features
    slots = {use.slot for use in description.textures}
    assert ("normal" in slots) == has_tangents


@pytest.mark.parametrize("topology", LINES)
def test_lines_that_change_shape_are_not_quads(topology: Topology) -> None:
    skinned = (*FULL, "JOINTS_0", "WEIGHTS_0")
    for description in (
        describe_material(bumpy(), skinned, topology),
        describe_material(bumpy(), FULL, topology, morphed=["POSITION"]),
    ):
        assert Feature.LINES not in description.features
        assert "LINE_OTHER" not in description.attributes
    still = describe_material(bumpy(), FULL, topology)
    assert "LINE_OTHER" in still.attributes
