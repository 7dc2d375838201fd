"""Draws spheres under environments in every mode; takes errors and times."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.bench.lighting_modes import LightingMode
from moka.bench.sphere_errors import SphereErrors, sphere_errors
from moka.bench.spheres import SphereGrid
from moka.commands.command_list import CommandList
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings

__all__ = ["LightingBench", "Measurement"]

# Pictures that are timed are this many times as wide and as high: what a
# frame costs anyway is to be small against what its pixels cost.
_TIMED_SCALE = 2


@dataclass(frozen=True, slots=True)
class Measurement:
    """Errors and medians of times of one mode under one environment.

    ``picture_ms`` is for a picture that is complete, which takes reference
    lighting many frames; ``preintegration_ms`` is what the first frame under
    an environment takes more than the next.
    """

    mode: LightingMode
    errors: SphereErrors
    preintegration_ms: float
    picture_ms: float


class LightingBench:
    """The spheres on a device, and a renderer for each mode.

    ``truth`` are the settings of the picture that the others are compared
    with. To be closed.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        grid: SphereGrid,
        modes: Sequence[LightingMode],
        truth: RenderSettings,
    ) -> None:
        self._device = device
        self._grid = grid
        self._camera = grid.camera()
        self._facets, self._smooth = grid.facets(), grid.smooth()
        self._renderers = {
            mode: Renderer(device, grid.size, mode.settings) for mode in modes
        }
        self._truth = Renderer(device, grid.size, truth)

    @property
    def timed_size(self) -> tuple[int, int]:
        """Width and height of the pictures that are timed."""
        width, height = self._grid.size
        return _TIMED_SCALE * width, _TIMED_SCALE * height

    def close(self) -> None:
        """End the renderers' threads."""
        for renderer in (*self._renderers.values(), self._truth):
            renderer.close()

    def truth(self, environment: Environment) -> NDArray[np.float32]:
        """The facets lit by reference lighting: radiance (H, W, 4).

        The top row is first; alpha is 1 on spheres and 0 elsewhere.
        """
        return self._picture(self._truth, environment)

    def errors(
        self, environment: Environment, truth: NDArray[np.float32]
    ) -> dict[LightingMode, SphereErrors]:
        """Of a picture in each mode, against ``truth``."""
        return {
            mode: sphere_errors(
                self._grid, truth, self._picture(renderer, environment)
            )
            for mode, renderer in self._renderers.items()
        }

    def measure(
        self,
        environment: Environment,
        truth: NDArray[np.float32],
        rounds: int,
    ) -> list[Measurement]:
        """Errors against ``truth``, then ``rounds`` of times, alternating."""
        errors = self.errors(environment, truth)
        first, steady = self._times(environment, rounds)
        measurements = []
        for mode in self._renderers:
            frame = float(np.median(steady[mode]))
            preintegration = float(np.median(first[mode])) - frame
            measurements.append(
                Measurement(
                    mode,
                    errors[mode],
                    max(preintegration, 0.0),
                    frame * mode.frames,
                )
            )
        return measurements

    def _times(
        self, environment: Environment, rounds: int
    ) -> tuple[
        dict[LightingMode, list[float]], dict[LightingMode, list[float]]
    ]:
        """Milliseconds of first frames and of those that follow.

        What slows the machine for a while slows all modes, as each round
        goes through all of them. The first round compiles and is left out.
        """
        first: dict[LightingMode, list[float]]
        first = {mode: [] for mode in self._renderers}
        steady: dict[LightingMode, list[float]]
        steady = {mode: [] for mode in self._renderers}
        for number in range(rounds + 1):
            for mode, renderer in self._renderers.items():
                # Another object: to the renderer a new environment.
                self._smooth.environment = replace(environment)
                times = self._frame(renderer), self._frame(renderer)
                if number:
                    first[mode].append(times[0])
                    steady[mode].append(times[1])
        return first, steady

    def _picture(
        self, renderer: Renderer, environment: Environment
    ) -> NDArray[np.float32]:
        self._facets.environment = environment
        renderer.size = self._grid.size
        commands = CommandList()
        renderer.draw(self._facets, self._camera, commands)
        while not renderer.is_complete:
            self._device.submit(commands).wait()
            commands = CommandList()
            renderer.draw(self._facets, self._camera, commands)
        radiance = renderer.read_radiance(commands)
        self._device.submit(commands).wait()
        assert radiance.data is not None
        picture = radiance.data[::-1]
        # Of what is covered; samples between facets count for nothing.
        coverage = picture[:, :, 3:]
        whole = np.where(coverage > 0.0, coverage, np.float32(1))
        covered: NDArray[np.float32] = np.divide(picture, whole)
        return covered

    def _frame(self, renderer: Renderer) -> float:
        """Draw a frame of the smooth spheres; how many milliseconds."""
        renderer.size = self.timed_size
        self._device.finish()
        start = time.perf_counter()
        commands = CommandList()
        renderer.draw(self._smooth, self._camera, commands)
        self._device.submit(commands)
        self._device.finish()
        return 1000.0 * (time.perf_counter() - start)
