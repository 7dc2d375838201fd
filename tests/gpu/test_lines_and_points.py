"""Every topology of glTF: sizes in pixels, order, shading without normals."""

import math

import numpy as np
import pytest

from moka.commands.descriptors import Topology
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import Material
from moka.model.cameras import Perspective
from moka.model.geometry import quad
from moka.model.lights import LightKind, PunctualLight
from moka.model.mesh import Primitive
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.pictures import draw_radiance, scene_of, square_camera

pytestmark = pytest.mark.gpu

WHITE = Material(unlit=True)
BACKGROUND = "transparent"
FURNACE = Environment.uniform((1.0, 1.0, 1.0))


def pixel(column: float, row: float, size: int = 32) -> tuple[float, ...]:
    """A point at a place of a square picture of ``square_camera()``."""
    return 2 * column / size - 1, 1 - 2 * row / size, 0.0


def shape(
    topology: Topology,
    places: list[tuple[float, ...]],
    indices: list[int] | None = None,
    **attributes: object,
) -> Primitive:
    return Primitive(
        {"POSITION": places, **attributes}, indices, topology=topology
    )


def shown(primitive: Primitive, material: Material = WHITE) -> Scene:
    return scene_of([(primitive, material, np.eye(4))], background=BACKGROUND)


def alpha(
    device: GraphicsDevice,
    scene: Scene,
    size: tuple[int, int] = (32, 32),
    **settings: object,
) -> np.ndarray:
    """Coverage (H, W), the top row first."""
    settings.setdefault("samples", 1)
    return draw_radiance(device, scene, square_camera(), size, **settings)[
        :, :, 3
    ]


@pytest.mark.parametrize("upright", [False, True])
def test_a_line_is_a_pixel_wide(
    egl_device: GraphicsDevice, upright: bool
) -> None:
    places = [pixel(4, 10.5), pixel(20, 10.5)]
    if upright:
        places = [pixel(10.5, 4), pixel(10.5, 20)]
    covered = alpha(egl_device, shown(shape(Topology.LINES, places)))
    expected = np.zeros((32, 32))
    expected[10, 4:20] = 1
    assert np.array_equal(covered, expected.T if upright else expected)


def test_lines_widen_with_the_picture(egl_device: GraphicsDevice) -> None:
    """One pixel at 720 rows are three at 2160."""
    line = shape(Topology.LINES, [(-1, 0, 0), (1, 0, 0)])
    covered = alpha(egl_device, shown(line), (4, 2160))
    assert covered.sum(axis=0).tolist() == [3] * 4
    assert covered[1078:1082, 0].tolist() in ([1, 1, 1, 0], [0, 1, 1, 1])


def test_slanted_lines_cover_their_area(egl_device: GraphicsDevice) -> None:
    """With multisampling, as much as a rectangle one pixel wide."""
    places = [pixel(3, 5), pixel(27, 23)]
    covered = alpha(egl_device, shown(shape(Topology.LINES, places)), samples=4)
    length = math.hypot(24, 18)
    assert covered.sum() == pytest.approx(length, rel=0.05)
    assert len(np.unique(covered)) > 2


def test_strips_and_loops_are_lists_of_their_segments(
    egl_device: GraphicsDevice,
) -> None:
    random = np.random.default_rng(2)
    places = [pixel(*place) for place in random.uniform(2, 30, (7, 2))]
    order = random.permutation(7).tolist()
    segments = {
        Topology.LINES: [(0, 1), (2, 3), (4, 5)],
        Topology.LINE_STRIP: [(i, i + 1) for i in range(6)],
        Topology.LINE_LOOP: [(i, (i + 1) % 7) for i in range(7)],
    }
    for topology, pairs in segments.items():
        for indices in (None, order):
            taken = indices or list(range(7))
            listed = shape(
                Topology.LINES, places, [taken[i] for p in pairs for i in p]
            )
            pictures = [
                alpha(egl_device, shown(each), samples=4)
                for each in (shape(topology, places, indices), listed)
            ]
            assert pictures[0].any()
            assert np.array_equal(*pictures), topology


@pytest.mark.parametrize("count", [1, 2])
def test_lines_without_length_draw_nothing(
    egl_device: GraphicsDevice, count: int
) -> None:
    for topology in (Topology.LINES, Topology.LINE_STRIP, Topology.LINE_LOOP):
        line = shape(topology, [pixel(16.5, 16.5)] * count)
        assert not alpha(egl_device, shown(line)).any()


