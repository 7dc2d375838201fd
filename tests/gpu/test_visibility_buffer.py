"""A visibility buffer shows what forward shading shows."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.core.maths import quaternion_about_axis, quaternion_to_matrix
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import load_environment
from moka.material.material import (
    AlphaMode,
    Material,
    Texture,
    TextureTransform,
)
from moka.model import (
    LightKind,
    Primitive,
    PunctualLight,
    cube,
    quad,
    sphere,
)
from moka.model.assemble import model_of
from moka.model.cameras import Orthographic, Perspective
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.scene import Scene
from tests.conformance.case import Case
from tests.conformance.features import FEATURES
from tests.support.pictures import (
    Items,
    draw_radiance,
    encoded,
    looking,
    placed_at,
    scene_of,
)

pytestmark = pytest.mark.gpu

SIZE = (96, 96)
CASES = [case for cases in FEATURES.values() for case in cases]


def turned(axis: tuple[float, ...], angle: float) -> NDArray[np.float64]:
    """A rotation (4, 4)."""
    matrix = np.eye(4)
    unit = np.divide(axis, np.linalg.norm(axis))
    matrix[:3, :3] = quaternion_to_matrix(quaternion_about_axis(unit, angle))
    return matrix


def noise(seed: int, low: int = 0, channels: int = 3) -> Texture:
    generator = np.random.default_rng(seed)
    # Smooth, so that another pixel's centre means another colour, not chance.
    coarse = generator.integers(low, 256, (8, 8, channels))
    return Texture(encoded(np.kron(coarse, np.ones((8, 8, 1)))))


def with_uvs(primitive: Primitive, **more: Any) -> Primitive:
    """The primitive with what ``more`` names; two sets of coordinates."""
    uv = primitive.attributes["TEXCOORD_0"]
    return Primitive(
        {**primitive.attributes, "TEXCOORD_1": uv[:, ::-1] * 0.7, **more},
        primitive.indices,
        material=primitive.material,
    )


def ball() -> Primitive:
    return sphere(1.0)


def stretched(primitive: Primitive, *scale: float) -> tuple[Any, Any]:
    matrix = turned((0.3, 1.0, 0.2), 0.7) @ np.diag((*scale, 1.0))
    return primitive, matrix


def textured() -> Items:
    material = Material(
        base_colour_texture=noise(1, 30),
        normal_texture=Texture(
            encoded(np.full((4, 4, 3), (160, 110, 240), np.uint8))
        ),
        metallic_roughness_texture=noise(2, 60),
        emissive_texture=noise(3),
        emissive_factor=(0.2, 0.1, 0.3),
        occlusion_texture=noise(4, 100),
    )
    return [(ball(), material, np.eye(4))]


def moved_coordinates() -> Items:
    moved = TextureTransform(offset=(0.2, 0.4), rotation=0.6, scale=(2.0, 0.5))
    material = Material(
        base_colour_texture=replace(noise(1, 30), transform=moved),
        normal_texture=replace(noise(5, 100), uv_set=1),
        emissive_texture=replace(noise(3), uv_set=1, transform=moved),
        emissive_factor=(0.5, 0.5, 0.5),
        metallic_factor=0.3,
    )
    return [(with_uvs(ball()), material, np.eye(4))]


def mirrored_and_flattened() -> Items:
    material = Material(
        base_colour_texture=noise(1, 30), normal_texture=noise(5, 100)
    )
    return [
        (*stretched(ball(), -0.5, 0.5, 0.5), material),
        (*stretched(ball(), 0.9, 0.2, 0.4), material),
    ]


def items(*pairs: tuple[Any, Any, Any]) -> Items:
    return [
        (primitive, material, matrix) for primitive, matrix, material in pairs
    ]


def rows_of_materials() -> Items:
    materials = [
        Material(
            base_colour_factor=(0.2 + 0.2 * i, 0.9 - 0.2 * i, 0.5, 1.0),
            roughness_factor=0.2 + 0.2 * i,
            metallic_factor=0.5,
        )
        for i in range(4)
    ]
    return [
        (
            ball() if i % 2 else cube(1.0),
            materials[i % 4],
            placed_at(i % 3 - 1, i // 3 - 1, 0.3 * i)
            @ np.diag((0.4, 0.4, 0.4, 1)),
        )
        for i in range(9)
    ]


def coloured_vertices() -> Items:
    primitive = ball()
    # Smooth, and beyond what a colour may be.
    colours = np.ones((primitive.vertex_count, 4), np.float32)
    colours[:, :3] = 0.5 + 0.7 * primitive.attributes["POSITION"]
    shape = with_uvs(primitive, COLOR_0=colours)
    return [(shape, Material(metallic_factor=0.2), np.eye(4))]


def flat_triangles() -> Items:
    """Without normals, seen from both sides."""
    primitive = ball()
    indices = primitive.indices
    assert indices is not None
    shape = Primitive(
        {
            name: primitive.attributes[name]
            for name in ("POSITION", "TEXCOORD_0")
        },
        indices.reshape(-1, 3)[:-600].reshape(-1),
    )
    material = Material(
        double_sided=True,
        base_colour_texture=noise(1, 30),
        metallic_factor=0.0,
    )
    return [(shape, material, turned((1, 0, 0), 1.2))]


def unlit() -> Items:
    return [
        (ball(), Material(unlit=True, base_colour_texture=noise(1)), np.eye(4))
    ]


SCENES: dict[str, Callable[[], Items]] = {
    "textured": textured,
    "moved coordinates": moved_coordinates,
    "mirrored and flattened": lambda: items(*mirrored_and_flattened()),
    "rows of materials": rows_of_materials,
    "coloured vertices": coloured_vertices,
    "flat triangles": flat_triangles,
    "unlit": unlit,
}


def lit(scene_items: Items, background: Any = "transparent") -> Scene:
    lamp = PunctualLight(LightKind.POINT, (1.0, 0.8, 0.6), 60.0)
    return scene_of(
        scene_items,
        load_environment("sky"),
        background,
        lights=[(lamp, placed_at(2.0, 2.0, 3.0))],
    )


def both(
    device: GraphicsDevice, scene: Scene, **settings: Any
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    camera = looking((0.1, -0.2, -1.0), 0.9, (-0.3, 0.6, 3.4))
    forward, seen = (
        draw_radiance(device, scene, camera, SIZE, shading=how, **settings)
        for how in ("forward", "visibility")
    )
    return forward, seen


@pytest.mark.parametrize("name", SCENES)
def test_one_sample_sees_the_same(device: GraphicsDevice, name: str) -> None:
    forward, seen = both(device, lit(SCENES[name]()))
    np.testing.assert_array_equal(seen[..., 3], forward[..., 3])
    assert forward[..., 3].mean() > 0.05
    # What is interpolated once in the rasteriser and once in the shader
    # differs in the last bits; at edges of shapes, quads of pixels tell less
    # about how far a mirrored sun is spread.
    off = np.abs(seen - forward)[..., :3].max(axis=-1)
    off /= np.maximum(forward[..., :3].max(axis=-1), 0.05)
    assert np.median(off) < 1e-5
    assert np.mean(off > 0.01) < 0.02


@pytest.mark.parametrize("name", SCENES)
def test_four_samples_cover_the_same(device: GraphicsDevice, name: str) -> None:
    forward, seen = both(device, lit(SCENES[name]()), samples=4)
    np.testing.assert_allclose(seen[..., 3], forward[..., 3], atol=1e-6)
    partly = (forward[..., 3] > 0) & (forward[..., 3] < 1)
    assert partly.any()
    # Samples of one surface share a place on it.
    off = np.abs(seen - forward)[..., :3].max(axis=-1)
    off /= np.maximum(forward[..., :3].max(axis=-1), 0.05)
    assert np.median(off) < 1e-5
    assert off.mean() < 0.01


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.title)
def test_a_feature_looks_as_it_must(case: Case) -> None:
    options = {**case.options, "shading": "visibility"}
    outcome = replace(case, options=options).run()
    assert outcome.passed, (outcome.differing, outcome.mean)


@pytest.mark.parametrize("samples", [1, 4])
def test_the_far_plane_is_nearer_than_nothing(
    device: GraphicsDevice, samples: int
) -> None:
    """Depth is 0 there, as where no surface is."""
    square = quad(1.0), Material(unlit=True), np.eye(4)
    scene = scene_of([square], background="transparent")
    camera = looking((0, 0, -1), 0.9, (0, 0, 4))
    camera.projection = Orthographic(1.0, 1.0, 0.1, 4.0)
    forward, seen = (
        draw_radiance(device, scene, camera, SIZE, samples=samples, shading=how)
        for how in ("forward", "visibility")
    )
    np.testing.assert_allclose(seen, forward, atol=1e-6)
    assert forward[..., 3].mean() == pytest.approx(0.25, abs=0.02)


def test_edges_between_surfaces_are_smooth(device: GraphicsDevice) -> None:
    """Two planes that meet in a pixel both give it their part."""
    red, blue = (
        Material(unlit=True, base_colour_factor=(*colour, 1.0))
        for colour in ((1, 0, 0), (0, 0, 1))
    )
    half = cube(1.0)
    scene = scene_of(
        [
            (half, red, turned((0, 0, 1), 0.3) @ placed_at(-0.5)),
            (half, blue, turned((0, 0, 1), 0.3) @ placed_at(0.5)),
        ],
        background="transparent",
    )
    camera = looking((0, 0, -1), 0.5, (0, 0, 3))
    forward, seen = (
        draw_radiance(device, scene, camera, SIZE, samples=4, shading=how)
        for how in ("forward", "visibility")
    )
    np.testing.assert_allclose(seen, forward, atol=1e-6)
    mixed = (seen[..., 0] > 0) & (seen[..., 2] > 0)
    assert mixed.any()


@pytest.mark.parametrize("background", ["environment", (0.1, 0.2, 0.3)])
@pytest.mark.parametrize("samples", [1, 4])
def test_only_an_area_is_drawn(
    device: GraphicsDevice, samples: int, background: Any
) -> None:
    scene = lit(textured(), background=background)
    camera = looking((0, 0, -1), 0.9, (0, 0, 3))
    settings = RenderSettings(samples=samples, shading="visibility")
    renderer = Renderer(device, SIZE, settings)
    pictures = []
    for area in (None, (0, 0, 40, 96), (40, 0, 56, 96)):
        renderer.area = area
        commands = CommandList()
        renderer.draw(scene, camera, commands)
        shown = renderer.read_display(commands)
        device.submit(commands).wait()
        assert shown.data is not None
        pictures.append(shown.data.copy())
    renderer.close()
    whole, _, joined = pictures
    np.testing.assert_array_equal(joined, whole)


@pytest.mark.parametrize("samples", [1, 4])
def test_settings_may_change_between_frames(
    device: GraphicsDevice, samples: int
) -> None:
    scene = lit(rows_of_materials(), background="environment")
    camera = looking((0, 0, -1), 0.9, (0, 0, 4))
    renderer = Renderer(device, SIZE, RenderSettings())

    def picture(how: str, size: tuple[int, int]) -> NDArray[Any]:
        renderer.size = size
        renderer.settings = RenderSettings(samples=samples, shading=how)
        commands = CommandList()
        renderer.draw(scene, camera, commands)
        shown = renderer.read_display(commands)
        device.submit(commands).wait()
        assert shown.data is not None
        return shown.data.copy()

    first = picture("visibility", SIZE)
    forward = picture("forward", SIZE)
    picture("visibility", (40, 24))
    again = picture("visibility", SIZE)
    renderer.close()
    np.testing.assert_array_equal(again, first)
    assert np.abs(first.astype(int) - forward).mean() < 0.5


@pytest.mark.parametrize("float_output", [False, True])
@pytest.mark.parametrize("samples", [1, 4])
def test_a_frame_shows_nothing_of_the_one_before(
    device: GraphicsDevice, samples: int, float_output: bool
) -> None:
    """Targets that serve again are not cleared where a sky is drawn."""
    scene = lit(textured(), background="environment")
    settings = RenderSettings(
        samples=samples, shading="visibility", float_output=float_output
    )
    towards, away = ((0, 0, z) for z in (-1, 1))
    views = [
        (looking(towards, 0.9, (0, 0, 3)), "environment", 0.0),
        (looking(towards, 0.9, (0.8, 0.3, 3)), "environment", 0.0),
        (looking(away, 0.9, (0, 0, 3)), "environment", 0.0),
        (looking(towards, 0.9, (-0.8, 0, 4)), "environment", 0.4),
        (looking(towards, 0.9, (0, 0.5, 3)), (0.1, 0.2, 0.3), 0.0),
        (looking(towards, 0.9, (0.3, 0, 5)), "transparent", 0.0),
        (looking(towards, 0.9, (0, 0, 4)), "environment", 0.0),
        (looking(towards, 0.9, (1.5, 0, 3)), "environment", 0.0),
    ]

    def picture(renderer: Renderer, view: int) -> list[NDArray[Any]]:
        camera, scene.background, scene.background_blur = views[view]
        commands = CommandList()
        renderer.draw(scene, camera, commands)
        reads = [renderer.read_radiance(commands)]
        reads.append(renderer.read_display(commands))
        device.submit(commands).wait()
        return [each.data.copy() for each in reads if each.data is not None]

    reused = Renderer(device, SIZE, settings)
    frames = [picture(reused, view) for view in range(len(views))]
    reused.close()
    for view, frame in enumerate(frames):
        fresh = Renderer(device, SIZE, settings)
        for read, expected in zip(frame, picture(fresh, view), strict=True):
            np.testing.assert_array_equal(read, expected)
        fresh.close()


def test_scenes_may_change_between_frames(device: GraphicsDevice) -> None:
    """Numbers, instances and shaders, for a renderer and one beside it."""
    material = Material(roughness_factor=0.4, metallic_factor=0.3)
    square = quad(0.3)
    scene = lit([(square, material, np.eye(4))])
    camera = looking((0, 0, -1), 0.9, (0, 0, 4))
    settings = RenderSettings(shading="visibility", float_output=True)
    renderer = Renderer(device, SIZE, settings)
    beside = Renderer(device, SIZE, settings, beside=renderer)

    def edit() -> None:
        scene.edit_material(material, base_colour_factor=(0.1, 0.8, 0.2, 1.0))

    def add(count: int) -> None:
        places = [placed_at(*xy, 0) for xy in np.ndindex(count, count)]
        scene.add(model_of([(square, material, each) for each in places]))

    def remove() -> None:
        scene.remove(scene.models[2])

    def hide() -> None:
        scene.models[0].visible = False

    pictures = []
    for change in (
        lambda: None,
        edit,
        lambda: add(2),
        lambda: add(4),
        remove,
        hide,
        renderer.reload_shaders,
    ):
        change()
        drawn = []
        # Frames in flight use what those after them let go.
        for each in (renderer, beside, renderer):
            commands = CommandList()
            each.draw(scene, camera, commands)
            drawn.append(each.read_radiance(commands))
            device.submit(commands)
        device.finish()
        assert renderer._targets.visibility is not None
        expected = draw_radiance(
            device, scene, camera, SIZE, samples=4, shading="visibility"
        )
        for read in drawn:
            assert read.data is not None
            np.testing.assert_array_equal(read.data[::-1], expected)
        pictures.append(expected)
    for before, after in pairwise(pictures[:-1]):
        assert (before != after).any()
    renderer.close()


def test_nothing_in_view_is_the_sky(device: GraphicsDevice) -> None:
    scene = lit(textured(), background="environment")
    away = looking((0, 0, 1), 0.9, (0, 0, 3))
    forward, seen = (
        draw_radiance(device, scene, away, SIZE, samples=4, shading=how)
        for how in ("forward", "visibility")
    )
    np.testing.assert_array_equal(seen, forward)
    assert forward[..., 3].min() == 1.0


def test_darkness_is_opaque(device: GraphicsDevice) -> None:
    """Without an environment its place is black, also around edges."""
    scene = scene_of(textured(), None, "environment")
    camera = looking((0, 0, -1), 0.9, (0, 0, 3))
    for samples in (1, 4):
        drawn = draw_radiance(
            device, scene, camera, SIZE, samples=samples, shading="visibility"
        )
        np.testing.assert_array_equal(drawn[..., 3], 1.0)


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize("scale", [1e-5, 1.0, 1e6])
@pytest.mark.parametrize("fov", [0.9, 0.0])
def test_crowded_triangles_of_any_size_are_finite(
    device: GraphicsDevice, samples: int, scale: float, fov: float
) -> None:
    """Fifty triangles a pixel, a box around the camera, both kinds of view."""
    detailed = sphere(0.5, 400, 200)
    size = np.diag((scale, scale, scale, 1.0))
    material = Material(base_colour_texture=noise(1), double_sided=True)
    around = cube(1.0), material, size @ np.diag((9.0, 9.0, 9.0, 1.0))
    scene = lit([(detailed, material, size), around])
    camera = looking((0, 0, -1), 1.0, (0, 0, 3 * scale))
    near, far = 0.01 * scale, 20 * scale
    camera.projection = (
        Perspective(fov, near=near)
        if fov
        else Orthographic(scale, scale, near, far)
    )
    pictures = [
        draw_radiance(
            device, scene, camera, (64, 64), samples=samples, shading=how
        )
        for how in ("forward", "visibility")
    ]
    forward, seen = (each[..., :3] for each in pictures)
    assert np.isfinite(seen).all()
    assert seen.min() >= 0
    assert forward.std() > 0
    off = np.abs(seen - forward).max(axis=-1)
    assert np.median(off) < 0.02 * np.median(forward)
    assert off.mean() < 0.05 * forward.mean()


def draws(
    device: GraphicsDevice,
    scene: Scene,
    towards: tuple[float, float, float] = (0, 0, -1),
    **settings: Any,
) -> int:
    """How many draws a frame has."""
    renderer = Renderer(
        device, SIZE, RenderSettings(**settings), statistics=Statistics()
    )
    commands = CommandList()
    renderer.draw(scene, looking(towards, 0.9, (0, 0, 3)), commands)
    counted = device.submit(commands).wait().gl_draws
    renderer.close()
    return counted


def test_draws_are_what_it_is_for(device: GraphicsDevice) -> None:
    scene = lit(textured())
    assert draws(device, scene, shading="forward") == 2
    # What is seen, which pixels that are, their shading, and the display.
    assert draws(device, scene, shading="visibility", samples=4) == 4
    assert draws(device, scene, shading="visibility", samples=1) == 3
    # Nothing is looked for where nothing has been drawn.
    assert draws(device, scene, (0, 0, 1), shading="visibility") == 1


def refused() -> dict[str, Items]:
    one, two = Material(), Material(base_colour_texture=noise(1))
    return {
        "blended": [(ball(), Material(alpha_mode=AlphaMode.BLEND), np.eye(4))],
        "masked": [(ball(), Material(alpha_mode=AlphaMode.MASK), np.eye(4))],
        "two programs": [
            (ball(), one, np.eye(4)),
            (ball(), two, placed_at(1)),
        ],
        "two textures": [
            (ball(), two, np.eye(4)),
            (
                ball(),
                Material(base_colour_texture=noise(2)),
                placed_at(1),
            ),
        ],
    }


@pytest.mark.parametrize("name", refused())
def test_what_it_cannot_show_is_shaded_as_it_is_drawn(
    device: GraphicsDevice, name: str
) -> None:
    scene = lit(refused()[name])
    forward = draws(device, scene, shading="forward")
    assert draws(device, scene, shading="visibility") == forward
    assert draws(device, scene) == forward


def test_it_is_chosen_where_it_pays(device: GraphicsDevice) -> None:
    def is_used(scene_items: Items, samples: int) -> bool:
        scene = lit(scene_items)
        chosen = draws(device, scene, samples=samples)
        return chosen != draws(
            device, scene, shading="forward", samples=samples
        )

    many = [(ball(), None, placed_at(0.1 * i, 0, 0)) for i in range(2)]
    on_software = device.info.is_software
    assert is_used(many, 4) == on_software
    assert is_used(textured() * 2, 1) == on_software
    assert not is_used(many, 1)
    assert not is_used([(cube(1.0), None, np.eye(4))], 4)
