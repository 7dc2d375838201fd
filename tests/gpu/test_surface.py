"""Surfaces look as glTF 2.0 says: factors, textures, alpha, normals."""

import itertools
import math

import numpy as np
import pytest

from moka.app.render import render
from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    Topology,
)
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.description import Feature, describe_material
from moka.material.material import (
    AlphaMode,
    Material,
    Texture,
    TextureTransform,
)
from moka.model.geometry import quad, sphere
from moka.model.lights import LightKind, PunctualLight
from moka.model.mesh import Primitive
from moka.model.triangles import with_flat_normals
from tests.support.pictures import (
    draw_radiance,
    draw_with_display,
    encoded,
    looking,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

NEAREST = SamplerDescriptor(
    magnify=Filter.NEAREST, minify=Filter.NEAREST, mipmap=MipmapMode.NONE
)
FURNACE = Environment.uniform((1.0, 1.0, 1.0))


def unlit(*rgba: float, **fields: object) -> Material:
    """A material of one radiance."""
    return Material(unlit=True, base_colour_factor=rgba, **fields)


def centre(picture: np.ndarray) -> np.ndarray:
    """RGB in the middle."""
    height, width = picture.shape[:2]
    return picture[height // 2, width // 2, :3]


def test_texels_come_back_exactly(device: GraphicsDevice) -> None:
    """An unlit quad, one texel a pixel: top row at the top, sRGB decoded."""
    generator = np.random.default_rng(2)
    texels = generator.integers(0, 256, (8, 8, 3)).astype(np.uint8)
    material = unlit(
        1, 1, 1, 1, base_colour_texture=Texture(encoded(texels), NEAREST)
    )
    scene = scene_of([(quad(2.0), material, np.eye(4))])
    radiance, display = draw_with_display(
        device, scene, square_camera(), (8, 8), tone_map="none"
    )
    value = texels / 255.0
    linear = np.where(
        value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4
    )
    assert np.abs(radiance[:, :, :3] - linear).max() < 2e-3
    assert np.array_equal(display[:, :, :3], texels)


@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_the_white_furnace_returns_one_with_compensation(
    egl_device: GraphicsDevice, metallic: float
) -> None:
    """A white metal reflects all, at every roughness and angle; a white
    dielectric never more.
    """
    items = []
    roughnesses = np.linspace(0, 1, 9)
    for index, roughness in enumerate(roughnesses):
        material = Material(
            metallic_factor=metallic, roughness_factor=float(roughness)
        )
        place = placed_at(2 * (index % 3) - 2, 2 * (index // 3) - 2)
        items.append((sphere(0.98, 64, 32), material, place))
    scene = scene_of(items, FURNACE, "transparent")
    picture = draw_radiance(egl_device, scene, square_camera(3.0), (192, 192))
    inside = picture[:, :, 3] == 1
    values = picture[inside][:, :3]
    assert len(values) > 20000
    assert values.max() <= 1.01
    if metallic:
        assert values.min() >= 0.99


def test_without_compensation_nothing_returns_more_than_it_gets(
    egl_device: GraphicsDevice,
) -> None:
    """A lobe does not, nor a base: glTF's two together do, for a silhouette.

    Appendix B gives the base 1 - F(v.h) of each light, of which as little is
    missing there as elsewhere, while the interface reflects nearly all.
    """
    items = [
        (
            sphere(0.98, 64, 32),
            Material(
                base_colour_factor=(1, 1, 1, 1) if m else (0, 0, 0, 1),
                metallic_factor=m,
                roughness_factor=r,
            ),
            placed_at(2 * x - 1, 2 * y - 1),
        )
        for (x, m), (y, r) in itertools.product(
            enumerate((0.0, 1.0)), enumerate((0.3, 1.0))
        )
    ]
    scene = scene_of(items, FURNACE, "transparent")
    for brdf, diffuse in itertools.product(
        ("gltf", "karis"), ("lambert", "oren-nayar")
    ):
        picture = draw_radiance(
            egl_device,
            scene,
            square_camera(2.0),
            (96, 96),
            multiscatter=False,
            brdf=brdf,
            diffuse=diffuse,
        )
        values = picture[picture[:, :, 3] == 1][:, :3]
        assert values.max() <= 1.005, (brdf, diffuse)
    # Roughness 1 at normal incidence: the directional albedo 1 - ln 2.
    metal = scene_of(
        [(quad(2), Material(roughness_factor=1.0), np.eye(4))], FURNACE
    )
    picture = draw_radiance(
        egl_device, metal, square_camera(), multiscatter=False
    )
    assert centre(picture) == pytest.approx(1 - math.log(2), abs=5e-3)


def test_factors_multiply_textures_and_vertex_colours(
    egl_device: GraphicsDevice,
) -> None:
    base = quad(2.0)
    coloured = Primitive(
        {
            **base.attributes,
            "COLOR_0": np.tile([0.5, 1, 1, 1], (base.vertex_count, 1)),
        },
        base.indices,
    )
    texel = np.full((1, 1, 3), 188, np.uint8)
    material = unlit(1, 0.5, 1, 1, base_colour_texture=Texture(encoded(texel)))
    scene = scene_of([(coloured, material, np.eye(4))])
    linear = ((188 / 255 + 0.055) / 1.055) ** 2.4
    expected = linear * np.array([0.5, 0.5, 1])
    got = centre(draw_radiance(egl_device, scene, square_camera()))
    assert got == pytest.approx(expected, rel=5e-3)


def test_emission_is_added_and_not_occluded(
    egl_device: GraphicsDevice,
) -> None:
    dark = np.zeros((1, 1, 3), np.uint8)
    material = Material(
        base_colour_factor=(0, 0, 0, 1),
        emissive_factor=(4.0, 2.0, 1.0),
        occlusion_texture=Texture(encoded(dark)),
    )
    scene = scene_of([(quad(2.0), material, np.eye(4))], FURNACE)
    got = centre(draw_radiance(egl_device, scene, square_camera()))
    assert got == pytest.approx((4, 2, 1), abs=1e-5)


def test_occlusion_takes_from_indirect_light_by_its_strength(
    egl_device: GraphicsDevice,
) -> None:
    half = np.full((1, 1, 3), 128, np.uint8)
    for strength in (0.0, 0.5, 1.0):
        material = Material(
            roughness_factor=0.5,
            occlusion_texture=Texture(encoded(half)),
            occlusion_strength=strength,
        )
        scene = scene_of([(quad(2.0), material, np.eye(4))], FURNACE)
        got = centre(draw_radiance(egl_device, scene, square_camera()))
        expected = 1 + strength * (128 / 255 - 1)
        assert got == pytest.approx(expected, rel=0.01)


def test_occlusion_packed_while_decoding_makes_the_same_picture(
    egl_device: GraphicsDevice,
) -> None:
    """Two images of one size become one texture; of two sizes, they stay."""
    generator = np.random.default_rng(8)
    occlusion = generator.integers(0, 256, (4, 4, 3)).astype(np.uint8)
    roughness = generator.integers(0, 256, (4, 4, 3)).astype(np.uint8)
    larger = occlusion.repeat(2, axis=0).repeat(2, axis=1)
    deep = np.stack([roughness[..., 1]] * 3, axis=-1)
    pictures = []
    for red, packs in ((occlusion, True), (larger, False), (deep, True)):
        material = Material(
            metallic_roughness_texture=Texture(encoded(roughness), NEAREST),
            occlusion_texture=Texture(encoded(red), NEAREST),
        )
        base = quad(2.0)
        description = describe_material(material, base.attributes)
        assert (Feature.PACKED_OCCLUSION in description.features) == packs
        assert len(description.textures) == (1 if packs else 2)
        scene = scene_of([(base, material, np.eye(4))], FURNACE)
        pictures.append(draw_radiance(egl_device, scene, square_camera()))
    assert np.allclose(pictures[0], pictures[1], atol=1e-6)
    assert not np.allclose(pictures[0], pictures[2], atol=1e-2)


def test_mask_cuts_at_the_cutoff_and_does_not_blend(
    egl_device: GraphicsDevice,
) -> None:
    texels = np.zeros((1, 4, 4), np.uint8)
    texels[0, :, :3] = 255
    texels[0, :, 3] = (0, 60, 70, 255)
    material = unlit(
        1,
        1,
        1,
        1,
        base_colour_texture=Texture(encoded(texels), NEAREST),
        alpha_mode=AlphaMode.MASK,
        alpha_cutoff=0.25,
    )
    scene = scene_of(
        [(quad(2.0), material, np.eye(4))], background="transparent"
    )
    row = draw_radiance(egl_device, scene, square_camera(), (4, 4))[0]
    assert row[:, 3].tolist() == [0, 0, 1, 1]
    assert row[:, 0].tolist() == [0, 0, 1, 1]


def test_blended_surfaces_composite_back_to_front(
    egl_device: GraphicsDevice,
) -> None:
    """However they are recorded, and over the sky that lies behind."""
    front = unlit(1, 0, 0, 0.5, alpha_mode=AlphaMode.BLEND)
    back = unlit(0, 1, 0, 0.5, alpha_mode=AlphaMode.BLEND)
    items = [
        (quad(2.0), front, placed_at(z=1)),
        (quad(2.0), back, placed_at(z=-1)),
    ]
    sky = Environment.uniform((0.0, 0.0, 1.0))
    for order in (items, items[::-1]):
        scene = scene_of(order, sky)
        got = centre(draw_radiance(egl_device, scene, square_camera()))
        assert got == pytest.approx((0.5, 0.25, 0.25), abs=1e-3)


def test_opaque_ignores_alpha(egl_device: GraphicsDevice) -> None:
    scene = scene_of([(quad(2.0), unlit(1, 1, 1, 0.1), np.eye(4))])
    picture = draw_radiance(egl_device, scene, square_camera())
    assert picture[16, 16].tolist() == [1, 1, 1, 1]


def test_near_hides_far_in_any_order(egl_device: GraphicsDevice) -> None:
    near = (quad(1.0), unlit(1, 0, 0, 1), placed_at(z=1))
    far = (quad(2.0), unlit(0, 1, 0, 1), placed_at(z=-1))
    for items in ([near, far], [far, near]):
        picture = draw_radiance(egl_device, scene_of(items), square_camera())
        assert centre(picture).tolist() == [1, 0, 0]
        assert picture[1, 1, :3].tolist() == [0, 1, 0]


def flipped() -> np.ndarray:
    """Turned by half a circle about Y: the back is seen."""
    return np.diag([-1.0, 1.0, -1.0, 1.0])


def test_back_faces_are_culled_unless_double_sided(
    egl_device: GraphicsDevice,
) -> None:
    for double_sided in (False, True):
        material = unlit(1, 1, 1, 1, double_sided=double_sided)
        scene = scene_of([(quad(2.0), material, flipped())])
        got = centre(draw_radiance(egl_device, scene, square_camera()))
        assert got.tolist() == [float(double_sided)] * 3


def test_a_mirrored_transform_keeps_its_front_in_front(
    egl_device: GraphicsDevice,
) -> None:
    mirrored = np.diag([-1.0, 1.0, 1.0, 1.0])
    scene = scene_of([(quad(2.0), unlit(1, 1, 1, 1), mirrored)])
    got = centre(draw_radiance(egl_device, scene, square_camera()))
    assert got.tolist() == [1, 1, 1]
    behind = mirrored @ flipped()
    scene = scene_of([(quad(2.0), unlit(1, 1, 1, 1), behind)])
    got = centre(draw_radiance(egl_device, scene, square_camera()))
    assert got.tolist() == [0, 0, 0]


def lamp() -> list[tuple[PunctualLight, np.ndarray]]:
    """Light that travels along -Z, towards what the camera sees."""
    light = PunctualLight(LightKind.DIRECTIONAL, intensity=math.pi)
    return [(light, np.eye(4))]


@pytest.mark.parametrize("has_normals", [True, False])
def test_both_sides_of_a_double_sided_surface_are_lit_alike(
    egl_device: GraphicsDevice, has_normals: bool
) -> None:
    base = quad(2.0)
    names = set(base.attributes) - (set() if has_normals else {"NORMAL"})
    surface = Primitive(
        {name: base.attributes[name] for name in names}, base.indices
    )
    material = Material(
        metallic_factor=0.0, roughness_factor=1.0, double_sided=True
    )
    shades = []
    for placement in (np.eye(4), flipped(), np.diag([-1.0, 1, 1, 1])):
        scene = scene_of([(surface, material, placement)], lights=lamp())
        picture = draw_radiance(
            egl_device, scene, square_camera(), multiscatter=False
        )
        shades.append(float(centre(picture)[0]))
    # Lambert 0.96 plus GGX at roughness 1: 0.04 / 4.
    assert shades == pytest.approx([0.97] * 3, rel=1e-3)


def test_missing_normals_are_flat_as_the_specification_asks(
    egl_device: GraphicsDevice,
) -> None:
    ball = sphere(0.9, 16, 8)
    without = Primitive({"POSITION": ball.attributes["POSITION"]}, ball.indices)
    flat = with_flat_normals(without)
    material = Material(metallic_factor=0.0, roughness_factor=1.0)
    pictures = [
        draw_radiance(
            egl_device,
            scene_of(
                [(primitive, material, np.eye(4))],
                FURNACE,
                "transparent",
                lights=lamp(),
            ),
            square_camera(),
            (64, 64),
        )
        for primitive in (without, flat)
    ]
    assert np.abs(pictures[0] - pictures[1]).max() < 2e-3


def bumps(x: int, y: int) -> Texture:
    """A normal map of one direction, as bytes."""
    texel = np.array([[[x, y, 230]]], np.uint8)
    return Texture(encoded(texel))


def lit_from(x: float, y: float, z: float) -> list:
    """A directional light from a direction."""
    camera = looking((-x, -y, -z))
    light = PunctualLight(LightKind.DIRECTIONAL, intensity=math.pi)
    return [(light, camera.transform.world_matrix)]


@pytest.mark.parametrize("has_tangents", [True, False])
@pytest.mark.parametrize("mirrored_uv", [True, False])
@pytest.mark.parametrize(
    ("texel", "side"),
    [((220, 128), (1, 0)), ((128, 220), (0, 1))],
)
def test_normal_maps_bend_towards_red_right_and_green_up(
    egl_device: GraphicsDevice,
    has_tangents: bool,
    mirrored_uv: bool,
    texel: tuple[int, int],
    side: tuple[int, int],
) -> None:
    """Red is +u; green is up in the image, whose v points down."""
    base = quad(2.0)
    uv = np.array(base.attributes["TEXCOORD_0"])
    if mirrored_uv:
        uv[:, 0] = 1 - uv[:, 0]
    attributes = {**base.attributes, "TEXCOORD_0": uv}
    if has_tangents:
        sign = -1.0 if mirrored_uv else 1.0
        # Along +u; w makes cross(n, t) w point up the image.
        attributes["TANGENT"] = np.tile(
            [sign, 0, 0, sign], (base.vertex_count, 1)
        )
    else:
        attributes.pop("TANGENT", None)
    material = Material(
        metallic_factor=0.0,
        roughness_factor=1.0,
        normal_texture=bumps(*texel),
    )
    if mirrored_uv:
        side = (-side[0], side[1])
    values = []
    for sign in (1, -1):
        lights = lit_from(0.7 * sign * side[0], 0.7 * sign * side[1], 0.7)
        scene = scene_of(
            [(Primitive(attributes, base.indices), material, np.eye(4))],
            lights=lights,
        )
        picture = draw_radiance(
            egl_device, scene, square_camera(), multiscatter=False
        )
        values.append(float(centre(picture)[0]))
    towards, away = values
    normal = np.array([*texel, 230]) / 255 * 2 - 1
    normal /= np.linalg.norm(normal)
    slope = normal[0] if side[0] else normal[1]
    light = math.sqrt(0.5)
    # Lambert alone; the specular part of 0.04 / 4 is the tolerance.
    assert towards == pytest.approx(
        0.96 * light * (normal[2] + slope), abs=0.03
    )
    assert away == pytest.approx(
        0.96 * light * max(0.0, normal[2] - slope), abs=0.03
    )


def test_texture_coordinate_sets_and_transforms(
    egl_device: GraphicsDevice,
) -> None:
    texels = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255] * 3]])
    image = encoded(texels)
    base = quad(2.0)
    second = np.tile([0.75, 0.25], (base.vertex_count, 1))
    surface = Primitive({**base.attributes, "TEXCOORD_1": second}, base.indices)

    def shown(texture: Texture) -> list[float]:
        material = unlit(1, 1, 1, 1, base_colour_texture=texture)
        scene = scene_of([(surface, material, np.eye(4))])
        picture = draw_radiance(egl_device, scene, square_camera(), (4, 4))
        return picture[0, 0, :3].round(3).tolist()

    assert shown(Texture(image, NEAREST)) == [1, 0, 0]
    assert shown(Texture(image, NEAREST, uv_set=1)) == [0, 1, 0]
    moved = TextureTransform(offset=(0.0, 0.5))
    assert shown(Texture(image, NEAREST, 0, moved)) == [0, 0, 1]
    moved = TextureTransform(offset=(0.5, 0.0))
    assert shown(Texture(image, NEAREST, 1, moved)) == [1, 0, 0]


