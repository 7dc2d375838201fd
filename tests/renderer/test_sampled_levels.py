"""Levels that a still picture reads, against derivatives in float64."""

import math
from typing import Any

import numpy as np
import pytest

from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    Topology,
)
from moka.material.material import Material, Texture, TextureTransform
from moka.model.cameras import Orthographic, Perspective
from moka.model.geometry import quad, sphere
from moka.model.mesh import Primitive
from moka.renderer import sampled_levels
from moka.renderer.footprints import footprints
from moka.renderer.sampled_levels import SampledLevels, StillPicture
from moka.scene.camera import Camera
from tests.support.pictures import encoded, placed_at, scene_of, square_camera

IMAGE = encoded(np.zeros((4, 4, 3), np.uint8))
CLIP = Camera(Perspective(math.radians(60))).projection_matrix(
    1.0, reversed_z=True
)
SIZE = (100, 100)
HERE = np.eye(4)


def finest(
    primitive: Primitive,
    *,
    matrices: Any = (HERE,),
    camera: Camera | None = None,
    size: tuple[int, int] = (64, 64),
    texels: tuple[int, int] = (256, 256),
    double_sided: bool = False,
    **texture: Any,
) -> int:
    """The finest level of a texture on ``primitive`` at each matrix."""
    read = Texture(IMAGE, **texture)
    material = Material(base_colour_texture=read, double_sided=double_sided)
    scene = scene_of([(primitive, material, matrix) for matrix in matrices])
    scene.update()
    picture = StillPicture(scene, camera or square_camera(), size)
    reads = [(index, read) for index in picture.drawn]
    return SampledLevels(picture, reads).finest(*texels)


