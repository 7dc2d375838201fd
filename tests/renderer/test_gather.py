"""Draws of a frame: in order, and the same ones for as long as they serve."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from moka.commands.sort_key import SortKey, unpack_key
from moka.model.assemble import model_of
from moka.model.geometry import cube
from moka.renderer.gather import DrawGatherer
from moka.renderer.prepared_scene import _ROW
from moka.renderer.view import View, look_through
from moka.scene.camera import Camera
from moka.scene.scene import Scene

STATES = np.array([5, 6], np.uint32)


def scene_of_cubes(count: int) -> Scene:
    """Cubes in no order along the view axis, each a model of its own."""
    scene = Scene()
    for z in np.random.default_rng(1).permutation(count):
        matrix = np.eye(4)
        matrix[:3, 3] = 0.1 * z, 0, -2.0 * z
        scene.add(model_of([(cube(), None, np.eye(4))]), matrix)
    scene.update()
    return scene


def gatherer(scene: Scene, blended: int = 0) -> DrawGatherer:
    """The last ``blended`` primitives are blended, in a later layer."""
    rows = np.zeros(len(scene.drawables.primitives), _ROW)
    rows["program"] = np.arange(len(rows)) % 2
    last = slice(len(rows) - blended, None)
    rows["blended"][last] = True
    rows["layer"][last] = 3
    prepared: Any = SimpleNamespace(rows=rows)
    return DrawGatherer(scene.drawables, prepared, 1)


def view_from(x: float = 0.0, z: float = 8.0, yaw: float = 0.0) -> View:
    camera = Camera()
    camera.transform.rotate((0, 1, 0), yaw)
    camera.transform.translate((x, 0, z))
    return look_through(camera, 1.0, reversed_z=True)


def gather(
    draws: DrawGatherer, scene: Scene, view: View
) -> tuple[np.ndarray, np.ndarray]:
    everything = np.arange(len(scene.drawables))
    return draws.gather(scene.transforms, everything, view, STATES)


def test_rows_are_in_the_order_of_their_keys() -> None:
    scene = scene_of_cubes(20)
    view = view_from()
    rows, instances = gather(gatherer(scene, blended=6), scene, view)
    keys = [unpack_key(key) for key in rows["key"].tolist()]
    assert rows["key"].tolist() == sorted(rows["key"].tolist())
    assert rows["first_instance"].tolist() == list(range(20))
    depths = -(instances["transform"][:, 2, 3])
    for key, depth in zip(keys, depths.tolist(), strict=True):
        assert key.pass_ == 1
        assert key.depth == pytest.approx(depth, rel=0.01)
    blended = [key.depth for key in keys if key.layer == 3]
    assert len(blended) == 6
    assert blended == sorted(blended, reverse=True)
    for program in (0, 1):
        opaque = [
            key.depth
            for key in keys
            if key.layer == 0 and key.program == program
        ]
        assert len(opaque) == 7
        assert opaque == sorted(opaque)


def test_a_camera_that_moved_little_keeps_the_order() -> None:
    """And none of the places: they are exact in every frame."""
    scene = scene_of_cubes(20)
    draws = gatherer(scene)
    first, _ = gather(draws, scene, view_from())
    view = view_from(0.5, 8.25, 0.02)
    again, instances = gather(draws, scene, view)
    assert again is first
    fresh, exact = gather(gatherer(scene), scene, view)
    for name in ("transform", "object"):
        both = [
            each[name][np.argsort(each["object"])]
            for each in (instances, exact)
        ]
        assert np.array_equal(*both)
    assert fresh is not first


@pytest.mark.parametrize(
    "view", [view_from(z=-60.0), view_from(x=9.0), view_from(yaw=math.pi)]
)
def test_a_camera_that_moved_far_sorts_anew(view: View) -> None:
    scene = scene_of_cubes(20)
    draws = gatherer(scene)
    first, _ = gather(draws, scene, view_from())
    again, _ = gather(draws, scene, view)
    fresh, _ = gather(gatherer(scene), scene, view)
    assert again is not first
    assert again.tolist() == fresh.tolist()


def test_what_moved_and_what_is_blended_is_sorted_in_every_frame() -> None:
    scene = scene_of_cubes(8)
    draws = gatherer(scene)
    view = view_from()
    first, _ = gather(draws, scene, view)
    scene.models[3].transform.translate((0, 0, -100))
    scene.update()
    rows, instances = gather(draws, scene, view)
    assert rows is not first
    assert instances["transform"][:, 2, 3].min() < -100
    draws = gatherer(scene, blended=1)
    first, _ = gather(draws, scene, view)
    assert gather(draws, scene, view)[0] is not first


def test_other_visible_draws_are_other_rows() -> None:
    scene = scene_of_cubes(8)
    draws = gatherer(scene)
    view = view_from()
    gather(draws, scene, view)
    some = np.array([1, 4, 6])
    rows, instances = draws.gather(scene.transforms, some, view, STATES)
    assert sorted(instances["object"].tolist()) == sorted(
        scene.drawables.object[some].tolist()
    )
    assert len(rows) == 3
    assert int(rows["key"][0]) >= int(SortKey(1))