@pytest.mark.parametrize(
    ("topology", "points", "filled"),
    [
        (Topology.LINES, [(-1, 0), (1, 0)], 32),
        (Topology.LINE_STRIP, [(-1, 0), (0, 0), (1, 0)], 32),
        (Topology.LINE_LOOP, [(-0.5, 0), (0.5, 0)], 16),
        (
            Topology.TRIANGLE_STRIP,
            [(-1, -1), (1, -1), (-1, 1), (1, 1)],
            1024,
        ),
        (Topology.TRIANGLE_FAN, [(-1, -1), (1, -1), (1, 1), (-1, 1)], 1024),
        (Topology.POINTS, [(0.03, 0.03)], 1),
    ],
)
def test_every_topology_is_drawn(
    egl_device: GraphicsDevice,
    topology: Topology,
    points: list[tuple[float, float]],
    filled: int,
) -> None:
    positions = np.array([(x, y + 0.01, 0) for x, y in points])
    if topology in (Topology.TRIANGLE_STRIP, Topology.TRIANGLE_FAN):
        positions[:, 1] -= 0.01
    for indices in (None, np.arange(len(points))):
        primitive = Primitive(
            {"POSITION": positions}, indices, topology=topology
        )
        scene = scene_of([(primitive, unlit(1, 1, 1, 1), np.eye(4))])
        picture = draw_radiance(egl_device, scene, square_camera())
        assert (picture[:, :, 0] == 1).sum() == pytest.approx(filled, abs=1)


