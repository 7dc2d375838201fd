"""Puts poses into effect: from columns of numbers to a model in a scene."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from moka.core.maths import compose
from moka.model.animation import Property
from moka.scene.forest import Rows
from moka.scene.pose import Pose, PoseLayout

if TYPE_CHECKING:
    from moka.scene.scene_model import SceneModel

__all__ = ["PosedModel"]

_TRANSLATION: Property = ("node", "translation")
_ROTATION: Property = ("node", "rotation")
_SCALE: Property = ("node", "scale")
_TRANSFORM = (_TRANSLATION, _ROTATION, _SCALE)
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
        before, self._pose = self._pose, pose
        if before is pose:
            return
        differs = {
            property_: (column != before[property_]).any(axis=1)
            for property_, column in pose.items()
        }
        moved = [differs.pop(name) for name in _TRANSFORM if name in differs]
        if moved:
            self._move(np.flatnonzero(np.logical_or.reduce(moved)))
        changed = {
            property_: np.flatnonzero(which)
            for property_, which in differs.items()
            if which.any()
        }
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
        """Write the matrices of nodes, which are made of all three parts."""
        if not places.size:
            return
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
