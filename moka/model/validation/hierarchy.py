"""Parents of nodes, as far as a broken file has them."""

from typing import Any

import numpy as np

__all__ = ["is_node", "list_of", "on_loops", "root_of"]

_FOREST = -1


def on_loops(parents: list[int]) -> list[int]:
    """Nodes that are their own ancestors, by jumping twice as far each time."""
    if not parents:
        return []
    jump = np.append(np.array(parents, np.int64), _FOREST)
    steps = len(parents).bit_length()
    for _ in range(steps):
        jump = jump[jump]
    # What is left stands on a loop, and so does all that it leads to.
    on_loop = np.zeros(len(jump), np.bool_)
    ends = jump[jump >= 0]
    above = np.append(np.array(parents, np.int64), _FOREST)
    while ends.size and not on_loop[ends].all():
        on_loop[ends] = True
        ends = above[ends]
    return np.flatnonzero(on_loop[:-1]).tolist()


def root_of(node: int, parents: list[int]) -> int:
    """The root above a node that is on or below no loop."""
    while parents[node] >= 0:
        node = parents[node]
    return node


def list_of(owner: dict[str, Any], name: str) -> list[Any]:
    """A list that an object has, empty if it has none."""
    value = owner.get(name)
    return value if isinstance(value, list) else []


def is_node(value: Any, parents: list[int]) -> bool:
    """Whether a value is the number of a node."""
    return (
        isinstance(value, int)
        and not isinstance(value, bool)
        and 0 <= value < len(parents)
    )
