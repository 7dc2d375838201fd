"""Where the joints of all skins of a scene are, as the GPU reads it.

A vertex goes to the mean, by its weights, of where its joints put it; the
node that places its mesh does not count (glTF 2.0, 3.7.3.3). The joints'
matrices are relative to an anchor among them, in double precision, so that
float32 holds their detail however far away from the origin they are; and
when the camera moves, only anchors move against it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from moka.core.maths import Array, is_mirrored
from moka.model.skins import skin_matrices
from moka.scene.forest import Rows

__all__ = ["SkinPoses"]


class SkinPoses:
    """S skins, each of one model in the scene, with J joints together.

    Given are the transform rows of each skin's joints and their inverse
    bind matrices. ``first`` and ``count`` (S,) tell where a skin's joints
    are in ``rows`` (J,) and ``matrices`` float64 (J, 3, 4), which go from
    the mesh to the world around ``anchor`` (S, 3). ``mirrored`` (S,) tells
    whether most joints turn front faces clockwise. ``version`` (S,) counts
    the changes of a pose.
    """

    def __init__(
        self, rows: Sequence[Rows], inverse_bind: Sequence[Array]
    ) -> None:
        self.count: Rows = np.array([len(each) for each in rows], np.intp)
        self.first: Rows = np.cumsum(self.count) - self.count
        self.rows: Rows = np.concatenate([np.empty(0, np.intp), *rows])
        self.inverse_bind: Array = np.concatenate(
            [np.empty((0, 4, 4)), *inverse_bind]
        )
        self.skin_of_joint: Rows = np.repeat(
            np.arange(len(self.count)), self.count
        )
        self.matrices: Array = np.zeros((len(self.rows), 3, 4))
        self.anchor: Array = np.zeros((len(self.count), 3))
        self.mirrored: NDArray[np.bool_] = np.zeros(len(self.count), np.bool_)
        self.version: NDArray[np.int64] = np.zeros(len(self.count), np.int64)

    def __len__(self) -> int:
        return len(self.count)

    def refresh(self, world: Array, touched: NDArray[np.bool_]) -> Rows:
        """Follow the transform rows that are ``touched`` (R,).

        ``world`` (R, 4, 4) are the world matrices. Returns the skins that
        have changed.
        """
        moved = touched[self.rows]
        if not moved.any():
            return np.empty(0, np.intp)
        skins = np.flatnonzero(np.logical_or.reduceat(moved, self.first))
        if len(skins) == len(self):
            self._follow(skins, slice(None), world)
        else:
            chosen = np.zeros(len(self), np.bool_)
            chosen[skins] = True
            joints = np.flatnonzero(chosen[self.skin_of_joint])
            self._follow(skins, joints, world)
        self.version[skins] += 1
        return skins

    def _follow(self, skins: Rows, joints: Rows | slice, world: Array) -> None:
        """Bring ``skins`` up to date, whose joints are ``joints``."""
        placed = world[self.rows[joints]]
        count = self.count[skins]
        first = np.cumsum(count) - count
        # What overflows is not finite, and culling keeps that.
        with np.errstate(over="ignore", invalid="ignore"):
            centre = np.add.reduceat(placed[:, :3, 3], first) / count[:, None]
            matrices = skin_matrices(placed[:, :3], self.inverse_bind[joints])
            matrices[:, :, 3] -= np.repeat(centre, count, axis=0)
            turned = np.add.reduceat(is_mirrored(matrices), first, dtype=int)
        self.anchor[skins] = centre
        self.matrices[joints] = matrices
        self.mirrored[skins] = 2 * turned > count
