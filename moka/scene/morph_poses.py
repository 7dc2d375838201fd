"""Which morph targets the draws of a scene show, and how far they reach."""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.maths import Array
from moka.model.mesh import Primitive
from moka.model.morphs import MorphTargets
from moka.scene.forest import NO_ROWS, Rows
from moka.scene.morph_weights import MorphWeights

__all__ = ["MorphGroup", "MorphPoses"]


class MorphGroup(Struct, eq=False):
    """The I draws of one primitive that has T morph targets.

    ``primitive`` is its position among the scene's, ``draws`` (I,) are the
    numbers of the draws, ``places`` (I, T) those of their weights.
    """

    primitive: int
    targets: MorphTargets
    draws: Rows
    places: Rows


class MorphPoses:
    """The weights of all draws of a scene that have morph targets.

    Of D draws, ``spread`` float64 (D, 2, 3) is the box of what positions
    may gain, ``version`` (D,) counts the changes of a draw's weights.
    """

    def __init__(
        self,
        primitives: Sequence[Primitive],
        primitive: Rows,
        owner: Rows,
        node: Rows,
        weights: Sequence[MorphWeights | None],
    ) -> None:
        """Draws by their primitive, model and node, all (D,)."""
        self.spread: Array = np.zeros((len(primitive), 2, 3))
        self.version: NDArray[np.int64] = np.zeros(len(primitive), np.int64)
        self.values = np.empty(0, np.float32)
        self.groups: list[MorphGroup] = []
        self._sources = [each for each in weights if each is not None]
        self._seen: tuple[int, ...] = ()
        sizes = [0 if each is None else len(each) for each in weights]
        before = np.cumsum([0, *sizes[:-1]])
        for position, each in enumerate(primitives):
            if each.targets is None:
                continue
            draws = np.flatnonzero(primitive == position)
            starts = [
                before[model] + source.slice_of(row).start
                for model, row in zip(
                    owner[draws].tolist(), node[draws].tolist(), strict=True
                )
                if (source := weights[model]) is not None
            ]
            places = np.array(starts, np.intp)[:, None] + np.arange(
                len(each.targets)
            )
            group = MorphGroup(position, each.targets, draws, places)
            self.groups.append(group)

    @property
    def has_changed(self) -> bool:
        """Whether weights have changed since the last :meth:`refresh`."""
        return self._versions() != self._seen

    def refresh(self) -> Rows:
        """Follow the weights; the draws whose own have changed."""
        seen = self._versions()
        if seen == self._seen:
            return NO_ROWS
        values = np.concatenate(
            [self.values[:0], *(source.values for source in self._sources)]
        )
        is_first = not self._seen
        changed = np.full(len(values), is_first)
        if not is_first:
            changed = values != self.values
        self._seen, self.values = seen, values
        stale = [NO_ROWS]
        for group in self.groups:
            rows = np.flatnonzero(changed[group.places].any(axis=1))
            if len(rows):
                draws = group.draws[rows]
                self.spread[draws] = group.targets.spread(
                    values[group.places[rows]]
                )
                self.version[draws] += 1
                stale.append(draws)
        return np.concatenate(stale)

    def _versions(self) -> tuple[int, ...]:
        return tuple(source.version for source in self._sources)
