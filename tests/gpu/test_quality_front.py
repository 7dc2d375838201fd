"""The named qualities are worth having: on the front of error against work.

Work is counted, not timed: directions that are read to prefilter an
environment, and directions that a pixel reads.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from moka.bench.lighting_measure import LightingBench
from moka.bench.lighting_modes import (
    LightingMode,
    lighting_modes,
    truth_settings,
)
from moka.bench.sphere_errors import SphereErrors
from moka.bench.spheres import MATERIALS, SphereGrid
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import load_environment
from moka.lighting.radiance_cube import cube_size
from moka.renderer.settings import RenderSettings

pytestmark = pytest.mark.gpu

BASE = RenderSettings(samples=1, multiscatter=False, float_output=True)
GRID = SphereGrid(MATERIALS[3:], (0.0, 0.1, 0.3, 0.7), 12)


@dataclass(frozen=True)
class Point:
    """What a mode costs, before and in a picture, and how far it is off."""

    mode: LightingMode
    errors: SphereErrors

    @property
    def work(self) -> tuple[int, int]:
        settings = self.mode.settings
        size = cube_size(256, half=settings.reflections == "half")
        pixel = 1
        if settings.ibl == "filtered":
            pixel += 2 * settings.ibl_samples
        return size * size, pixel

    def beats(self, other: "Point") -> bool:
        """No dearer in any way, and plainly closer."""
        return (
            all(a <= b for a, b in zip(self.work, other.work, strict=True))
            and self.errors.relative_rmse < 0.95 * other.errors.relative_rmse
            and self.errors.mirror <= other.errors.mirror
        )


@pytest.fixture(scope="module")
def points() -> Iterator[list[Point]]:
    """The cheap modes, under the studio."""
    with GraphicsDevice.open("egl") as device:
        yield _measured(device)


def _measured(device: GraphicsDevice) -> list[Point]:
    modes = [
        mode
        for mode in lighting_modes(BASE, quick=False)
        if mode.family != "reference"
    ]
    bench = LightingBench(device, GRID, modes, truth_settings(BASE, 512))
    try:
        environment = load_environment("studio")
        assert environment is not None
        truth = bench.truth(environment)
        return [
            Point(mode, errors)
            for mode, errors in bench.errors(environment, truth).items()
        ]
    finally:
        bench.close()


@pytest.mark.parametrize("quality", ["fast", "balanced", "best"])
def test_nothing_else_is_as_cheap_and_closer(
    points: list[Point], quality: str
) -> None:
    (named,) = (point for point in points if point.mode.quality == quality)
    better = [point.mode.name for point in points if point.beats(named)]
    assert not better


def test_each_quality_gives_something_for_its_price(
    points: list[Point],
) -> None:
    by_name = {point.mode.quality: point for point in points}
    fast, balanced, best = (
        by_name[name] for name in ("fast", "balanced", "best")
    )
    assert fast.work[0] < balanced.work[0]
    assert fast.errors.mirror > balanced.errors.mirror
    # Cheaper at a modest error.
    assert fast.errors.relative_rmse < 1.15 * balanced.errors.relative_rmse
    assert best.work[1] > balanced.work[1]
    assert best.errors.relative_rmse < 0.8 * balanced.errors.relative_rmse