def test_multisampling_smooths_edges_in_linear_light(
    egl_device: GraphicsDevice,
) -> None:
    turned = np.eye(4)
    turned[:2, :2] = [[0.8, -0.6], [0.6, 0.8]]
    scene = scene_of([(quad(1.2), unlit(1, 1, 1, 1), turned)])
    hard = draw_radiance(egl_device, scene, square_camera(), samples=1)
    soft = draw_radiance(egl_device, scene, square_camera(), samples=4)
    assert set(np.unique(hard[:, :, 0])) == {0.0, 1.0}
    assert set(np.unique(soft[:, :, 0])) == {0.0, 0.25, 0.5, 0.75, 1.0}
    assert soft[:, :, 0].mean() == pytest.approx(hard[:, :, 0].mean(), abs=0.02)


def test_multisampling_does_not_sparkle_at_silhouettes() -> None:
    """Against many single samples: no pixel is brighter than what is there.

    Normals extrapolated past a triangle's edge made 16 of these pixels up
    to 1.5 brighter than anything near them.
    """
    width, height, times = 320, 180, 4
    fine = render(size=(times * width, times * height), samples=1)
    parts = fine.pixels[..., :3].max(axis=-1)
    parts = parts.reshape(height, times, width, times).max(axis=(1, 3))
    padded = np.pad(parts, 1, mode="edge")
    allowed = np.max(
        [
            padded[y : y + height, x : x + width]
            for y in range(3)
            for x in range(3)
        ],
        axis=0,
    )
    picture = render(size=(width, height), samples=4)
    # The ground's texture is filtered, not sampled: it may differ by a bit.
    assert (picture.pixels[..., :3].max(axis=-1) - allowed).max() < 0.15


