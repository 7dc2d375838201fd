"""Light rows against the formulas of KHR_lights_punctual in float64."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from moka.core.maths import compose, normalise
from moka.model.lights import LightKind, PunctualLight
from moka.scene.lights import LIGHT, pack_lights

IDENTITY = np.eye(4)[None]


def arriving(row: np.void, point: np.ndarray) -> np.ndarray:
    """What the shader makes of a row, in lux per channel."""
    towards = row["position"].astype(np.float64) - point
    distance = float(np.linalg.norm(towards))
    if not row["positional"]:
        return np.asarray(row["intensity"], np.float64)
    window = np.clip(1 - (distance * row["inverse_range"]) ** 4, 0, 1)
    cosine = row["direction"] @ (-towards / distance)
    cone = np.clip(cosine * row["angle_scale"] + row["angle_offset"], 0, 1)
    return np.asarray(row["intensity"] * window / distance**2 * cone**2)


def specified(
    light: PunctualLight, place: np.ndarray, axis: np.ndarray, to: np.ndarray
) -> np.ndarray:
    """The recommended formulas as the extension's text gives them."""
    intensity = light.intensity * np.array(light.colour)
    if light.kind is LightKind.DIRECTIONAL:
        return np.asarray(intensity)
    distance = np.linalg.norm(to - place)
    attenuation = (
        max(min(1.0 - (distance / light.range) ** 4, 1), 0) / distance**2
    )
    if light.kind is LightKind.SPOT:
        inner = math.cos(light.inner_cone_angle)
        outer = math.cos(light.outer_cone_angle)
        angle_scale = 1.0 / max(0.001, inner - outer)
        angle_offset = -outer * angle_scale
        cd = axis @ (to - place) / distance
        angular = min(max(cd * angle_scale + angle_offset, 0), 1)
        attenuation *= angular * angular
    return np.asarray(intensity * attenuation)


unit = st.floats(0, 1)


@given(
    kind=st.sampled_from(LightKind),
    colour=st.tuples(unit, unit, unit),
    intensity=st.one_of(st.just(0.0), st.floats(0.01, 1e5)),
    reach=st.sampled_from([0.5, 3.0, 100.0, math.inf]),
    outer=st.floats(1e-3, math.pi / 2),
    inner=unit,
    seed=st.integers(0, 2**32 - 1),
)
def test_rows_give_what_the_extension_recommends(
    kind: LightKind,
    colour: tuple[float, float, float],
    intensity: float,
    reach: float,
    outer: float,
    inner: float,
    seed: int,
) -> None:
    random = np.random.default_rng(seed)
    light = PunctualLight(kind, colour, intensity, reach, inner * outer, outer)
    place, point = random.uniform(-2, 2, (2, 3))
    # Half of the points in the cone, or few would be.
    world = compose(place, random.normal(size=4), random.uniform(0.1, 3, 3))
    axis = normalise(-world[:3, 2])
    if seed % 2:
        off = random.normal(size=3) * math.sin(outer) / 2
        point = place + axis + off
    (row,) = pack_lights([light], world[None])
    expected = specified(light, place, axis, point)
    # Rounding of a cosine in float32, on the steepest edge a cone may have.
    tolerance = 5e-4 * intensity / min(1, np.linalg.norm(point - place)) ** 2
    assert_allclose(arriving(row, point), expected, rtol=1e-5, atol=tolerance)


def test_absurd_lights_stay_finite() -> None:
    world = np.eye(4)[None].repeat(2, axis=0)
    world[1, :3, 3] = (np.inf, -np.inf, np.nan)
    light = PunctualLight(LightKind.POINT, (1, 1, 1), 1e300, 1e-310)
    rows = pack_lights([light, light], world)
    for name in LIGHT.names:
        assert np.isfinite(rows[name]).all()


def test_rows_are_four_vec4_in_std140() -> None:
    assert LIGHT.itemsize == 64
    offsets = [LIGHT.fields[name][1] for name in LIGHT.names]
    assert offsets == [0, 12, 16, 28, 32, 44, 48, 52, 56, 60]


def test_infinite_range_and_wide_cones_do_nothing() -> None:
    (row,) = pack_lights([PunctualLight(LightKind.POINT)], IDENTITY)
    assert row["inverse_range"] == 0
    assert (row["angle_scale"], row["angle_offset"]) == (0, 1)


def test_equal_cone_angles_stay_finite() -> None:
    light = PunctualLight(
        LightKind.SPOT, inner_cone_angle=0.5, outer_cone_angle=0.5
    )
    (row,) = pack_lights([light], IDENTITY)
    assert_allclose(row["angle_scale"], 1000)


@pytest.mark.parametrize("scale", [(1, 1, 5), (2, 2, 2), (1, 1, 0)])
def test_light_shines_along_minus_z_at_any_scale(
    scale: tuple[float, ...],
) -> None:
    quarter = (0, math.sqrt(0.5), 0, math.sqrt(0.5))
    world = compose((0, 0, 0), quarter, scale)
    light = PunctualLight(LightKind.DIRECTIONAL)
    (row,) = pack_lights([light], world[None])
    assert_allclose(row["direction"], [-1, 0, 0], atol=1e-7)


def test_positions_are_relative_in_double_precision() -> None:
    world = compose((1e8 + 0.25, 0, 0), (0, 0, 0, 1), (1, 1, 1))
    light = PunctualLight(LightKind.POINT)
    (row,) = pack_lights([light], world[None], origin=(1e8, 0, 0))
    assert row["position"].tolist() == [0.25, 0, 0]


def test_no_lights_are_no_rows() -> None:
    assert pack_lights([], np.empty((0, 4, 4))).shape == (0,)
