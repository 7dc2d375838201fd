"""Puts poses into effect: from columns of numbers to a model in a scene."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.core.maths import Array, compose
from moka.model.animation import Property
from moka.scene.forest import Rows
from moka.scene.pose import Pose, PoseLayout

if TYPE_CHECKING:
    from moka.scene.scene_model import SceneModel

__all__ = ["PosedModel"]

_TRANSLATION: Property = ("node", "translation")
_ROTATION: Property = ("node", "rotation")
_SCALE: Property = ("node", "scale")
_WEIGHTS: Property = ("node", "weights")


class PosedModel:
    """One model of a scene, and the pose that it was last given.

    Only what differs from that pose is written, so that what stands still
    in an animation costs no more than what nothing moves.
    """

    def __init__(self, model: "SceneModel", layout: PoseLayout) -> None:
        self._model = model
        self._layout = layout
        self._pose: Pose = layout.rest

    def take(self, pose: Pose) -> None:
        """Take the pose; it must not change afterwards."""
        changed = {
            property_: rows
            for property_, column in pose.items()
            if (rows := _differing(column, self._pose[property_])).size
        }
        self._pose = pose
        moved = [
            changed.pop(name)
            for name in (_TRANSLATION, _ROTATION, _SCALE)
            if name in changed
        ]
        if moved:
            self._move(np.unique(np.concatenate(moved)))
        weights = changed.pop(_WEIGHTS, None)
        if weights is not None and self._model.morph_weights is not None:
            self._model.morph_weights.write(
                self._layout.things[_WEIGHTS][weights],
                pose[_WEIGHTS][weights, 0],
            )
        for kind, thing, values in self._by_thing(changed):
            if kind == "light":
                self._light(thing, values)
            elif kind == "camera":
                self._camera(thing, values)

    def _move(self, places: Rows) -> None:
        pose = self._pose
        nodes = self._layout.things[_TRANSLATION][places]
        self._model.transform.tree.set_local(
            self._model.rows[nodes],
            compose(
                pose[_TRANSLATION][places],
                pose[_ROTATION][places],
                pose[_SCALE][places],
            ),
        )

    def _by_thing(
        self, changed: dict[Property, Rows]
    ) -> Iterator[tuple[str, int, dict[str, Any]]]:
        """Kind and position of what changed, with all its new values."""
        found: dict[tuple[str, int], dict[str, Any]] = {}
        for (kind, name), places in changed.items():
            things = self._layout.things[kind, name][places].tolist()
            values = self._pose[kind, name][places].tolist()
            for thing, value in zip(things, values, strict=True):
                found.setdefault((kind, thing), {})[name] = (
                    tuple(value) if len(value) > 1 else value[0]
                )
        for (kind, thing), named in found.items():
            yield kind, thing, named

    def _light(self, number: int, values: dict[str, Any]) -> None:
        """A light that shines at several nodes changes at all of them."""
        placed = self._model.layout.lights
        for light, (_, own) in zip(self._model.lights, placed, strict=False):
            if own == number:
                light.description = replace(light.description, **values)

    def _camera(self, number: int, values: dict[str, Any]) -> None:
        placed = self._model.layout.cameras
        for camera, (_, own) in zip(self._model.cameras, placed, strict=False):
            if own == number:
                camera.projection = replace(camera.projection, **values)


def _differing(new: Array, old: Array) -> Rows:
    """Rows of two columns that are not the same."""
    if new is old:
        return np.empty(0, np.intp)
    different: NDArray[np.bool_] = (new != old).any(axis=1)
    return np.flatnonzero(different)
