"""Pictures of what moves: an animation, a camera that goes around, or both."""

import math
from collections.abc import Callable, Collection, Iterator
from typing import Any

import numpy as np
from msgspec import Struct

from moka.app.render_request import RenderRequest, request_of
from moka.app.render_session import PendingImage, RenderSession
from moka.core.errors import OptionError
from moka.core.image import Image
from moka.core.statistics import Statistics
from moka.scene.camera import Camera
from moka.scene.transform import Transform

__all__ = ["FramesRequest", "frame_count", "render_frames", "request_frames"]

TURNTABLE_FRAMES = 120

# More frames than this are a slip of the finger.
MOST_FRAMES = 1_000_000


class FramesRequest(Struct, frozen=True):
    """What moves, and how often a picture is taken.

    ``frames`` is how many, None for those of one run of the animation, or
    120 of a model that has none. With ``turntable`` the camera goes once
    around the scene, counter-clockwise seen from above; the lights stay. An
    animated model moves on by 1 / ``frames_per_second`` from picture to
    picture, and begins again when its animation has ended.
    """

    frames: int | None = None
    turntable: bool = False
    frames_per_second: float = 30.0

    def check(self) -> None:
        """Raise OptionError for values that mean nothing."""
        if self.frames is not None and not 1 <= self.frames <= MOST_FRAMES:
            raise OptionError(
                f"frames: {self.frames} is not between 1 and {MOST_FRAMES}"
            )
        if not 0 < self.frames_per_second <= 1000:
            raise OptionError(
                f"frames per second: {self.frames_per_second:g} is not above "
                "0 and at most 1000"
            )


def render_frames(
    source: Any = None,
    *,
    frames: int | None = None,
    turntable: bool = False,
    frames_per_second: float = 30.0,
    cache: bool = True,
    **options: Any,
) -> Iterator[Image]:
    """Render a sequence of pictures headless, one after the other.

    ``frames`` is how many, by default those of one run of the animation, or
    120 of a model that has none. An animated model moves on by
    1 / ``frames_per_second`` seconds from picture to picture, from ``time``
    on and around when it ends; with ``turntable`` the camera goes once around
    the middle of the scene, counter-clockwise seen from above, while model
    and environment stay. ``options`` are those of :func:`moka.render`.

    Yields :class:`moka.Image`; while one is looked at, the next is drawn.
    Stop early by closing the iterator. Raises what :func:`moka.render` does,
    and OptionError where nothing would move.
    """
    wanted = FramesRequest(frames, turntable, frames_per_second)
    request = request_of(source, **options)
    for _, image in request_frames(
        request,
        wanted,
        Statistics(),
        want_pixels=True,
        want_display=True,
        cache=cache,
    ):
        yield image


def request_frames(
    request: RenderRequest,
    wanted: FramesRequest,
    statistics: Statistics,
    *,
    want_pixels: bool,
    want_display: bool,
    debug: bool = False,
    cache: bool = False,
    announce: Callable[[int], Collection[int]] | None = None,
) -> Iterator[tuple[int, Image]]:
    """The pictures of :func:`render_frames` with their numbers from 0.

    ``announce`` is told how many there will be, and tells which of them are
    not needed.
    """
    wanted.check()
    with RenderSession.open(
        request, statistics, debug=debug, cache=cache, moves=True
    ) as session:
        count = frame_count(session, wanted)
        unneeded = announce(count) if announce is not None else ()
        start = session.camera
        centre = _centre(session)
        waiting: tuple[int, PendingImage] | None = None
        for number in range(count):
            if number in unneeded:
                continue
            session.pose(_time(session, number / wanted.frames_per_second))
            if wanted.turntable:
                session.camera = _turned(
                    start, centre, 2.0 * math.pi * number / count
                )
            pending = session.submit(
                want_pixels=want_pixels, want_display=want_display
            )
            # While the next one is drawn, whoever asked has this one.
            if waiting is not None:
                yield waiting[0], waiting[1].wait()
            waiting = number, pending
        if waiting is not None:
            yield waiting[0], waiting[1].wait()
        session.report()
        session.keep_lighting()


def frame_count(session: RenderSession, wanted: FramesRequest) -> int:
    """How many pictures there will be.

    Raises OptionError where they would all be the same.
    """
    animations = session.model.model.animations
    if not animations and not wanted.turntable:
        raise OptionError(
            "frames: nothing moves, the model has no animation; try a turntable"
        )
    if wanted.frames is not None:
        return wanted.frames
    if not animations:
        return TURNTABLE_FRAMES
    duration = session.animation_duration - session.request.time
    return max(1, math.ceil(duration * wanted.frames_per_second - 1e-9))


def _time(session: RenderSession, passed: float) -> float:
    """The time of the pose when ``passed`` seconds have gone by."""
    duration = session.animation_duration
    time = session.request.time + passed
    # The end itself is shown, unless it is where the next run begins.
    return time % duration if duration and time > duration else time


def _centre(session: RenderSession) -> Any:
    bounds = session.scene.bounds()
    return np.zeros(3) if bounds is None else np.mean(bounds, axis=0)


def _turned(camera: Camera, centre: Any, angle: float) -> Camera:
    """``camera`` gone ``angle`` radians around the vertical at ``centre``."""
    turned = Camera(
        camera.projection, Transform.from_matrix(camera.transform.world_matrix)
    )
    turned.transform.rotate_around(centre, (0, 1, 0), angle)
    return turned
