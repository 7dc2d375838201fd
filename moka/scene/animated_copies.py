"""Puts poses into effect: from columns of numbers to models in a scene."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.core.maths import compose
from moka.model.animation import Property
from moka.scene.animated_material import with_values
from moka.scene.animation_pose import PoseLayout, Poses
from moka.scene.forest import Rows

if TYPE_CHECKING:
    from moka.scene.scene_model import SceneModel

__all__ = ["AnimatedCopies"]

_TRANSLATION: Property = ("node", "translation")
_ROTATION: Property = ("node", "rotation")
_SCALE: Property = ("node", "scale")
_TRANSFORM = (_TRANSLATION, _ROTATION, _SCALE)
_WEIGHTS: Property = ("node", "weights")
_VISIBLE: Property = ("node", "visible")


class AnimatedCopies:
    """The copies of one model in a scene, and the poses that they have.

    Only what differs from the pose before is written, so that what stands
    still in an animation costs no more than what nothing moves; and matrices
    of all copies are made and written together.
    """

    def __init__(self, layout: PoseLayout) -> None:
        self._layout = layout
        self._models: list[SceneModel | None] = []
        self._free: list[int] = []
        self._now: Poses = layout.rest_poses(0)
        # Transform rows of the nodes that move, by copy.
        self._nodes = layout.things.get(_TRANSLATION, np.empty(0, np.intp))
        self._rows: Rows = np.empty((0, len(self._nodes)), np.intp)

    def add(self, model: "SceneModel") -> int:
        """The number of a copy, which has the pose of the file."""
        if self._free:
            number = self._free.pop()
            self._models[number] = model
        else:
            number = len(self._models)
            self._models.append(model)
            if number >= len(self._rows):
                self._extend(max(1, number))
        self._rows[number] = model.rows[self._nodes]
        for property_, column in self._layout.rest.items():
            self._now[property_][number] = column
        return number

    def remove(self, number: int) -> None:
        """Forget a copy; its number may be given to another."""
        self._models[number] = None
        self._free.append(number)

    def take(self, copies: Sequence[int], poses: Poses) -> None:
        """Give ``copies`` (P,), each of them once, their poses."""
        rows = np.array(copies, np.intp)
        differs: dict[Property, NDArray[np.bool_]] = {}
        for property_, column in poses.items():
            now = self._now[property_]
            which = (column != now[rows]).any(axis=-1)
            if which.any():
                differs[property_] = which
                now[rows] = column
        moved = [differs.pop(name) for name in _TRANSFORM if name in differs]
        if moved:
            self._move(rows, poses, np.logical_or.reduce(moved))
        if differs:
            for index, copy in enumerate(copies):
                changed = {
                    property_: np.flatnonzero(which[index])
                    for property_, which in differs.items()
                    if which[index].any()
                }
                if changed:
                    self._change(copy, changed)

    def _extend(self, more: int) -> None:
        """Make room for so many further copies."""
        empty = np.empty((more, len(self._nodes)), np.intp)
        self._rows = np.concatenate([self._rows, empty])
        added = self._layout.rest_poses(more)
        self._now = {
            property_: np.concatenate([column, added[property_]])
            for property_, column in self._now.items()
        }

    def _move(
        self, copies: Rows, poses: Poses, moved: NDArray[np.bool_]
    ) -> None:
        """Write matrices, which are made of all three parts."""
        index, place = np.nonzero(moved)
        model = self._models[int(copies[0])]
        assert model is not None  # All copies are in one scene.
        model.transform.tree.set_local(
            self._rows[copies[index], place],
            compose(*(poses[name][index, place] for name in _TRANSFORM)),
        )

    def _change(self, copy: int, changed: dict[Property, Rows]) -> None:
        """Write everything but matrices: places of columns that differ."""
        model = self._models[copy]
        assert model is not None
        weights = changed.pop(_WEIGHTS, None)
        if weights is not None and model.morph_weights is not None:
            model.morph_weights.write(
                self._layout.things[_WEIGHTS][weights],
                self._now[_WEIGHTS][copy, weights, 0],
            )
        visible = changed.pop(_VISIBLE, None)
        if visible is not None:
            nodes = self._layout.things[_VISIBLE][visible]
            model.transform.tree.set_visible(
                model.rows[nodes], self._now[_VISIBLE][copy, visible, 0] != 0
            )
        things = {
            (kind, thing)
            for (kind, name), places in changed.items()
            for thing in self._layout.things[kind, name][places].tolist()
        }
        for kind, thing in sorted(things):
            values = self._values(copy, kind, thing)
            if kind == "material":
                _change_material(model, thing, values)
            elif kind == "light":
                _change_light(model, thing, values)
            else:
                _change_camera(model, thing, values)

    def _values(self, copy: int, kind: str, thing: int) -> dict[str, Any]:
        """All that animations move of one thing, as it is now."""
        values = {}
        for (of, name), things in self._layout.things.items():
            if of == kind:
                place = int(np.searchsorted(things, thing))
                if place < len(things) and things[place] == thing:
                    row = tuple(self._now[of, name][copy, place].tolist())
                    values[name] = row if len(row) > 1 else row[0]
        return values


def _change_material(
    model: "SceneModel", number: int, values: dict[str, Any]
) -> None:
    own = model.own_materials[model.model.materials[number]]
    live = model.scene.live_materials
    assert live is not None  # Made with the first such model.
    live.set(own, with_values(live.now(own), values))


def _change_light(
    model: "SceneModel", number: int, values: dict[str, Any]
) -> None:
    """A light that shines at several nodes changes at all of them."""
    for light, (_, own) in zip(model.lights, model.layout.lights, strict=True):
        if own == number:
            light.description = replace(light.description, **values)


def _change_camera(
    model: "SceneModel", number: int, values: dict[str, Any]
) -> None:
    placed = model.layout.cameras
    for camera, (_, own) in zip(model.cameras, placed, strict=True):
        if own == number:
            camera.projection = replace(camera.projection, **values)