def test_colours_run_along_a_line(egl_device: GraphicsDevice) -> None:
    line = shape(
        Topology.LINES,
        [pixel(0, 16.5), pixel(32, 16.5)],
        COLOR_0=[(0, 1, 0, 1), (1, 0, 0, 1)],
    )
    picture = draw_radiance(egl_device, shown(line), square_camera(), samples=1)
    along = (np.arange(32) + 0.5) / 32
    assert picture[16, :, 0] == pytest.approx(along, abs=2e-3)
    assert picture[16, :, 1] == pytest.approx(1 - along, abs=2e-3)


def test_lines_reach_behind_the_camera(egl_device: GraphicsDevice) -> None:
    """From far ahead, below the camera, to far behind it: down the middle."""
    line = shape(Topology.LINES, [(0, -1, -1000), (0, -1, 500)])
    for places in (slice(None), slice(None, None, -1)):
        turned = shape(
            Topology.LINES, line.attributes["POSITION"][places].tolist()
        )
        camera = Camera(Perspective(math.pi / 2, 0.01))
        picture = draw_radiance(
            egl_device, shown(turned), camera, (33, 33), samples=1
        )[:, :, 3]
        assert picture[18:, 16].all()
        assert picture[:, :16].sum() == picture[:, 17:].sum() == 0
        assert not picture[:16].any()
    # Wholly behind, nothing is to be seen.
    behind = shape(Topology.LINES, [(0, -1, 10), (0, 1, 500)])
    assert not draw_radiance(
        egl_device, shown(behind), Camera(), (33, 33)
    ).any()


def test_lines_hide_and_are_hidden(egl_device: GraphicsDevice) -> None:
    line = shape(Topology.LINES, [(-1, 0.03, 0), (1, 0.03, 0)])
    red = Material(unlit=True, base_colour_factor=(1, 0, 0, 1))
    for z, seen in ((-0.5, True), (0.5, False)):
        place = np.eye(4)
        place[2, 3] = z
        scene = scene_of([(line, WHITE, np.eye(4)), (quad(2.0), red, place)])
        picture = draw_radiance(egl_device, scene, square_camera(), samples=1)
        assert bool(picture[:, 16, 1].any()) is seen


def test_points_are_squares_of_a_part_of_the_height(
    egl_device: GraphicsDevice,
) -> None:
    for height, side in ((32, 1), (720, 2), (1440, 4)):
        points = shape(Topology.POINTS, [(0, 0, 0)])
        covered = alpha(egl_device, shown(points), (height, height))
        rows, columns = np.nonzero(covered)
        # A point on the corner of four pixels may take any of them.
        assert len(rows) == side * side
        assert np.ptp(rows) == np.ptp(columns) == side - 1
        assert abs(rows.mean() + 0.5 - height / 2) <= 0.5


def test_points_may_be_indexed(egl_device: GraphicsDevice) -> None:
    places = [pixel(column + 0.5, 8.5) for column in range(32)]
    points = shape(Topology.POINTS, places, [3, 9, 27])
    covered = alpha(egl_device, shown(points))
    assert np.argwhere(covered).tolist() == [[8, 3], [8, 9], [8, 27]]


@pytest.mark.parametrize(
    "topology", [Topology.TRIANGLE_STRIP, Topology.TRIANGLE_FAN]
)
@pytest.mark.parametrize("indexed", [False, True])
def test_strips_and_fans_are_lists_of_their_triangles(
    egl_device: GraphicsDevice, topology: Topology, indexed: bool
) -> None:
    """Wound alike too: back faces are culled, colours tell vertices apart."""
    random = np.random.default_rng(7)
    angles = np.linspace(0, 1.5 * np.pi, 8)
    if topology is Topology.TRIANGLE_FAN:
        places = [(0, 0, 0)] + [
            (0.9 * math.cos(a), 0.9 * math.sin(a), 0) for a in angles[:7]
        ]
    else:
        places = [
            (x / 4 - 0.9, 0.5 if x % 2 == 0 else -0.5, 0) for x in range(8)
        ]
    colours = np.append(random.random((8, 3)), np.ones((8, 1)), axis=1)
    indices = None
    if indexed:
        order = random.permutation(8)
        places = np.array(places)[np.argsort(order)].tolist()
        indices = order.tolist()
    one = shape(topology, places, indices, COLOR_0=colours)
    taken = indices or list(range(8))
    triangles = (
        [(i + 1, i + 2, 0) for i in range(6)]
        if topology is Topology.TRIANGLE_FAN
        else [(i, i + 1 + i % 2, i + 2 - i % 2) for i in range(6)]
    )
    listed = shape(
        Topology.TRIANGLES,
        places,
        [taken[i] for corners in triangles for i in corners],
        COLOR_0=colours,
    )
    pictures = [
        draw_radiance(egl_device, shown(each), square_camera(), samples=1)
        for each in (one, listed)
    ]
    assert (pictures[0][:, :, 3] > 0).sum() > 100
    assert np.allclose(*pictures, atol=2e-3)


