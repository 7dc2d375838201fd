"""How far a mode of lighting is from the reference, for what is seen now.

Both are rendered off screen, through the centres of the same pixels and
without multisampling, so that all that differs is the light. The figures are
those of docs/accuracy.md, of objects where that has spheres.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.core.errors import MokaError
from moka.graphics.device import Frame
from moka.renderer.convergence import Schedule
from moka.renderer.light_sources import MadeLighting
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.renderer.surface_values import unpack_values
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = ["ErrorMeasurement", "LightingError", "lighting_error"]

#: Samples a pixel of the truth.
SAMPLES = 256

# Of a smaller picture of the same view, which has the same error.
_MOST_PIXELS = 192 * 108

# Frames off screen for each that the window draws.
_FRAMES_PER_STEP = 4

# An object of fewer pixels is no sphere of any size.
_FEWEST_PIXELS = 16


class LightingError(Struct, frozen=True):
    """Errors over the visible pixels.

    ``relative_rmse`` is the root mean square error of an object over its
    mean radiance, as the mean over objects; ``median`` the median over
    pixels and channels of the relative error. ``pixels`` are those that
    were compared, ``truth_error`` the relative standard error of the truth
    itself in the worst tile, None where it is not known.
    """

    relative_rmse: float
    median: float
    pixels: int
    truth_error: float | None = None


def lighting_error(
    truth: NDArray[np.floating],
    picture: NDArray[np.floating],
    objects: NDArray[np.integer],
) -> LightingError | None:
    """Compare radiance (H, W, 3 or more) where ``objects`` (H, W) is not 0.

    None where nothing is to be seen, or nothing is lit.
    """
    seen = objects != 0
    expected = np.asarray(truth, np.float64)[seen, :3]
    difference = np.asarray(picture, np.float64)[seen, :3] - expected
    errors = []
    numbers = objects[seen]
    found = np.unique(numbers, return_counts=True)
    for number, pixels in zip(*found, strict=True):
        own = numbers == number
        mean = float(expected[own].mean())
        if mean > 0.0 and pixels >= _FEWEST_PIXELS:
            square = float(np.mean(difference[own] ** 2))
            errors.append(math.sqrt(square) / mean)
    lit = expected > 0.0
    if not errors or not lit.any():
        return None
    relative = np.abs(difference[lit]) / expected[lit]
    return LightingError(
        sum(errors) / len(errors), float(np.median(relative)), int(seen.sum())
    )


class ErrorMeasurement:
    """A measurement that goes on a little in each frame of a window.

    ``beside`` is the renderer of the view, whose ``settings`` are measured.
    Call :meth:`step` until it ``is_done``; then ``result`` is there, unless
    nothing was lit. ``progress`` is 0 to 1. While it ``waits`` for
    :meth:`prepare`, which may go before, steps do nothing.
    """

    def __init__(
        self, beside: Renderer, scene: Scene, camera: Camera, samples: int
    ) -> None:
        width, height = beside.size
        scale = min(1.0, math.sqrt(_MOST_PIXELS / (width * height)))
        self.measured = beside.settings
        self.result: LightingError | None = None
        self.progress = 0.0
        self.is_done = False
        self.waits = False
        self._plain = replace(self.measured, samples=1, float_output=True)
        self._truth = replace(
            self._plain,
            ibl="reference",
            reference_samples=samples,
            max_error=None,
        )
        self._light: dict[str, MadeLighting | None] = {}
        self._scene = scene
        self._camera = _copied(camera)
        self._renderer = Renderer(
            beside.device,
            (max(round(width * scale), 1), max(round(height * scale), 1)),
            beside=beside,
        )
        self._renderer.at_centres = True
        self._samples = samples
        self._steps = self._measure()
        self._frame: Frame | None = None

    def prepare(self, told: Callable[[int, int], None]) -> None:
        """Make what lights both pictures; on a thread that may wait.

        See :meth:`moka.renderer.renderer.Renderer.prepare_lighting`.
        """
        for settings in (self._plain, self._truth):
            self._light[settings.ibl] = self._renderer.prepare_lighting(
                self._scene.environment, self._scene, settings, told
            )

    def step(self) -> None:
        """Go on, if the GPU has done the last step."""
        if self.is_done or self.waits:
            return
        if self._frame is not None:
            if not self._frame.is_done:
                return
            self._frame.wait()  # What it reads back has arrived then.
        self._frame = next(self._steps, None)
        if self._frame is None:
            self.is_done = True
            self._renderer.release_targets()

    def _measure(self) -> Iterator[Frame]:
        names = ("object-id",)
        commands = self._drawn(self._plain)
        radiance = self._renderer.read_radiance(commands)
        values = self._renderer.read_values(
            self._scene, self._camera, names, commands
        )
        yield self._submitted(commands)
        objects = unpack_values(names, values)["object-id"]
        frames = Schedule.of(self._samples).total_frames
        # Begun anew where the scene has changed, but not for ever.
        for number in range(4 * frames):
            commands = self._drawn(self._truth)
            self.progress = min((number + 1) / frames, 1.0)
            if self._renderer.is_complete:
                break
            frame = self._submitted(commands)
            if number % _FRAMES_PER_STEP == 0:
                yield frame
        else:
            raise MokaError(
                "the error cannot be measured while the scene moves; pause it"
            )
        expected = self._renderer.read_radiance(commands)
        yield self._submitted(commands)
        assert radiance.data is not None
        assert expected.data is not None
        found = lighting_error(
            expected.data[::-1], radiance.data[::-1], objects
        )
        if found is not None:
            statistics = self._renderer.lighting_statistics
            self.result = replace(
                found, truth_error=statistics["estimated_error"]
            )

    def _drawn(self, settings: RenderSettings) -> CommandList:
        self._renderer.settings = settings
        made = self._light.pop(settings.ibl, None)
        if made is not None:
            self._renderer.adopt_lighting(made)
        commands = CommandList()
        self._renderer.draw(self._scene, self._camera, commands)
        return commands

    def _submitted(self, commands: CommandList) -> Frame:
        return self._renderer.device.submit(commands, paced=False)


def _copied(camera: Camera) -> Camera:
    """A camera that stays where the other one is now."""
    copy = Camera()
    copy.projection = camera.projection
    copy.transform.world_matrix = camera.transform.world_matrix
    return copy