def test_half_float_targets_hold_no_infinity(
    egl_device: GraphicsDevice,
) -> None:
    material = Material(emissive_factor=(1e7, 0, 0))
    scene = scene_of(
        [(quad(1.0), material, np.eye(4))],
        Environment.uniform((1e8, 1e8, 1e8)),
    )
    for samples in (1, 4):
        picture = draw_radiance(
            egl_device,
            scene,
            square_camera(),
            samples=samples,
            float_output=False,
        )
        assert np.isfinite(picture).all()
    exact = draw_radiance(egl_device, scene, square_camera())
    assert exact[0, 0, 0] == pytest.approx(1e8)


def test_detail_survives_a_million_metres_from_the_origin(
    egl_device: GraphicsDevice,
) -> None:
    """World space is relative to the camera: the same picture far away."""
    far = np.array([1e6, -2e6, 3e6])
    pictures = []
    for offset in (np.zeros(3), far):
        items = [
            (
                sphere(0.8, 32, 16),
                Material(metallic_factor=0.0, roughness_factor=0.4),
                placed_at(*offset),
            )
        ]
        scene = scene_of(items, FURNACE, "transparent", lights=lamp())
        camera = looking(
            (0, 0, -1), math.radians(30), offset + np.array([0, 0, 5])
        )
        pictures.append(draw_radiance(egl_device, scene, camera, (64, 64)))
    assert np.abs(pictures[0] - pictures[1]).max() < 2e-3


