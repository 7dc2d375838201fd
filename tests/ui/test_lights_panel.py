"""Where a light shines from, and the angles that a panel shows of it."""

import math

import numpy as np
import pytest

from moka.model.lights import LightKind, PunctualLight
from moka.scene.scene import Scene
from moka.ui.panels.lights import _direction, _point


@pytest.mark.parametrize("azimuth", [-170.0, -90.0, 0.0, 30.0, 179.0])
@pytest.mark.parametrize("elevation", [-90.0, -20.0, 0.0, 50.0, 90.0])
def test_angles_are_kept_also_straight_up_and_down(
    azimuth: float, elevation: float
) -> None:
    scene = Scene()
    light = scene.add_light(PunctualLight(LightKind.DIRECTIONAL))
    _point(light, math.radians(azimuth), math.radians(elevation))
    assert _direction(light) == pytest.approx((azimuth, elevation), abs=1e-6)
    scene.update()
    (row,) = scene.light_rows()
    across = math.cos(math.radians(elevation))
    towards = (
        across * math.sin(math.radians(azimuth)),
        math.sin(math.radians(elevation)),
        across * math.cos(math.radians(azimuth)),
    )
    np.testing.assert_allclose(-row["direction"], towards, atol=1e-6)
