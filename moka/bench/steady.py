"""Times frames of one scene, each finished before the next begins."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from msgspec.structs import asdict
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.renderer.renderer import Renderer
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = ["FrameTimes", "Orbit", "time_frames"]


@dataclass(frozen=True, slots=True)
class FrameTimes:
    """Times (N,) of N frames in milliseconds, and counters of the last.

    ``frame_ms`` is from the start of a frame until the GPU has finished it,
    ``submit_ms`` the part of it in which Python updates, draws and submits,
    ``cpu_ms`` the time of all threads, which hold a software driver.
    """

    frame_ms: NDArray[np.float64]
    submit_ms: NDArray[np.float64]
    cpu_ms: NDArray[np.float64]
    counts: dict[str, int]


class Orbit:
    """Moves a camera around a scene, which it frames, by equal steps."""

    def __init__(
        self, scene: Scene, camera: Camera, aspect: float, step: float
    ) -> None:
        """``step`` is the yaw from frame to frame, in radians."""
        self._camera = camera
        self._aspect = aspect
        self._step = step
        self._bounds = scene.bounds()

    def __call__(self, frame: int) -> None:
        """Place the camera for ``frame``."""
        self._camera.frame(self._bounds, self._aspect, yaw=frame * self._step)


def time_frames(
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    advance: Callable[[int], None],
    frames: int,
    warm_up: int = 3,
    *,
    between: Callable[[], object] | None = None,
) -> FrameTimes:
    """Draw ``warm_up`` frames untimed and ``frames`` timed ones.

    ``advance`` is called with the number of each and moves things. The
    first frames compile and upload, and a software driver compiles once
    more when it sees the first draws. ``between`` is called after every
    frame, untimed.
    """
    device = renderer.device
    times = np.empty((3, warm_up + frames))
    for number in range(warm_up + frames):
        cpu, start = time.process_time(), time.perf_counter()
        advance(number)
        commands = CommandList()
        renderer.draw(scene, camera, commands)
        frame = device.submit(commands)
        submitted = time.perf_counter()
        device.finish()
        finished = time.perf_counter()
        times[:, number] = (
            finished - start,
            submitted - start,
            time.process_time() - cpu,
        )
        if between is not None:
            between()
    counters = frame.wait()
    frame_ms, submit_ms, cpu_ms = 1000.0 * times[:, warm_up:]
    return FrameTimes(
        frame_ms,
        submit_ms,
        cpu_ms,
        renderer.statistics.counts | asdict(counters),
    )
