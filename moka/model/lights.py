"""Punctual lights: directional, point and spot.

Source: KHR_lights_punctual. A node places a light; directional lights and
spots shine down its -Z axis.
"""

import math
from collections.abc import Sequence
from enum import Enum
from typing import Literal

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.model.schema import Node, Vector3, read_extension
from moka.model.source import GltfSource

__all__ = ["LightKind", "PunctualLight", "read_lights", "read_node_lights"]

_EXTENSION = "KHR_lights_punctual"


class LightKind(Enum):
    """How a punctual light shines; the values are the extension's names."""

    DIRECTIONAL = "directional"
    POINT = "point"
    SPOT = "spot"


class PunctualLight(Struct, frozen=True):
    """A light without extent.

    ``colour`` is linear Rec.709, ``intensity`` in candela for points and
    spots and in lux for directional lights, ``range`` the distance in metres
    beyond which it is dark, the cone angles are half angles in radians.
    """

    kind: LightKind
    colour: tuple[float, float, float] = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    range: float = math.inf
    inner_cone_angle: float = 0.0
    outer_cone_angle: float = math.pi / 4
    name: str = ""


class _Spot(msgspec.Struct, rename="camel"):
    inner_cone_angle: float = 0.0
    outer_cone_angle: float = math.pi / 4


class _Light(msgspec.Struct, rename="camel"):
    type: Literal["directional", "point", "spot"]
    color: Vector3 = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    range: float | None = None
    spot: _Spot = msgspec.field(default_factory=_Spot)
    name: str = ""


class _Lights(msgspec.Struct):
    lights: list[_Light] = []


class _NodeLight(msgspec.Struct):
    light: int


def read_lights(source: GltfSource) -> list[PunctualLight]:
    """All lights; raises ModelError for values without meaning."""
    lights = read_extension(
        source.document, _EXTENSION, _Lights, source.where, ""
    )
    if lights is None:
        return []
    return [
        _light(source, f"extensions.{_EXTENSION}.lights[{index}]", light)
        for index, light in enumerate(lights.lights)
    ]


def read_node_lights(
    source: GltfSource, nodes: Sequence[tuple[int, Node]], count: int
) -> NDArray[np.int32]:
    """For each node of the file the light that it places, -1 for none.

    ``nodes`` are those with extensions, each with its index. Raises
    ModelError if a light is not one of ``count``.
    """
    indices = np.full(len(source.document.nodes), -1, np.int32)
    for index, node in nodes:
        path = f"nodes[{index}]"
        light = read_extension(node, _EXTENSION, _NodeLight, source.where, path)
        if light is not None:
            path = f"{path}.extensions.{_EXTENSION}.light"
            source.check_index(path, light.light, "lights", count)
            indices[index] = light.light
    return indices


def _light(source: GltfSource, path: str, light: _Light) -> PunctualLight:
    inner, outer = light.spot.inner_cone_angle, light.spot.outer_cone_angle
    if light.intensity < 0 or min(light.color) < 0:
        raise source.error(path, "is negative; light cannot be taken away")
    if light.range is not None and light.range <= 0:
        raise source.error(f"{path}.range", "must be greater than 0")
    # Equal angles, an edge without a gradient, are common in real files, and
    # so is pi / 2 that float32 has rounded up.
    if not 0 <= inner <= outer <= math.pi / 2 + 1e-6:
        raise source.error(
            f"{path}.spot",
            "needs 0 <= innerConeAngle < outerConeAngle <= pi / 2",
        )
    return PunctualLight(
        LightKind(light.type),
        light.color,
        light.intensity,
        math.inf if light.range is None else light.range,
        min(inner, math.pi / 2),
        min(outer, math.pi / 2),
        light.name,
    )
