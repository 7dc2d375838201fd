"""Puts poses into effect: from columns of numbers to a model in a scene."""

from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.core.maths import compose
from moka.model.animation import Property
from moka.scene.animated_material import with_values
from moka.scene.animation_pose import Pose, PoseLayout
from moka.scene.forest import Rows

if TYPE_CHECKING:
    from moka.scene.scene_model import SceneModel

__all__ = ["AnimatedModel"]

_TRANSLATION: Property = ("node", "translation")
_ROTATION: Property = ("node", "rotation")
_SCALE: Property = ("node", "scale")
_TRANSFORM = (_TRANSLATION, _ROTATION, _SCALE)
_WEIGHTS: Property = ("node", "weights")
_VISIBLE: Property = ("node", "visible")


class AnimatedModel:
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
        weights = differs.pop(_WEIGHTS, None)
        if weights is not None and self._model.morph_weights is not None:
            self._model.morph_weights.write(
                self._layout.things[_WEIGHTS][weights],
                pose[_WEIGHTS][weights, 0],
            )
        visible = differs.pop(_VISIBLE, None)
        if visible is not None:
            self._show(np.flatnonzero(visible))
        for kind, thing in self._things(differs):
            values = self._values(kind, thing)
            if kind == "material":
                self._change_material(thing, values)
            elif kind == "light":
                self._change_light(thing, values)
            else:
                self._change_camera(thing, values)

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

    def _show(self, places: Rows) -> None:
        """Mark nodes as visible or hidden."""
        nodes = self._layout.things[_VISIBLE][places]
        self._model.transform.tree.set_visible(
            self._model.rows[nodes], self._pose[_VISIBLE][places, 0] != 0
        )

    def _things(
        self, differs: dict[Property, NDArray[np.bool_]]
    ) -> set[tuple[str, int]]:
        """Kind and position of each material, light and camera that did."""
        return {
            (kind, thing)
            for (kind, name), which in differs.items()
            for thing in self._layout.things[kind, name][which].tolist()
        }

    def _values(self, kind: str, thing: int) -> dict[str, Any]:
        """All that animations move of one thing, as the pose has it."""
        values = {}
        for (of, name), things in self._layout.things.items():
            if of == kind:
                place = int(np.searchsorted(things, thing))
                if place < len(things) and things[place] == thing:
                    row = tuple(self._pose[of, name][place].tolist())
                    values[name] = row if len(row) > 1 else row[0]
        return values

    def _change_material(self, number: int, values: dict[str, Any]) -> None:
        model = self._model
        own = model.own_materials[model.model.materials[number]]
        live = model.scene.live_materials
        assert live is not None  # Made with the first such model.
        live.set(own, with_values(own, values))

    def _change_light(self, number: int, values: dict[str, Any]) -> None:
        """A light that shines at several nodes changes at all of them."""
        placed = self._model.layout.lights
        for light, (_, own) in zip(self._model.lights, placed, strict=True):
            if own == number:
                light.description = replace(light.description, **values)

    def _change_camera(self, number: int, values: dict[str, Any]) -> None:
        placed = self._model.layout.cameras
        for camera, (_, own) in zip(self._model.cameras, placed, strict=True):
            if own == number:
                camera.projection = replace(camera.projection, **values)
