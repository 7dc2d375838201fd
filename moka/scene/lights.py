"""Lights of a scene, and their rows for the GPU.

Source: KHR_lights_punctual, whose formulas the rows prepare. For a point at
distance d in direction l from a light that shines along s::

    window  = clamp(1 - (d * inverse_range)^4, 0, 1) / d^2
    cone    = clamp(dot(s, l) * angle_scale + angle_offset, 0, 1)^2
    arrives = intensity * window * cone          (lux)

A directional light has neither; it is the same everywhere.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.maths import Array, forward_directions
from moka.core.radiometry import NARROWEST_CONE_EDGE
from moka.model.lights import LightKind, PunctualLight
from moka.scene.transform import Transform

__all__ = ["LIGHT", "Light", "pack_lights"]

# One light as the shader reads it: four vec4 of a std140 block. The position
# is relative to the origin that it was packed for; "positional" is 1, or 0
# for a directional light; the intensity is colour times candela or lux. The
# angular radius, in radians, is a sun's; other lights have none. It is 1 for
# "in_map" if the environment's map shows the sun as well.
LIGHT = np.dtype(
    [
        ("position", np.float32, 3),
        ("positional", np.float32),
        ("direction", np.float32, 3),
        ("inverse_range", np.float32),
        ("intensity", np.float32, 3),
        ("angle_scale", np.float32),
        ("angle_offset", np.float32),
        ("angular_radius", np.float32),
        ("in_map", np.float32),
        ("spare", np.float32),
    ]
)

# A range of which the inverse still is a float32.
_SHORTEST = 1e-30


class Light:
    """A punctual light of a scene; it shines along -Z of its transform.

    ``description`` may be replaced to change it, ``visible`` put out.
    """

    def __init__(
        self, description: PunctualLight, transform: Transform
    ) -> None:
        self.description = description
        self.transform = transform
        self.visible = True

    def __repr__(self) -> str:
        return f"<Light {self.description.kind.value}: {self.transform!r}>"


def pack_lights(
    lights: Sequence[PunctualLight],
    world: ArrayLike,
    origin: ArrayLike = (0, 0, 0),
) -> NDArray[np.void]:
    """Rows (N,) of :data:`LIGHT` for lights placed by matrices (N, 4, 4).

    Positions become relative to ``origin``, in double precision, so that a
    scene far from zero keeps its detail; directions are unit vectors along
    which the light travels, in world space.
    """
    rows = np.zeros(len(lights), LIGHT)
    if not len(lights):
        return rows
    world = np.asarray(world, np.float64)
    kind = np.array([light.kind.value for light in lights])
    colour = np.array([light.colour for light in lights])
    intensity = np.array([light.intensity for light in lights])
    inner = np.cos([light.inner_cone_angle for light in lights])
    outer = np.cos([light.outer_cone_angle for light in lights])
    spot = kind == LightKind.SPOT.value
    scale = 1 / np.maximum(NARROWEST_CONE_EDGE, inner - outer)
    rows["position"] = _single(world[:, :3, 3] - np.asarray(origin))
    rows["positional"] = kind != LightKind.DIRECTIONAL.value
    rows["direction"] = forward_directions(world)
    reach = np.array([light.range for light in lights])
    rows["inverse_range"] = 1 / np.maximum(reach, _SHORTEST)
    rows["intensity"] = _single(intensity[:, None] * colour)
    rows["angle_scale"] = np.where(spot, scale, 0)
    rows["angle_offset"] = np.where(spot, -outer * scale, 1)
    return rows


def _single(values: Array) -> NDArray[np.float32]:
    """``values`` in float32, the largest for what is beyond its range.

    One absurd light would otherwise make every pixel NaN.
    """
    largest = float(np.finfo(np.float32).max)
    finite = np.nan_to_num(values, posinf=largest, neginf=-largest)
    return np.clip(finite, -largest, largest).astype(np.float32)