def test_no_index_restarts_a_strip(egl_device: GraphicsDevice) -> None:
    """65535 is a vertex like any other, though files should not name it."""
    places = np.zeros((65536, 3), np.float32)
    places[[0, 1, 65535, 2]] = [
        (-1, 1, 0),
        (-1, -1, 0),
        (1, 1, 0),
        (1, -1, 0),
    ]
    strip = Primitive(
        {"POSITION": places},
        np.array([0, 1, 65535, 2], np.uint16),
        topology=Topology.TRIANGLE_STRIP,
    )
    assert alpha(egl_device, shown(strip)).all()


@pytest.mark.parametrize("topology", [Topology.POINTS, Topology.LINES])
def test_without_normals_there_is_no_light_but_emission(
    egl_device: GraphicsDevice, topology: Topology
) -> None:
    """Base colour, vertex colour and emission are summed (section 3.9.7)."""
    material = Material(
        base_colour_factor=(0.5, 0.25, 0.125, 1), emissive_factor=(0, 0, 0.5)
    )
    places = [pixel(8.5, 16.5), pixel(24.5, 16.5)]
    thing = shape(topology, places, COLOR_0=[(1, 0.5, 1, 1)] * 2)
    scene = scene_of(
        [(thing, material, np.eye(4))], FURNACE, background=BACKGROUND
    )
    picture = draw_radiance(egl_device, scene, square_camera(), samples=1)
    assert picture[16, 8, :3] == pytest.approx((0.5, 0.125, 0.625), abs=1e-3)


@pytest.mark.parametrize("topology", [Topology.POINTS, Topology.LINES])
@pytest.mark.parametrize("mirrored", [False, True])
def test_with_normals_they_are_lit_like_surfaces(
    egl_device: GraphicsDevice, topology: Topology, mirrored: bool
) -> None:
    material = Material(
        metallic_factor=0.0, roughness_factor=1.0, double_sided=True
    )
    light = PunctualLight(LightKind.DIRECTIONAL, intensity=math.pi)
    places = [pixel(8.5, 16.5), pixel(24.5, 16.5)]
    normal = (0.0, 0.6, 0.8)
    thing = shape(topology, places, NORMAL=[normal] * 2)
    plane = quad(4.0)
    surface = Primitive(
        {**plane.attributes, "NORMAL": [normal] * 4}, plane.indices
    )
    place = np.diag([-1.0 if mirrored else 1.0, 1.0, 1.0, 1.0])
    shades = [
        draw_radiance(
            egl_device,
            scene_of([(each, material, place)], lights=[(light, np.eye(4))]),
            square_camera(),
            samples=1,
            multiscatter=False,
        )
        for each in (thing, surface)
    ]
    column = 16
    if topology is Topology.POINTS:
        column = 23 if mirrored else 8
    assert shades[1][16, column, 0] > 0.7
    assert shades[0][16, column] == pytest.approx(
        shades[1][16, column], abs=2e-3
    )


def test_a_cloud_of_a_million_points(egl_device: GraphicsDevice) -> None:
    """Every pixel shows the nearest of its thousand points."""
    side, layers = 32, 1000
    column, row = np.meshgrid(np.arange(side), np.arange(side))
    flat = np.stack(
        [
            2 * (column.ravel() + 0.5) / side - 1,
            1 - 2 * (row.ravel() + 0.5) / side,
        ],
        axis=1,
    )
    random = np.random.default_rng(3)
    depth = random.permuted(
        np.tile(np.linspace(-1, 1, layers), (len(flat), 1)), axis=1
    )
    places = np.empty((layers, len(flat), 3), np.float32)
    places[..., :2] = flat
    places[..., 2] = depth.T
    shade = random.random((layers, len(flat))).astype(np.float32)
    colours = np.ones((layers, len(flat), 4), np.float32)
    colours[..., 0] = shade
    cloud = Primitive(
        {"POSITION": places.reshape(-1, 3), "COLOR_0": colours.reshape(-1, 4)},
        topology=Topology.POINTS,
    )
    assert cloud.vertex_count > 1_000_000
    picture = draw_radiance(egl_device, shown(cloud), square_camera())
    nearest = shade[depth.argmax(axis=1), np.arange(len(flat))]
    assert picture[:, :, 0] == pytest.approx(
        nearest.reshape(side, side), abs=1e-6
    )