@pytest.mark.parametrize("brdf", ["gltf", "karis", "blinn-phong"])
@pytest.mark.parametrize("diffuse", ["lambert", "oren-nayar", "burley"])
def test_every_permutation_compiles_and_is_finite(
    egl_device: GraphicsDevice, brdf: str, diffuse: str
) -> None:
    texel = np.full((1, 1, 4), 200, np.uint8)
    texture = Texture(encoded(texel))
    moved = Texture(
        encoded(texel[:, :, :3]), transform=TextureTransform(rotation=0.3)
    )
    base = quad(0.4)
    full = Primitive(
        {
            **base.attributes,
            "TANGENT": np.tile([1.0, 0, 0, 1], (base.vertex_count, 1)),
            "TEXCOORD_1": base.attributes["TEXCOORD_0"],
            "COLOR_0": np.ones((base.vertex_count, 4)),
        },
        base.indices,
    )
    bare = Primitive({"POSITION": base.attributes["POSITION"]}, base.indices)
    textures = {
        "base_colour_texture": texture,
        "metallic_roughness_texture": moved,
        "normal_texture": texture,
        "occlusion_texture": moved,
        "emissive_texture": moved,
        "emissive_factor": (0.1, 0.1, 0.1),
    }
    items = []
    variants = itertools.product(
        (full, base, bare),
        ({}, textures),
        AlphaMode,
        (False, True),
    )
    for number, (primitive, fields, alpha, double_sided) in enumerate(variants):
        material = Material(
            alpha_mode=alpha, double_sided=double_sided, **fields
        )
        place = placed_at((number % 6) / 3 - 0.83, (number // 6) / 3 - 0.83)
        items.append((primitive, material, place))
    scene = scene_of(items, FURNACE, lights=lamp())
    picture = draw_radiance(
        egl_device, scene, square_camera(), brdf=brdf, diffuse=diffuse
    )
    assert np.isfinite(picture).all()
    assert picture.min() >= 0
