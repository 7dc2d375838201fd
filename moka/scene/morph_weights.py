"""The weights of a scene model's morph targets, in one array."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import OptionError
from moka.model.model import Model
from moka.model.morphs import LARGEST_WEIGHT

__all__ = ["MorphWeights"]


class MorphWeights:
    """Weights of all morph targets that the nodes of one scene model show.

    ``values`` is float32 (W,): for each node in the order of the model's
    rows, one weight per target of its mesh. They begin as the file says:
    the node's weights, else its mesh's, else 0 (glTF 2.0, 3.7.2.2). Read
    them freely, change them with :meth:`write` or :meth:`set`; ``version``
    counts the changes, so that a still face costs nothing.
    """

    def __init__(self, model: Model) -> None:
        counts = np.array(
            [*(mesh.target_count for mesh in model.meshes), 0], np.intp
        )[model.nodes.mesh]  # -1, no mesh, is the last: 0.
        self._ends: NDArray[np.intp] = np.cumsum(counts)
        self._starts: NDArray[np.intp] = self._ends - counts
        self.values: NDArray[np.float32] = np.zeros(counts.sum(), np.float32)
        self.version = 0
        for row in np.flatnonzero(counts).tolist():
            mesh = model.meshes[model.nodes.mesh[row]]
            weights = model.nodes.weights.get(row, mesh.weights)
            if weights:
                self.values[self.slice_of(row)] = weights

    def __len__(self) -> int:
        return len(self.values)

    def slice_of(self, node: int) -> slice:
        """Where the weights of a node are, by its row in ``model.nodes``.

        Empty for a node without morph targets.
        """
        return slice(int(self._starts[node]), int(self._ends[node]))

    def set(self, node: int, weights: ArrayLike) -> None:
        """Give a node all its weights (T,). Raises OptionError as write."""
        self.write(self.slice_of(node), weights)

    def write(
        self, where: slice | NDArray[np.intp], weights: ArrayLike
    ) -> None:
        """Replace ``values[where]``; counts as a change only if it is one.

        Raises OptionError for another number of weights, and for weights
        that are not finite or beyond 1e18.
        """
        try:
            new = np.asarray(weights, np.float32)
        except (TypeError, ValueError):
            raise OptionError(
                f"morph weights: {weights!r} are not numbers"
            ) from None
        old = self.values[where]
        if new.shape != old.shape:
            raise OptionError(
                f"morph weights: {new.size} given, there are {old.size}"
            )
        if not (np.abs(new) <= LARGEST_WEIGHT).all():
            raise OptionError(
                "morph weights: they must be finite and within 1e18"
            )
        if not np.array_equal(new, old):
            self.values[where] = new
            self.version += 1
