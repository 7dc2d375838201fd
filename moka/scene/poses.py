"""What of a scene moves within itself: skins, morph targets and their boxes.

Made only for scenes that have some, see
:class:`moka.scene.drawables.Drawables`.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.errors import ModelError
from moka.core.maths import Array, transform_bounds
from moka.model.skins import Skin
from moka.scene.forest import Rows
from moka.scene.morph_poses import MorphPoses
from moka.scene.morph_weights import MorphWeights
from moka.scene.skin_poses import SkinPoses

if TYPE_CHECKING:
    from moka.scene.drawables import Drawables

__all__ = ["PosedModel", "Poses"]


class PosedModel(Struct, frozen=True):
    """One copy of a model: its skins, transform rows of nodes, weights."""

    skins: list[Skin]
    rows: Rows
    weights: MorphWeights | None


class Poses:
    """The poses of a scene's D draws, and the boxes that hold them.

    Given are the models, and for each draw its ``node`` and ``model_skin``
    (D,): its row and its position in the model's own nodes and skins. Then
    ``skin`` (D,) is the number of a draw's skin in ``skins``, -1 for what
    follows its node; ``morphs`` are the weights of targets. ``version``
    counts the updates that changed a pose. Raises ModelError if a mesh that
    was made in memory follows a joint which is not there.
    """

    def __init__(
        self,
        drawables: "Drawables",
        models: Sequence[PosedModel],
        node: Rows,
        model_skin: Rows,
    ) -> None:
        self.version = 0
        self._given = models, node, model_skin
        self.skin, self.skins = _find_skins(models, drawables.owner, model_skin)
        self.morphs = MorphPoses(
            drawables.primitives,
            drawables.primitive,
            drawables.owner,
            node,
            [model.weights for model in models],
        )
        self._rest_bounds = drawables.local_bounds.copy()
        self._skinned: Rows = np.flatnonzero(self.skin >= 0)
        boxes = [
            drawables.primitives[position].joint_boxes
            for position in drawables.primitive[self._skinned].tolist()
        ]
        count = np.array([len(each.joints) for each in boxes], np.intp)
        self._box_count: Rows = count
        self._box_draw: Rows = np.repeat(self._skinned, count)
        self._boxes: Array = np.concatenate(
            [np.empty((0, 2, 3)), *(each.boxes for each in boxes)]
        )
        own = np.concatenate(
            [np.empty(0, np.intp), *(each.joints for each in boxes)]
        )
        skin = self.skin[self._box_draw]
        if (own >= self.skins.count[skin]).any():
            raise ModelError("a mesh follows a joint that its skin lacks")
        self._box_joint: Rows = own + self.skins.first[skin]

    def refresh(
        self,
        drawables: "Drawables",
        world: Array,
        touched: NDArray[np.bool_],
    ) -> None:
        """Follow transform rows that are ``touched`` (R,), and weights.

        ``world`` (R, 4, 4) are the world matrices. Sets the boxes of the
        draws in ``drawables`` that this concerns.
        """
        skins = self.skins.refresh(world, touched)
        morphed = self.morphs.refresh()
        if len(skins) or len(morphed):
            self.version += 1
        elif not touched.any():
            return
        changed = np.zeros(len(self.skin), np.bool_)
        changed[morphed] = True
        rigid = np.flatnonzero(changed & (self.skin < 0))
        drawables.local_bounds[rigid] = (
            self._rest_bounds[rigid] + self.morphs.spread[rigid]
        )
        drawables.place_boxes(rigid, world)
        if not len(self._skinned):
            return
        moved = np.zeros(len(self.skins), np.bool_)
        moved[skins] = True
        draws = self._skinned
        # The node of a skinned mesh can move alone, and means nothing.
        changed[draws] |= (
            moved[self.skin[draws]] | touched[drawables.row[draws]]
        )
        self._place(drawables, changed)

    def only(self, kept: NDArray[np.bool_], drawables: "Drawables") -> "Poses":
        """Those of the draws that are ``kept`` (D,), now ``drawables``."""
        models, node, model_skin = self._given
        made = Poses(drawables, models, node[kept], model_skin[kept])
        made._rest_bounds = self._rest_bounds[kept]
        return made

    def place(self, world: Array) -> None:
        """Put skinned draws' matrices (D, 3, 4) at their skins' anchors."""
        draws = self._skinned
        world[draws, :, :3] = np.eye(3)
        world[draws, :, 3] = self.skins.anchor[self.skin[draws]]

    def _place(
        self, drawables: "Drawables", changed: NDArray[np.bool_]
    ) -> None:
        """Set the world boxes of skinned draws that are ``changed`` (D,)."""
        kept = changed[self._skinned]
        draws = self._skinned[kept]
        if not len(draws):
            return
        count = self._box_count[kept]
        chosen = slice(None) if kept.all() else changed[self._box_draw]
        joint, owner = self._box_joint[chosen], self._box_draw[chosen]
        skin = self.skin[draws]
        # What overflows is not finite, and culling keeps that.
        with np.errstate(over="ignore", invalid="ignore"):
            boxes = transform_bounds(
                self.skins.matrices[joint],
                self._boxes[chosen] + self.morphs.spread[owner],
            )
            first = np.cumsum(count) - count
            least = np.minimum.reduceat(boxes[:, 0], first)
            greatest = np.maximum.reduceat(boxes[:, 1], first)
            bounds = np.stack([least, greatest], axis=1)
            bounds += self.skins.anchor[skin][:, None]
        drawables.set_bounds(draws, bounds)
        drawables.mirrored[draws] = self.skins.mirrored[skin]


def _find_skins(
    models: Sequence[PosedModel], owner: Rows, model_skin: Rows
) -> tuple[Rows, SkinPoses]:
    """The skins in use, and for each draw the number of its own or -1."""
    rows: list[Rows] = []
    inverse_bind: list[Array] = []
    skin_of_draw = np.full(len(owner), -1)
    for number, model in enumerate(models):
        if not model.skins:
            continue
        draws = np.flatnonzero((owner == number) & (model_skin >= 0))
        used, own = np.unique(model_skin[draws], return_inverse=True)
        skin_of_draw[draws] = own + len(rows)
        for index in used.tolist():
            skin = model.skins[index]
            rows.append(model.rows[skin.joints])
            inverse_bind.append(skin.inverse_bind)
    return skin_of_draw, SkinPoses(rows, inverse_bind)
