"""Where boxes lie in a picture."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moka.model.cameras import Orthographic, Perspective
from moka.renderer.view import View, look_through
from moka.scene.camera import Camera

SIZE = (200, 120)


def view_from(
    eye: tuple[float, float, float],
    target: tuple[float, float, float] = (0, 0, 0),
    lens: Perspective | Orthographic | None = None,
) -> View:
    camera = Camera(lens or Perspective(0.9))
    camera.transform.translate(eye)
    camera.transform.look_at(target, (0, 1, 0))
    return look_through(camera, SIZE[0] / SIZE[1], reversed_z=True)


def places_of(view: View, points: np.ndarray) -> np.ndarray:
    """Where points (N, 3) are, in pixels from the lower left."""
    relative = np.column_stack([points - view.position, np.ones(len(points))])
    clip = relative @ view.clip_from_world.T
    return (clip[:, :2] / clip[:, 3:] * 0.5 + 0.5) * SIZE


LENSES = [Perspective(0.9), Perspective(0.1), Orthographic(2.0, 1.2, 0.1, 50)]
number = st.floats(-1.0, 1.0)


@given(
    st.tuples(number, number, number),
    st.tuples(number, number, number),
    st.tuples(number, number),
    st.sampled_from(LENSES),
)
@settings(max_examples=60, deadline=None)
def test_everything_in_a_box_is_in_its_rectangle(
    one: tuple[float, ...],
    other: tuple[float, ...],
    aside: tuple[float, float],
    lens: Perspective | Orthographic,
) -> None:
    box = np.sort(np.array([one, other]), axis=0)
    view = view_from((*aside, 4.0), lens=lens)
    rectangle = view.rectangle_of(box, SIZE)
    assert rectangle is not None
    left, bottom, width, height = rectangle
    points = np.random.default_rng(1).uniform(*box, (200, 3))
    for place in places_of(view, points):
        if (place >= 0).all() and (place < SIZE).all():
            assert left <= place[0] <= left + width
            assert bottom <= place[1] <= bottom + height
    assert 0 <= left <= left + width <= SIZE[0]
    assert 0 <= bottom <= bottom + height <= SIZE[1]


def test_it_is_no_larger_than_it_has_to_be() -> None:
    view = view_from((0, 0, 4), lens=Orthographic(2.0, 1.2, 0.1, 50))
    box = np.array([[-0.5, -0.3, -1.0], [0.5, 0.3, 1.0]])
    assert view.rectangle_of(box, SIZE) == (74, 44, 52, 32)


def test_what_reaches_behind_the_camera_may_be_anywhere() -> None:
    view = view_from((0, 0, 4))
    around = np.array([[-9.0, -9.0, -9.0], [9.0, 9.0, 9.0]])
    assert view.rectangle_of(around, SIZE) is None
    endless = np.array([[-1.0, -1.0, -np.inf], [1.0, 1.0, 1.0]])
    assert view.rectangle_of(endless, SIZE) is None
    nowhere = np.full((2, 3), np.nan)
    assert view.rectangle_of(nowhere, SIZE) is None


def test_what_lies_beside_the_picture_has_no_pixels() -> None:
    view = view_from((0, 0, 4))
    beside = np.array([[40.0, 0.0, -1.0], [41.0, 1.0, 0.0]])
    rectangle = view.rectangle_of(beside, SIZE)
    assert rectangle is not None
    assert rectangle[2] * rectangle[3] == 0
