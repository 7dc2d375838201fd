"""Normal maps without tangents show what geometry would show."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from moka.graphics.device import GraphicsDevice
from moka.material.description import Feature, describe_material
from moka.material.material import TextureTransform
from moka.model import (
    LightKind,
    Primitive,
    PunctualLight,
    load_model,
    with_tangents,
)
from moka.model.morphs import MorphTargets
from tests.support.bump_scenes import (
    LAYOUTS,
    bump_by_geometry,
    bump_by_normal_map,
)
from tests.support.pictures import (
    draw_radiance,
    looking,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

SIZE = 64
# From the left above and from the right below, in colours of their own.
LIGHTS = [
    (
        PunctualLight(LightKind.DIRECTIONAL, colour=colour, intensity=math.pi),
        looking(direction).transform.world_matrix,
    )
    for colour, direction in (
        ((1.0, 0.3, 0.2), (0.6, -0.5, -0.6)),
        ((0.1, 0.4, 1.0), (-0.7, 0.2, -0.7)),
    )
]


def primitive_of(gltf: object) -> Primitive:
    return load_model(gltf).meshes[0].primitives[0]  # type: ignore[arg-type]


def picture(
    device: GraphicsDevice, primitive: Primitive
) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
    scene = scene_of(
        [(primitive, primitive.material, np.eye(4))], lights=LIGHTS
    )
    drawn = draw_radiance(
        device, scene, square_camera(), (SIZE, SIZE), suns="off"
    )
    # Without the border, where the mesh and the plane may end differently.
    return drawn[1:-1, 1:-1, :3]


@pytest.fixture(scope="module")
def by_geometry() -> Primitive:
    return primitive_of(bump_by_geometry())


def test_every_layout_shows_the_bump(
    egl_device: GraphicsDevice, by_geometry: Primitive
) -> None:
    wanted = picture(egl_device, by_geometry)
    # It is a bump: one side is lit by one light, the other by the other.
    assert np.ptp(wanted[..., 0]) > 0.5
    for name, layout in LAYOUTS.items():
        primitive = primitive_of(bump_by_normal_map(layout))
        assert "TANGENT" not in primitive.attributes
        found = picture(egl_device, primitive)
        error = np.abs(found - wanted)
        # A step of 8 bits turns a normal by 0.008; where the picture has few
        # of the 256 texels, filtering adds to it.
        stretched = name == "stretched"
        assert error.mean() < (0.006 if stretched else 0.0025), name
        assert error.max() < (0.06 if stretched else 0.025), name


@pytest.mark.parametrize("why", ["no normals", "a transform", "targets"])
def test_the_shader_makes_the_same_frame(
    egl_device: GraphicsDevice, by_geometry: Primitive, why: str
) -> None:
    """Where vertices have no tangents, and none are made."""
    wanted = picture(egl_device, by_geometry)
    for name in ("sheared", "mirrored and sheared"):
        primitive = primitive_of(bump_by_normal_map(LAYOUTS[name]))
        attributes, targets = dict(primitive.attributes), None
        material = primitive.material
        assert material is not None
        if why == "no normals":
            del attributes["NORMAL"]
        elif why == "a transform":
            assert material.normal_texture is not None
            material = replace(
                material,
                normal_texture=replace(
                    material.normal_texture, transform=TextureTransform()
                ),
            )
        else:
            targets = MorphTargets([{"POSITION": np.ones((6, 3), np.float32)}])
        primitive = Primitive(
            attributes, primitive.indices, material=material, targets=targets
        )
        description = describe_material(
            material, attributes, morphed=primitive.morphed
        )
        assert Feature.VERTEX_TANGENT not in description.features
        error = np.abs(picture(egl_device, primitive) - wanted)
        assert error.mean() < 0.0025
        assert error.max() < 0.025


def test_tangents_of_the_file_give_the_same_picture(
    egl_device: GraphicsDevice,
) -> None:
    primitive = primitive_of(bump_by_normal_map(LAYOUTS["mirrored"]))
    made = with_tangents(primitive)
    # The two vertices between the halves are needed twice.
    assert made.vertex_count == primitive.vertex_count + 2
    np.testing.assert_array_equal(
        picture(egl_device, made), picture(egl_device, primitive)
    )
