"""Morph targets: what they add to vertices, and how much of each.

Source: glTF 2.0 specification, section 3.7.2.2 (morph targets).
"""

from collections.abc import Sequence

from moka.model import schema
from moka.model.source import GltfSource

__all__ = ["LARGEST_WEIGHT", "check_targets", "check_weights"]

# A sum over hundreds of targets stays far inside float32.
LARGEST_WEIGHT = 1e18


def check_targets(source: GltfSource, path: str, mesh: schema.Mesh) -> None:
    """Raise ModelError unless the mesh's counts of targets agree."""
    count = mesh.target_count
    for number, primitive in enumerate(mesh.primitives):
        if len(primitive.targets) != count:
            raise source.error(
                f"{path}.primitives[{number}].targets",
                f"are {len(primitive.targets)}, those of the first primitive "
                f"are {count}",
            )
    if mesh.weights:
        check_weights(source, f"{path}.weights", mesh.weights, count)


def check_weights(
    source: GltfSource, path: str, weights: Sequence[float], count: int
) -> None:
    """Raise ModelError unless there are ``count`` weights in range."""
    if len(weights) != count:
        raise source.error(
            path, f"are {len(weights)} for {count} morph targets"
        )
    if max(map(abs, weights)) > LARGEST_WEIGHT:
        raise source.error(path, f"are beyond {LARGEST_WEIGHT:g}")
