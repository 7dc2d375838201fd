"""Poses: what all that a model's animations move is at one moment.

A pose has a column for each property that any animation of the model moves,
with a row for each thing of which it is moved. So two animations that move
different things still have poses of one shape, and can be blended.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from moka.core.interpolation import lerp, slerp
from moka.core.maths import Array
from moka.model.animation import (
    AnimationChannel,
    AnimationTarget,
    Property,
    rest_transforms,
)
from moka.model.model import Model
from moka.scene.animated_material import material_value
from moka.scene.forest import Rows
from moka.scene.morph_weights import MorphWeights

__all__ = ["PoseLayout", "Poses", "blended"]

#: Columns float64 (P, N, C) of P poses by property.
Poses = dict[Property, Array]

_TRANSFORM = ("translation", "rotation", "scale")
_LARGEST = float(np.finfo(np.float32).max)


class PoseLayout:
    """Which things have a row in which column of a model's poses.

    ``things`` (N,) holds for each property, sorted, rows of nodes, positions
    of materials, lights or cameras, and for weights positions in the values
    of :class:`MorphWeights`. ``rest`` holds the columns (N, C) of the pose
    of the file, when nothing plays.
    """

    def __init__(self, model: Model) -> None:
        weights = MorphWeights(model)
        self._weights = weights
        found: dict[Property, set[int]] = defaultdict(set)
        for animation in model.animations:
            for channel in animation.channels:
                target = channel.target
                found[target.kind, target.property].update(self._things(target))
        moved = set().union(
            *(found.pop(("node", name), ()) for name in _TRANSFORM)
        )
        self.things: dict[Property, Rows] = {
            property_: np.array(sorted(things), np.intp)
            for property_, things in found.items()
        }
        self.rest: dict[Property, Array] = {
            property_: _rest(model, weights, property_, things)
            for property_, things in self.things.items()
        }
        if moved:
            # A node's matrix is made of all three, whichever of them move.
            nodes = np.array(sorted(moved), np.intp)
            parts = rest_transforms(model.nodes, model.rest_pose, nodes)
            for name, column in zip(_TRANSFORM, parts, strict=True):
                self.things["node", name] = nodes
                self.rest["node", name] = column

    def rest_poses(self, count: int) -> Poses:
        """The pose of the file so many times, to be written into."""
        return {
            property_: np.repeat(column[None], count, axis=0)
            for property_, column in self.rest.items()
        }

    def places(self, channels: Iterable[AnimationChannel]) -> list[Rows]:
        """For each channel its rows in the column of its property."""
        row_of = {
            property_: dict(
                zip(things.tolist(), range(len(things)), strict=True)
            )
            for property_, things in self.things.items()
        }
        places = []
        for channel in channels:
            target = channel.target
            rows = row_of[target.kind, target.property]
            things = self._things(target)
            places.append(np.array([rows[thing] for thing in things], np.intp))
        return places

    def _things(self, target: AnimationTarget) -> Sequence[int]:
        if target.property != "weights":
            return (target.index,)
        where = self._weights.slice_of(target.index)
        all_of_node = range(where.start, where.stop)
        if target.element is None:
            return all_of_node
        return (all_of_node[target.element],)


def blended(first: Poses, second: Poses, weight: float) -> Poses:
    """Poses between two of one model: ``first`` at 0, ``second`` at 1.

    Rotations turn the shorter way, visibility is that of the nearer pose,
    everything else goes straight.
    """
    result = {}
    for property_, column in first.items():
        along = np.broadcast_to(weight, column.shape[:-1])
        if property_ == ("node", "rotation"):
            result[property_] = slerp(column, second[property_], along)
        elif property_ == ("node", "visible"):
            result[property_] = second[property_] if weight >= 0.5 else column
        else:
            result[property_] = lerp(column, second[property_], along)
    return result


def _rest(
    model: Model, weights: MorphWeights, property_: Property, things: Rows
) -> Array:
    """The column of a property when nothing plays."""
    kind, name = property_
    if name == "weights":
        return weights.values[things, None].astype(np.float64)
    if name == "visible":
        shown = ~np.isin(things, model.nodes.hidden)
        return shown[:, None].astype(np.float64)
    owners: Any = {
        "material": model.materials,
        "light": model.lights,
        "camera": [camera.projection for camera in model.cameras],
    }[kind]
    values = [
        material_value(owners[thing], name)
        if kind == "material"
        else getattr(owners[thing], name)
        for thing in things.tolist()
    ]
    # What has no end is as far as float32 goes, so that it can be blended.
    column = np.minimum(np.array(values, np.float64), _LARGEST)
    return column.reshape(len(things), -1)