def numerical_steps(corners: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Steps (S, 2) at points of a triangle, by differences over rays.

    Coordinates are read where the ray through a pixel meets the plane; the
    focal length is that of ``CLIP``.
    """
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    edges = np.stack([corners[1] - corners[0], corners[2] - corners[0]])
    focal = 0.5 * SIZE[1] / math.tan(math.radians(30))

    def coordinates(pixels: np.ndarray) -> np.ndarray:
        rays = np.column_stack([pixels / focal, -np.ones(len(pixels))])
        points = rays * ((corners[0] @ normal) / (rays @ normal))[:, None]
        weights = (points - corners[0]) @ np.linalg.pinv(edges)
        return uv[0] + weights @ (uv[1:] - uv[0])

    inside = np.random.default_rng(5).dirichlet((1, 1, 1), 400)
    points = np.vstack([inside, np.eye(3)]) @ corners
    pixels = focal * points[:, :2] / -points[:, 2:]
    delta = 1e-4
    by_axis = [
        (coordinates(pixels + step) - coordinates(pixels - step)) / (2 * delta)
        for step in delta * np.eye(2)
    ]
    return np.abs(by_axis).max(axis=0)


@pytest.mark.parametrize("seed", range(20))
def test_steps_are_those_of_the_corners_and_hardly_less_inside(
    seed: int,
) -> None:
    """Exact at corners; between them nothing is a tenth below their least."""
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (3, 3)) - (0, 0, 4)
    uv = random.uniform(0, 2, (3, 2))
    measured = footprints(corners[None], uv[None], CLIP, SIZE, front=None)
    assert measured is not None
    exact = numerical_steps(corners, uv)
    least = exact[-3:].min(axis=0)
    assert measured.steps[:, 0] == pytest.approx(least, rel=1e-5)
    largest = exact.max(axis=1)
    assert measured.steps[:, 0].max() <= 1.1 * largest.min()


def test_areas_are_in_pixels_and_end_at_the_edges() -> None:
    corners = np.array([[(-1, -1, -2), (1, -1, -2), (-1, 1, -2)]], np.float64)
    uv = np.array([[(0, 0), (1, 0), (0, 1)]], np.float64)
    measured = footprints(corners, uv, CLIP, SIZE, front=1)
    assert measured is not None
    focal = 50 / math.tan(math.radians(30))
    assert measured.areas == pytest.approx([0.5 * (2 * focal / 2) ** 2])
    large = footprints(100 * corners + (0, 0, 190), uv, CLIP, SIZE, front=1)
    assert large is not None
    assert large.areas == pytest.approx([SIZE[0] * SIZE[1]])


@pytest.mark.parametrize(
    ("side", "level"), [(32, 3), (63, 2), (64, 2), (65, 1), (128, 1), (129, 0)]
)
def test_a_square_reads_the_level_of_its_size(side: int, level: int) -> None:
    """256 texels over ``side`` pixels: a step of 256 / side."""
    assert finest(quad(2.0), size=(side, side)) == level


def test_the_longer_side_decides() -> None:
    """As every driver has it: OpenGL 4.6, 8.14.1."""
    assert finest(quad(2.0), texels=(1024, 64)) == 4
    assert finest(quad(2.0), texels=(128, 128)) == 1


def test_the_nearest_of_several_decides() -> None:
    far = Camera(Perspective(math.radians(60)))
    matrices = [placed_at(z=-4), placed_at(x=3, z=-8)]
    both = finest(quad(2.0), matrices=matrices, camera=far, size=(256, 256))
    one = finest(quad(2.0), matrices=matrices[1:], camera=far, size=(256, 256))
    assert (both, one) == (1, 2)


def test_transforms_of_coordinates_count() -> None:
    """Eight times as many texels in a pixel are three levels."""
    eight = TextureTransform(scale=(8.0, 8.0), offset=(0.3, 0.1), rotation=0.0)
    assert finest(quad(2.0), transform=eight) == 5
    eighth = TextureTransform(scale=(0.125, 0.125))
    assert finest(quad(2.0), transform=eighth) == 0


@pytest.mark.parametrize(
    ("sampler", "level"),
    [
        (SamplerDescriptor(), 2),
        (SamplerDescriptor(mipmap=MipmapMode.NEAREST), 2),
        (SamplerDescriptor(mipmap=MipmapMode.NONE), 0),
        # It would magnify up to half a level, with another filter.
        (SamplerDescriptor(minify=Filter.NEAREST), 1),
        (SamplerDescriptor(minify=Filter.NEAREST, magnify=Filter.NEAREST), 2),
        (SamplerDescriptor(anisotropy=4.0), 0),
    ],
)
def test_the_sampler_decides_with(
    sampler: SamplerDescriptor, level: int
) -> None:
    assert finest(quad(2.0), sampler=sampler) == level


def test_slivers_are_negligible_and_larger_parts_are_not() -> None:
    """Collapsed coordinates on a thousandth of the area, and on a tenth."""
    whole = np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])
    for part, level in ((0.0004, 2), (0.1, 0)):
        sliver = whole * (part, 1) + (1 + part, 0)
        corners = np.vstack([whole, sliver])
        shape = Primitive(
            {
                "POSITION": np.column_stack([corners, np.zeros(8)]),
                "TEXCOORD_0": np.vstack([0.5 * whole, 0 * whole]),
            },
            np.array([0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7]),
        )
        camera = square_camera(1.25)
        assert finest(shape, camera=camera, size=(80, 80)) == level


def test_what_faces_away_reads_nothing() -> None:
    turned = np.diag([-1.0, 1.0, -1.0, 1.0])
    assert finest(quad(2.0), matrices=[turned]) == 8
    assert finest(quad(2.0), matrices=[turned], double_sided=True) == 2
    mirrored = np.diag([-1.0, 1.0, 1.0, 1.0])
    assert finest(quad(2.0), matrices=[mirrored]) == 2


def test_a_surface_that_reaches_behind_the_camera_is_read_in_full() -> None:
    floor = placed_at(y=-1)
    floor[:3, :3] = 50 * np.array([(1, 0, 0), (0, 0, 1), (0, -1, 0)])
    camera = Camera(Perspective(math.radians(60)))
    assert finest(quad(2.0), matrices=[floor], camera=camera) == 0


def test_what_is_not_clear_is_read_in_full() -> None:
    square = quad(2.0)
    points = Primitive(square.attributes, topology=Topology.POINTS)
    assert finest(points) == 0
    huge = np.diag([1e200, 1e200, 1.0, 1.0])
    assert finest(square, matrices=[huge]) == 0


def test_many_triangles_for_few_texels_are_not_measured() -> None:
    fine = sphere(1.0, 64, 64)
    camera = Camera(Orthographic(1, 1, 0.0, 100.0))
    camera.transform.translate((0, 0, 5))
    assert finest(fine, camera=camera, size=(8, 8), texels=(1024, 1024)) > 0
    assert finest(fine, camera=camera, size=(8, 8), texels=(256, 256)) == 0


@pytest.mark.parametrize("side", [16, 33, 48, 300, 700])
def test_a_look_at_a_part_first_changes_nothing(
    side: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And measures fewer triangles where all levels are needed."""
    counts = []

    def counted(positions: np.ndarray, *rest: Any, **named: Any) -> Any:
        counts[-1] += len(positions)
        return footprints(positions, *rest, **named)

    monkeypatch.setattr(sampled_levels, "footprints", counted)
    levels = []
    for many in (1 << 30, 0):
        monkeypatch.setattr(sampled_levels, "_MANY", many)
        counts.append(0)
        levels.append(
            finest(sphere(1.0, 64, 48), size=(side, side), texels=(1024, 512))
        )
    assert levels[0] == levels[1]
    if not levels[0]:
        assert counts[1] < counts[0] / 10


def test_a_picture_ends_when_anything_moves() -> None:
    scene = scene_of([(quad(2.0), None, placed_at())])
    scene.update()
    camera = square_camera()
    picture = StillPicture(scene, camera, SIZE)
    assert picture.shows(scene, camera, SIZE)
    assert not picture.shows(scene, camera, (100, 99))
    camera.transform.translate((0, 0, 1))
    assert not picture.shows(scene, camera, SIZE)
    camera.transform.translate((0, 0, -1))
    assert picture.shows(scene, camera, SIZE)
    scene.models[0].transform.translate((0, 0, -1))
    scene.update()
    assert not picture.shows(scene, camera, SIZE)
