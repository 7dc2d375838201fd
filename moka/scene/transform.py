"""A handle on one transform: position, rotation, scale, parent.

Single values are PyGLM's (``vec3``, ``quat``, ``mat4``), which is imported
when the first of them is needed; what is stored and computed is double
precision. Positions, points and axes are in the space of the parent, which
is the world for a transform without one; angles are radians.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from moka.core.errors import OptionError
from moka.core.maths import Array, look_rotation, rotation_and_stretch
from moka.scene.transforms import TransformTree, check_affine
from moka.scene.values import (
    pyglm,
    to_matrix3,
    to_quaternion,
    to_stretch,
    to_turn,
    to_vector,
)

__all__ = ["Transform"]

_REMOVED = "transform: used after its model was removed from the scene"


class Transform:
    """Where something is, how it is turned and how large it is.

    Stands alone until it is given to a scene, a camera or a parent. Every
    argument takes a PyGLM value or a sequence: ``position`` and ``scale``
    (x, y, z), ``rotation`` (x, y, z, w); ``scale`` may be one number. Without
    arguments it is the identity.

    Raises OptionError for a wrong number of values, NaN or infinity, and
    when it is used after its model was removed from the scene.
    """

    __slots__ = ("__weakref__", "_edit", "_parts", "_row", "_tree")

    _tree: TransformTree | None
    _row: int
    # Position, rotation, stretch as they were at that edit of the row.
    _parts: tuple[Any, Any, Any]
    _edit: int

    def __init__(
        self,
        position: Any = None,
        rotation: Any = None,
        scale: Any = None,
    ) -> None:
        tree = TransformTree()
        self._attach(tree, tree.add())
        # The identity is there already, and needs no PyGLM.
        if position is not None or rotation is not None or scale is not None:
            self._store(
                to_vector(_or(position, (0, 0, 0)), "the position"),
                to_quaternion(_or(rotation, (0, 0, 0, 1))),
                to_stretch(_or(scale, 1)),
            )

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> "Transform":
        """A transform with an affine (4, 4) matrix, [row, column].

        Raises OptionError if it is not affine.
        """
        transform = cls()
        transform.tree.set_local(transform.row, matrix)
        return transform

    @classmethod
    def of_row(cls, tree: TransformTree, row: int) -> "Transform":
        """The handle on ``row`` of ``tree``: the same one while it lives."""
        handle = tree.handles.get(row)
        if isinstance(handle, Transform):
            return handle
        transform = cls.__new__(cls)
        transform._attach(tree, row)
        return transform

    def __repr__(self) -> str:
        if self._tree is None:
            return "<Transform of a removed model>"
        return f"<Transform at {tuple(self._tree.local[self._row, :3, 3])}>"

    @property
    def tree(self) -> TransformTree:
        """The arrays that hold the transform."""
        if self._tree is None:
            raise OptionError(_REMOVED)
        return self._tree

    @property
    def row(self) -> int:
        """Its row in :attr:`tree`."""
        if self._tree is None:
            raise OptionError(_REMOVED)
        return self._row

    @property
    def visible(self) -> bool:
        """Whether its own mark lets it and what is below it be seen.

        What is below a transform that is not visible is not drawn and sheds
        no light, whatever its own mark says; cameras there still see.
        """
        return self.tree.is_visible(self.row)

    @visible.setter
    def visible(self, value: bool) -> None:
        self.tree.set_visible(self.row, value)

    @property
    def position(self) -> Any:
        """Position in metres, ``glm.vec3``; takes any (x, y, z)."""
        return pyglm().vec3(self._current()[0])

    @position.setter
    def position(self, value: Any) -> None:
        _, rotation, stretch = self._current()
        self._store(to_vector(value, "the position"), rotation, stretch)

    @property
    def rotation(self) -> Any:
        """Rotation, unit ``glm.quat``; takes any (x, y, z, w), not zero."""
        return pyglm().quat(self._current()[1])

    @rotation.setter
    def rotation(self, value: Any) -> None:
        position, _, stretch = self._current()
        self._store(position, to_quaternion(value), stretch)

    @property
    def scale(self) -> Any:
        """Scale along the own axes, ``glm.vec3``; takes also one number.

        A mirroring matrix has a negative z scale. Setting it drops shear.
        """
        stretch = self._current()[2]
        return pyglm().vec3(stretch[0][0], stretch[1][1], stretch[2][2])

    @scale.setter
    def scale(self, value: Any) -> None:
        position, rotation, _ = self._current()
        self._store(position, rotation, to_stretch(value))

    @property
    def forward(self) -> Any:
        """Unit vector along the own -Z, ``glm.vec3``."""
        return pyglm().vec3(self._current()[1] * pyglm().dvec3(0, 0, -1))

    @property
    def right(self) -> Any:
        """Unit vector along the own +X, ``glm.vec3``."""
        return pyglm().vec3(self._current()[1] * pyglm().dvec3(1, 0, 0))

    @property
    def up(self) -> Any:
        """Unit vector along the own +Y, ``glm.vec3``."""
        return pyglm().vec3(self._current()[1] * pyglm().dvec3(0, 1, 0))

    def to_matrix(self) -> Any:
        """The local matrix, translation * rotation * scale, ``glm.mat4``."""
        return pyglm().mat4(pyglm().dmat4(self.local_matrix))

    @property
    def local_matrix(self) -> Array:
        """The local matrix, float64 (4, 4), [row, column]; takes any affine.

        Setting keeps shear. Raises OptionError for what is not affine.
        """
        return np.array(self.tree.local[self._row])

    @local_matrix.setter
    def local_matrix(self, matrix: ArrayLike) -> None:
        self.tree.set_local(self._row, matrix)

    @property
    def world_matrix(self) -> Array:
        """The matrix to world space, float64 (4, 4); takes any affine.

        Setting raises OptionError for what is not affine, and where a parent
        has scale 0.
        """
        return np.array(self.tree.world_of(self._row))

    @world_matrix.setter
    def world_matrix(self, matrix: ArrayLike) -> None:
        parent = int(self.tree.parents[self._row])
        world = check_affine(matrix)
        self.local_matrix = self.tree.relative_to(parent, world)

    def translate(self, offset: Any) -> None:
        """Move by ``offset`` in metres."""
        position, rotation, stretch = self._current()
        moved = position + to_vector(offset, "an offset")
        self._store(moved, rotation, stretch)

    def rotate(self, axis: Any, angle: float) -> None:
        """Turn on the spot by ``angle`` about ``axis``."""
        position, rotation, stretch = self._current()
        turn = to_turn(axis, angle)
        self._store(position, turn * rotation, stretch)

    def rotate_around(self, point: Any, axis: Any, angle: float) -> None:
        """Go around a line through ``point`` and turn with it.

        Counter-clockwise by ``angle`` for an observer whom ``axis`` points
        at. The same side keeps facing the line.
        """
        position, rotation, stretch = self._current()
        turn = to_turn(axis, angle)
        centre = to_vector(point, "a point")
        moved = centre + turn * (position - centre)
        self._store(moved, turn * rotation, stretch)

    def look_at(self, target: Any, up: Any = (0, 1, 0)) -> None:
        """Turn -Z towards ``target``, a point in the world.

        +Y points as far towards ``up``, a direction in the world, as it can;
        it may be parallel to the line of sight. Raises OptionError if the
        target is where the transform is.
        """
        tree = self.tree
        world = np.eye(4)
        world[:3, 3] = to_vector(target, "the target")
        world[:3, 1] = to_vector(up, "the up direction")
        parent = int(tree.parents[self._row])
        inside = tree.relative_to(parent, world)
        forward = inside[:3, 3] - tree.local[self._row, :3, 3]
        if not forward.any():
            raise OptionError("transform: cannot look at its own position")
        rotation = look_rotation(forward, inside[:3, 1])
        position, _, stretch = self._current()
        self._store(position, pyglm().quat_cast(to_matrix3(rotation)), stretch)

    @property
    def parent(self) -> "Transform | None":
        """What this transform is relative to; None for the world."""
        row = int(self.tree.parents[self._row])
        return None if row < 0 else Transform.of_row(self.tree, row)

    def set_parent(
        self, parent: "Transform | None", *, keep_world: bool = False
    ) -> None:
        """Become relative to ``parent``, or to the world for None.

        With ``keep_world`` the local matrix changes so that nothing moves.
        Transforms that belong to no scene join the one of the others.
        Raises OptionError if both belong to different scenes, if this would
        be its own ancestor, or if the parent's scale is zero and the world
        matrix is to be kept.
        """
        world = self.world_matrix
        row = -1
        if parent is not None:
            if parent.tree is not self.tree:
                if self.tree.fixed:
                    self.tree.absorb(parent.tree)
                else:
                    parent.tree.absorb(self.tree)
            row = parent.row
        tree = self.tree
        if keep_world:
            local = tree.relative_to(row, world)
        tree.set_parent(self._row, row)
        if keep_world:
            tree.set_local(self._row, local)

    def row_moved(self, tree: TransformTree | None, row: int) -> None:
        """Follow the row; for :class:`TransformTree` alone."""
        known = self._edit == self.tree.edits(self._row)
        self._tree = tree
        self._row = row
        self._edit = tree.edits(row) if known and tree is not None else -1

    def _attach(self, tree: TransformTree, row: int) -> None:
        self._tree = tree
        self._row = row
        self._edit = -1
        tree.handles[row] = self

    def _current(self) -> tuple[Any, Any, Any]:
        """Position, rotation and stretch as dvec3, dquat and dmat3.

        They are remembered, since a scale of zero hides the rotation in the
        matrix; unless someone else wrote the matrix since.
        """
        tree = self.tree
        if self._edit != tree.edits(self._row):
            glm = pyglm()
            local = tree.local[self._row]
            (x, y, z, w), stretch = rotation_and_stretch(local[:3, :3])
            self._parts = (
                glm.dvec3(*local[:3, 3].tolist()),
                glm.dquat(w, x, y, z),
                to_matrix3(stretch),
            )
            self._edit = tree.edits(self._row)
        return self._parts

    def _store(self, position: Any, rotation: Any, stretch: Any) -> None:
        glm = pyglm()
        rotation = glm.normalize(rotation)
        local = np.eye(4)
        local[:3, :3] = glm.mat3_cast(rotation) * stretch
        local[:3, 3] = position
        self.tree.set_local(self._row, local)
        self._parts = (position, rotation, stretch)
        self._edit = self.tree.edits(self._row)


def _or(value: Any, default: Any) -> Any:
    return default if value is None else value
